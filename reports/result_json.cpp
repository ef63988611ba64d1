#include "reports/result_json.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimise/chamber_fill.h"
#include "reports/field_json.h"
#include "reports/json_support.h"
#include "reports/layers_json.h"
#include "reports/provenance.h"
#include "reports/wording.h"

namespace gradwright {
namespace {

using nlohmann::json;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

double at(const std::vector<double>& values, std::size_t index) {
    return index < values.size() ? values[index] : kUndefined;
}

/// All numbers null: an evaluation that gave none must not look like a perfect one.
json undefined_misfit(const Misfit& misfit) {
    json object = misfit_json(misfit);
    for (const char* key : {"value", "debiased", "noise_floor"}) object[key] = nullptr;
    object["interval"] = {nullptr, nullptr};
    return object;
}

/// [y][x] from a row-major vector.
json grid(const std::vector<double>& values, std::size_t columns) {
    json rows = json::array();
    for (std::size_t start = 0; columns > 0 && start + columns <= values.size(); start += columns)
        rows.push_back(numbers(std::span(values).subspan(start, columns)));
    return rows;
}

json drift_profile_json(const XDrift& drift) {
    return {{"difference", numbers(drift.difference)},
            {"standard_error", numbers(drift.standard_error)},
            {"band_factor", number(simultaneous_factor(drift.standard_error, 0.95, drift.degrees))}};
}

const char* estimator_of(const Evaluation& evaluation) {
    if (evaluation.fidelity == Fidelity::kinematic) return "closed form";
    return evaluation.fidelity == Fidelity::map || evaluation.every_grain ? "every grain for every y"
                                                                          : "bins of their own grains";
}

json evaluation_summary(const Study& study, const Evaluation& evaluation) {
    const bool defined = evaluation.health.ok() && !evaluation.profile.gi.empty();
    // the kinematic picture lays nothing, and a spread that failed was not measured
    const bool laid = evaluation.health.ok() && evaluation.fidelity != Fidelity::kinematic;
    const auto measured = [laid](double value) { return laid ? number(value) : json(nullptr); };
    json turnover = nullptr;
    if (!evaluation.origin_mean.empty())
        turnover = {{"origin_mean", numbers(evaluation.origin_mean)},
                    {"origin_deviation", numbers(evaluation.origin_deviation)},
                    {"parts", "sixths of the platform; shares of the dispenser's length"}};
    // what bins of their own grains say, where every grain was asked about every y
    json plain = nullptr;
    if (!evaluation.plain_check.gi.empty())
        plain = {{"gi", numbers(evaluation.plain_check.gi)},
                 {"standard_error", numbers(evaluation.plain_check.standard_error)},
                 {"x_drift", drift_profile_json(evaluation.plain_check_drift)}};
    return {{"fidelity", to_string(evaluation.fidelity)},
            {"estimator", estimator_of(evaluation)},
            {"extrapolated", evaluation.one_error},
            {"plain_bins", plain},
            {"turnover", turnover},
            {"status", evaluation.health.status},
            {"reason", evaluation.health.reason},
            {"seed", evaluation.seed},
            {"design", design_json(study, evaluation.design)},
            {"misfit", defined ? misfit_json(evaluation.misfit) : undefined_misfit(evaluation.misfit)},
            {"x_drift",
             defined ? misfit_json(evaluation.drift_misfit) : undefined_misfit(evaluation.drift_misfit)},
            {"y_m", numbers(evaluation.profile.y_m)},
            {"gi", numbers(evaluation.profile.gi)},
            {"standard_error", numbers(evaluation.profile.standard_error)},
            {"capture_fraction", measured(evaluation.capture_fraction)},
            {"supply_ratio", measured(evaluation.supply_ratio)},
            {"coverage", measured(evaluation.coverage)},
            {"waste_fraction", measured(evaluation.waste_fraction)},
            {"packing_fraction", measured(evaluation.packing_fraction)},
            {"grains", evaluation.grains},
            {"steps", evaluation.steps},
            {"grain_steps", number(evaluation.grain_steps)},
            {"seconds", number(evaluation.seconds)},
            {"seconds_cold", number(evaluation.seconds_cold)},
            {"state_hash", evaluation.state_hash}};
}

json history_json(const StudyResult& result) {
    auto rows = json::array();
    for (const HistoryEntry& entry : result.history) {
        rows.push_back({{"iteration", entry.iteration},
                        {"stage", entry.stage},
                        {"fidelity", to_string(entry.fidelity)},
                        {"objective", number(entry.objective)},
                        {"misfit", number(entry.misfit)},
                        {"x_drift", number(entry.drift)},
                        {"spreads", entry.spreads},
                        {"seconds", number(entry.seconds)},
                        {"points_m", plan_points(entry.design.partition.points)},
                        {"note", entry.note}});
        if (!entry.design.partition.second.empty())
            rows.back()["points2_m"] = plan_points(entry.design.partition.second);
    }
    return rows;
}

/// Target, predicted, confirmed on one axis. A bin that is undefined in target or confirmed is null in both,
/// so that a script that skips nulls compares the same bins whichever it looks at.
json profile_json(const Study& study, const StudyResult& result) {
    const bool proved = !result.confirmed.gi.empty();
    const auto& y = proved ? result.confirmed.y_m : result.predicted.profile.y_m;
    json target = json::array(), predicted = json::array(), confirmed = json::array();
    json low = json::array(), high = json::array(), error = json::array(), weight = json::array();
    json left_target = json::array(), left_confirmed = json::array();
    for (std::size_t b = 0; b < y.size(); ++b) {
        const double asked = at(result.target, b), found = at(result.confirmed.gi, b);
        // A bin without weight (within 2 D90 of a side or the periodic seam, outside the footprint, don't
        // care) is no part of the misfit: null in target and confirmed, its values kept apart under left_out.
        const bool counts = !(at(result.weight, b) <= 0);
        const bool defined = counts && std::isfinite(asked) && (!proved || std::isfinite(found));
        left_target.push_back(number(counts ? kUndefined : asked));
        left_confirmed.push_back(number(counts ? kUndefined : found));
        target.push_back(number(defined ? asked : kUndefined));
        predicted.push_back(number(at(result.predicted.profile.gi, b)));
        confirmed.push_back(number(defined ? found : kUndefined));
        low.push_back(number(defined ? at(result.band_low, b) : kUndefined));
        high.push_back(number(defined ? at(result.band_high, b) : kUndefined));
        error.push_back(number(defined ? at(result.confirmed.standard_error, b) : kUndefined));
        weight.push_back(number(at(result.weight, b)));
    }
    // unequal fills act in the first layer only: what the layers after it will be
    const ChamberFill fill = chamber_fill(study, result.design);
    json levelled = nullptr;
    if (!fill.lasts())
        levelled = numbers(fill.levelled(proved ? result.confirmed.gi : result.predicted.profile.gi));
    return {{"y_m", numbers(y)},
            {"levelled", levelled},
            {"target", target},
            {"predicted", predicted},
            {"confirmed", confirmed},
            {"band_low", low},
            {"band_high", high},
            {"standard_error", error},
            {"weight", weight},
            {"left_out", {{"target", left_target}, {"confirmed", left_confirmed}}},
            {"predicted_standard_error", numbers(result.predicted.profile.standard_error)},
            {"band", "simultaneous 95 % over the bins"}};
}

json pairs_json(const std::vector<std::pair<std::string, std::string>>& pairs) {
    auto rows = json::array();
    for (const auto& [key, value] : pairs) rows.push_back({{"option", key}, {"given_used", value}});
    return rows;
}

json gate_json(const std::optional<PowderGate>& gate) {
    if (!gate) return nullptr;
    return {{"passes", gate->passes},
            {"difference", number(gate->difference)},
            {"noise", number(gate->noise)},
            {"p_value", number(gate->p_value)},
            {"drift_p_value", number(gate->drift_p_value)}};
}

json extrapolated_json(const std::optional<ScaledHeap>& heap) {
    if (!heap) return nullptr;
    auto strips = json::array();
    for (const HeapOrder& strip : heap->strips)
        strips.push_back({{"dispenser_length_m", number(strip.dispenser_length)},
                          {"dosage_factor", number(strip.dosage_factor)},
                          {"turnovers", number(strip.turnovers)},
                          {"profile_order", number(strip.profile)},
                          {"profile_rest", number(strip.profile_rest)},
                          {"drift_order", number(strip.drift)},
                          {"lateral", number(strip.lateral)},
                          {"capture_fraction", number(strip.capture_fraction)},
                          {"seed", strip.seed},
                          {"grains", strip.grains},
                          {"seconds_cold", number(strip.seconds_cold)}});
    const OrderLaw& law = heap->law;
    return {{"strips", strips},
            {"law",
             {{"form", "amplitude exp(-N / memory) cos(2 pi N / turn + phase)"},
              {"fitted", law.fitted},
              {"amplitude", number(law.fitted ? law.amplitude : kUndefined)},
              {"memory", number(law.fitted ? law.memory : kUndefined)},
              {"turn", number(law.fitted ? law.turn : kUndefined)},
              {"phase", number(law.fitted ? law.phase : kUndefined)},
              {"collapse_error", number(law.fitted ? law.collapse_error : kUndefined)},
              {"longest_miss", number(law.longest_miss)},
              {"longest_envelope", number(law.longest_envelope)}}},
            {"turnovers", number(heap->turnovers)},
            {"longest_strip_m", number(heap->longest)},
            {"profile_step", number(heap->profile_step)},
            {"drift_step", number(heap->drift_step)},
            {"dose_step", number(heap->dose_step)},
            {"profile_error", number(heap->profile_error)},
            {"drift_error", number(heap->drift_error)},
            {"rests_on", heap->rests_on}};
}

json beds_json(const StudyResult& result) {
    auto rows = json::array();
    for (const BedFacts& bed : result.beds)
        rows.push_back({{"packing_fraction", number(bed.packing_fraction)},
                        {"mean_coordination", number(bed.mean_coordination)},
                        {"max_overlap_ratio", number(bed.max_overlap_ratio)},
                        {"speed_number", number(bed.speed_number)},
                        {"carried_weight_ratio", number(bed.carried_weight_ratio)},
                        {"steps", bed.steps},
                        {"from_cache", bed.from_cache},
                        {"made_d10_d50_d90_m", numbers(bed.made_d10_d50_d90)},
                        {"seconds", number(bed.seconds)},
                        {"seconds_cold", number(bed.seconds_cold)}});
    return rows;
}

}  // namespace

json misfit_json(const Misfit& misfit) {
    return {{"norm", to_string(misfit.norm)},
            {"value", number(misfit.value)},
            {"debiased", number(misfit.debiased)},
            {"interval", {number(misfit.interval_low), number(misfit.interval_high)}},
            {"noise_floor", number(misfit.noise_floor)},
            {"tolerance", number(misfit.tolerance)}};
}

json constraints_json(const std::vector<ConstraintState>& states) {
    json list = json::array();
    for (const ConstraintState& state : states)
        list.push_back({{"name", state.name},
                        {"kind", state.limit ? "limit" : "linear"},
                        {"unit", state.dimension == "length"  ? "m"
                                 : state.dimension == "angle" ? "rad"
                                                              : "1"},
                        {"value", number(state.value)},
                        {"at_least", number(state.low)},
                        {"at_most", number(state.high)},
                        {"slack", number(state.slack)},
                        {"kept", state.kept()}});
    return list;
}

json design_json(const Study& study, const Design& design) {
    json parameters = json::object();
    for (const auto& [name, value] : design.parameters) parameters[name] = number(value);
    json partition = {{"family", to_string(design.family)},
                      {"parameters", parameters},
                      {"points_m", plan_points(design.partition.points)},
                      {"points_in_dispenser_m", json::array()}};
    if (design.partition.points.size() >= 2)
        partition["points_in_dispenser_m"] =
            plan_points(design.partition.clipped(study.scene.dispenser_length, study.dispenser_width));
    if (!design.partition.second.empty()) {
        partition["points2_m"] = plan_points(design.partition.second);
        partition["points2_in_dispenser_m"] =
            plan_points(design.partition.second_clipped(study.scene.dispenser_length, study.dispenser_width));
        partition["between"] = design.partition.a_between() ? "A" : "B";
    }
    return {
        {"partition", partition},
        {"fill_fraction", {{"A", number(design.fill_fraction[0])}, {"B", number(design.fill_fraction[1])}}},
        {"dosage_factor", number(design.dosage_factor)},
        {"dose", {{"A", number(design.dose[0])}, {"B", number(design.dose[1])}}},
        {"land_m", number(design.land)},
        {"blade_speed_m_s", number(design.blade_speed > 0 ? design.blade_speed : study.scene.blade_speed)},
        {"layer_thickness_m",
         number(design.layer_thickness > 0 ? design.layer_thickness : study.scene.layer_thickness)},
        {"footprint_offset_m", number(design.footprint_offset)}};
}

json inputs_json(const Study& study) {
    auto rows = json::array();
    for (const InputEntry& input : study.inputs)
        rows.push_back({{"key", input.key},
                        {"value", input.value},
                        {"unit", input.unit},
                        {"origin", input.origin},
                        {"note", input.note}});
    return rows;
}

json to_json(const Study& study, const StudyResult& result, const std::vector<std::string>& files) {
    const Wording words = wording(study, result);
    const bool proved = !result.confirmed.gi.empty();
    json drift = misfit_json(result.drift_misfit);
    drift["value"] = number(proved ? result.confirmed_drift.value : result.predicted.drift.value);
    drift["noise_floor"] =
        number(proved ? result.confirmed_drift.noise_floor : result.predicted.drift.noise_floor);
    drift["tolerance"] = number(study.objective.x_drift_tolerance);
    drift["profile"] = drift_profile_json(proved ? result.confirmed_drift : result.predicted.drift);
    if (study.target.is_field()) drift["profile"]["target"] = numbers(drift_targets(study));
    if (result.extrapolated)  // one error moves all bins
        drift["profile"]["band_factor"] = number(common_factor(result.predicted.drift.degrees));
    drift["of"] = proved ? "confirmed" : "predicted";
    const bool measured = proved || !result.predicted.profile.gi.empty();
    if (!measured) {
        drift["value"] = drift["noise_floor"] = drift["debiased"] = nullptr;
        drift["interval"] = {nullptr, nullptr};
    }
    const auto found = [&](double value) { return measured ? number(value) : json(nullptr); };
    json misfit = measured ? misfit_json(result.misfit) : undefined_misfit(result.misfit);
    misfit["of"] = drift["of"];
    misfit["tolerance"] = number(study.objective.tolerance);
    json confirmations = json::array();
    for (const Evaluation& evaluation : result.confirmations)
        confirmations.push_back(evaluation_summary(study, evaluation));
    json stages = json::object();
    for (const auto& [stage, seconds] : result.stage_seconds) stages[stage] = number(seconds);
    json provenance = provenance_json();
    provenance["host"] = {
        {"isa", result.host_isa}, {"cores", result.host_cores}, {"threads", result.threads}};
    const bool failed = result.termination == "failed" || result.termination == "not_run";
    json object = {
        {"study", study.name},
        {"study_file", study.file},
        {"machine", study.machine_name},
        {"target", study.target.describe()},
        {"termination", result.termination},
        {"message", result.message},
        {"verdict", to_string(result.verdict)},
        {"target_met", result.verdict == Verdict::met && !failed},
        {"verdict_text", words.verdict},
        {"misfit", misfit},
        {"x_drift", drift},
        {"capture_fraction", found(result.capture_fraction)},
        {"supply_ratio", found(result.supply_ratio)},
        {"design", design_json(study, result.design)},
        {"profile", profile_json(study, result)},
        {"judged_layer", judged_layer_json(study)},
        {"layers", layers_json(study, result)},
        {"coverage", found(result.coverage)},
        {"waste_fraction", found(result.waste_fraction)},
        {"waste_a_share", found(result.confirmations.empty() ? kUndefined : result.waste_a_share)},
        {"packing_fraction", found(result.packing_fraction)},
        {"spreads", {{"map", result.spreads_map}, {"full", result.spreads_full}}},
        {"predicted", evaluation_summary(study, result.predicted)},
        {"confirmations", confirmations},
        {"straight", result.straight ? evaluation_summary(study, *result.straight) : json(nullptr)},
        {"powder_gate", gate_json(result.powder_gate)},
        {"extrapolated", extrapolated_json(result.extrapolated)},
        {"kinematic", result.kinematic ? evaluation_summary(study, *result.kinematic) : json(nullptr)},
        {"beds", beds_json(result)},
        {"history", history_json(result)},
        {"given_used", pairs_json(result.given_used)},
        {"reductions", study.reductions},
        {"inputs", inputs_json(study)},
        {"warnings", words.warnings},
        {"stage_seconds", stages},
        {"seconds", number(result.seconds)},
        {"seconds_cold", number(result.seconds_cold)},
        {"seed", result.seed},
        {"provenance", provenance},
        {"files", files}};
    if (!result.constraints.empty()) object["constraints"] = constraints_json(result.constraints);
    if (const json field = field_json(result); !field.is_null()) object["field"] = field;
    return object;
}

json evaluation_json(const Study& study, const Evaluation& evaluation,
                     const std::vector<std::string>& files) {
    const GradationProfile& profile = evaluation.profile;
    const Band band = simultaneous_band(profile.gi, profile.standard_error, profile.degrees);
    json target = json::array();
    for (std::size_t b = 0; b < profile.gi.size(); ++b)
        target.push_back(number(std::isfinite(profile.gi[b]) ? at(evaluation.target, b) : kUndefined));
    json drift = misfit_json(evaluation.drift_misfit);
    drift["value"] = number(evaluation.drift.value);
    drift["noise_floor"] = number(evaluation.drift.noise_floor);
    drift["tolerance"] = number(study.objective.x_drift_tolerance);
    drift["profile"] = drift_profile_json(evaluation.drift);
    if (study.target.is_field()) drift["profile"]["target"] = numbers(drift_targets(study));
    json map = {{"x_m", numbers(evaluation.map.x_m)},
                {"y_m", numbers(evaluation.map.y_m)},
                {"gi", grid(evaluation.map.gi, evaluation.map.x_m.size())},
                {"mass_kg", grid(evaluation.map.mass_kg, evaluation.map.x_m.size())},
                {"order", "gi[y][x]"}};
    json object = evaluation_summary(study, evaluation);
    for (const char* key : {"y_m", "gi", "standard_error"}) object.erase(key);
    object["study"] = study.name;
    object["profile"] = {{"y_m", numbers(profile.y_m)},
                         {"gi", numbers(profile.gi)},
                         {"band_low", numbers(band.low)},
                         {"band_high", numbers(band.high)},
                         {"standard_error", numbers(profile.standard_error)},
                         {"target", target},
                         {"weight", numbers(evaluation.weight)},
                         {"band", "simultaneous 95 % over the bins"}};
    object["map"] = map;
    object["judged_layer"] = judged_layer_json(study);
    object["layers"] = layers_json(study, evaluation);
    std::vector<ConstraintState> constraints = constraint_states(study, evaluation.design);
    for (const ConstraintState& limit : limit_states(study, evaluation)) constraints.push_back(limit);
    if (!constraints.empty()) object["constraints"] = constraints_json(constraints);
    if (const json field = field_json(evaluation); !field.is_null()) object["field"] = field;
    if (!evaluation.health.ok()) drift["value"] = drift["noise_floor"] = drift["debiased"] = nullptr;
    object["x_drift"] = drift;
    // a strip's grains carry no powder
    const bool labelled = evaluation.health.ok() &&
                          (evaluation.fidelity == Fidelity::full || evaluation.fidelity == Fidelity::lammps);
    object["waste_a_share"] = labelled ? number(evaluation.waste_a_share) : json(nullptr);
    object["objective"] = number(evaluation.objective);
    object["kinematic_error_bound"] = number(evaluation.kinematic_error_bound);
    object["max_overlap_ratio"] = number(evaluation.health.max_overlap_ratio);
    object["deep_contact_share"] = number(evaluation.health.deep_contact_share);
    object["warnings"] = evaluation.health.warnings;
    object["inputs"] = inputs_json(study);
    object["reductions"] = study.reductions;
    object["provenance"] = provenance_json();
    object["files"] = files;
    return object;
}

}  // namespace gradwright
