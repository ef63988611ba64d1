#include "optimise/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "optimise/machine.h"
#include "optimise/material_table.h"

namespace gradwright {
namespace {

// Widest values taken as meant; beyond them a unit has gone wrong.
constexpr double kLargestPlan = 10;         // [m]
constexpr double kLargestGrain = 10e-3;     // [m]
constexpr double kLargestSpeed = 10;        // [m/s]
constexpr double kLargestModulus = 2000e9;  // [Pa]
constexpr double kLargestDensity = 30000;   // [kg/m3]
constexpr double kDensestPacking = 0.74;    // equal spheres cannot lie denser
constexpr double kLargestCoarsening = 4;    // beyond it a layer is one grain
constexpr long kMostLayers = 1000;          // a dispenser holds fewer doses
constexpr double kGrainsAcross = 3;         // a dispenser narrower than 3 d does not flow (physics.md 7)

const char* const kPaper =
    "Choudhury, Annabattula, Amirthalingam, Multi-Material Spreading Strategies for FGM Manufacturing in "
    "LPBF";

std::string paper(const std::string& where) {
    return fmt::format("{}, {}", kPaper, where);
}

/// The default powder's value carried over to another median, exact when nothing changes.
double scaled(double reference_value, double reference_base, double base) {
    return base == reference_base ? reference_value : reference_value * (base / reference_base);
}

std::string number(double si) {
    return format_quantity(si, "length");
}

const Material* find_material(const std::vector<Material>& table, const std::string& name) {
    const auto it =
        std::find_if(table.begin(), table.end(), [&](const Material& m) { return m.name == name; });
    return it == table.end() ? nullptr : &*it;
}

std::vector<Material> material_table(TomlReader& reader) {
    try {
        return shipped_materials();
    } catch (const InputError& error) {
        for (const InputProblem& problem : error.problems) reader.add(problem);
        return {};
    }
}

/// The part of a material's source that belongs to one number: "density: ...; Young's modulus: ...; Poisson's
/// ratio: ...".
std::string source_of(const Material& material, const std::string& title) {
    const auto start = material.source.find(title + ": ");
    if (start == std::string::npos) return "material table";
    const std::string rest = material.source.substr(start + title.size() + 2);
    std::size_t end = rest.size();
    for (const char* next : {"; Young's modulus: ", "; Poisson's ratio: "})
        end = std::min(end, rest.find(next));
    return "material table: " + rest.substr(0, end);
}

Material named_material(TomlReader& reader, Section& section, const TomlReader::Found& found,
                        const std::string& key, const std::string& name) {
    const std::vector<Material> table = material_table(reader);
    if (const Material* material = find_material(table, name)) return *material;
    std::vector<std::string> names;
    std::string list;
    for (const Material& material : table) {
        names.push_back(material.name);
        list += (list.empty() ? "" : ", ") + material.name;
    }
    const std::string nearest = nearest_name(name, names);
    section.problem(found, key, "is not in the material table",
                    nearest.empty()
                        ? fmt::format("known: {}; or write {{ density = ..., youngs_modulus = ... }}", list)
                        : fmt::format("did you mean \"{}\"?", nearest));
    return {};
}

Material read_material(TomlReader& reader, Section& powder, const std::string& label) {
    const std::string key = "material";
    const TomlReader::Found found = powder.find(key);
    if (!found.node) {
        powder.missing(
            key, fmt::format("name one, such as material = \"{}\"", label == "A" ? "SS17-4PH" : "IN718"));
        return {};
    }
    if (const auto* name = found.node->as_string()) {
        const Material material = named_material(reader, powder, found, key, name->get());
        const std::string path = powder.path(key);
        reader.record({path, name->get(), "", found.origin, found.note});
        if (material.name.empty()) return material;
        reader.derived(path + ".density", material.density, "density", source_of(material, "density"));
        reader.derived(path + ".youngs_modulus", material.youngs_modulus, "pressure",
                       source_of(material, "Young's modulus"));
        reader.derived(path + ".poissons_ratio", material.poissons_ratio, "",
                       source_of(material, "Poisson's ratio"));
        if (!material.composition.empty())
            reader.record({path + ".composition", composition_text(material), "wt%", "default",
                           "material table: " + material.composition_source});
        return material;
    }
    Material material;
    if (!found.node->is_table()) {
        powder.problem(
            found, key, "must be a name or a table",
            "write material = \"IN718\" or { density = \"8200 kg/m3\", youngs_modulus = \"195 GPa\" }");
        return material;
    }
    Section own(powder.sub(key));
    material.name = own.text("name", "powder " + label, "not named");
    material.density = own.quantity("density", "density", required("such as density = \"8200 kg/m3\""),
                                    Range::above_to(0, kLargestDensity));
    material.youngs_modulus =
        own.quantity("youngs_modulus", "pressure", required("such as youngs_modulus = \"195 GPa\""),
                     Range::above_to(0, kLargestModulus));
    material.poissons_ratio =
        own.number("poissons_ratio", {0.3, "our default: the paper gives none", "assumed"},
                   Range{.low = 0, .high = 0.5, .high_open = true});
    material.source = own.text("source", "the study file", "not given");
    read_composition(own, material, "the study file");
    own.finish();
    return material;
}

/// `reference`: what a missing value is scaled from (the default powder for A, A's sizes for B).
SizeDistribution read_size(TomlReader& reader, Section& powder, const SizeDistribution& reference,
                           const std::string& reference_name) {
    Section size = powder.sub("size");
    if (!powder.has("size") && reference_name == "powder A") {
        reader.record(
            {powder.path("size"), "as powder A", "", "default", "powder B takes the sizes of powder A"});
        return reference;
    }
    size.choice("basis", {"volume"}, "volume", "quantiles are by volume");
    const Range length = Range::above_to(0, kLargestGrain);
    const std::string note = "as " + reference_name;
    const std::string scaling = reference_name + ", scaled";
    SizeDistribution result;
    result.d50 = size.quantity("D50", "length", {reference.d50, note}, length);
    const bool same = result.d50 == reference.d50;
    result.d10 = size.quantity(
        "D10", "length", {scaled(reference.d10, reference.d50, result.d50), same ? note : scaling}, length);
    result.d90 = size.quantity(
        "D90", "length", {scaled(reference.d90, reference.d50, result.d50), same ? note : scaling}, length);
    result.cut_low = size.quantity(
        "cut_low", "length",
        {scaled(reference.cut_low, reference.d10, result.d10), "15 um for D10 = 25 um, scaled"}, length);
    result.cut_high = size.quantity(
        "cut_high", "length",
        {scaled(reference.cut_high, reference.d90, result.d90), "80 um for D90 = 62 um, scaled"}, length);
    size.finish();

    const std::string d10 = size.path("D10"), d50 = size.path("D50"), d90 = size.path("D90");
    if (reader.sound({d10, d50, d90}) && !(result.d10 < result.d50 && result.d50 < result.d90))
        reader.conflict({d50, d10, d90},
                        fmt::format("needs D10 < D50 < D90, has {}, {}, {}", number(result.d10),
                                    number(result.d50), number(result.d90)),
                        "order the three diameters");
    else if (reader.sound({size.path("cut_low"), size.path("cut_high"), d10, d50, d90}) &&
             !(result.cut_low < result.d50 && result.d50 < result.cut_high))
        reader.conflict({size.path("cut_low"), size.path("cut_high"), d50},
                        fmt::format("needs cut_low < D50 < cut_high, has {}, {}, {}", number(result.cut_low),
                                    number(result.d50), number(result.cut_high)),
                        "keep the median inside the cut");
    return result;
}

}  // namespace

double largest_grain(const Scene& scene) {
    return std::max(scene.powder[0].size.cut_high, scene.powder[1].size.cut_high);
}

void read_machine(TomlReader& reader, Section& root, Study& study) {
    Section machine = root.sub("machine");
    Scene& scene = study.scene;
    const TomlReader::Found use = machine.find("use");
    std::string title;
    if (use.node) {
        if (const auto* name = use.node->as_string()) {
            title = supply_machine(reader, name->get(),
                                   {use.file, use.line, "machine.use", node_text(*use.node), "", ""});
            reader.record({"machine.use", name->get(), "", use.origin, use.note});
        } else {
            machine.problem(use, "use", "must be the name of a machine", "such as use = \"coupon-rig\"");
        }
    }
    study.machine_name =
        machine.text("name", title.empty() ? "unnamed machine" : title, use.node ? "machine.use" : "");
    if (!machine.has("name") && !title.empty())
        reader.amend("machine.name", title, "machine file", "machine.use");

    const TomlReader::Found feed = machine.find("feed");
    if (feed.node && feed.node->value<std::string>() == "hopper")
        machine.problem(feed, "feed",
                        "is not what can be designed for: a hopper travels with the blade and pours out "
                        "powder on the way, so there is no dispenser in which a partition could stand",
                        "take a machine whose powder a piston lifts before the blade (feed = \"piston\")");
    else
        machine.choice("feed", {"piston"}, "piston", "a piston lifts the powder before the blade");

    const std::string mend = "give it, or take a shipped machine: use = \"coupon-rig\"";
    const Range plan = Range::above_to(0, kLargestPlan);
    // Where `use` failed, its missing numbers are no further problems.
    const bool unusable = use.node && title.empty();
    const auto needed = [&](double value) {
        return unusable ? Default{value, "", "default", false} : required(mend);
    };
    Section dispenser = machine.sub("dispenser");
    scene.dispenser_length = dispenser.quantity("length", "length", needed(scene.dispenser_length), plan);
    study.dispenser_width = dispenser.quantity("width", "length", needed(study.dispenser_width), plan);
    scene.dispenser_depth = dispenser.quantity(
        "depth", "length", {scene.dispenser_depth, "not given: measure the well", "assumed"}, plan);
    dispenser.finish();
    Section platform = machine.sub("platform");
    scene.platform_length = platform.quantity("length", "length", needed(scene.platform_length), plan);
    const double platform_width =
        platform.quantity("width", "length", {study.dispenser_width, "as wide as the dispenser"}, plan);
    platform.finish();
    study.design_space.land = machine.variable("land", "land", "length", study.design_space.land,
                                               "our default; a mixer: the longer the way, the better mixed",
                                               Range::between(0, kLargestPlan));
    scene.land = study.design_space.land.value;
    scene.second_land = machine.quantity("second_land", "length",
                                         {scene.second_land, "our default: room for one heap"}, plan);
    Section blade = machine.sub("blade");
    scene.blade_tip_radius =
        blade.quantity("tip_radius", "length", {0, "flat face, sharp edge (the paper: linear)"},
                       Range::between(0, kLargestPlan));
    scene.blade_thickness =
        blade.quantity("thickness", "length", {scene.blade_thickness, "our default"}, plan);
    blade.finish();
    const TomlReader::Found wall = machine.find("wall");
    const auto* wall_name = wall.node ? wall.node->as_string() : nullptr;
    if (wall.node && !wall_name)
        machine.problem(wall, "wall", "must be the name of a material", "such as wall = \"geometry\"");
    scene.wall = named_material(reader, machine, wall, "wall", wall_name ? wall_name->get() : "geometry");
    reader.record({"machine.wall", wall_name ? wall_name->get() : "geometry", "",
                   wall.node ? wall.origin : "default",
                   wall.node ? wall.note : paper("table 1, geometry material")});
    machine.finish();

    if (reader.sound({"machine.platform.width", "machine.dispenser.width"}) &&
        std::abs(platform_width - study.dispenser_width) > 1e-9)
        reader.conflict({"machine.platform.width", "machine.dispenser.width"},
                        fmt::format("platform and dispenser must be equally wide, are {} and {}",
                                    number(platform_width), number(study.dispenser_width)),
                        "give the width that the blade spreads over for both");
    if (reader.sound({"machine.blade"}) && scene.blade_tip_radius > scene.blade_thickness)
        reader.conflict({"machine.blade.tip_radius", "machine.blade.thickness"},
                        fmt::format("the tip radius {} exceeds the blade's thickness {}",
                                    number(scene.blade_tip_radius), number(scene.blade_thickness)),
                        "make the blade thicker or the tip sharper");
    scene.width = study.dispenser_width;
}

void read_powders(TomlReader& reader, Section& root, Study& study) {
    Section powders = root.sub("powder");
    Scene& scene = study.scene;
    for (const int i : {0, 1}) {
        const std::string label = i == 0 ? "A" : "B";
        Section powder = powders.sub(label);
        scene.powder[i].material = read_material(reader, powder, label);
        scene.powder[i].size = i == 0 ? read_size(reader, powder, SizeDistribution{},
                                                  "our default powder (25/40/62 um; the paper gives D50)")
                                      : read_size(reader, powder, scene.powder[0].size, "powder A");
        powder.finish();
    }
    powders.finish();
}

void read_process(TomlReader& reader, Section& root, Study& study) {
    Section process = root.sub("process");
    Scene& scene = study.scene;
    scene.layer_thickness = process.quantity("layer_thickness", "length", {40e-6, paper("section 4")},
                                             Range::above_to(0, kLargestGrain));
    scene.blade_speed =
        process.quantity("blade_speed", "speed", {scene.blade_speed, "our default: the paper gives none"},
                         Range::above_to(0, kLargestSpeed));
    const std::string substrate = process.choice("substrate", {"fused", "plate", "powder"}, "fused",
                                                 "a part in the middle of its build");
    scene.substrate = substrate == "plate"    ? Substrate::plate
                      : substrate == "powder" ? Substrate::powder
                                              : Substrate::fused;
    const bool fused = scene.substrate == Substrate::fused;
    scene.layers =
        static_cast<int>(process.integer("layers", 1, "one dose and one pass of the blade", 1, kMostLayers));
    if (scene.substrate == Substrate::powder) {
        scene.substrate_share_a = process.number(
            "substrate_share_a", {1, "the powder under the layer is powder A"}, Range::between(0, 1));
    } else {
        process.know("substrate_share_a");
        if (process.has("substrate_share_a"))
            study.warnings.push_back("process.substrate_share_a has no effect: substrate is not \"powder\"");
    }
    scene.roughness = process.quantity(
        "roughness", "length", {scene.powder[0].size.d50, "D50 of powder A: fixed grains of that size"},
        Range::above_to(0, kLargestGrain));

    const TomlReader::Found gap = process.find("gap");
    const auto* gap_text = gap.node ? gap.node->as_string() : nullptr;
    const std::string rule_of_gap = gap_text ? gap_text->get() : (fused ? "steady" : "layer");
    std::vector<std::string> names = {"steady", "layer"};
    study.gap_steady = rule_of_gap == "steady";
    study.gap_layer = rule_of_gap == "layer";
    double length = scene.layer_thickness;
    if (gap.node && !gap_text) {
        process.problem(gap, "gap", gap.node->is_number() ? "has no unit" : "must be a string",
                        "write \"steady\", \"layer\" or a length such as \"140 um\"");
    } else if (rule_of_gap != "steady" && rule_of_gap != "layer") {
        try {
            length = parse_quantity(rule_of_gap, "length");
            if (!(length > 0 && length <= kLargestGrain))
                process.problem(gap, "gap", Range::above_to(0, kLargestGrain).rule("length"),
                                "such as \"140 um\"");
        } catch (const std::invalid_argument& error) {
            const std::string nearest = nearest_name(rule_of_gap, names);
            process.problem(
                gap, "gap", "must be \"steady\", \"layer\" or a length",
                nearest.empty() ? "such as \"140 um\"" : fmt::format("did you mean \"{}\"?", nearest));
        }
    }
    const bool is_length = rule_of_gap != "steady" && rule_of_gap != "layer";
    reader.record({"process.gap", rule_of_gap, is_length ? unit_of(rule_of_gap) : "",
                   gap.node ? gap.origin : "default",
                   gap.node ? gap.note : "steady over fused metal, one layer over a plate or powder"});
    if (study.gap_steady) {
        study.steady_packing = process.number(
            "steady_packing",
            {study.steady_packing, "0.28-0.33 seen at gap 150 um; put in the packing your own runs report",
             "assumed"},
            Range::above_to(0, kDensestPacking));
        scene.gap = scene.layer_thickness /
                    study.steady_packing;  // fixed point g x packing(g) = layer (physics.md 1)
    } else {
        if (process.has("steady_packing"))
            study.warnings.push_back("process.steady_packing has no effect: gap is not \"steady\"");
        process.know("steady_packing");
        scene.gap = length;
    }
    reader.derived("process.gap.length", scene.gap, "length",
                   study.gap_steady ? "layer_thickness / steady_packing" : "as process.gap says");

    const std::string sides = process.choice("sides", {"frictional", "frictionless", "periodic"}, "periodic",
                                             "no side walls: every y answers for every other");
    scene.sides = sides == "periodic"     ? Sides::periodic
                  : sides == "frictional" ? Sides::frictional
                                          : Sides::frictionless;
    scene.plate_thickness = process.quantity("plate_thickness", "length", {0, "an ideally thin partition"},
                                             Range::between(0, kLargestPlan));
    study.allow_starved =
        process.boolean("allow_starved", false, "a supply ratio below 1.05 is refused unless this is true");
    scene.allow_starved = study.allow_starved;
    scene.gravity =
        process.quantity("gravity", "acceleration", {scene.gravity, "standard"}, Range::above_to(0, 1000));
    process.finish();

    const double d_max = largest_grain(scene);
    if (reader.sound({"process.plate_thickness", "machine.dispenser"}) &&
        scene.plate_thickness >= std::min(scene.dispenser_length, study.dispenser_width))
        reader.conflict({"process.plate_thickness"}, "the partition's plate would fill the dispenser",
                        "make it thinner than the dispenser is long and wide");
    for (const auto& [key, value] :
         {std::pair<std::string, double>{"machine.dispenser.length", scene.dispenser_length},
          std::pair<std::string, double>{"machine.dispenser.width", study.dispenser_width}})
        if (reader.sound({key, "powder"}) && value < kGrainsAcross * d_max)
            reader.conflict({key},
                            fmt::format("must hold at least {} of the largest grains ({}), is {}",
                                        kGrainsAcross, number(d_max), number(value)),
                            "widen the dispenser or sieve the powder");
    if (!reader.sound({"process", "powder"})) return;
    if (scene.gap < d_max)
        study.warnings.push_back(
            fmt::format("the gap {} is smaller than the largest grain {}: grains will be held back "
                        "or jam; raise process.layer_thickness or sieve the powder",
                        number(scene.gap), number(d_max)));
    if (!fused && study.gap_steady)
        study.warnings.push_back(
            "gap \"steady\" belongs to a fused substrate: the first layer on a bare plate, and every layer "
            "on powder, has the gap of one layer (process.gap = \"layer\")");
    if (!fused && is_length && scene.layers > 1)
        study.warnings.push_back(fmt::format(
            "process.gap {} is the first layer's: the platform sinks by one layer thickness ({}) before each "
            "later one, which is its gap",
            number(scene.gap), number(scene.layer_thickness)));
    if (fused && rule_of_gap == "layer")
        study.warnings.push_back(
            "gap \"layer\" over fused metal is the first layer's only: the melt shrinks and the gap "
            "opens to layer_thickness / packing (process.gap = \"steady\")");
}

void read_interaction(TomlReader& reader, Section& root, Study& study) {
    Section section = root.sub("interaction");
    Interaction& interaction = study.scene.interaction;
    const std::string table = paper("table 1, all pairs");
    interaction.static_friction = section.number("static_friction", {0.64, table}, Range::between(0, 10));
    interaction.coefficient_of_restitution =
        section.number("restitution", {0.5, table}, Range::above_to(0, 1));
    interaction.rolling_friction = section.number("rolling_friction", {0.1, table}, Range::between(0, 10));
    const Range energy = Range::between(0, 10);
    if (section.has("surface_energy")) {
        // Gamma = 2 gamma: two new surfaces per parted contact (physics.md 3).
        interaction.work_of_adhesion =
            2 * section.quantity("surface_energy", "work_of_adhesion", {0.01, ""}, energy);
        if (section.has("work_of_adhesion"))
            reader.conflict({"interaction.surface_energy"},
                            "stands beside work_of_adhesion, which says the same",
                            "keep one; work of adhesion = 2 x surface energy of like materials");
        else
            reader.derived("interaction.work_of_adhesion", interaction.work_of_adhesion, "work_of_adhesion",
                           "2 x surface_energy");
        section.know("work_of_adhesion");
    } else {
        interaction.work_of_adhesion =
            section.quantity("work_of_adhesion", "work_of_adhesion", {0.02, paper("section 2.1")}, energy);
        section.know("surface_energy");
    }
    const std::string cap =
        section.choice("friction_cap", {"thornton", "edem_repulsive", "normal"}, "thornton",
                       "our default: the elastic force plus twice the pull-off force");
    interaction.friction_cap = cap == "thornton" ? FrictionCap::thornton
                               : cap == "normal" ? FrictionCap::normal
                                                 : FrictionCap::edem_repulsive;
    const std::string rolling = section.choice(
        "rolling_model", {"constant_torque", "edem", "spring", "none"}, "constant_torque",
        "our default: half of `edem` for equal grains; EDEM, the paper's software, uses `edem`");
    interaction.rolling_model = rolling == "none"     ? RollingModel::none
                                : rolling == "spring" ? RollingModel::spring
                                : rolling == "edem"   ? RollingModel::edem
                                                      : RollingModel::constant_torque;
    interaction.rolling_regularisation_speed =
        section.quantity("rolling_regularisation_speed", "speed",
                         {interaction.rolling_regularisation_speed, "our default: linear below this speed"},
                         Range::above_to(0, kLargestSpeed));
    section.finish();
}

void read_numerics(TomlReader& reader, Section& root, Study& study) {
    Section section = root.sub("numerics");
    Scene& scene = study.scene;
    scene.softening = section.number(
        "softening", {scene.softening, paper("table 1: E 210 GPa -> 0.0210 GPa")}, Range::above_to(0, 1));
    scene.adhesion_scaling =
        section.choice(
            "adhesion_scaling", {"cohesion_number", "none"}, "cohesion_number",
            paper("section 2.1: cohesion number kept; whether 0.02 J/m2 is before or after is not said")) ==
                "none"
            ? AdhesionScaling::none
            : AdhesionScaling::cohesion_number;
    study.reductions =
        section.choices("reductions", {kReductions.begin(), kReductions.end()},
                        "nothing is left out of the physics", "reduced", {kReduced.begin(), kReduced.end()});
    const toml::node* named = reader.root().at_path("numerics.reductions").node();
    const bool set = named && named->is_string() && !study.reductions.empty();
    Section time_step = section.sub("time_step");
    scene.rayleigh_fraction =
        time_step.number("rayleigh_fraction",
                         set ? Default{kReducedRayleighFraction,
                                       "reductions \"reduced\": priced in docs/speed-against-error.md"}
                             : Default{scene.rayleigh_fraction, "our default"},
                         Range::above_to(0, 1));
    time_step.finish();
    const auto reduced = [&study](const char* name) {
        return std::find(study.reductions.begin(), study.reductions.end(), name) != study.reductions.end();
    };

    if (reduced("fines_cut") && reader.sound({"powder"}))
        for (const int i : {0, 1}) {
            SizeDistribution& size = scene.powder[i].size;
            size.cut_low = std::max(size.cut_low, size.d10);
            size.cut_high = std::min(size.cut_high, size.d90);
            const std::string path = i == 0 ? "powder.A.size." : "powder.B.size.";
            const std::string note = "reduction fines_cut: the finest grain sets the time step";
            reader.amend(path + "cut_low", number(size.cut_low), "given", note);
            reader.amend(path + "cut_high", number(size.cut_high), "given", note);
        }

    if (reduced("coarse_map") || reduced("coarse_grains")) {
        study.map_coarsening = section.number("coarse_factor", {1.5, "reduction: grains 1.5 times as large"},
                                              Range::between(1, kLargestCoarsening));
        if (reduced("coarse_grains")) study.full_coarsening = study.map_coarsening;
        study.warnings.push_back(fmt::format(
            "{} with grains {} times as large: good for the gradation, not for packing, coverage or waste",
            reduced("coarse_grains") ? "every spread is computed" : "the map is spread",
            study.map_coarsening));
    } else if (section.has("coarse_factor")) {
        section.know("coarse_factor");
        study.warnings.push_back(
            "numerics.coarse_factor has no effect without the reduction \"coarse_map\" or \"coarse_grains\"");
    }
    scene.early_stop = reduced("early_stop");

    const double d50 = std::max(scene.powder[0].size.d50, scene.powder[1].size.d50);
    const double d_max = largest_grain(scene);
    // Powder deeper than about 8 D50 hardly moves (physics.md 1).
    const double depths = reduced("shallow_bed") ? 3 : 8;
    scene.bed_depth = section.quantity(
        "bed_depth", "length",
        {std::min(depths * d50, scene.dispenser_depth),
         reduced("shallow_bed") ? "reduction shallow_bed: 3 D50" : "8 D50: deeper powder hardly moves"},
        Range::above_to(0, kLargestPlan));
    if (reader.sound({"numerics.bed_depth", "machine.dispenser.depth"}) &&
        scene.bed_depth > scene.dispenser_depth)
        reader.conflict(
            {"numerics.bed_depth", "machine.dispenser.depth"},
            fmt::format("must not exceed the dispenser's depth {}", number(scene.dispenser_depth)),
            "leave it out, or lower it");

    study.strip_width = study.dispenser_width;
    if (reduced("strip_map")) {
        study.strip_width =
            section.quantity("strip_width", "length", {std::min(10 * d50, study.dispenser_width), "10 D50"},
                             Range::above_to(0, kLargestPlan));
        if (reader.sound({"numerics.strip_width", "powder", "machine.dispenser"})) {
            if (study.strip_width > study.dispenser_width)
                reader.conflict(
                    {"numerics.strip_width"},
                    fmt::format("must not exceed the dispenser's width {}", number(study.dispenser_width)),
                    "narrow the strip");
            else if (study.strip_width < kGrainsAcross * d_max * study.map_coarsening)
                reader.conflict({"numerics.strip_width"},
                                fmt::format("must hold at least {} of the largest grains ({})", kGrainsAcross,
                                            number(d_max * study.map_coarsening)),
                                "widen the strip");
        }
    } else {
        section.know("strip_width");
        if (section.has("strip_width"))
            study.warnings.push_back(
                "numerics.strip_width has no effect without the reduction \"strip_map\"");
        reader.derived("numerics.strip_width", study.strip_width, "length",
                       "no reduction strip_map: the map is spread at full width");
    }
    scene.precision =
        section.choice("precision", {"single", "double"}, "single",
                       "number type of the contact law; integration is always double") == "double"
            ? Precision::double_law
            : Precision::single_law;
    scene.sleep = section.boolean("sleep", true, "grains at rest in a quiet neighbourhood are not computed");
    section.finish();
}

}  // namespace gradwright
