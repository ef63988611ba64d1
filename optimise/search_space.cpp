#include "optimise/search_space.h"

#include <algorithm>

namespace gradwright {

SearchSpace::SearchSpace(const Study& study, const PartitionFamily& family, const Design& start,
                         const std::vector<double>& p, Moves moves)
    : study_(study),
      family_(family),
      design_(start),
      partition_free_(study.design_space.partition_free),
      low_(family.low()),
      high_(family.high()),
      start_(p),
      step_(p.size(), 0.1) {
    family_.clip(start_);
    if (!partition_free_) low_ = high_ = start_;
    const DesignSpace& space = study.design_space;
    Variable offset = space.footprint_offset;
    offset.low = std::max(offset.low, -study.footprint.x_low);
    offset.high = std::min(offset.high, study.scene.platform_length - study.footprint.x_high);
    const bool all = moves == Moves::everything;
    const auto free = [](const Variable& variable, bool moves) {
        return moves && variable.free && variable.high > variable.low;
    };
    for (std::size_t i = 0; i < motion_.size(); ++i) {
        const bool place = !kMotionVariables[i].spreads;
        const Variable* variable = place ? &offset : &kMotionVariables[i].in(space);
        if (free(*variable, all || place)) motion_[i] = {variable->low, variable->high - variable->low};
        const double range = motion_[i].range;
        low_.push_back(0);
        high_.push_back(range > 0 ? 1 : 0);
        start_.push_back(range > 0 ? std::clamp((variable->value - variable->low) / range, 0.0, 1.0) : 0);
        step_.push_back(0.2);
    }
}

int SearchSpace::free_count() const {
    int count = 0;
    for (std::size_t i = 0; i < size(); ++i) count += high_[i] > low_[i];
    return count;
}

std::vector<double> SearchSpace::kept(const std::vector<double>& x) const {
    std::vector<double> inside = x;
    for (std::size_t i = 0; i < size(); ++i) inside[i] = std::clamp(inside[i], low_[i], high_[i]);
    if (study_.constraints.empty()) return inside;
    std::vector<std::pair<double, double>> bounds;
    for (const ConstraintState& state : constraint_states(study_, at(inside, false)))
        bounds.emplace_back(state.low / state.scale, state.high / state.scale);
    return nearest_kept(
        [this](const std::vector<double>& point) {
            std::vector<double> values;
            for (const ConstraintState& state : constraint_states(study_, at(point, false)))
                values.push_back(state.value / state.scale);
            return values;
        },
        bounds, low_, high_, inside);
}

double SearchSpace::detour(const std::vector<double>& x) const {
    return study_.constraints.empty() ? 0 : gradwright::detour(x, kept(x));
}

Design SearchSpace::design(const std::vector<double>& x) const {
    return at(kept(x), true);
}

Design SearchSpace::at(const std::vector<double>& inside, bool with_curve) const {
    Design design = design_;
    const std::size_t parameters = size() - motion_.size();
    if (partition_free_) {
        const auto p = std::span(inside).first(parameters);
        design.family = family_.family();
        if (with_curve) design.partition = family_.curve(p);
        design.parameters = family_.named(p);
    }
    for (std::size_t i = 0; i < motion_.size(); ++i)
        if (motion_[i].range > 0)
            kMotionVariables[i].of(design) = motion_[i].low + inside[parameters + i] * motion_[i].range;
    return design;
}

double SearchSpace::unsound(const std::vector<double>& x) const {
    if (!partition_free_) return 0;
    std::vector<double> inside = kept(x);
    inside.resize(inside.size() - motion_.size());
    return family_.unsound(inside);
}

}  // namespace gradwright
