#include "reports/hand_over.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "optimise/build_section.h"
#include "optimise/chamber_fill.h"
#include "reports/sha256.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

std::string mm(double metres) {
    return millimetres(metres) + " mm";
}

double solid_density(const Scene& scene, int chamber) {
    const double share = scene.share_a[static_cast<std::size_t>(chamber)];
    return share * scene.powder[0].material.density + (1 - share) * scene.powder[1].material.density;
}

std::string id_of(const Study& study, const std::vector<Plate>& plates) {
    std::string text =
        fmt::format("{} {:.9g} {:.9g} {:.9g} {}\n", study.machine_name, study.scene.dispenser_length,
                    study.dispenser_width, study.scene.dispenser_depth, study.build.material);
    for (const Plate& plate : plates) {
        text += fmt::format("{} {:.9g} {:.9g} {:.9g} {:.9g} {}\n", plate.name, plate.thickness,
                            plate.bend_radius, plate.z_low, plate.z_high, plate.rounded);
        if (plate.tabs())
            text += fmt::format("{:.9g} {:.9g} {:.9g}\n", plate.z_seat, plate.ends[0].cut, plate.ends[1].cut);
        for (const PlanPoint& p : plate.corners) text += fmt::format("{:.9g} {:.9g}\n", p.x, p.y);
    }
    std::string digits = sha256(text).substr(0, 8);
    for (char& c : digits) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return "GW-" + digits;
}

std::string doubt(const FinishedDesign& finished) {
    if (finished.termination == "failed" || finished.termination == "not_run") return "the design failed";
    std::vector<std::string> doubts;
    if (finished.termination == "interrupted") doubts.push_back("the design was interrupted");
    if (finished.extrapolated) doubts.push_back("extrapolated from strips");
    if (finished.verdict == "undecided") doubts.push_back("verdict undecided");
    if (finished.verdict == "not_met") doubts.push_back("target not met");
    return fmt::format("{}", fmt::join(doubts, ", "));
}

FillPlan fill_plan(const Study& study, const FinishedDesign& finished, const HandOver& over) {
    const Scene scene = scene_of(study, finished.design, false, study.seed);
    const PartitionBuild& build = study.build;
    FillPlan plan;
    const auto ideal = ideal_areas(study, finished.design);
    std::array<double, 2> level;
    for (const std::size_t k : {0u, 1u})
        level[k] = (1 - finished.design.fill_fraction[k]) * scene.dispenser_depth;
    const auto volume = chamber_volumes(study, finished.design, over.plates, level);
    // either end of a line may stand off by its tolerance: at most half its length times that, each
    double area_error = 0;
    for (const Plate& plate : over.plates)
        for (const PlateEnd& end : plate.ends)
            if (end.at.wall != WallEnd::Wall::none)
                area_error += 0.5 * plate.middle_length() * linear_tolerance(end.at.offset);
    // slots and notches run full once the plate is out: half from either side
    double in_walls = 0;
    const double slot_height = build.tabs ? build.tab_depth : scene.dispenser_depth;
    for (const Plate& plate : over.plates)
        for (const PlateEnd& end : plate.ends)
            if (end.at.wall != WallEnd::Wall::none)
                in_walls += end.slot_along * build.slot_depth * slot_height;
    double solid = 0;
    for (const int i : {0, 1}) {
        ChamberPlan& chamber = plan.chambers[static_cast<std::size_t>(i)];
        const auto k = static_cast<std::size_t>(i);
        chamber.powder = chamber_name(study, i);
        chamber.ideal_area = ideal[k];
        chamber.level = level[k];
        // the scene's dose height is the larger piston's
        const auto& dose = finished.design.dose;
        chamber.rise = scene.dose_height * dose[k] / std::max(dose[0], dose[1]);
        const double height = scene.dispenser_depth - chamber.level;
        chamber.volume = volume[k];
        chamber.area = chamber.volume / height;
        chamber.measured = build.bulk_density[k] > 0;
        chamber.bulk_density =
            chamber.measured ? build.bulk_density[k] : finished.bed_packing * solid_density(scene, i);
        chamber.mass = chamber.volume * chamber.bulk_density;
        chamber.mass_tolerance = chamber.mass * build.density_tolerance +
                                 std::min(area_error, chamber.area) * height * chamber.bulk_density;
        chamber.top_up = (std::max(0.0, chamber.ideal_area * height - chamber.volume) + 0.5 * in_walls) *
                         chamber.bulk_density;
        const double lifted = chamber.rise * chamber.ideal_area;
        plan.dosed += lifted * chamber.bulk_density;
        solid += lifted * chamber.bulk_density / solid_density(scene, i);
    }
    plan.piston_start = scene.dispenser_depth;
    plan.rise = scene.dose_height;
    plan.area_ratio = scene.platform_length / scene.dispenser_length;
    // the spreads had this much powder below the rim once the floor had risen; a last layer needs as much
    const double kept = std::min(scene.bed_depth, scene.dispenser_depth);
    plan.layers =
        std::max(0, static_cast<int>(std::floor((scene.dispenser_depth - kept) / plan.rise + 1e-9)));
    plan.left_over = scene.dispenser_depth - plan.layers * plan.rise;
    if (finished.waste_fraction) {
        plan.overflow = *finished.waste_fraction * plan.dosed;
        if (finished.waste_a_share) {
            const double s = *finished.waste_a_share, a = s * scene.powder[0].material.density,
                         b = (1 - s) * scene.powder[1].material.density;
            plan.overflow = *finished.waste_fraction * solid * (a + b);
            plan.overflow_a = a / (a + b);
        }
    }
    return plan;
}

std::vector<std::string> steps_of(const Study& study, const HandOver& over) {
    const PartitionBuild& build = study.build;
    const FillPlan& plan = over.fill;
    const bool pair = over.plates.size() > 1;
    const char* plates = pair ? "plates" : "plate";
    const bool arrows = std::any_of(over.flats.begin(), over.flats.end(),
                                    [](const FlatPattern& flat) { return flat.arrow != 0; });
    std::vector<std::string> steps;
    if (!(plan.chambers[0].measured && plan.chambers[1].measured))
        steps.push_back(
            "Before use, measure the bulk density of each powder that is marked so: pour it loosely into a "
            "cup of "
            "known volume, 25 cm\u00b3 or more, strike it off without tapping, weigh; the mean of three. "
            "Mass to fill "
            "in = volume in the table x density measured.");
    const std::vector<std::string> rest = {
        fmt::format(
            "Clean and dry dispenser, {} and {}. Check that the engraving reads {} and that no edge has "
            "a burr higher than {:.0f} um.",
            build.tabs ? "notches" : "slots", plates, over.id, finest_d10(study) * 1e6),
        fmt::format("Lower the dispenser floor to {} below the rim.", mm(plan.piston_start)),
        fmt::format(
            "Put the {} in from above, into {}: SIDE A towards chamber A{}. {}", plates,
            build.tabs ? "the notches of the rim" : "the slots",
            arrows ? ", the engraved arrow in the spreading direction" : "",
            build.tabs
                ? fmt::format("Raise the floor until it just lifts the {}, then lower it by {:.3g} um: "
                              "the tabs sit, the gap below is less than the finest grains.",
                              plates, build.clearance * 1e6)
                : fmt::format("The lower edge stands on the floor (gap below {:.4g} um).",
                              finest_d10(study) * 1e6))};
    steps.insert(steps.end(), rest.begin(), rest.end());
    const auto fill = [&](int i) {
        const ChamberPlan& chamber = plan.chambers[static_cast<std::size_t>(i)];
        return fmt::format("Fill chamber {} with {} ({}) to {}; strike it off, do not tap.",
                           i == 0 ? "A" : "B", chamber.powder,
                           mass_text(chamber.mass, chamber.mass_tolerance),
                           chamber.level > 0 ? mm(chamber.level) + " below the rim" : "the rim");
    };
    // half and half: powder on one side only would bend the sheet
    steps.push_back(
        fmt::format("Fill both chambers to about half first, A then B, so that the {} not pushed aside.",
                    pair ? "plates are" : "plate is"));
    steps.push_back(fill(0));
    steps.push_back(fill(1));
    steps.push_back(
        fmt::format("Draw the {} straight up, slowly, without tilting, at least {}. Brush what clings to "
                    "{} back onto its own side.",
                    plates, mm(study.scene.dispenser_depth), pair ? "them" : "it"));
    steps.push_back(fmt::format(
        "Top up the trough that is left, with the {} in the walls, flush with {}: about {} of "
        "A's powder on A's side, {} of B's on B's.",
        build.tabs ? "notches" : "slots",
        plan.chambers[0].level > 0 || plan.chambers[1].level > 0 ? "the powder beside it" : "the rim",
        mass_text(plan.chambers[0].top_up), mass_text(plan.chambers[1].top_up)));
    if (plan.chambers[0].level == plan.chambers[1].level)
        steps.push_back(
            "Level with a straight edge along the spreading direction, never across it; wipe the rim.");
    else
        steps.push_back(
            "Level each chamber to its own height along the spreading direction, never across it.");
    steps.push_back(fmt::format(
        "For each layer raise {} (dosage factor x layer thickness x platform / dispenser area{}: {:.4g} x "
        "{} x {:.4g}).",
        plan.one_floor() ? "the floor by " + mm(plan.rise)
                         : fmt::format("piston A by {}, piston B by {}", mm(plan.chambers[0].rise),
                                       mm(plan.chambers[1].rise)),
        plan.one_floor() ? "" : ", times each piston's dose", over.dosage_factor,
        mm(plan.rise / (over.dosage_factor * plan.area_ratio)), plan.area_ratio));
    return steps;
}

std::vector<Acceptance> acceptance_of(const Study& study, const HandOver& over) {
    std::vector<Acceptance> all;
    for (const Plate& plate : over.plates)
        for (const PlateEnd& end : plate.ends) {
            if (end.at.wall == WallEnd::Wall::none) continue;
            const bool across = end.at.wall == WallEnd::Wall::rear || end.at.wall == WallEnd::Wall::platform;
            all.push_back(
                {fmt::format("{}: middle of the {} on the wall {}, from the wall {}", plate.name,
                             study.build.tabs ? "notch" : "slot", end.at.name(), across ? "y = 0" : "x = 0"),
                 fmt::format("{} {} mm", millimetres(end.at.offset), tolerance_text(end.at.offset)),
                 "do not fill: rework it, or design again with the partition as it stands ('gradwright "
                 "evaluate --design')"});
        }
    all.push_back(
        {"gap under the plate, by feeler gauge along its whole length",
         fmt::format("a gauge of {:.4g} um does not pass", std::floor(finest_d10(study) * 1e6)),
         "lap the lower edge on a flat stone; a gap lets the powders mix before the plate is drawn"});
    if (study.build.tabs)
        all.push_back({"gap between the plate's ends and the walls, by feeler gauge over the whole depth",
                       fmt::format("a gauge of {:.4g} um does not pass", std::floor(finest_d10(study) * 1e6)),
                       "do not fill: the ends are fitted to this dispenser; make the plate again"});
    all.push_back({"plate upright, by square against the rim", "no light wider than the plate at the grip",
                   "straighten it or clean the slots: a leaning plate moves the boundary along the depth"});
    for (const int i : {0, 1}) {
        const ChamberPlan& chamber = over.fill.chambers[static_cast<std::size_t>(i)];
        all.push_back({fmt::format("mass filled into chamber {}", i == 0 ? "A" : "B"),
                       mass_text(chamber.mass, chamber.mass_tolerance),
                       "too little: powder bridges, loosen it with a thin rod and fill up; too much: it was "
                       "compacted, empty "
                       "the chamber and fill it loosely; still off: measure the bulk density; whoever issued "
                       "this sheet writes "
                       "it anew with the measured one (partition_build.bulk_density)"});
    }
    all.push_back(
        {"surface after levelling, in oblique light", "no trough, no powder of one side on the other",
         "top up and level again; mixed powder is lifted off with a vacuum nozzle, not spread over"});
    all.push_back({"first layer on a plain plate", "closed; its colour boundary where the target has it",
                   "do not melt: empty the dispenser and begin with step 1"});
    return all;
}

}  // namespace

bool HandOver::buildable() const {
    return std::all_of(checks.begin(), checks.end(), [](const PlateCheck& check) { return check.passed; });
}

std::string mass_text(double kilograms) {
    if (!std::isfinite(kilograms)) return "unknown";
    if (kilograms < 0.99995e-3) return fmt::format("{:.3g} mg", kilograms * 1e6);
    if (kilograms < 0.99995) return fmt::format("{:.4g} g", kilograms * 1e3);
    return fmt::format("{:.4g} kg", kilograms);
}

std::string mass_text(double kilograms, double tolerance) {
    if (!std::isfinite(kilograms) || !(tolerance > 0)) return mass_text(kilograms);
    const double scale = kilograms < 0.99995e-3 ? 1e6 : kilograms < 0.99995 ? 1e3 : 1;
    const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(tolerance * scale))));
    return fmt::format("{:.{}f} \u00b1 {:.{}f} {}", kilograms * scale, decimals, tolerance * scale, decimals,
                       scale == 1e6   ? "mg"
                       : scale == 1e3 ? "g"
                                      : "kg");
}

std::string density_text(double kilograms_per_cubic_metre) {
    return fmt::format("{:.3f} g/cm\u00b3", kilograms_per_cubic_metre / 1e3);
}

std::string tolerance_text(double length) {
    return fmt::format("\u00b1{:.1f}", linear_tolerance(length) * 1e3);
}

HandOver hand_over(const Study& study, const FinishedDesign& finished) {
    HandOver over;
    over.partition = finished.design.partition;
    over.dosage_factor = finished.design.dosage_factor;
    over.plates = plates_of(study, finished.design);
    if (over.plates.empty())
        throw std::invalid_argument("the partition does not cross the dispenser: there is nothing to build");
    over.id = id_of(study, over.plates);
    bool bent = false;
    for (Plate& plate : over.plates) {
        bent = bent || !plate.turns.empty();
        over.marks.push_back(engrave(plate, over.id, arrow_along(plate), study.build.engraving));
        over.flats.push_back(flat_pattern(plate));
    }
    over.make = study.build.printed ? "printed wall" : bent ? "bent sheet" : "straight sheet";
    over.checks = plate_checks(study, over.plates);
    over.slot = slot_effect(study, finished.design, over.plates);
    over.fill = fill_plan(study, finished, over);
    over.steps = steps_of(study, over);
    over.acceptance = acceptance_of(study, over);
    over.warnings = plate_warnings(study, over.plates);
    for (const int i : {0, 1})
        if (!over.fill.chambers[static_cast<std::size_t>(i)].measured)
            over.warnings.push_back(
                fmt::format("bulk density of chamber {} not measured: {:.0f} kg/m3 is the solid density "
                            "times {} of {:.3f}; MEASURE "
                            "BEFORE USE and set partition_build.bulk_density.{}",
                            i == 0 ? "A" : "B", over.fill.chambers[static_cast<std::size_t>(i)].bulk_density,
                            finished.packing_simulated ? "the simulated packing" : "an assumed packing",
                            finished.bed_packing, i == 0 ? "A" : "B"));
    if (!chamber_fill(study, finished.design).level())
        over.warnings.push_back(
            "the chambers are filled to different levels, which acts in the first layer only");
    const std::string why = doubt(finished);
    if (!why.empty()) over.mark = "NOT VERIFIED: " + why;
    if (!over.buildable()) {
        std::vector<std::string> failed;
        for (const PlateCheck& check : over.checks)
            if (!check.passed) failed.push_back(check.id);
        over.mark += fmt::format("{}CANNOT BE BUILT AS DRAWN: {}", over.mark.empty() ? "" : "; ",
                                 fmt::join(failed, ", "));
    }
    over.first_line = !over.mark.empty()    ? over.mark
                      : over.slot.simulated ? "Verified: target met in simulation with this plate"
                                            : "Target met in simulation; the plate's slot is not simulated";
    return over;
}

}  // namespace gradwright
