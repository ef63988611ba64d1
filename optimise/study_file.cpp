// The study file: TOML in, Study out, every problem at once.
#include "optimise/study_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "optimise/build_section.h"
#include "optimise/constraint_section.h"
#include "optimise/heap_order.h"
#include "optimise/joined.h"
#include "optimise/motion.h"
#include "optimise/partition_section.h"
#include "optimise/scene_file.h"
#include "optimise/target_file.h"
#include "optimise/toml_reader.h"

namespace gradwright {
namespace {

constexpr double kSlack = 1e-9;  // relative, for lengths that are meant to be equal

std::string mm(double si) {
    return format_quantity(si, "length");
}

const std::array<std::string, 13> kSections = {
    "study",      "machine",   "process",  "powder", "interaction", "target",         "design_space",
    "constraint", "objective", "numerics", "run",    "scale_up",    "partition_build"};

/// A value of the process that may be freed: its range stands under [design_space], its start is the
/// process's own where that lies inside.
Variable read_freed(Section& space, const std::string& key, const std::string& dimension, double own,
                    const Range& range) {
    Variable result{key, own};
    if (!space.has(key)) {
        space.know(key);
        return result;
    }
    result = space.variable(key, key, dimension, result, "", range);
    const TomlReader::Found found = space.find(key);
    if (found.node->is_array() || found.node->is_table()) {
        if (result.free && found.node->is_array() && own >= result.low && own <= result.high)
            result.value = own;
    } else {
        space.problem(found, key, "can only be freed here: its value stands under [process]",
                      "write a pair [low, high], or move the value to process." + key);
    }
    return result;
}

// --- design space
// ---------------------------------------------------------------------------------------------------

void read_design_space(TomlReader& reader, Section& root, Study& study) {
    Section space = root.sub("design_space");
    DesignSpace& design = study.design_space;
    Scene& scene = study.scene;
    read_partition(reader, space, study);

    Section fill = space.sub("fill_fraction");
    for (const int i : {0, 1}) {
        const std::string label = i == 0 ? "A" : "B";
        design.fill_fraction[i] = fill.variable(label, "fill_fraction." + label, "", design.fill_fraction[i],
                                                "filled to the rim", Range::above_to(0, 1));
    }
    fill.finish();
    Section dose = space.sub("dose");
    for (const int i : {0, 1}) {
        const std::string label = i == 0 ? "A" : "B";
        design.dose[i] = dose.variable(label, "dose." + label, "", design.dose[i],
                                       "one piston under both chambers", Range::above_to(0, 10));
    }
    dose.finish();
    for (const int i : {0, 1})
        if (scene.layers > 1 && (design.dose[i].free || design.dose[i].value != 1))
            reader.conflict({i == 0 ? "design_space.dose.A" : "design_space.dose.B", "process.layers"},
                            "pistons of their own are spread for a single layer only",
                            "leave design_space.dose out, or process.layers at 1");
    Section premix = space.sub("premix");
    const Default pure[2] = {{1, "pure powder"}, {0, "pure powder"}};
    for (const int i : {0, 1})
        scene.share_a[i] = premix.number(i == 0 ? "A" : "B", pure[i], Range::between(0, 1));
    premix.finish();
    const std::vector<std::string> premix_keys = {"design_space.premix.A", "design_space.premix.B"};
    if (reader.sound(premix_keys) && !(scene.share_a[0] > scene.share_a[1]))
        reader.conflict(
            premix_keys,
            fmt::format("chamber A holds {:.3g} of powder A and chamber B {:.3g}: there is nothing to grade",
                        scene.share_a[0], scene.share_a[1]),
            "give chamber A the larger share of powder A");
    else if (reader.sound(premix_keys) && reader.sound({"target"})) {
        const auto [low, high] = study.target.gi_range();
        constexpr double kBeyond = 0.005;
        if (low < scene.share_a[1] - kBeyond || high > scene.share_a[0] + kBeyond)
            study.warnings.push_back(
                fmt::format("the target asks for GI {:.3g} to {:.3g}, the chambers hold {:.3g} to {:.3g} "
                            "(design_space.premix): "
                            "beyond that no partition can go",
                            low, high, scene.share_a[1], scene.share_a[0]));
    }
    design.dosage_factor = space.variable("dosage_factor", "dosage_factor", "", design.dosage_factor,
                                          "section 2.1 of the paper: the dispenser rises by twice the layer",
                                          Range::above_to(0, 100));
    if (space.has("land")) {
        Variable land = space.variable("land", "land", "length", design.land, "", Range::between(0, 10));
        // A free land starts from the machine's own where that lies inside the bounds.
        const toml::node* node = reader.root().at_path("design_space.land").node();
        if (land.free && node && !node->is_table() && scene.land >= land.low && scene.land <= land.high)
            land.value = scene.land;
        design.land = land;
        scene.land = land.value;
    }
    space.know("land");
    design.blade_speed = read_freed(space, "blade_speed", "speed", scene.blade_speed, Range::above_to(0, 10));
    design.layer_thickness =
        read_freed(space, "layer_thickness", "length", scene.layer_thickness, Range::above_to(0, 1e-3));
    design.footprint_offset =
        space.variable("footprint_offset", "footprint_offset", "length", design.footprint_offset,
                       "the part stands where [target] footprint says", Range::between(-10, 10));
    space.finish();

    // Rise of the dispenser floor (physics.md 1.3); dispenser and platform are equally wide.
    const double lengths = scene.platform_length / scene.dispenser_length;
    const Design start = [&] {
        Design result;
        for (const MotionVariable& motion : kMotionVariables) motion.of(result) = motion.in(design).value;
        return result;
    }();
    Study full_size = study;  // the scene below is the real one; coarse grains are scene_of's own business
    full_size.full_coarsening = 1;
    const Scene started = scene_of(full_size, start, false, study.seed);
    scene.blade_speed = started.blade_speed;
    scene.layer_thickness = started.layer_thickness;
    scene.gap = started.gap;
    scene.dose_height = started.dose_height;
    scene.headspace = started.headspace;
    const std::vector<std::string> dose_keys = {"design_space.dosage_factor", "process.layer_thickness",
                                                "design_space.layer_thickness", "design_space.dose",
                                                "machine"};
    reader.derived("process.dose_height", scene.dose_height, "length",
                   "dosage_factor x layer_thickness x platform / dispenser area, times the larger dose");
    const auto lowest = [](const Variable& v) { return v.free ? v.low : v.value; };
    const auto highest = [](const Variable& v) { return v.free ? v.high : v.value; };
    const double h_low = lowest(design.dosage_factor) * lowest(design.layer_thickness) * lengths,
                 h_high = highest(design.dosage_factor) * highest(design.layer_thickness) * lengths *
                          std::max(highest(design.dose[0]), highest(design.dose[1]));
    if (reader.sound(dose_keys) && h_high >= scene.dispenser_depth)
        reader.conflict({"design_space.dosage_factor", "machine.dispenser.depth"},
                        fmt::format("one dose would lift the floor by {}, the dispenser is {} deep",
                                    mm(h_high), mm(scene.dispenser_depth)),
                        "lower the dosage factor, or give a deeper dispenser");
    for (const int i : {0, 1}) {
        const std::string key = i == 0 ? "design_space.fill_fraction.A" : "design_space.fill_fraction.B";
        const double deepest = (1 - lowest(design.fill_fraction[i])) * scene.dispenser_depth;
        const double rise = h_low * lowest(design.dose[i]);
        if (reader.sound(dose_keys) && reader.sound({key}) && deepest >= rise)
            reader.conflict(
                {key},
                fmt::format("leaves the chamber {} below the rim, more than the floor rises ({}): it starves",
                            mm(deepest), mm(rise)),
                fmt::format("fill it above {:.4g}, or raise the dosage factor",
                            std::max(0.0, 1 - rise / scene.dispenser_depth)));
    }
    if (reader.sound({"target.footprint", "machine.platform", "design_space.footprint_offset"}) &&
        (study.footprint.x_low + lowest(design.footprint_offset) < -kSlack ||
         study.footprint.x_high + highest(design.footprint_offset) > scene.platform_length * (1 + kSlack)))
        reader.conflict(
            {"design_space.footprint_offset"},
            fmt::format("shifts the footprint off the platform (0 to {})", mm(scene.platform_length)),
            "narrow the range");
}

void read_objective(Section& root, Study& study) {
    Section section = root.sub("objective");
    Objective& objective = study.objective;
    const std::string norm = section.choice("norm", {"rmse", "mean_absolute", "max"}, "rmse", "our default");
    objective.norm = norm == "rmse" ? Norm::rmse : norm == "max" ? Norm::max : Norm::mean_absolute;
    objective.tolerance =
        section.number("tolerance", {objective.tolerance, "our default"}, Range::above_to(0, 1));
    objective.x_drift_tolerance = section.number(
        "x_drift_tolerance", {objective.x_drift_tolerance, "our default"}, Range::above_to(0, 2));
    objective.x_drift_weight =
        section.number("x_drift_weight", {objective.x_drift_weight, "a ramp that wanders along x is no ramp"},
                       Range::between(0, 1e6));
    objective.waste_weight =
        section.number("waste_weight", {objective.waste_weight, "price of powder that ends in the overflow"},
                       Range::between(0, 1e6));
    objective.min_coverage =
        section.number("min_coverage", {objective.min_coverage, "our default"}, Range::between(0, 1));
    if (section.has("max_waste"))
        objective.max_waste = section.number("max_waste", {0, ""}, Range::above_to(0, 1));
    if (section.has("min_supply_ratio"))
        objective.min_supply_ratio = section.number("min_supply_ratio", {0, ""}, Range::above_to(0, 100));
    section.know("max_waste");
    section.know("min_supply_ratio");
    section.finish();
}

void read_run(TomlReader& reader, Section& root, Study& study) {
    Section section = root.sub("run");
    study.seed = static_cast<std::uint64_t>(section.integer("seed", 1, "the same seed gives the same numbers",
                                                            0, std::numeric_limits<long>::max()));
    study.max_spreads = static_cast<int>(
        section.integer("max_spreads", 4, "budget: map and confirming spreads together", 1, 100000));
    study.map_spreads =
        static_cast<int>(section.integer("map_spreads", 1, "spreads pooled in the map", 1, 100000));
    section.finish();
    if (reader.sound({"run"}) && study.map_spreads > study.max_spreads)
        reader.conflict(
            {"run.map_spreads", "run.max_spreads"},
            fmt::format("{} map spreads exceed the budget of {}", study.map_spreads, study.max_spreads),
            "raise max_spreads or lower map_spreads");
    study.scene.seed = study.seed;
}

/// [scale_up]: the machine is not spread but extrapolated from strips.
void read_scale_up(TomlReader& reader, Section& root, Study& study) {
    if (!root.has("scale_up")) {
        root.know("scale_up");
        return;
    }
    Section section = root.sub("scale_up");
    const double length = study.scene.dispenser_length;
    std::vector<double> lengths =
        section.quantities("lengths", "length", {1.6e-3, 3.2e-3, 6.4e-3, 12.8e-3},
                           "our default: five to ten minutes on two cores", 3, Range::above_to(0, 10));
    const double own = study.design_space.dosage_factor.value;
    std::vector<double> dosages = section.quantities(
        "dosage_factors", "", {own, 1.25 * own, 1.5 * own},
        "the study's own, 1.25 and 1.5 times it: less could starve", 1, Range::above_to(0, 100));
    section.finish();
    if (reader.sound({"scale_up.lengths", "machine.dispenser"}))
        for (const double strip : lengths)
            if (strip >= length)
                reader.conflict({"scale_up.lengths"},
                                fmt::format("{} is no shorter than the dispenser, {}", mm(strip), mm(length)),
                                "leave it out; a dispenser that can be spread needs no [scale_up]");
    for (const MotionVariable& motion : kMotionVariables)
        if (motion.in(study.design_space).free)
            reader.conflict(
                {std::string("design_space.") + motion.name},
                "must not be free beside [scale_up]: an extrapolated machine is designed at one motion",
                "give it one value");
    for (const int i : {0, 1})
        if (study.design_space.fill_fraction[i].value != 1 && !study.design_space.fill_fraction[i].free)
            reader.conflict(
                {i == 0 ? "design_space.fill_fraction.A" : "design_space.fill_fraction.B"},
                "must be 1 beside [scale_up]: an extrapolated machine is designed with full chambers",
                "fill both to 1");
    for (const int i : {0, 1})
        if (study.design_space.dose[i].value != 1 && !study.design_space.dose[i].free)
            reader.conflict({i == 0 ? "design_space.dose.A" : "design_space.dose.B"},
                            "must be 1 beside [scale_up]: an extrapolated machine has one dispenser floor",
                            "leave design_space.dose out");
    if (study.target.is_field())
        reader.conflict(
            {"target.shape"},
            "\"field\" has no place beside [scale_up]: an extrapolated machine has no cells along x",
            "ask for a gradation over y, or leave [scale_up] out");
    study.scale_up = {lengths, dosages};
    // what the law is fitted to is not a search that could be cut short
    const auto plan = scale_up_plan(study, own);
    study.max_spreads = std::max(study.max_spreads, int(plan.size()));
    reader.amend("run.max_spreads", fmt::format("{}", study.max_spreads), "derived",
                 "as many as scale_up asks for");
}

void warn_of_estimates(TomlReader& reader, Study& study) {
    std::vector<std::string> estimated;
    for (const InputEntry& entry : reader.inputs())
        if (entry.note.find("measure this") != std::string::npos)
            estimated.push_back(fmt::format("{} ({})", entry.key, entry.value));
    if (!estimated.empty())
        study.warnings.push_back(
            fmt::format("stand-ins of the machine file, to be measured on yours and set in the "
                        "study: {}",
                        joined(estimated)));
}

std::size_t section_index(const std::string& key) {
    const std::string section = key.substr(0, key.find('.'));
    return static_cast<std::size_t>(std::find(kSections.begin(), kSections.end(), section) -
                                    kSections.begin());
}

void warn_of_layers(Study& study) {
    const auto& fill = study.design_space.fill_fraction;
    const bool fills = fill[0].free || fill[1].free || fill[0].value != fill[1].value;
    if (study.scene.layers > 1 && fills && judged_number(study) != 1)
        study.warnings.push_back(fmt::format(
            "unequal fill fractions act in the first layer only, and target.layer judges {}: the blade has "
            "levelled the chambers by then",
            judged_number(study) == 0 ? "all layers together"
                                      : fmt::format("layer {}", judged_number(study))));
    if (study.scene.layers > 1 && study.scene.substrate == Substrate::fused &&
        (study.footprint.x_low > 0 || study.footprint.x_high < study.scene.platform_length))
        study.warnings.push_back(
            "every layer is melted over the whole platform, the part's footprint is smaller: in the machine "
            "the "
            "powder beside the part stays");
}

}  // namespace

std::string InputProblem::text() const {
    std::string result = file;
    if (line > 0) result += fmt::format(":{}", line);
    result += ": ";
    if (!key.empty()) result += key + (value.empty() ? "" : " = " + value) + ": ";
    result += rule;
    if (!mend.empty()) result += "; " + mend;
    return result;
}

std::string report_of(const InputError& error) {
    std::string result = fmt::format("{} problem{} in the input\n", error.problems.size(),
                                     error.problems.size() == 1 ? "" : "s");
    int index = 0;
    for (const InputProblem& problem : error.problems)
        result += fmt::format("{:3d}. {}\n", ++index, problem.text());
    return result;
}

Study parse_study(const std::string& text, const std::string& file_name,
                  const std::vector<std::string>& overrides) {
    TomlReader reader(text, file_name, overrides);
    Study study;
    study.file = file_name;
    study.text = text;
    Section root(reader, &reader.root(), "", 0);
    Section naming = root.sub("study");
    study.name = naming.text("name", std::filesystem::path(file_name).stem().string(), "the file's name");
    naming.finish();
    read_machine(reader, root, study);
    read_powders(reader, root, study);
    read_process(reader, root, study);
    read_interaction(reader, root, study);
    read_numerics(reader, root, study);
    read_target(reader, root, study);
    read_design_space(reader, root, study);
    read_constraints(reader, root, study);
    read_objective(root, study);
    read_run(reader, root, study);
    read_scale_up(reader, root, study);
    read_partition_build(reader, root, study);
    root.finish();
    if (!reader.problems().empty()) {
        std::stable_sort(reader.problems().begin(), reader.problems().end(),
                         [](const InputProblem& a, const InputProblem& b) {
                             return a.file != b.file ? a.file < b.file : a.line < b.line;
                         });
        throw InputError{reader.problems()};
    }
    warn_of_estimates(reader, study);
    warn_of_layers(study);
    study.inputs = std::move(reader.inputs());
    std::stable_sort(study.inputs.begin(), study.inputs.end(), [](const InputEntry& a, const InputEntry& b) {
        return section_index(a.key) < section_index(b.key);
    });
    return study;
}

Study read_study(const std::string& file, const std::vector<std::string>& overrides) {
    std::error_code ignored;
    std::ifstream stream(file, std::ios::binary);
    std::stringstream text;
    text << stream.rdbuf();
    if (!stream || std::filesystem::is_directory(file, ignored))
        throw InputError{{{file, 0, "", "", "cannot be read", "check the path and the permissions"}}};
    return parse_study(text.str(), file, overrides);
}

}  // namespace gradwright
