#include "optimise/lammps_deck.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optimise/lammps_law.h"

namespace gradwright {
namespace {

constexpr int kFixedType = 3;  // 1 = A, 2 = B
const char* const kGroups[2] = {"a", "b"};

/// One wall in the deck: a fix for each powder that is there, because fix wall/gran knows one stiffness.
std::string wall_fixes(const LammpsLaw& law, const Body& body, const std::string& name, int powders,
                       double softer) {
    std::string out;
    for (int k = 0; k < powders; ++k) {
        const std::string numbers = law.wall(k, body.frictionless, softer);
        if (body.kind == Body::Kind::plane) {
            const char axis = "xyz"[body.axis];
            const std::string at = fmt::format("{:.17g}", body.offset);
            out += fmt::format("fix {}_{} {} wall/gran granular {} {}plane {} {}\n", name, kGroups[k],
                               kGroups[k], numbers, axis, body.sign > 0 ? at : "NULL",
                               body.sign > 0 ? "NULL" : at);
        } else {
            out += fmt::format("fix {}_{} {} wall/gran/region granular {} region {}\n", name, kGroups[k],
                               kGroups[k], numbers, name);
        }
    }
    return out;
}

double largest_radius(const Stage& stage) {
    double top = 0;
    for (const double r : stage.bed.radius) top = std::max(top, r);
    for (const GrainSpec& g : stage.fixed) top = std::max(top, g.radius);
    return top;
}

}  // namespace

std::string lammps_shot_file(std::size_t shot) {
    return fmt::format("shot-{}.dump", shot + 1);
}

std::string lammps_obstacle(const Scene& scene) {
    if (scene.blade_tip_radius > 0)
        return "LAMMPS's blade is a block with sharp edges: set machine.blade.tip_radius to 0 um";
    if (scene.layers > 1 || scene.substrate == Substrate::powder)
        return "LAMMPS spreads one layer on fused metal or a plate: set process.layers to 1 and "
               "process.substrate to \"fused\"";
    return {};
}

long lammps_step(const Scene& scene, double blade_x) {
    return std::lround((blade_x - kBladeStart) / (scene.blade_speed * scene_time_step(scene)));
}

long lammps_way_steps(const Scene& scene) {
    return static_cast<long>(
        std::ceil((platform_end(scene) - kBladeStart) / (scene.blade_speed * scene_time_step(scene))));
}

std::string lammps_deck(const Scene& scene, const Stage& stage, const LammpsDeckOptions& options) {
    const LammpsLaw law(scene);
    const double dt = scene_time_step(scene), end = platform_end(scene);
    const bool periodic = scene.sides == Sides::periodic;
    const int powders = stage.labelled ? 2 : 1;
    const long way = lammps_way_steps(scene);
    std::string out;
    const auto line = [&out](const std::string& text) { out += text + '\n'; };

    line(
        "# A spread of Gradwright's for LAMMPS (release of 29 September 2021, Debian's package lammps). By "
        "hand:");
    line(fmt::format("#   {}lmp -in {} -var skin 6e-6",
                     options.ranks > 1 ? fmt::format("mpirun -np {} ", options.ranks) : "", kLammpsDeck));
    line(
        "# Types: 1 powder A, 2 powder B, 3 fixed rough grains. SI units. What its law cannot say as ours "
        "does:");
    for (const std::string& difference : lammps_differences(scene, options.rigid_blade))
        line("#   " + difference);
    line(
        "# Every `run` after the first says `pre no`: fix wall/gran puts its damping through the tsuji "
        "polynomial");
    line("# again at each initialisation, so a second one would change the walls' restitution.");
    line("variable skin index 8e-6           # [m]; the fastest of 4, 6, 8, 12 um on these beds");
    line("variable balance_every index 2000  # steps");
    line("units si");
    line("atom_style sphere");
    // Shrink-wrapped where nothing may leave, so that a grain can only be lost over the far end, as in ours.
    line(periodic ? "boundary sf p s" : "boundary sf s s");
    line("newton off");
    line("comm_modify vel yes");
    if (options.ranks > 1) line(fmt::format("processors {} 1 1", options.ranks));
    line(fmt::format("read_data {}", kLammpsBed));
    line("group a type 1");
    line("group b type 2");
    line("group mobile type 1 2");
    line(fmt::format("group fixed type {}", kFixedType));
    line("pair_style granular");
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) line(fmt::format("pair_coeff {} {} {}", i + 1, j + 1, law.pair(i, j)));
    line("neighbor ${skin} bin");
    line("neigh_modify every 1 delay 0 check yes exclude group fixed fixed");
    line(fmt::format("timestep {:.17g}", dt));
    line(fmt::format("fix weight mobile gravity {:.17g} vector 0 0 -1", scene.gravity));
    line("fix still fixed freeze");
    line(fmt::format("variable way equal {:.17g}*step*dt  # of the blade [m]", scene.blade_speed));
    for (std::size_t b = 0; b < stage.bodies.size(); ++b) {
        const Body& body = stage.bodies[b];
        const bool moves = static_cast<int>(b) == stage.blade;
        const std::string name = moves ? "blade" : fmt::format("wall{}", b);
        if (body.kind == Body::Kind::box)
            line(fmt::format(
                "region {} block {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} side out{} units box", name,
                body.x0, body.x1, -1.0, 1 + scene.width, body.z0, body.z1,
                moves ? " move v_way NULL NULL" : ""));
        out += wall_fixes(law, body, name, powders, options.rigid_blade ? 1 : wall_softening(body));
    }
    line("fix motion mobile nve/sphere");
    if (options.ranks > 1) line("fix even all balance ${balance_every} 1.05 shift x 10 1.02");
    line("compute ke mobile ke");
    line("compute spin mobile erotate/sphere");
    line("compute size mobile property/atom radius");
    line(fmt::format("variable ahead atom \"(x > {:.17g}) * (z > 0) * {:.17g} * c_size^3\"", end,
                     4.0 / 3.0 * std::numbers::pi));
    line("compute heap mobile reduce sum v_ahead  # solid beyond the platform and above its edge [m3]");
    line(fmt::format("thermo {}", std::max<long>(200, way / 200)));
    line("thermo_style custom step atoms v_way c_ke c_spin c_heap cpu");
    line("thermo_modify flush yes lost ignore");

    // Shots on the way, then the platform's end.
    long now = 0;
    std::string later;  // " pre no" once the first run has been set up
    const auto run_to = [&](long step) {
        line(fmt::format("run {}{}", std::max(0L, step - now), later));
        later = " pre no";
        now = std::max(now, step);
    };
    const char* const kColumns = "id x yu z vx vy vz modify sort id format float %.17g";
    for (std::size_t k = 0; k < options.shots.size(); ++k) {
        run_to(std::min(way, lammps_step(scene, options.shots[k])));
        line(fmt::format("write_dump mobile custom {} {}", lammps_shot_file(k), kColumns));
    }
    run_to(way);
    // One heap length further: sqrt(2 A/tan 30 deg), A = section of the heap; no more than the second land.
    const double section = scene.width * std::max(stage.bed.facts.packing_fraction, 0.3);
    line(fmt::format("variable heap_length equal sqrt(2*c_heap/{:.17g}/{:.17g})", section,
                     std::tan(std::numbers::pi / 6)));
    const double most = 0.9 * scene.second_land, least = 0.1e-3;
    line(fmt::format(
        "variable further equal (v_heap_length<{0:.17g})*v_heap_length+(v_heap_length>={0:.17g})*{0:.17g}",
        most));
    line(fmt::format("variable stop equal {:.17g}+(v_further>{:.17g})*v_further+(v_further<={:.17g})*{:.17g}",
                     end, least, least, least));
    line(fmt::format("variable last equal ceil((v_stop-{:.17g})/{:.17g})", kBladeStart,
                     scene.blade_speed * dt));
    line("variable steps equal $(v_last-step)");
    line("run ${steps} pre no");
    line("variable way equal $(v_way:%.17g)  # the blade stands");
    line(fmt::format("print \"$(v_way:%.17g)\" file {} screen no", kLammpsWay));
    line("# At rest: mean kinetic energy per grain below 1e-3 m g d");
    line("variable again loop 40");
    line("label settle");
    line(fmt::format("if \"$(c_ke+c_spin:%.17g) <= {:.17g}\" then \"jump SELF rest\"",
                     quiet_energy(scene, stage.bed.x.size())));
    line("run 500 pre no");
    line("next again");
    line("jump SELF settle");
    line("label rest");
    line(fmt::format("write_dump mobile custom {} {}", kLammpsFinal, kColumns));
    return out;
}

std::string lammps_bed(const Scene& scene, const Stage& stage) {
    const Bed& bed = stage.bed;
    const double margin = 2 * largest_radius(stage);
    const double low_x = -margin, high_x = platform_end(scene) + scene.second_land;
    double low_z = -margin, high_z = margin;
    for (const GrainSpec& g : stage.fixed) low_z = std::min(low_z, g.z - margin);
    for (const double z : bed.z) high_z = std::max(high_z, z + margin);
    std::string out = "A levelled and raised bed of Gradwright's: id type diameter density x y z\n\n";
    out += fmt::format("{} atoms\n3 atom types\n\n", stage.fixed.size() + bed.x.size());
    out += fmt::format("{:.17g} {:.17g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n{:.17g} {:.17g} zlo zhi\n\n", low_x,
                       high_x, 0.0, scene.width, low_z, high_z);
    out += "Atoms # sphere\n\n";
    std::size_t id = 0;
    const auto row = [&](int type, double radius, double density, double x, double y, double z) {
        out += fmt::format("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", ++id, type, 2 * radius, density,
                           x, y, z);
    };
    for (const GrainSpec& g : stage.fixed) row(kFixedType, g.radius, scene.wall.density, g.x, g.y, g.z);
    for (std::size_t k = 0; k < bed.x.size(); ++k) {
        const int powder = stage.labelled ? bed.material[k] : 0;
        row(powder + 1, bed.radius[k], scene.powder[powder].material.density, bed.x[k], bed.y[k], bed.z[k]);
    }
    return out;
}

}  // namespace gradwright
