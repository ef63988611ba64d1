#include "reports/wording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "optimise/chamber_fill.h"
#include "optimise/map_evaluator.h"
#include "reports/plate_checks.h"

namespace gradwright {
namespace {

/// GI numbers carry three decimals: bins hold some hundred grains, more digits would be noise.
std::string gi_text(double value) {
    return std::isfinite(value) ? fmt::format("{:.3f}", value) : "undefined";
}
std::string percent(double share) {
    return std::isfinite(share) ? fmt::format("{:.0f} %", 100 * share) : "undefined";
}

const char* norm_name(Norm norm) {
    switch (norm) {
        case Norm::rmse:
            return "rms misfit";
        case Norm::mean_absolute:
            return "mean absolute misfit";
        case Norm::max:
            return "largest misfit";
    }
    return "misfit";
}

std::string against(const Misfit& misfit) {
    return fmt::format("{} (95 % bounds {} and {} after noise, floor {}), tolerance {}",
                       gi_text(misfit.value), gi_text(misfit.interval_low), gi_text(misfit.interval_high),
                       gi_text(misfit.noise_floor), gi_text(misfit.tolerance));
}

std::string margin(const char* name, const Misfit& misfit) {
    switch (verdict_of(misfit)) {
        case Verdict::met:
            return fmt::format("{}: at most {}, {} inside the tolerance of {}", name,
                               gi_text(misfit.interval_high),
                               gi_text(misfit.tolerance - misfit.interval_high), gi_text(misfit.tolerance));
        case Verdict::not_met:
            return fmt::format("{}: at least {}, {} beyond the tolerance of {}", name,
                               gi_text(misfit.interval_low), gi_text(misfit.interval_low - misfit.tolerance),
                               gi_text(misfit.tolerance));
        case Verdict::undecided:
            return fmt::format(
                "{}: between {} and {} with a noise floor of {}, so the tolerance of {} is neither met nor "
                "missed",
                name, gi_text(misfit.interval_low), gi_text(misfit.interval_high),
                gi_text(misfit.noise_floor), gi_text(misfit.tolerance));
    }
    return {};
}

std::string fill_line(const Study& study, const StudyResult& result, int chamber) {
    const Scene& scene = study.scene;
    const Powder& powder = scene.powder[static_cast<std::size_t>(chamber)];
    const double length = scene.dispenser_length, width = study.dispenser_width;
    double area = length * width;
    if (result.design.partition.points.size() >= 2) {
        const double area_a = result.design.partition.area_a(length, width);
        area = chamber == 0 ? area_a : area - area_a;
    }
    const double fraction = result.design.fill_fraction[static_cast<std::size_t>(chamber)];
    const double own = chamber == 0 ? scene.share_a[0] : 1 - scene.share_a[1];
    const Powder& other = scene.powder[static_cast<std::size_t>(1 - chamber)];
    std::string what = fmt::format("{}, D10/D50/D90 {:.0f}/{:.0f}/{:.0f} um", powder.material.name,
                                   powder.size.d10 * 1e6, powder.size.d50 * 1e6, powder.size.d90 * 1e6);
    if (own < 1)
        what = fmt::format("premix of {:.3g} % {} and {:.3g} % {} by solid volume", own * 100,
                           powder.material.name, (1 - own) * 100, other.material.name);
    std::string line = fmt::format("{}: {}, fill fraction {:.3g}", chamber == 0 ? "A" : "B", what, fraction);
    if (fraction < 1)
        line +=
            fmt::format(" (level {} mm below the rim)", millimetres((1 - fraction) * scene.dispenser_depth));
    const Design& design = result.design;
    if (design.dose[0] != design.dose[1])
        line += fmt::format(", own piston: {:.4g} times the common rise per layer",
                            design.dose[static_cast<std::size_t>(chamber)]);
    line += fmt::format(", {:.2f} mm2 in plan", area * 1e6);
    const double packing = result.beds.empty() ? 0 : result.beds.front().packing_fraction;
    if (packing >
        0)  // a real well is as deep as the machine says; the bed that was simulated may be shallower
        line += fmt::format(", about {:.3g} mg at packing {:.2f}",
                            area * scene.dispenser_depth * fraction * packing *
                                (own * powder.material.density + (1 - own) * other.material.density) * 1e6,
                            packing);
    return line;
}

}  // namespace

std::string millimetres(double metres) {
    const std::string text = fmt::format("{:.3f}", metres * 1e3);
    return text == "-0.000" ? "0.000" : text;
}

std::string duration(double seconds) {
    if (!std::isfinite(seconds)) return "unknown";
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const long whole = std::lround(seconds);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::vector<PartitionRow> partition_rows(const Study& study, const Design& design) {
    std::vector<PartitionRow> rows;
    if (design.partition.points.size() < 2) return rows;
    const double length = study.scene.dispenser_length, width = study.dispenser_width;
    const auto list = [&rows](int curve, const std::vector<PlanPoint>& points) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            PartitionRow row{curve,
                             static_cast<int>(i) + 1,
                             points[i].x * 1e3,
                             points[i].y * 1e3,
                             std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::quiet_NaN()};
            if (i + 1 < points.size()) {
                const double dx = points[i + 1].x - points[i].x, dy = points[i + 1].y - points[i].y;
                row.length_mm = std::hypot(dx, dy) * 1e3;
                row.angle_deg = std::atan2(dy, dx) * 180 / std::numbers::pi;
            }
            rows.push_back(row);
        }
    };
    list(1, design.partition.clipped(length, width));
    list(2, design.partition.second_clipped(length, width));
    return rows;
}

std::string chamber_name(const Study& study, int chamber) {
    const double own = chamber == 0 ? study.scene.share_a[0] : 1 - study.scene.share_a[1];
    const std::string& name = study.scene.powder[static_cast<std::size_t>(chamber)].material.name;
    return own < 1 ? fmt::format("{:.3g} % {}", own * 100, name) : name;
}

std::string partition_name(const Design& design) {
    const std::string name = to_string(design.family);
    if (design.family == Family::sigmoid || design.family == Family::spline)
        return name + " partition, its corners within 0.002 mm of the curve";
    if (design.family == Family::two_curves)
        return fmt::format("two partitions with {} between them", design.partition.a_between() ? "A" : "B");
    return name + " partition";
}

Wording wording(const Study& study, const StudyResult& result) {
    Wording words;
    const bool proved = !result.confirmed.gi.empty();
    const bool measured = proved || !result.predicted.profile.gi.empty();
    const std::string name = norm_name(result.misfit.norm);
    if (!measured || result.termination == "failed" || result.termination == "not_run") {
        words.state = "failed";
        words.headline = "No result";
        words.verdict =
            result.message.empty()
                ? fmt::format("The search ended without a measured gradation ({}).", result.termination)
                : result.message;
    } else {
        const std::string source = proved                ? "confirmed"
                                   : result.extrapolated ? "extrapolated"
                                                         : "predicted (not confirmed)";
        const std::string misfit = margin((source + " " + name).c_str(), result.misfit);
        const std::string drift = margin("x drift", result.drift_misfit);
        switch (result.verdict) {
            case Verdict::met:
                words.state = "met";
                words.headline = result.extrapolated ? "Target met, extrapolated" : "Target met";
                break;
            case Verdict::not_met:
                words.state = "not_met";
                words.headline = result.extrapolated ? "Target not met, extrapolated" : "Target not met";
                break;
            case Verdict::undecided:
                words.state = "undecided";
                words.headline = result.extrapolated ? "Undecided, extrapolated" : "Undecided";
                break;
        }
        words.verdict = fmt::format("{}; {}.", misfit, drift);
        const auto counting =
            std::count_if(result.weight.begin(), result.weight.end(), [](double w) { return w > 0; });
        if (counting < static_cast<std::ptrdiff_t>(result.weight.size()))
            words.verdict += fmt::format(
                " Judged in {} of {} bins: not beside the {}, nor where the study says don't care.", counting,
                result.weight.size(),
                study.scene.sides != Sides::periodic         ? "side walls"
                : result.design.family == Family::two_curves ? "periodic seam"
                                                             : "periodic seam, where A meets B again");
        words.verdict.front() = static_cast<char>(std::toupper(words.verdict.front()));
    }
    if (measured) {
        words.misfit = fmt::format("{} {}", name, against(result.misfit));
        words.drift = fmt::format("x drift {}", against(result.drift_misfit));
    }
    if (proved) {
        const std::size_t n = result.confirmations.size();
        words.sure = fmt::format("{} spread{} of the full width with both powders in {}, on packing seed{}",
                                 n, n == 1 ? "" : "s", n == 1 ? "it" : "them", n == 1 ? " " : "s ");
        for (std::size_t i = 0; i < n; ++i)
            words.sure += fmt::format("{}{}", i ? ", " : "", result.confirmations[i].seed);
        words.sure += fmt::format(" that the search never saw; standard errors from {}.",
                                  n >= 3 ? "the replicates"
                                         : "blocks along x, widened for the chance of a single bed (three "
                                           "beds would give them directly)");
        if (std::all_of(result.confirmations.begin(), result.confirmations.end(),
                        [](const Evaluation& one) { return one.every_grain; }))
            words.sure += fmt::format(
                " Periodic sides: every y has the same law, so every laid grain was read for every y by "
                "where "
                "it came from; bins of their own grains agree with that.{}",
                spreads_like_its_image(study)
                    ? " The bed's mirror image is as likely and was read too, so that the numbers are of the "
                      "average bed."
                    : "");
    } else if (result.extrapolated) {
        const ScaledHeap& heap = *result.extrapolated;
        words.sure = fmt::format(
            "Extrapolated from {} strips, the longest {} mm of dispenser; no bed of this size was spread. "
            "Carried in "
            "every band: {:.3f} in GI, {:.3f} in x drift (rms along a ramp). It rests on: {}.",
            heap.strips.size(), millimetres(heap.longest), heap.profile_error, heap.drift_error,
            fmt::join(heap.rests_on, "; "));
    } else {
        words.sure = "No confirming spread with both powders in it: every number here is a prediction.";
    }

    const auto rows = partition_rows(study, result.design);
    if (rows.size() < 2) {
        words.build = "no partition inside the dispenser";
    } else {
        words.build = partition_name(result.design) + ", mm:";
        for (const PartitionRow& row : rows) {
            if (row.curve == 2 && row.number == 1) words.build += " and";
            words.build +=
                fmt::format(" ({}, {})", millimetres(row.x_mm * 1e-3), millimetres(row.y_mm * 1e-3));
        }
    }
    if (rows.size() >= 2)
        for (int chamber : {0, 1}) words.fill.push_back(fill_line(study, result, chamber));
    const Scene scene = scene_of(study, result.design, false, result.seed);
    words.dose =
        fmt::format("dosage factor {:.3g}: raise the dispenser floor by {} mm; layer {} mm, gap {} mm",
                    result.design.dosage_factor, millimetres(scene.dose_height),
                    millimetres(scene.layer_thickness), millimetres(scene.gap));
    if (study.design_space.blade_speed.free)
        words.dose += fmt::format("; blade {:.3g} mm/s", scene.blade_speed * 1e3);
    if (scene.land > 0) words.dose += fmt::format("; land {} mm", millimetres(scene.land));
    const double shift = result.design.footprint_offset;
    words.dose +=
        fmt::format("; part at x {} to {} mm of the platform", millimetres(study.footprint.x_low + shift),
                    millimetres(study.footprint.x_high + shift));
    if (measured)
        words.losses = fmt::format(
            "{} of the dosed solid is laid, {} overflows{}; coverage {}, supply ratio {:.2f}",
            percent(result.capture_fraction), percent(result.waste_fraction),
            std::isfinite(result.waste_a_share) ? " (" + percent(result.waste_a_share) + " of it A)" : "",
            percent(result.coverage), result.supply_ratio);
    words.warnings = study.warnings;
    words.warnings.insert(words.warnings.end(), result.warnings.begin(), result.warnings.end());
    const double drift = proved ? result.confirmed_drift.value : result.predicted.drift.value;
    if (!result.field_target.empty() && measured)
        words.verdict +=
            " Misfit over the cells of x and y; x drift is what changes along x beyond what the target asks "
            "for.";
    else if (measured && drift > 0.1)  // physics.md 5: above 0.1 it stands on the first screen
        words.warnings.push_back(
            fmt::format("x drift {:.3f}: the gradation changes along the spreading direction; the profile "
                        "averaged over x hides it",
                        drift));
    const ChamberFill fill = chamber_fill(study, result.design);
    if (measured && !fill.lasts()) {
        const bool field = !result.field_target.empty();
        const GradationProfile& predicted = field ? result.predicted.field.cells : result.predicted.profile;
        const GradationProfile& confirmed = field ? result.confirmed_field.cells : result.confirmed;
        const std::vector<double>& target = field ? result.field_target : result.target;
        std::vector<double> residual = fill.levelled(proved ? confirmed.gi : predicted.gi);
        for (std::size_t b = 0; b < residual.size() && b < target.size(); ++b) residual[b] -= target[b];
        words.warnings.push_back(fmt::format(
            "the chambers are filled unequally, which acts in the first layer only: once they are level the "
            "same partition lays a {} of {} from the target, not {}",
            name, gi_text(norm_of(result.misfit.norm, residual, field ? result.field_weight : result.weight)),
            gi_text(result.misfit.value)));
    }
    // the spreads of most studies know a partition of no thickness; the plate that is built leaves a slot
    if (const auto plates = plates_of(study, result.design); !plates.empty()) {
        const SlotEffect slot = slot_effect(study, result.design, plates);
        if (!slot.simulated)
            words.warnings.push_back(
                fmt::format("the slot that the drawn plate leaves is not simulated: {} mm of thickness take "
                            "{:.1f} % of the dispenser and leave a trough about {} mm deep",
                            millimetres(study.build.thickness), 100 * slot.share, millimetres(slot.depth)));
    }
    std::vector<std::string> unique;
    for (const std::string& warning : words.warnings)
        if (std::find(unique.begin(), unique.end(), warning) == unique.end()) unique.push_back(warning);
    words.warnings = unique;
    return words;
}

}  // namespace gradwright
