// gradwright check: every input with its unit and where it comes from, what the study will cost, and what is
// doubtful.
#include "cli/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "cli/common.h"
#include "optimise/design_run.h"
#include "optimise/heap_order.h"
#include "optimise/motion.h"
#include "reports/json_support.h"
#include "reports/layers_json.h"
#include "reports/result_json.h"

namespace gradwright::cli {
namespace {

// Supply ratio (dosed solid over laid solid): below the first a dose is refused unless allowed, below the
// second it is doubtful [-].
constexpr double kRefusedSupply = 1.05;
constexpr double kDoubtfulSupply = 1.2;

struct CheckOptions {
    std::string study;
};

int free_count(const DesignSpace& space) {
    if (!space.partition_free) return 0;
    if (space.family == Family::straight) return int(space.angle_deg.free) + int(space.offset.free);
    if (space.family == Family::sigmoid)
        return int(space.centre.free) + int(space.height.free) + int(space.place.free) +
               int(space.width_10_90.free);
    if (space.family == Family::two_curves) return 3 * space.knots - 2;  // one more gap per knot
    // Every knot moves across the dispenser; along it the knots of the curve are free as well, ends excepted.
    return 2 * space.knots - 2;
}

/// What makes the study impossible, as input problems.
std::vector<InputProblem> fatal_problems(const Study& study, const StudyEstimate& estimate) {
    std::vector<InputProblem> problems;
    std::set<std::string> seen;
    for (const SpreadEstimate& spread : estimate.spreads)
        for (const SceneProblem& problem : spread.problems)
            if (problem.fatal && seen.insert(problem.text).second)
                problems.push_back({study.file, 0, "scene", spread.name, problem.text, ""});
    if (estimate.supply_ratio < kRefusedSupply && !study.allow_starved)
        problems.push_back(
            {study.file, 0, "design_space.dosage_factor",
             fmt::format("{:.3g}", start_design(study).dosage_factor),
             fmt::format("the supply ratio is {:.2f}, below {}: the layer would be starved",
                         estimate.supply_ratio, kRefusedSupply),
             "raise dosage_factor, lower layer_thickness, or allow it with process.allow_starved = true"});
    for (const double dosage : study.scale_up.dosage_factors) {
        const Design design = start_design(study);
        const double supply =
            supply_ratio(scaled_strip(study, design, study.scale_up.lengths.front(), dosage, study.seed),
                         kAssumedBedPacking, study.steady_packing);
        if (supply < kRefusedSupply && !study.allow_starved)
            problems.push_back(
                {study.file, 0, "scale_up.dosage_factors", fmt::format("{:.3g}", dosage),
                 fmt::format("the supply ratio is {:.2f}, below {}: that strip would be starved", supply,
                             kRefusedSupply),
                 "leave it out, or take a larger one"});
    }
    return problems;
}

nlohmann::json check_json(const Study& study, const StudyEstimate& estimate, int threads) {
    auto spreads = nlohmann::json::array();
    for (const SpreadEstimate& spread : estimate.spreads)
        spreads.push_back({{"name", spread.name},
                           {"at_most", spread.at_most},
                           {"grains", number(spread.cost.grains)},
                           {"fixed_grains", number(spread.cost.fixed_grains)},
                           {"steps", number(spread.cost.steps)},
                           {"grain_steps", number(spread.cost.grain_steps)},
                           {"memory_bytes", number(spread.cost.memory_bytes)},
                           {"seconds", number(spread.seconds)}});
    return {
        {"study", study.name},
        {"study_file", study.file},
        {"machine", study.machine_name},
        {"target", study.target.describe()},
        {"inputs", inputs_json(study)},
        {"reductions", study.reductions},
        {"variables", {{"partition", estimate.partition_variables}, {"motion", estimate.motion_variables}}},
        {"spreads", spreads},
        {"assumed",
         {{"grain_steps_per_second_per_core", kAssumedSpeed}, {"bed_packing", kAssumedBedPacking}}},
        {"threads", threads},
        {"gap_m", number(estimate.gap)},
        {"layers", study.scene.layers},
        {"judged_layer", judged_layer_json(study)},
        {"packed_depth_m", number(estimate.packed_depth)},
        {"dose_height_m", number(estimate.dose_height)},
        {"supply_ratio", number(estimate.supply_ratio)},
        {"seconds_at_most", number(estimate.seconds_at_most)},
        {"memory_bytes", number(estimate.memory_bytes)},
        {"warnings", all_warnings(study, estimate)}};
}

void print_inputs(const Study& study) {
    std::size_t key_width = 0, value_width = 0;
    for (const InputEntry& input : study.inputs) {
        key_width = std::max(key_width, input.key.size());
        value_width = std::max(value_width, input.value.size());
    }
    value_width = std::min<std::size_t>(value_width, 36);
    std::string section;
    for (const InputEntry& input : study.inputs) {
        const std::string head = input.key.substr(0, input.key.find('.'));
        if (head != section) fmt::print("\n");
        section = head;
        // The value carries its unit already when it was a quantity; a bare number gets it here.
        const bool has_unit = input.unit.empty() || input.unit == "-" ||
                              input.value.find(input.unit) != std::string::npos ||
                              input.value.find_first_not_of("0123456789.eE+-") != std::string::npos;
        const std::string value = has_unit ? input.value : input.value + " " + input.unit;
        fmt::print("  {:<{}}  {:<{}}  {:<12}  {}\n", input.key, key_width, value, value_width, input.origin,
                   input.note);
    }
}

void print_check(const Study& study, const StudyEstimate& estimate, int threads) {
    fmt::print("Study {} ({})\nMachine {}\nTarget  {}\n", study.name, study.file, study.machine_name,
               study.target.describe());
    print_inputs(study);
    fmt::print("\nReductions  {}\n",
               study.reductions.empty() ? "none" : fmt::format("{}", fmt::join(study.reductions, ", ")));
    fmt::print("Free        {} of the partition, {} of the motion\n", estimate.partition_variables,
               estimate.motion_variables);
    fmt::print(
        "Gap         {:.0f} um ({}); dose {:.0f} um; supply ratio {:.2f} at an assumed bed packing of {}\n",
        1e6 * estimate.gap,
        study.gap_steady ? fmt::format("steady, assumed layer packing {}", study.steady_packing) : "as given",
        1e6 * estimate.dose_height, estimate.supply_ratio, kAssumedBedPacking);
    if (study.scene.layers > 1)
        fmt::print(
            "Layers      {}, judged {}; the bed is packed {:.0f} um deep below the rim, a dose for each\n",
            study.scene.layers, judged_number(study) == 0 ? "all" : fmt::format("{}", judged_number(study)),
            1e6 * estimate.packed_depth);
    fmt::print(
        "\nEstimated cost on {} thread{}, at {:.0f} million grain-steps/s and core ('gradwright bench' "
        "measures "
        "yours):\n",
        threads, threads == 1 ? "" : "s", kAssumedSpeed / 1e6);
    for (const SpreadEstimate& spread : estimate.spreads)
        fmt::print("  {:<10}  {} grains ({} fixed), {} steps, {} grain-steps, {}, {} each, at most {}\n",
                   spread.name, count_text(spread.cost.grains), count_text(spread.cost.fixed_grains),
                   count_text(spread.cost.steps), count_text(spread.cost.grain_steps),
                   bytes_text(spread.cost.memory_bytes), duration_text(spread.seconds), spread.at_most);
    fmt::print("  all spreads of the budget: at most {}; sleeping grains and cached beds cost nothing\n",
               duration_text(estimate.seconds_at_most));
    const std::vector<std::string> warnings = all_warnings(study, estimate);
    if (!warnings.empty()) fmt::print("\nWarnings\n");
    for (const std::string& warning : warnings) fmt::print("  {}\n", warning);
}

ExitCode run_check(const CheckOptions& options, const CommonOptions& common) {
    const Study study = load_study(options.study, common);
    const int threads = thread_count(common);
    const StudyEstimate result = estimate(study, threads);
    refuse_impossible(study, result);
    if (common.json)
        fmt::print("{}\n", json_text(check_json(study, result, threads)));
    else
        print_check(study, result, threads);
    return ExitCode::met;
}

}  // namespace

void refuse_impossible(const Study& study, const StudyEstimate& estimate) {
    const std::vector<InputProblem> problems = fatal_problems(study, estimate);
    if (!problems.empty()) throw InputError{problems};
}

std::vector<std::string> all_warnings(const Study& study, const StudyEstimate& estimate) {
    std::vector<std::string> texts;
    std::set<std::string> seen;
    const auto add = [&](const std::string& text) {
        if (seen.insert(text).second) texts.push_back(text);
    };
    for (const std::string& text : study.warnings) add(text);
    for (const SpreadEstimate& spread : estimate.spreads)
        for (const SceneProblem& problem : spread.problems)
            if (!problem.fatal) add(problem.text);
    if (estimate.supply_ratio < kDoubtfulSupply && estimate.supply_ratio >= kRefusedSupply)
        add(fmt::format(
            "supply ratio {:.2f} is below {}: the end of the platform may run dry; raise dosage_factor",
            estimate.supply_ratio, kDoubtfulSupply));
    if (estimate.supply_ratio < kRefusedSupply && study.allow_starved)
        add(fmt::format("supply ratio {:.2f} is below {} and allowed by the study: the layer will be starved",
                        estimate.supply_ratio, kRefusedSupply));
    return texts;
}

StudyEstimate estimate(const Study& study, int threads) {
    const Design design = start_design(study);
    StudyEstimate result;
    struct Planned {
        std::string name;
        Scene scene;
        int at_most;
    };
    std::vector<Planned> planned;
    if (study.scale_up.on()) {
        for (const auto& [length, dosage] : scale_up_plan(study, design.dosage_factor))
            planned.push_back({fmt::format("strip {:.4g} mm, dosage {:.3g}", 1e3 * length, dosage),
                               scaled_strip(study, design, length, dosage, study.seed), 1});
    } else {
        planned.push_back({"map strip", scene_of(study, design, true, study.seed), study.map_spreads});
        planned.push_back({"full width", scene_of(study, design, false, study.seed),
                           std::max(0, study.max_spreads - study.map_spreads)});
    }
    for (const auto& [name, scene, at_most] : planned) {
        SpreadEstimate spread;
        spread.name = name;
        spread.cost = estimate_cost(scene);
        spread.seconds = spread.cost.grain_steps / (kAssumedSpeed * std::max(1, threads));
        spread.at_most = at_most;
        // what is never spread cannot be refused
        if (at_most > 0) spread.problems = validate(scene);
        result.seconds_at_most += spread.at_most * spread.seconds;
        result.memory_bytes = std::max(result.memory_bytes, spread.cost.memory_bytes);
        result.spreads.push_back(std::move(spread));
        result.gap = scene.gap;
    }
    const Scene own = scene_of(study, design, true, study.seed);
    result.dose_height = own.dose_height;
    result.packed_depth = own.floor_depth();
    result.supply_ratio = supply_ratio(own, kAssumedBedPacking, study.steady_packing);
    const DesignSpace& space = study.design_space;
    result.partition_variables = free_count(space);
    for (const MotionVariable& motion : kMotionVariables) result.motion_variables += motion.in(space).free;
    return result;
}

void add_check(CLI::App& app, Call& call) {
    auto options = std::make_shared<CheckOptions>();
    CLI::App* verb = app.add_subcommand(
        "check", "Validate a study: every value with unit and origin, what it will cost, what is doubtful");
    verb->add_option("STUDY", options->study, "Study file (TOML)")->required();
    add_study_options(*verb, call.options);
    verb->add_option("--threads", call.options.threads, "Threads to estimate the time for")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    add_output_options(*verb, call.options);
    verb->callback(
        [options, &call] { call.run = [options, &call] { return run_check(*options, call.options); }; });
}

}  // namespace gradwright::cli
