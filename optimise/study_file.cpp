// The study file: TOML in, Study out, every problem at once.
#include "optimise/study_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "optimise/joined.h"
#include "optimise/scene_file.h"
#include "optimise/toml_reader.h"

namespace gradwright {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSlack = 1e-9;  // relative, for lengths that are meant to be equal

std::string mm(double si) {
    return format_quantity(si, "length");
}

const std::array<std::string, 10> kSections = {"study",       "machine", "process",      "powder",
                                               "interaction", "target",  "design_space", "objective",
                                               "numerics",    "run"};

// --- target
// ---------------------------------------------------------------------------------------------------------

/// Keys that only one shape has.
const std::vector<std::pair<std::string, std::string>> kShapeKeys = {{"from", "linear"},
                                                                     {"to", "linear"},
                                                                     {"centre", "sigmoid"},
                                                                     {"width_10_90", "sigmoid"},
                                                                     {"gi_low", "sigmoid, step"},
                                                                     {"gi_high", "sigmoid, step"},
                                                                     {"y", "step"},
                                                                     {"file", "table"}};

std::pair<double, double> end_of_ramp(Section& target, const std::string& key, double gi) {
    const std::string mend = fmt::format("write {} = {{ y = \"0.4 mm\", gi = {:.1f} }}", key, gi);
    if (!target.has(key)) {
        target.know(key);
        target.missing(key, mend);
        return {gi * 1e-3, gi};
    }
    Section end = target.sub(key);
    const double y = end.quantity("y", "length", required(mend), Range::between(-10, 10));
    const double value = end.number("gi", required(mend), Range::between(0, 1));
    end.finish();
    return {y, value};
}

void read_zones(TomlReader& reader, Section& target, Study& study) {
    const TomlReader::Found found = target.find("zones");
    if (!found.node) {
        reader.record({"target.zones", "none", "", "default", "every bin weighs 1"});
        return;
    }
    const toml::array* array = found.node->as_array();
    if (!array) {
        target.problem(found, "zones", "must be a list of tables",
                       "such as [{ from = \"0 mm\", to = \"0.4 mm\", weight = 0 }]");
        return;
    }
    int index = 0;
    for (const toml::node& item : *array) {
        const std::string key = fmt::format("zones[{}]", index++);
        TomlReader::Found at = found;
        at.node = &item;
        if (found.line > 0) at.line = static_cast<int>(item.source().begin.line);
        if (!item.is_table()) {
            target.problem(at, key, "must be a table",
                           "such as { from = \"0 mm\", to = \"0.4 mm\", weight = 0 }");
            continue;
        }
        Section zone(reader, item.as_table(), target.path(key), at.line);
        TargetZone read;
        read.y_low =
            zone.quantity("from", "length", required("where the zone begins"), Range::between(-10, 10));
        read.y_high = zone.quantity("to", "length", required("where the zone ends"), Range::between(-10, 10));
        read.weight =
            zone.number("weight", {0, "a zone without a weight is don't-care"}, Range::between(0, 1e6));
        zone.finish();
        if (reader.sound({target.path(key)}) && !(read.y_low < read.y_high))
            target.problem(at, key, "must have from < to", "swap the two");
        study.target.zones.push_back(read);
    }
}

void read_shape(TomlReader& reader, Section& target, Study& study) {
    if (!target.has("shape")) {
        target.know("shape");
        target.missing("shape", "write shape = \"linear\", \"sigmoid\", \"step\" or \"table\"");
        for (const auto& [key, shapes] : kShapeKeys) target.know(key);
        return;
    }
    const std::string shape = target.choice("shape", {"linear", "sigmoid", "step", "table"}, "", "");
    for (const auto& [key, shapes] : kShapeKeys) {
        if (shape.empty())
            target.know(key);
        else if (shapes.find(shape) == std::string::npos)
            target.refuse(key, fmt::format("has no place in shape = \"{}\"", shape),
                          fmt::format("leave it out, or choose a shape that has it: {}", shapes));
    }
    if (shape.empty()) return;
    const Range gi = Range::between(0, 1);
    if (shape == "linear") {
        auto [y0, gi0] = end_of_ramp(target, "from", 0);
        auto [y1, gi1] = end_of_ramp(target, "to", 1);
        if (reader.sound({"target.from", "target.to"})) {
            if (y0 == y1)
                reader.conflict({"target.from.y", "target.to.y"}, "from.y and to.y must differ",
                                "for a jump write shape = \"step\", y = ...");
            if (y0 > y1) {
                std::swap(y0, y1);
                std::swap(gi0, gi1);
            }
        }
        study.target = linear_target(y0, gi0, y1, gi1);
    } else if (shape == "sigmoid") {
        const double centre =
            target.quantity("centre", "length", required("where the GI is midway"), Range::between(-10, 10));
        const double width = target.quantity("width_10_90", "length", required("from 10 to 90 % of the rise"),
                                             Range::above_to(0, 10));
        const double low = target.number("gi_low", {0, "GI far below the centre"}, gi);
        const double high = target.number("gi_high", {1, "GI far above the centre"}, gi);
        study.target = sigmoid_target(centre, width, low, high);
    } else if (shape == "step") {
        const double y =
            target.quantity("y", "length", required("where the GI jumps"), Range::between(-10, 10));
        const double low = target.number("gi_low", {0, "GI below the step"}, gi);
        const double high = target.number("gi_high", {1, "GI above the step"}, gi);
        study.target = step_target(y, low, high);
    } else {
        if (!target.has("file")) {
            target.know("file");
            target.missing("file", "name a CSV file with the columns y_mm and gi, relative to the study");
            return;
        }
        const TomlReader::Found found = target.find("file");
        const std::string file = target.text("file", "", "");
        if (file.empty()) return;
        const std::filesystem::path path = std::filesystem::path(reader.file()).parent_path() / file;
        try {
            study.target = table_target(path.string());
            study.target.table_file = file;
        } catch (const std::runtime_error& error) {
            target.problem(found, "file", error.what(), "mend the table or name another file");
        }
    }
}

void read_target(TomlReader& reader, Section& root, Study& study) {
    Section target = root.sub("target");
    if (!root.has("target")) {
        root.missing(
            "target",
            "say what is wanted: [target] shape = \"linear\", from = { y = \"0.4 mm\", gi = 0 }, to = ...");
        return;
    }
    read_shape(reader, target, study);
    read_zones(reader, target, study);

    const double width = study.dispenser_width, length = study.scene.platform_length;
    study.bins.width = target.quantity("bin_width", "length", {0.2e-3, "0.2 mm: section 2.1 of the paper"},
                                       Range::above_to(0, 10));
    study.bins.count = static_cast<int>(std::min(1e6, std::floor(width / study.bins.width * (1 + kSlack))));
    Section footprint = target.sub("footprint");
    const auto x = footprint.pair("x", "length", {0, length}, "the whole platform", Range::between(0, 10));
    // Beside a wall the layer is the wall's, not the design's: 2 D90 at each side stay out of the misfit
    // (physics.md 1).
    const double margin = study.scene.sides == Sides::periodic
                              ? 0
                              : 2 * std::max(study.scene.powder[0].size.d90, study.scene.powder[1].size.d90);
    const bool room = width - 2 * margin > study.bins.width;
    const auto y =
        footprint.pair("y", "length", {room ? margin : 0, room ? width - margin : width},
                       margin > 0 && room ? "the width less 2 D90 beside each wall" : "the whole width",
                       Range::between(0, 10));
    footprint.finish();
    study.footprint = {x.first, x.second, y.first, y.second};
    target.finish();

    if (reader.sound({"target", "machine"})) {
        if (x.second > length * (1 + kSlack))
            reader.conflict({"target.footprint.x"},
                            fmt::format("must end on the platform, which is {} long", mm(length)),
                            "shorten or move the footprint");
        if (y.second > width * (1 + kSlack))
            reader.conflict({"target.footprint.y"}, fmt::format("must end within the width {}", mm(width)),
                            "narrow the footprint");
        int inside = 0;
        for (int bin = 0; bin < study.bins.count; ++bin)
            inside += study.bins.low(bin) >= y.first - kSlack * width &&
                      study.bins.low(bin) + study.bins.width <= y.second + kSlack * width;
        if (inside == 0)
            reader.conflict(
                {"target.bin_width", "target.footprint.y"},
                fmt::format("no bin of {} lies wholly inside the footprint", mm(study.bins.width)),
                "make the bins narrower or the footprint wider");
        if (margin > 0 && reader.given("target.footprint.y") &&
            (y.first < margin * (1 - kSlack) || y.second > (width - margin) * (1 + kSlack)))
            study.warnings.push_back(
                fmt::format("the footprint reaches into the {} beside a wall, where the wall and "
                            "not the partition decides the layer",
                            mm(margin)));
        if (study.bins.count * study.bins.width < width * (1 - 1e-6))
            study.warnings.push_back(fmt::format(
                "the width {} is no multiple of the bin width {}: the last {} are not judged", mm(width),
                mm(study.bins.width), mm(width - study.bins.count * study.bins.width)));
    }
    if (!reader.sound({"target"})) return;
    for (const std::string& rule : problems(study.target))
        reader.conflict({"target.shape"}, rule, "change [target]");
    const double middle = study.target(0.5 * (y.first + y.second));
    if (std::abs(study.target(y.first) - middle) < 1e-6 && std::abs(study.target(y.second) - middle) < 1e-6)
        study.warnings.push_back(
            "the target is the same everywhere in the footprint: no gradation is asked for");
}

// --- design space
// ---------------------------------------------------------------------------------------------------

void read_partition(TomlReader& reader, Section& space, Study& study) {
    Section section = space.sub("partition");
    DesignSpace& design = study.design_space;
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const bool straight =
        section.choice("family", {"polyline", "straight"}, "polyline",
                       "our default: a straight one reproduces a ramp to 0.04-0.05 only") == "straight";
    design.family = straight ? Family::straight : Family::polyline;
    const std::vector<std::string> polyline = {"knots", "monotone", "points", "start", "minimum_segment"};
    for (const std::string& key : straight ? polyline : std::vector<std::string>{"angle", "offset"})
        section.refuse(
            key, fmt::format("has no place in family = \"{}\"", straight ? "straight" : "polyline"),
            fmt::format("leave it out, or choose family = \"{}\"", straight ? "polyline" : "straight"));
    if (straight) {
        Variable angle = design.angle_deg, offset = design.offset;
        offset.low = -0.5 * width;
        offset.high = 0.5 * width;
        design.angle_deg =
            section.variable("angle", "partition.angle", "angle", angle, "free: bounds of the family",
                             Range::between(-90 * kDegree, 90 * kDegree), kDegree);
        design.offset = section.variable("offset", "partition.offset", "length", offset,
                                         "free: half the width to each side", Range::between(-10, 10));
        design.partition_free = design.angle_deg.free || design.offset.free;
        if (reader.sound({"design_space.partition.offset", "machine.dispenser.width"}) &&
            (std::abs(design.offset.low) > width || std::abs(design.offset.high) > width))
            reader.conflict({"design_space.partition.offset"},
                            fmt::format("must stay within one width ({}) of the centre", mm(width)),
                            "lower the offset");
    } else {
        design.knots =
            static_cast<int>(section.integer("knots", 5, "our default: 4-5 knots reproduce a ramp", 2, 50));
        design.monotone = section.boolean("monotone", true, "y never turns back along x");
        design.minimum_segment = section.quantity(
            "minimum_segment", "length", {design.minimum_segment, "our default: what a workshop can bend"},
            Range::above_to(0, 10));
        const std::vector<PlanPoint> fixed = section.points("points", 2);
        const std::vector<PlanPoint> start = section.points("start", 2);
        if (section.has("points") && section.has("start"))
            reader.conflict({"design_space.partition.start"}, "stands beside points, which fix the partition",
                            "keep points (fixed) or start (free)");
        design.given_points = fixed.empty() ? start : fixed;
        design.partition_free = fixed.empty();
        const std::string points_key =
            fixed.empty() ? "design_space.partition.start" : "design_space.partition.points";
        if (!design.given_points.empty()) {
            if (PartitionCurve{design.given_points}.self_intersects())
                reader.conflict({points_key}, "the partition crosses itself",
                                "order the points along the curve");
            else if (PartitionCurve{design.given_points}.clipped(length, width).empty())
                reader.conflict(
                    {points_key}, "the partition never crosses the dispenser",
                    fmt::format("the dispenser is 0 to {} in x and 0 to {} in y", mm(length), mm(width)));
            if (!section.has("knots")) design.knots = static_cast<int>(design.given_points.size());
        }
        if (design.partition_free &&
            reader.sound({"design_space.partition.knots", "design_space.partition.minimum_segment",
                          "machine.dispenser"}) &&
            (design.knots - 1) * design.minimum_segment >= length)
            reader.conflict({"design_space.partition.minimum_segment", "design_space.partition.knots"},
                            fmt::format("{} knots at least {} apart do not fit into a dispenser {} long",
                                        design.knots, mm(design.minimum_segment), mm(length)),
                            "use fewer knots or shorter segments");
    }
    section.finish();
}

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
        if (design.fill_fraction[i].free)
            fill.problem(fill.find(label), label, "is not searched: it must be one value",
                         "take the middle of the range, or try several values with `evaluate --set`");
    }
    fill.finish();
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
    design.footprint_offset =
        space.variable("footprint_offset", "footprint_offset", "length", design.footprint_offset,
                       "the part stands where [target] footprint says", Range::between(-10, 10));
    space.finish();

    // Rise of the dispenser floor (physics.md 1.3); dispenser and platform are equally wide.
    const double per_dosage = scene.layer_thickness * scene.platform_length / scene.dispenser_length;
    scene.dose_height = design.dosage_factor.value * per_dosage;
    const std::vector<std::string> dose_keys = {"design_space.dosage_factor", "process.layer_thickness",
                                                "machine"};
    reader.derived("process.dose_height", scene.dose_height, "length",
                   "dosage_factor x layer_thickness x platform / dispenser area");
    const auto lowest = [](const Variable& v) { return v.free ? v.low : v.value; };
    const auto highest = [](const Variable& v) { return v.free ? v.high : v.value; };
    const double h_low = lowest(design.dosage_factor) * per_dosage,
                 h_high = highest(design.dosage_factor) * per_dosage;
    if (reader.sound(dose_keys) && h_high >= scene.dispenser_depth)
        reader.conflict({"design_space.dosage_factor", "machine.dispenser.depth"},
                        fmt::format("one dose would lift the floor by {}, the dispenser is {} deep",
                                    mm(h_high), mm(scene.dispenser_depth)),
                        "lower the dosage factor, or give a deeper dispenser");
    for (const int i : {0, 1}) {
        scene.headspace[i] = (1 - design.fill_fraction[i].value) * scene.dispenser_depth;
        const std::string key = i == 0 ? "design_space.fill_fraction.A" : "design_space.fill_fraction.B";
        const double deepest = (1 - lowest(design.fill_fraction[i])) * scene.dispenser_depth;
        if (reader.sound(dose_keys) && reader.sound({key}) && deepest >= h_low)
            reader.conflict(
                {key},
                fmt::format("leaves the chamber {} below the rim, more than the floor rises ({}): it starves",
                            mm(deepest), mm(h_low)),
                fmt::format("fill it above {:.4g}, or raise the dosage factor",
                            std::max(0.0, 1 - h_low / scene.dispenser_depth)));
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
    read_objective(root, study);
    read_run(reader, root, study);
    root.finish();
    if (!reader.problems().empty()) {
        std::stable_sort(reader.problems().begin(), reader.problems().end(),
                         [](const InputProblem& a, const InputProblem& b) {
                             return a.file != b.file ? a.file < b.file : a.line < b.line;
                         });
        throw InputError{reader.problems()};
    }
    warn_of_estimates(reader, study);
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
