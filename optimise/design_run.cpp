#include "optimise/design_run.h"

#include <fmt/format.h>

#include <numbers>

#include "optimise/dem_evaluator.h"
#include "optimise/kinematic_evaluator.h"
#include "optimise/lammps_spread.h"
#include "optimise/map_evaluator.h"
#include "optimise/motion.h"
#include "optimise/partition_family.h"

namespace gradwright {
namespace {

/// SplitMix64 (Steele, Lea, Flood 2014): neighbouring inputs give unrelated outputs.
std::uint64_t split_mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

/// Seed number `index` of a study: 52 mixed bits over the lowest, which says what it is for.
std::uint64_t derived_seed(std::uint64_t study_seed, int index, bool confirmation) {
    const std::uint64_t mixed = split_mix(split_mix(study_seed) + std::uint64_t(index));
    return ((mixed >> 12) << 1) | (confirmation ? 1 : 0);
}

}  // namespace

std::uint64_t map_seed(std::uint64_t study_seed, int index) {
    return derived_seed(study_seed, index, false);
}
std::uint64_t confirmation_seed(std::uint64_t study_seed, int index) {
    return derived_seed(study_seed, index, true);
}

Design start_design(const Study& study) {
    const DesignSpace& space = study.design_space;
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    Design design;
    design.family = space.family;
    for (const MotionVariable& motion : kMotionVariables) motion.of(design) = motion.in(space).value;
    if (space.family == Family::straight) {
        design.partition = straight_partition(length, width, space.angle_deg.value * std::numbers::pi / 180,
                                              space.offset.value);
        design.parameters = {{"angle_deg", space.angle_deg.value}, {"offset_m", space.offset.value}};
        return design;
    }
    if (space.given_points.size() >= 2) {
        const bool smooth = space.family == Family::spline;
        design.partition.points = smooth ? spline_through(space.given_points) : space.given_points;
        design.partition.second = space.given_second;
        for (std::size_t k = 0; k < space.given_points.size(); ++k) {
            design.parameters.emplace_back(fmt::format("x{}_m", k), space.given_points[k].x);
            design.parameters.emplace_back(fmt::format("y{}_m", k), space.given_points[k].y);
        }
        for (std::size_t k = 0; k < space.given_second.size(); ++k) {
            design.parameters.emplace_back(fmt::format("second_x{}_m", k), space.given_second[k].x);
            design.parameters.emplace_back(fmt::format("second_y{}_m", k), space.given_second[k].y);
        }
        if (smooth) design.parameters.emplace_back("least_bend_radius_m", spline_radius(space.given_points));
        return design;
    }
    const bool above = stands_above(study, space);
    const PartitionFamily family(space, length, width, {above, !above});
    const std::vector<double> p =
        closed_form_start(study, family, [&](double share) { return share * length; });
    design.partition = family.curve(p);
    design.parameters = family.named(p);
    return design;
}

Evaluation evaluate_once(const Study& study, const Design& design, Fidelity fidelity, std::uint64_t seed,
                         const RunOptions& options, SpreadResult* spread) {
    SpreadRunner runner(options);
    Journal journal(options.journal_folder);
    switch (fidelity) {
        case Fidelity::kinematic: {
            const Evaluation evaluation = KinematicEvaluator(study).evaluate(design, seed);
            journal.append(evaluation);
            return evaluation;
        }
        case Fidelity::map:
            return MapEvaluator(study, runner, &journal).evaluate(design, seed);
        case Fidelity::lammps:
            return LammpsEvaluator(study, options, options.lammps_folder, &journal).evaluate(design, seed);
        case Fidelity::full:
            break;
    }
    DemEvaluator evaluator(study, runner, &journal);
    const Evaluation evaluation = evaluator.evaluate(design, seed);
    if (spread) *spread = evaluator.last();
    return evaluation;
}

}  // namespace gradwright
