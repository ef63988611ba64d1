// Machines and designs that the tests of the hand-over build plates of: straight, bent, a pair, a printed
// curve.
#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "optimise/build_section.h"
#include "optimise/partition_family.h"
#include "reports/hand_over.h"
#include "tests/reports/fixture.h"

namespace gradwright::fixture {

inline constexpr double kDegree = std::numbers::pi / 180;

inline FinishedDesign straight(const Study& study, double degrees, double offset = 0) {
    FinishedDesign finished;
    finished.verdict = "met";
    finished.design.family = Family::straight;
    finished.design.partition =
        straight_partition(study.scene.dispenser_length, study.dispenser_width, degrees * kDegree, offset);
    finished.design.dosage_factor = 3;
    finished.design.land = study.scene.land;
    return finished;
}

/// A dispenser of 100 x 60 x 40 mm, in which sheet of 0.5 mm is thin.
inline Study large() {
    Study study = fixture::study("large machine");
    study.scene.dispenser_length = study.scene.platform_length = 0.1;
    study.dispenser_width = study.scene.width = 0.06;
    study.scene.dispenser_depth = 0.04;
    study.build.thickness = 0.5e-3;
    study.build.engraving = 0.1e-3;
    study.build.bend_radius = 1e-3;
    study.build.k_factor = din_k_factor(1e-3, 0.5e-3);
    return study;
}

/// The same, its plates held by tabs.
inline Study with_tabs(Study study) {
    study.build.tabs = true;
    study.build.slot_depth = 5e-3;
    study.build.tab_depth = 3e-3;
    study.build.end_clearance = 12e-6;
    return study;
}

inline FinishedDesign bent() {
    FinishedDesign finished;
    finished.verdict = "met";
    finished.design.partition.points = {{0, 0.01}, {0.04, 0.02}, {0.07, 0.04}, {0.1, 0.045}};
    finished.design.dosage_factor = 2;
    finished.waste_fraction = 0.2;
    finished.waste_a_share = 0.25;
    return finished;
}

inline FinishedDesign pair_of_curves() {
    FinishedDesign finished = bent();
    finished.design.family = Family::two_curves;
    finished.design.partition.points = {{0, 0.04}, {0.05, 0.045}, {0.1, 0.04}};
    finished.design.partition.second = {{0.1, 0.02}, {0.05, 0.015}, {0, 0.02}};
    return finished;
}

inline FinishedDesign smooth(Study& study) {
    study.build.printed = true;
    study.build.thickness = 1e-3;
    FinishedDesign finished = bent();
    finished.design.family = Family::spline;
    finished.design.partition.points =
        spline_through(std::vector<PlanPoint>{{0, 0.01}, {0.03, 0.015}, {0.06, 0.04}, {0.1, 0.05}});
    return finished;
}

struct Built {
    Study study;
    FinishedDesign finished;
};
/// Straight, bent, a pair, a printed curve; each in slots and by tabs.
inline std::vector<Built> every_kind() {
    Study printed = large();
    const FinishedDesign curve = smooth(printed);
    std::vector<Built> all;
    for (const Built& one : {Built{large(), straight(large(), 20)},
                             {large(), straight(large(), -35)},
                             {large(), bent()},
                             {large(), pair_of_curves()},
                             {printed, curve}}) {
        all.push_back(one);
        all.push_back({with_tabs(one.study), one.finished});
    }
    return all;
}

inline double length_of(const std::vector<PlanPoint>& line) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
        sum += std::hypot(line[i + 1].x - line[i].x, line[i + 1].y - line[i].y);
    return sum;
}

}  // namespace gradwright::fixture
