#include "optimise/build_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace gradwright {
namespace {

// What still counts as a plate that hands draw out of a dispenser [m].
constexpr double kThinnest = 0.05e-3, kThickest = 3e-3, kLongestGrip = 0.5;
constexpr double kThinnestPrint = 0.4e-3;  // one bead of a common 0.4 mm nozzle
constexpr double kDeepestMark = 0.1e-3;

std::string mm(double si) {
    return format_quantity(si, "length");
}

bool smooth(Family family) {
    return family == Family::sigmoid || family == Family::spline;
}

void read_densities(TomlReader& reader, Section& section, Study& study) {
    Section density = section.sub("bulk_density");
    const Scene& scene = study.scene;
    for (const int i : {0, 1}) {
        const std::string key = i == 0 ? "A" : "B", path = density.path(key);
        if (!density.has(key)) {
            density.know(key);
            reader.record({path, "not measured", "", "assumed",
                           "solid density x simulated packing of the bed: measure before use"});
            continue;
        }
        study.build.bulk_density[i] =
            density.quantity(key, "density", required("such as \"4.4 g/cm3\""), Range::above_to(0, 30000));
        const double solid = scene.share_a[i] * scene.powder[0].material.density +
                             (1 - scene.share_a[i]) * scene.powder[1].material.density;
        if (reader.sound({path, "powder", "design_space.premix"}) && study.build.bulk_density[i] >= solid)
            reader.conflict({path},
                            fmt::format("is no bulk density: what fills chamber {} has a solid density of {}",
                                        key, format_quantity(solid, "density")),
                            "measure it loose, as it is filled in");
    }
    density.finish();
}

/// Slots over the whole depth, or tabs in notches of the rim; and what is known of the machine around them.
void read_hold(TomlReader& reader, Section& section, Study& study) {
    PartitionBuild& build = study.build;
    const double depth = study.scene.dispenser_depth, finest = finest_d10(study);
    build.tabs =
        section.choice("hold", {"slots", "tabs"}, "slots",
                       "slots over the walls' whole depth keep the powders apart at the ends") == "tabs";
    build.slot_depth = section.quantity(
        "slot_depth", "length",
        build.tabs ? Default{3e-3, "our default: a tab that carries the plate"}
                   : Default{1e-3, "our default: holds a sheet upright; the walls must be thicker"},
        Range::between(0.2e-3, 50e-3));
    if (build.tabs) {
        build.tab_depth = section.quantity(
            "tab_depth", "length",
            {std::min(3e-3, depth / 4), "notches in the rim: 3 mm deep, at most a quarter of the dispenser"},
            Range::between(0.1e-3, kLongestGrip));
        build.end_clearance =
            section.quantity("end_clearance", "length",
                             {0.5 * finest, "between ends and walls below the tabs: half the finest D10"},
                             Range::between(0, 1e-3));
    } else if (reader.sound({"partition_build.hold"})) {
        for (const char* key : {"tab_depth", "end_clearance"})
            section.refuse(key, "belongs to tabs, and this plate stands in slots",
                           "hold = \"tabs\", or leave it out");
    }
    if (!build.tabs)
        for (const char* key : {"tab_depth", "end_clearance"}) section.know(key);
    for (const auto& [key, field, what] :
         {std::tuple{"wall_thickness", &build.wall_thickness, "slots or notches must leave some of it"},
          std::tuple{"headroom", &build.headroom, "above the rim: the plate is drawn out into it"}}) {
        if (section.has(key)) {
            *field = section.quantity(key, "length", required("such as \"200 mm\""), Range::above_to(0, 10));
        } else {
            section.know(key);
            reader.record(
                {section.path(key), "not given", "", "default", fmt::format("{}; not checked", what)});
        }
    }
    const std::string at = "partition_build.";
    if (!build.tabs) return;
    if (reader.sound({at + "tab_depth", "machine"}) && !(build.tab_depth < depth))
        reader.conflict({at + "tab_depth"},
                        fmt::format("the tabs would sit {} below the rim of a dispenser {} deep",
                                    mm(build.tab_depth), mm(depth)),
                        fmt::format("less than {}, or hold = \"slots\"", mm(depth)));
    if (reader.sound({at + "end_clearance", "powder"}) && !(build.end_clearance < finest))
        reader.conflict({at + "end_clearance"},
                        fmt::format("{} lets powder past the plate's ends: the finest D10 is {}",
                                    mm(build.end_clearance), mm(finest)),
                        fmt::format("at most {}", mm(0.5 * finest)));
}

}  // namespace

double din_k_factor(double bend_radius, double thickness) {
    return std::clamp(0.65 + 0.5 * std::log10(bend_radius / thickness), 0.0, 1.0) / 2;
}

double finest_d10(const Study& study) {
    return std::min(study.scene.powder[0].size.d10, study.scene.powder[1].size.d10);
}

void read_partition_build(TomlReader& reader, Section& root, Study& study) {
    Section section = root.sub("partition_build");
    PartitionBuild& build = study.build;
    const std::string at = "partition_build.";
    const Family family = study.design_space.family;
    build.printed = section.choice("make", {"sheet", "printed"}, smooth(family) ? "printed" : "sheet",
                                   smooth(family) ? "a smooth curve has no corners to bend at"
                                                  : "cut and bent sheet") == "printed";
    const double simulated = study.scene.plate_thickness, finest = finest_d10(study);
    build.thickness = section.quantity(
        "thickness", "length",
        simulated > 0   ? Default{simulated, "process.plate_thickness, as spread"}
        : build.printed ? Default{kThinnestPrint, "our default: one bead of a 0.4 mm nozzle"}
                        : Default{0.3e-3, "our default: the thinnest sheet that stays straight in the hand"},
        Range::between(kThinnest, kThickest));
    build.grip = section.quantity("grip", "length", {20e-3, "our default: two fingers above the rim"},
                                  Range::between(1e-3, kLongestGrip));
    build.material =
        section.text("material", build.printed ? "PA 12, laser sintered" : "EN 1.4301 (AISI 304), 2B",
                     build.printed ? "our default: stiff, no dust" : "our default: bends, does not rust");
    build.bend_radius = section.quantity(
        "bend_radius", "length", {build.thickness, "inside, one thickness: annealed stainless, DIN 6935"},
        Range::between(kThinnest, 20e-3));
    build.k_factor = section.number(
        "k_factor", {din_k_factor(build.bend_radius, build.thickness), "DIN 6935: (0.65 + lg(r/t)/2)/2"},
        Range::between(0, 0.5));
    build.clearance =
        section.quantity("clearance", "length", {0.5 * finest, "under the plate: half the finest D10"},
                         Range::between(0, 1e-3));
    read_hold(reader, section, study);
    build.slot_clearance =
        section.quantity("slot_clearance", "length",
                         {0.25 * finest, "each side: with its own tolerance three of them stay below D10"},
                         Range::between(0, 1e-3));
    build.least_slot_width = section.quantity("least_slot_width", "length",
                                              {0.3e-3, "our default: wire of 0.25 mm and its spark gap"},
                                              Range::between(0, 10e-3));
    build.engraving =
        section.quantity("engraving", "length",
                         {std::min(kDeepestMark, build.thickness / 5),
                          "depth of number, sides and arrow: a fifth of the thickness, at most 0.1 mm"},
                         Range::between(0, kThickest / 3));
    read_densities(reader, section, study);
    build.density_tolerance =
        section.number("density_tolerance",
                       {build.density_tolerance, "our default: how far repeated fillings differ; measure it"},
                       Range::above_to(0, 0.5));
    for (const auto& [key, field] : {std::pair{"owner", &build.owner},
                                     {"creator", &build.creator},
                                     {"approved", &build.approved},
                                     {"date", &build.date}}) {
        *field = section.text(key, "-", "title block (ISO 7200): left to be filled in by hand");
        if (*field == "-") field->clear();
    }
    section.finish();

    if (reader.sound({at + "make", "design_space.partition"}) && !build.printed && smooth(family))
        reader.conflict({at + "make"},
                        fmt::format("a {} partition has no corners to bend a sheet at", to_string(family)),
                        "make = \"printed\", or another family: polyline");
    if (reader.sound({at + "clearance", "powder"}) && !(build.clearance < finest))
        reader.conflict({at + "clearance"},
                        fmt::format("{} lets powder under the plate: the finest D10 is {}",
                                    mm(build.clearance), mm(finest)),
                        fmt::format("at most {}", mm(0.5 * finest)));
    if (reader.sound({at + "slot_clearance", "powder"}) && !(3 * build.slot_clearance < finest))
        reader.conflict(
            {at + "slot_clearance"},
            fmt::format("{} each side and as much again as the slot's tolerance let powder past the "
                        "plate's ends: the finest D10 is {}",
                        mm(build.slot_clearance), mm(finest)),
            fmt::format("at most {}", mm(0.25 * finest)));
    if (reader.sound({at + "engraving", at + "thickness"}) &&
        !(3 * build.engraving <= build.thickness * (1 + 1e-9)))
        reader.conflict({at + "engraving", at + "thickness"},
                        fmt::format("marks of {} on both sides leave less than a third of {}",
                                    mm(build.engraving), mm(build.thickness)),
                        fmt::format("at most {}", mm(build.thickness / 3)));
    const double slot = build.thickness + 2 * build.slot_clearance;
    // a plate that the study spreads needs no workshop: unasked, this is left to the checks of `spec`
    const bool asked = reader.given(at + "thickness") || reader.given(at + "least_slot_width");
    if (asked && reader.sound({at + "thickness", at + "slot_clearance", at + "least_slot_width"}) &&
        slot < build.least_slot_width)
        reader.conflict({at + "least_slot_width", at + "thickness"},
                        fmt::format("the slot would be {} wide, the workshop cuts {} at least", mm(slot),
                                    mm(build.least_slot_width)),
                        "take a thicker plate, or a finer wire");
}

}  // namespace gradwright
