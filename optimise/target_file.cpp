// [target] of a study file.
#include "optimise/target_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "optimise/joined.h"
#include "optimise/study_file.h"

namespace gradwright {
namespace {

constexpr double kSlack = 1e-9;  // relative, for lengths that are meant to be equal

std::string mm(double si) {
    return format_quantity(si, "length");
}

/// Keys that only one shape has.
const std::vector<std::pair<std::string, std::string>> kShapeKeys = {{"from", "linear"},
                                                                     {"to", "linear"},
                                                                     {"centre", "sigmoid"},
                                                                     {"width_10_90", "sigmoid"},
                                                                     {"gi_low", "sigmoid, step"},
                                                                     {"gi_high", "sigmoid, step"},
                                                                     {"y", "step"},
                                                                     {"file", "table, field"},
                                                                     {"x_bin_width", "field"},
                                                                     {"levels", "plateaus"},
                                                                     {"gi_outer", "aba"},
                                                                     {"gi_inner", "aba"},
                                                                     {"ramp_in", "aba"},
                                                                     {"ramp_out", "aba"}};
const std::vector<std::string> kShapes = {"linear", "sigmoid", "step", "table", "plateaus", "aba", "field"};
const char* const kLevelsExample =
    "levels = [{ gi = 0.0, to = \"0.4 mm\" }, { gi = 0.5, from = \"0.7 mm\", to = \"0.9 mm\" }, "
    "{ gi = 1.0, from = \"1.2 mm\" }]";

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

/// `field`: the shape asked for, whether its file could be read or not.
void read_zones(TomlReader& reader, Section& target, Study& study, bool field) {
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
        if (field) {
            const Default edge_low = {read.x_low, "from the footprint's near end"},
                          edge_high = {read.x_high, "to its far end"};
            if (zone.has("x_from"))
                read.x_low = zone.quantity("x_from", "length", edge_low, Range::between(-10, 10));
            if (zone.has("x_to"))
                read.x_high = zone.quantity("x_to", "length", edge_high, Range::between(-10, 10));
        } else {
            for (const char* key : {"x_from", "x_to"})
                zone.refuse(key, "has no place in a target of y alone",
                            "leave it out, or ask for a gradation over x and y with shape = \"field\"");
        }
        zone.know("x_from");
        zone.know("x_to");
        read.weight =
            zone.number("weight", {0, "a zone without a weight is don't-care"}, Range::between(0, 1e6));
        zone.finish();
        if (reader.sound({target.path(key)}) && !(read.y_low < read.y_high))
            target.problem(at, key, "must have from < to", "swap the two");
        if (reader.sound({target.path(key)}) && !(read.x_low < read.x_high))
            target.problem(at, key, "must have x_from < x_to", "swap the two");
        study.target.zones.push_back(read);
    }
}

/// Levels in the order of y. The first has no beginning and the last no end: they hold as far as there is
/// powder.
void read_levels(TomlReader& reader, Section& target, Study& study) {
    const std::string mend = fmt::format("write {}", kLevelsExample);
    const TomlReader::Found found = target.find("levels");
    if (!found.node) {
        target.missing("levels", mend);
        return;
    }
    const toml::array* array = found.node->as_array();
    if (!array || array->size() < 2) {
        target.problem(found, "levels", "must be a list of at least 2 tables", mend);
        return;
    }
    std::vector<Plateau> levels;
    std::vector<TomlReader::Found> places;
    const std::size_t last = array->size() - 1;
    for (std::size_t k = 0; k <= last; ++k) {
        const toml::node& item = *array->get(k);
        const std::string key = fmt::format("levels[{}]", k);
        TomlReader::Found at = found;
        at.node = &item;
        if (found.line > 0) at.line = static_cast<int>(item.source().begin.line);
        places.push_back(at);
        Plateau& level = levels.emplace_back();
        if (!item.is_table()) {
            target.problem(at, key, "must be a table", mend);
            continue;
        }
        Section section(reader, item.as_table(), target.path(key), at.line);
        level.gi =
            section.number("gi", required("the GI of this level, such as gi = 0.5"), Range::between(0, 1));
        const Range anywhere = Range::between(-10, 10);
        if (k == 0) {
            section.refuse("from", "has no place in the first level, which holds from the edge on",
                           "leave it out");
            section.know("from");
        } else {
            level.from = section.quantity("from", "length", required("where this level begins"), anywhere);
        }
        if (k == last) {
            section.refuse("to", "has no place in the last level, which holds up to the edge",
                           "leave it out");
            section.know("to");
        } else {
            level.to = section.quantity("to", "length", required("where this level ends"), anywhere);
        }
        section.finish();
    }
    if (!reader.sound({"target.levels"})) return;
    for (std::size_t k = 0; k <= last; ++k) {
        const std::string key = fmt::format("levels[{}]", k);
        if (k > 0 && k < last && levels[k].from > levels[k].to)
            target.problem(places[k], key, "must have from <= to", "swap the two");
        if (k > 0 && !(levels[k].from > levels[k - 1].to))
            target.problem(places[k], key,
                           fmt::format("must begin after the level before ends, at {}", mm(levels[k - 1].to)),
                           "order the levels along y; for a jump leave 1 um between the two");
    }
    if (reader.sound({"target.levels"})) study.target = plateaus_target(levels);
}

/// One ramp of an A-B-A: { from = "0.3 mm", to = "0.5 mm" }.
std::pair<double, double> ramp(Section& target, const std::string& key, const std::string& sample) {
    const std::string mend = fmt::format("write {} = {}", key, sample);
    if (!target.has(key)) {
        target.know(key);
        target.missing(key, mend);
        return {0, 0};
    }
    Section section = target.sub(key);
    const double from = section.quantity("from", "length", required(mend), Range::between(-10, 10));
    const double to = section.quantity("to", "length", required(mend), Range::between(-10, 10));
    section.finish();
    return {from, to};
}

void read_aba(TomlReader& reader, Section& target, Study& study) {
    const double outer = target.number("gi_outer", {1, "A outside: A-B-A"}, Range::between(0, 1));
    const double inner = target.number("gi_inner", {0, "B inside: A-B-A"}, Range::between(0, 1));
    const auto in = ramp(target, "ramp_in", "{ from = \"0.3 mm\", to = \"0.5 mm\" }");
    const auto out = ramp(target, "ramp_out", "{ from = \"1.1 mm\", to = \"1.3 mm\" }");
    if (!reader.sound({"target.ramp_in", "target.ramp_out", "target.gi_outer", "target.gi_inner"})) return;
    const char* const jump = "order the two; for a jump leave 1 um between them";
    if (!(in.first < in.second))
        reader.conflict({"target.ramp_in.from"}, "ramp_in must have from < to", jump);
    if (!(out.first < out.second))
        reader.conflict({"target.ramp_out.from"}, "ramp_out must have from < to", jump);
    if (reader.sound({"target.ramp_in", "target.ramp_out"}) && out.first < in.second)
        reader.conflict({"target.ramp_out.from"},
                        fmt::format("ramp_out must not begin before ramp_in ends, at {}", mm(in.second)),
                        "move the two ramps apart");
    if (outer == inner)
        reader.conflict({"target.gi_inner", "target.gi_outer"}, "gi_outer and gi_inner must differ",
                        "A-B-A has gi_outer = 1.0 and gi_inner = 0.0");
    if (reader.sound({"target"}))
        study.target = aba_target(outer, inner, in.first, in.second, out.first, out.second);
}

/// target.layer: "last", "all" or a number from 1.
void read_layer(TomlReader& reader, Section& target, Study& study) {
    const TomlReader::Found found = target.find("layer");
    const int layers = study.scene.layers;
    if (!found.node) {
        reader.record({"target.layer", "last", "", "default", "of several layers the last one is judged"});
        return;
    }
    const auto* word = found.node->as_string();
    const auto* number = found.node->as_integer();
    const std::string mend = fmt::format("write \"last\", \"all\" or a number from 1 to {}", layers);
    if (word && (word->get() == "last" || word->get() == "all")) {
        study.judged_layer = word->get() == "all" ? kAllLayers : kLastLayer;
        reader.record({"target.layer", word->get(), "", found.origin, found.note});
    } else if (!number) {
        target.problem(found, "layer", "must be \"last\", \"all\" or a whole number", mend);
    } else if (number->get() < 1 || number->get() > layers) {
        target.problem(found, "layer", fmt::format("is not among the {} that process.layers lays", layers),
                       mend);
    } else {
        study.judged_layer = static_cast<int>(number->get());
        reader.record({"target.layer", fmt::format("{}", study.judged_layer), "-", found.origin, found.note});
    }
}

/// A gradation that lies wholly beside the bed is a slip of the pen, most often of the unit: what is left of
/// it is one pure powder.
void refuse_beside_the_bed(TomlReader& reader, const std::vector<std::string>& keys, double low, double high,
                           double width) {
    if (reader.sound(keys) && (high <= 0 || low >= width))
        reader.conflict(
            keys,
            fmt::format("lies beside the bed, which is {} wide (machine.dispenser.width): no gradation "
                        "is left of the target",
                        mm(width)),
            fmt::format("y runs from 0 to {} across the bed", mm(width)));
}

/// Returns the shape's name; empty when there is none that is known.
std::string read_shape(TomlReader& reader, Section& target, Study& study) {
    if (!target.has("shape")) {
        target.know("shape");
        target.missing("shape", fmt::format("write shape = \"linear\", or one of {}", joined(kShapes)));
        for (const auto& [key, shapes] : kShapeKeys) target.know(key);
        return {};
    }
    const std::string shape = target.choice("shape", kShapes, "", "");
    for (const auto& [key, shapes] : kShapeKeys) {
        if (shape.empty())
            target.know(key);
        else if (shapes.find(shape) == std::string::npos)
            target.refuse(key, fmt::format("has no place in shape = \"{}\"", shape),
                          fmt::format("leave it out, or choose a shape that has it: {}", shapes));
    }
    if (shape.empty()) return shape;
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
        if (reader.sound({"machine"}))
            refuse_beside_the_bed(reader, {"target.from.y", "target.to.y"}, y0, y1, study.dispenser_width);
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
        if (reader.sound({"machine"}))
            refuse_beside_the_bed(reader, {"target.y"}, y, y, study.dispenser_width);
        const double low = target.number("gi_low", {0, "GI below the step"}, gi);
        const double high = target.number("gi_high", {1, "GI above the step"}, gi);
        study.target = step_target(y, low, high);
    } else if (shape == "plateaus") {
        read_levels(reader, target, study);
    } else if (shape == "aba") {
        read_aba(reader, target, study);
    } else {
        if (!target.has("file")) {
            target.know("file");
            target.missing("file", fmt::format("name a CSV file with the columns {}y_mm, gi and, where "
                                               "wanted, weight, relative to the study",
                                               shape == "field" ? "x_mm, " : ""));
            return shape;
        }
        const TomlReader::Found found = target.find("file");
        const std::string file = target.text("file", "", "");
        if (file.empty()) return shape;
        const std::filesystem::path path = std::filesystem::path(reader.file()).parent_path() / file;
        try {
            study.target = shape == "field" ? field_target(path.string()) : table_target(path.string());
            study.target.table_file = file;
        } catch (const std::runtime_error& error) {
            target.problem(found, "file", error.what(), "mend the table or name another file");
        }
    }
    return shape;
}

/// The cells of a field along x; its mean over them is what a profile is held against.
void read_columns(TomlReader& reader, Section& target, Study& study) {
    const double low = study.footprint.x_low, length = study.footprint.x_high - low;
    const double width =
        target.quantity("x_bin_width", "length", {length / 3, "a third of the footprint, as the x drift"},
                        Range::above_to(0, 10));
    if (!study.target.is_field() || !reader.sound({"target.x_bin_width", "target.footprint.x"})) return;
    study.target = study.target.over_x(low, study.footprint.x_high);
    const double columns = length / width;
    if (columns > 100) {
        reader.conflict({"target.x_bin_width"},
                        fmt::format("cuts the footprint, {} long, into more than 100 columns", mm(length)),
                        "make it wider: a column narrower than a few grains shows grains, not a gradation");
        return;
    }
    study.columns = std::max(1, static_cast<int>(std::lround(columns)));
    if (std::abs(study.columns * width - length) > 1e-3 * length)  // 0.5333 mm is a third of 1.6 mm
        study.warnings.push_back(fmt::format(
            "the footprint, {} long, is no multiple of x_bin_width {}: {} columns of {} are judged",
            mm(length), mm(width), study.columns, mm(length / study.columns)));
}

}  // namespace

void read_target(TomlReader& reader, Section& root, Study& study) {
    Section target = root.sub("target");
    if (!root.has("target")) {
        root.missing(
            "target",
            "say what is wanted: [target] shape = \"linear\", from = { y = \"0.4 mm\", gi = 0 }, to = ...");
        return;
    }
    const bool field = read_shape(reader, target, study) == "field";
    read_zones(reader, target, study, field);
    read_layer(reader, target, study);

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
    if (field) read_columns(reader, target, study);
    target.know("x_bin_width");
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
    bool flat = true;
    constexpr int kSamples = 200;  // a level or a peak between the two ends counts too
    const int along = study.target.is_field() ? kSamples : 0;
    for (int i = 0; i <= along; ++i) {
        const double at_x = x.first + (along > 0 ? i * (x.second - x.first) / along : 0);
        for (int k = 0; k <= kSamples; ++k)
            flat &= std::abs(study.target.at(at_x, y.first + k * (y.second - y.first) / kSamples) -
                             study.target.at(x.first, y.first)) < 1e-6;
    }
    if (flat)
        study.warnings.push_back(
            "the target is the same everywhere in the footprint: no gradation is asked for");
}

}  // namespace gradwright
