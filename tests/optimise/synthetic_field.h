// Targets over x and y whose cells are known: a partition's own truth on a heap, or a closed form.
#pragma once
#include <functional>

#include "tests/optimise/synthetic_heap.h"

namespace gradwright::testing_heap {

/// Field through gi(x, y) on a grid of `columns` x `rows` points over the footprint [m].
inline Target field_through(const Study& study, int columns, int rows,
                            const std::function<double(double x, double y)>& gi) {
    Target field;
    field.shape = TargetShape::field;
    const Footprint& f = study.footprint;
    for (int i = 0; i < columns; ++i)
        field.field_x.push_back(f.x_low + (f.x_high - f.x_low) * i / (columns - 1));
    for (int j = 0; j < rows; ++j) field.table_y.push_back(study.dispenser_width * j / (rows - 1));
    for (const double y : field.table_y)
        for (const double x : field.field_x) field.field_gi.push_back(gi(x, y));
    field.table_gi.assign(field.table_y.size(), 0);
    return field.over_x(f.x_low, f.x_high);
}

/// True GI of every cell, column after column.
inline std::vector<double> true_cells(const Heap& heap, const Study& study, const Design& design,
                                      bool labelled) {
    std::vector<double> cells;
    Study column = study;
    const double low = study.footprint.x_low, width = (study.footprint.x_high - low) / study.columns;
    for (int c = 0; c < study.columns; ++c) {
        column.footprint.x_low = low + c * width;
        column.footprint.x_high = low + (c + 1) * width;
        const Truth of_column = truth(heap, column, design, labelled);
        cells.insert(cells.end(), of_column.gi.begin(), of_column.gi.end());
    }
    return cells;
}

/// True rmse over the cells that count.
inline double true_field_rmse(const Heap& heap, const Study& study, const Design& design) {
    std::vector<double> residual = true_cells(heap, study, design, true);
    const std::vector<double> target = field_targets(study);
    for (std::size_t c = 0; c < residual.size(); ++c) residual[c] -= target[c];
    return norm_of(Norm::rmse, residual, field_weights(study));
}

}  // namespace gradwright::testing_heap
