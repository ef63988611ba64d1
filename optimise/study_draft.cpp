#include "optimise/study_draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "optimise/design_run.h"
#include "optimise/machine.h"

namespace gradwright {
namespace {

constexpr int kCommentColumn = 44;
constexpr double kGrainsPerBin = 5;  // D50: narrower bins show grains, not a gradation
constexpr double kDosageFactor = 3;

std::string length(double si) {
    return format_quantity(si, "length");
}

/// The lines of the file, comments in one column.
class Sheet {
  public:
    void heading(const std::string& text) { text_ += "\n[" + text + "]\n"; }
    void remark(const std::string& text) { text_ += "# " + text + "\n"; }
    void line(const std::string& text, const std::string& comment = "") {
        text_ += comment.empty() ? text : fmt::format("{:<{}}# {}", text + " ", kCommentColumn, comment);
        text_ += '\n';
    }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
};

/// What the draft is laid out by. Fallbacks stand in only until the machine's own problems are reported.
struct Layout {
    double width = 1.6e-3, dispenser = 3.2e-3, platform = 3.2e-3;
    int bins = 8;
    bool scale_up = false;
};

double number_of(const std::vector<MachineNumber>& numbers, const std::string& key, double fallback) {
    for (const MachineNumber& number : numbers)
        if (number.key == key) try {
                return parse_quantity(number.value, "length");
            } catch (const std::invalid_argument&) {
                return fallback;  // read_study says what is wrong with it
            }
    return fallback;
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + "\"";
}

std::string size_line(const GrainSizes& size) {
    return fmt::format("size = {{ basis = \"volume\", D10 = \"{}\", D50 = \"{}\", D90 = \"{}\" }}",
                       length(size.d10), length(size.d50), length(size.d90));
}

void write_machine(Sheet& sheet, const DraftOptions& options, const std::string& title,
                   const std::vector<MachineNumber>& numbers, StudyDraft& draft) {
    sheet.heading("machine");
    sheet.line(fmt::format("use = {}", quoted(options.machine)), title);
    sheet.remark("x runs with the blade, y across it; the gradation lies along y.");
    sheet.remark(
        "The machine's numbers with their sources. To put in what you measured, uncomment and change.");
    for (const MachineNumber& number : numbers) {
        sheet.line(fmt::format("# {} = {}", number.key, quoted(number.value)), number.source);
        if (!number.measured) draft.measure.push_back("machine." + number.key);
    }
}

void write_powders(Sheet& sheet, const DraftOptions& options, StudyDraft& draft) {
    const GrainSizes stand_in{25e-6, 40e-6, 62e-6};
    const GrainSizes a = options.size[0].value_or(stand_in);
    for (const int i : {0, 1}) {
        const std::string label = i == 0 ? "A" : "B";
        sheet.heading("powder." + label);
        sheet.line(fmt::format("material = {}", quoted(options.powder[i])),
                   i == 0 ? "GI, the gradation index, is the volume share of A; density, stiffness: "
                            "gradwright materials"
                          : "");
        if (options.size[i]) {
            sheet.line(size_line(*options.size[i]));
        } else {
            sheet.remark(i == 0
                             ? "measure this: a usual gas-atomised powder; yours stands on its certificate "
                               "(laser diffraction, by volume)"
                             : "measure this: taken as powder A");
            sheet.line(size_line(a));
            draft.measure.push_back("powder." + label + ".size");
        }
    }
}

void write_process(Sheet& sheet, const DraftOptions& options, StudyDraft& draft) {
    sheet.heading("process");
    sheet.line(fmt::format("layer_thickness = \"{}\"", length(options.layer_thickness)),
               "of the melted part, per layer");
    sheet.line("blade_speed = \"100 mm/s\"", "measure this: your machine's recoating speed");
    sheet.line("substrate = \"fused\"",
               "what lies under the layer: \"fused\" metal, unfused \"powder\" or a bare \"plate\"");
    sheet.line("gap = \"steady\"", "the melt shrinks, so the gap has opened to layer / packing");
    sheet.line("steady_packing = 0.28", "of the laid powder; put in what your own runs report");
    sheet.line("sides = \"periodic\"", "no side walls in the model; \"frictional\" has them");
    sheet.line("plate_thickness = \"0 um\"", "of the partition; 0: it leaves no slot when it is pulled out");
    draft.measure.push_back("process.blade_speed");

    sheet.heading("interaction");
    sheet.remark(
        "of every pair of grains and of the walls; docs/bulk.md shows what an angle of repose says of them");
    sheet.line("static_friction = 0.64", "measure this");
    sheet.line("restitution = 0.5", "measure this");
    sheet.line("rolling_friction = 0.1", "measure this");
    sheet.line("work_of_adhesion = \"0.02 J/m2\"", "measure this");
    for (const char* key : {"static_friction", "restitution", "rolling_friction", "work_of_adhesion"})
        draft.measure.push_back(std::string("interaction.") + key);
}

void write_target(Sheet& sheet, const DraftOptions& options, const Layout& layout) {
    const auto y = [&layout](double share) { return length(share * layout.width); };
    sheet.heading("target");
    sheet.line(fmt::format("shape = \"{}\"", options.target),
               fmt::format("GI along y, over a width of {}; docs/targets.md has all shapes", y(1)));
    if (options.target == "linear") {
        sheet.line(fmt::format("from = {{ y = \"{}\", gi = 0.0 }}", y(0.25)), "pure B up to here");
        sheet.line(fmt::format("to   = {{ y = \"{}\", gi = 1.0 }}", y(0.75)), "pure A from here on");
    } else if (options.target == "sigmoid") {
        sheet.line(fmt::format("centre = \"{}\"", y(0.5)), "GI 0.5 here");
        sheet.line(fmt::format("width_10_90 = \"{}\"", y(0.4)), "from GI 0.1 to GI 0.9");
    } else if (options.target == "step") {
        sheet.line(fmt::format("y = \"{}\"", y(0.5)), "pure B below, pure A above");
    } else if (options.target == "plateaus") {
        sheet.line("levels = [", "joined by straight ramps");
        sheet.line(fmt::format("    {{ gi = 0.0, to = \"{}\" }},", y(0.25)));
        sheet.line(fmt::format("    {{ gi = 0.5, from = \"{}\", to = \"{}\" }},", y(0.45), y(0.55)));
        sheet.line(fmt::format("    {{ gi = 1.0, from = \"{}\" }},", y(0.75)));
        sheet.line("]");
    } else {
        sheet.line(fmt::format("ramp_in  = {{ from = \"{}\", to = \"{}\" }}", y(0.125), y(0.375)),
                   "A outside, B between the ramps");
        sheet.line(fmt::format("ramp_out = {{ from = \"{}\", to = \"{}\" }}", y(0.625), y(0.875)));
    }
    const auto x = [&layout](double share) { return length(share * layout.platform); };
    if (layout.scale_up)
        sheet.line(fmt::format("footprint = {{ x = [\"{}\", \"{}\"], y = [\"{}\", \"{}\"] }}", x(0.2), x(0.8),
                               y(0.1), y(0.9)),
                   "where the part stands, x from the platform's near edge; it is judged there");
    else
        sheet.line(fmt::format("footprint = {{ x = [\"{}\", \"{}\"] }}", x(0.5), x(1)),
                   "where the part stands, from the platform's near edge; it is judged there");
    sheet.line(fmt::format("bin_width = \"{}\"", length(layout.width / layout.bins)),
               "the profile is judged in such bins");
}

/// What the search may build for this target: on a machine that is extrapolated the simplest plate, on one
/// that is spread one that may fold, which cancels the x drift.
std::string family_of_draft(const std::string& target, bool scale_up) {
    if (target == "aba") return "{ family = \"two_curves\", knots = 3 }";
    if (target == "plateaus") return "{ family = \"polyline\", knots = 7, monotone = false }";
    if (!scale_up) return "{ family = \"polyline\", knots = 5, monotone = false }";
    return target == "sigmoid" ? "{ family = \"sigmoid\" }" : "{ family = \"straight\" }";
}

void write_search(Sheet& sheet, const DraftOptions& options, const Layout& layout) {
    sheet.heading("design_space");
    sheet.line("partition = " + family_of_draft(options.target, layout.scale_up));
    sheet.remark("docs/partitions.md has all families");
    sheet.line("fill_fraction = { A = 1.0, B = 1.0 }", "both chambers filled to the rim");
    sheet.line(fmt::format("dosage_factor = {:.1f}", kDosageFactor),
               "the dispenser rises by 3 layers for each layer; [2.0, 5.0] frees it");

    sheet.heading("objective");
    sheet.line("norm = \"rmse\"");
    sheet.line(fmt::format("tolerance = {}", layout.scale_up ? "0.10" : "0.04"),
               layout.scale_up ? "rms error of GI that is still good enough; an extrapolation promises little"
                               : "rms error of GI that is still good enough");
    sheet.line(fmt::format("x_drift_tolerance = {}", layout.scale_up ? "0.20" : "0.10"),
               "how far the profile may wander along x");
    sheet.line("min_coverage = 0.95", "share of the platform that the layer covers");

    sheet.heading("numerics");
    sheet.line("softening = 1e-4", "Young's modulus is scaled by this: a longer time step");
    sheet.line("reductions = \"reduced\"",
               "what is left out of the physics, priced in docs/speed-against-error.md");

    sheet.heading("run");
    sheet.line("seed = 1", "the same seed gives the same numbers");
    if (!layout.scale_up) {
        sheet.line("map_spreads = 2", "strips pooled into one map");
        sheet.line("max_spreads = 4", "strips and full-width confirmations together");
        return;
    }
    std::vector<std::string> lengths;
    for (const double strip : {1.6e-3, 3.2e-3, 6.4e-3, 12.8e-3})
        if (2 * strip <= layout.dispenser) lengths.push_back(quoted(length(strip)));
    if (lengths.size() < 3) {
        lengths.clear();
        for (const double share : {0.125, 0.25, 0.5})
            lengths.push_back(quoted(length(share * layout.dispenser)));
    }
    sheet.heading("scale_up");
    sheet.remark("Too large to be spread grain by grain: strips of it are, and the machine is extrapolated");
    sheet.remark(
        "(docs/scale-up.md). A longer strip is worth more than anything else here, and costs the most.");
    sheet.line(fmt::format("lengths = [{}]", fmt::join(lengths, ", ")), "of the strips' dispensers");
    sheet.line(fmt::format("dosage_factors = [2.0, {:.1f}, 4.5]", kDosageFactor),
               "also spread, at the middle length");

    sheet.heading("partition_build");
    sheet.line("thickness = \"0.5 mm\"", "of the plate that the workshop makes (docs/hand-over.md)");
    sheet.line("slot_depth = \"3 mm\"", "how far its ends reach into the dispenser's walls");
}

std::string write_study(const DraftOptions& options, const std::string& name, const std::string& title,
                        const std::vector<MachineNumber>& numbers, const Layout& layout, StudyDraft& draft) {
    draft.measure.clear();
    Sheet sheet;
    if (!options.file.empty()) {
        sheet.line("#   gradwright check  " + options.file);
        sheet.line("#   gradwright design " + options.file);
        sheet.line("#");
    }
    sheet.remark(fmt::format("{} and {} on: {}.", options.powder[0], options.powder[1], title));
    sheet.remark("Every length, speed and energy is a string with its unit. What says");
    sheet.remark("\"measure this\" is a stand-in that nobody has measured on your machine and your powders.");
    sheet.heading("study");
    sheet.line("name = " + quoted(name));
    write_machine(sheet, options, title, numbers, draft);
    write_powders(sheet, options, draft);
    write_process(sheet, options, draft);
    write_target(sheet, options, layout);
    write_search(sheet, options, layout);
    return sheet.text();
}

}  // namespace

StudyDraft draft_study(const DraftOptions& options) {
    const std::filesystem::path file(options.file);
    const std::vector<MachineNumber> numbers = machine_numbers(options.machine, file.parent_path().string());
    const std::string name = !options.name.empty() ? options.name : file.stem().string();
    Layout layout;
    layout.dispenser = number_of(numbers, "dispenser.length", layout.dispenser);
    layout.platform = number_of(numbers, "platform.length", layout.platform);
    layout.width = number_of(numbers, "dispenser.width", layout.width);
    double d50 = 40e-6;
    for (const auto& size : options.size)
        if (size) d50 = std::max(d50, size->d50);
    for (const int bins : {20, 16, 10, 8, 5, 4}) {
        layout.bins = bins;
        if (layout.width / bins >= kGrainsPerBin * d50 * (1 - 1e-9)) break;
    }
    StudyDraft draft;
    const auto written = [&](const std::string& title) {
        return write_study(options, name.empty() ? "study" : name, title, numbers, layout, draft);
    };
    // Read at once: what the machine file or the sizes have wrong is told before anything is written.
    const Study study = parse_study(written(options.machine), options.file);
    draft.machine_title = study.machine_name;
    const Scene full = scene_of(study, start_design(study), false, study.seed);
    draft.scale_up = layout.scale_up = estimate_cost(full).grain_steps > kLargestDraftedSpread;
    draft.text = written(draft.machine_title);
    if (layout.scale_up) parse_study(draft.text, options.file);
    return draft;
}

}  // namespace gradwright
