#include "optimise/lammps_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>

#include "dem/bed.h"
#include "dem/boundary.h"
#include "dem/contact_law.h"
#include "dem/random.h"
#include "optimise/lammps_law.h"

namespace gradwright {
namespace {

using Vector = std::array<double, 3>;

Vector operator+(const Vector& a, const Vector& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vector operator-(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector operator*(double s, const Vector& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vector& a) {
    return std::sqrt(dot(a, a));
}
Vector unit(const Vector& a) {
    return (1 / length(a)) * a;
}

struct Grain {
    int material = 0;  ///< 0 A, 1 B, 2 fixed
    double radius = 0;
    Vector x{}, v{}, w{};
};

enum class Kind { pair, stretched, wall };

/// One contact under the glass: grain i against grain j, or against a body.
struct Probe {
    Kind kind = Kind::pair;
    int i = 0, j = -1;
    Body body;
    /// Of the friction limit that the spring alone would reach in the steps of the run; of a stretched pair:
    /// of the tear-off overlap.
    double share = 1;
    ContactHistory<double> history{};
    bool slipped = false;
};

constexpr long kSteps = 200;
constexpr double kSkin = 5e-6;

/// What our law says of one contact.
struct Answer {
    double normal = 0;  ///< force on i along n [N]
    Vector tangential{}, torque{}, n{};
    double limit = 0;     ///< mu F_cap [N]
    double pull_off = 0;  ///< F_po [N]
};

class Laboratory {
  public:
    Laboratory(const Scene& scene, const LammpsLaw& law) : scene_(scene), law_(law) {
        const double e = scene.interaction.coefficient_of_restitution;
        constants_.static_friction = scene.interaction.static_friction;
        constants_.damping_factor =
            2 * std::sqrt(5.0 / 6.0) * -std::log(e) / std::hypot(std::log(e), std::numbers::pi);
        time_step_ = scene_time_step(scene);
    }

    /// Contact as it stands: geometry, motion, stiffness.
    Contact<double> contact(const Probe& probe, const std::vector<Grain>& grains, Vector& n) const {
        const Grain& a = grains[probe.i];
        Contact<double> c{};
        const double mass_a = mass(a);
        Vector v = a.v, wj{};
        PairConstants k{};
        if (probe.kind == Kind::wall) {
            const NearestPoint near = nearest_point(probe.body, 0, 0, a.x[0], a.x[1], a.x[2]);
            n = {near.nx, near.ny, near.nz};
            c.overlap = a.radius - near.distance;
            c.radius = a.radius;
            c.mass = mass_a;
            k = law_.constants(a.material, kWallMaterial);
            c.arm_i = c.arm_j = c.reach_i = c.reach_j = a.radius;
        } else {
            const Grain& b = grains[probe.j];
            const Vector d = a.x - b.x;
            const double distance = length(d), sum = a.radius + b.radius;
            n = (1 / distance) * d;
            c.overlap = (sum * sum - dot(d, d)) / (sum + distance);
            c.radius = a.radius * b.radius / sum;
            c.mass = b.material == kWallMaterial ? mass_a : mass_a * mass(b) / (mass_a + mass(b));
            v = a.v - b.v;
            wj = b.w;
            k = law_.constants(a.material, b.material);
            c.reach_i = a.radius;
            c.reach_j = b.radius;
            c.arm_i = a.radius - 0.5 * c.overlap;
            c.arm_j = b.radius - 0.5 * c.overlap;
        }
        c.nx = n[0], c.ny = n[1], c.nz = n[2];
        c.vx = v[0], c.vy = v[1], c.vz = v[2];
        c.wix = a.w[0], c.wiy = a.w[1], c.wiz = a.w[2];
        c.wjx = wj[0], c.wjy = wj[1], c.wjz = wj[2];
        c.e_star = k.e_star;
        c.g_star8 = k.g_star8;
        c.touching = 1;
        if (adhesive(probe))
            c.jkr_radius =
                std::cbrt(2 * std::numbers::pi * law_.work_of_adhesion() * c.radius * c.radius / k.e_star);
        return c;
    }

    /// `steps` evaluations, the last of which is returned; 0: one with an empty spring that does not grow.
    Answer answer(Probe& probe, const std::vector<Grain>& grains, long steps) const {
        LawConstants law = constants_;
        law.time_step = steps > 0 ? time_step_ : 0;
        // fix wall/gran: |F_n| is the cap
        if (!adhesive(probe)) law.friction_cap = FrictionCap::normal;
        Answer out;
        const Contact<double> c = contact(probe, grains, out.n);
        out.pull_off = 1.5 * std::numbers::pi * c.radius * (adhesive(probe) ? law_.work_of_adhesion() : 0);
        ContactResponse<double> r{};
        for (long step = 0; step < std::max(1L, steps); ++step) {
            r = adhesive(probe) ? contact_law<double, true, RollingModel::none, SlidingConvention::lammps>(
                                      law, {}, c, probe.history)
                                : contact_law<double, false, RollingModel::none, SlidingConvention::lammps>(
                                      law, {}, c, probe.history);
            const Vector force = {r.fx, r.fy, r.fz};
            out.normal = dot(force, out.n);
            out.tangential = force - out.normal * out.n;
            out.torque = {r.tix, r.tiy, r.tiz};
            out.limit = law.static_friction * cap(probe, c, out);
            if (length(out.tangential) > out.limit * (1 - 1e-12)) probe.slipped = steps > 0 || probe.slipped;
        }
        return out;
    }

    /// Sliding speed at which a spring reaches `share` of the friction limit in the steps of the run.
    double sliding_speed(const Probe& probe, const std::vector<Grain>& grains) const {
        Vector n{};
        Contact<double> c = contact(probe, grains, n);
        double a = std::sqrt(c.radius * std::max(c.overlap, 0.0));
        if (adhesive(probe)) {
            const double s = jkr_root<double>(c.overlap * c.radius / (c.jkr_radius * c.jkr_radius));
            a = c.jkr_radius * s * s;
        }
        Probe still = probe;
        std::vector<Grain> quiet = grains;
        for (Grain& g : quiet) g.v = g.w = {};
        const Answer rest = answer(still, quiet, 0);
        return rest.limit > 0
                   ? probe.share * rest.limit / (c.g_star8 * a * static_cast<double>(kSteps) * time_step_)
                   : 1e-4;
    }

    bool adhesive(const Probe& probe) const { return probe.kind != Kind::wall && law_.adhesive(); }
    double time_step() const { return time_step_; }
    double mass(const Grain& g) const {
        const double density =
            g.material == kWallMaterial ? scene_.wall.density : scene_.powder[g.material].material.density;
        return density * sphere_volume(g.radius);
    }

  private:
    double cap(const Probe& probe, const Contact<double>& c, const Answer& now) const {
        if (!adhesive(probe)) return std::fabs(now.normal);
        Contact<double> still = c;
        still.vx = still.vy = still.vz = 0;
        ContactHistory<double> none{};
        LawConstants law = constants_;
        const auto r = contact_law<double, true, RollingModel::none>(law, {}, still, none);
        return std::max(0.0, r.fx * c.nx + r.fy * c.ny + r.fz * c.nz + 2 * now.pull_off);
    }

    const Scene& scene_;
    const LammpsLaw& law_;
    LawConstants constants_;
    double time_step_ = 0;
};

struct Bench {
    std::vector<Grain> grains;
    std::vector<Probe> probes;
    double pull_speed = 0;  ///< of the second grains of stretched pairs, along x [m/s]
    Body plane, step;       ///< walls z = 0 and the block x < 0, z < 0
    std::vector<int> plane_grains, step_grains, pulled;
};

Vector any_direction(Random& random) {
    return unit({random.normal(), random.normal(), random.normal()});
}

/// Gives grain i of a probe its motion: normal speed, sliding of the wanted speed, part of it by spin, and a
/// twist that must not matter.
void set_in_motion(const Probe& probe, Bench& bench, const Laboratory& laboratory, Random& random) {
    Vector n{};
    laboratory.contact(probe, bench.grains, n);
    const double speed = laboratory.sliding_speed(probe, bench.grains);
    Grain& a = bench.grains[probe.i];
    const Vector along = unit(cross(n, any_direction(random)));
    a.w = (speed / (2 * a.radius)) * any_direction(random);
    Vector surface = a.radius * a.w, common{};
    if (probe.j >= 0) {
        Grain& b = bench.grains[probe.j];
        if (b.material != kWallMaterial) {
            b.w = (speed / (2 * b.radius)) * any_direction(random);
            common = 0.01 * any_direction(random);
            b.v = common;
        }
        surface = surface + b.radius * b.w;
    }
    const double normal_speed = 0.03 * (2 * random.uniform() - 1);
    a.v = common + normal_speed * n + speed * along + cross(surface, n);
}

Bench make_bench(const Scene& scene, const Laboratory& laboratory, const LammpsLaw& law) {
    Bench bench;
    Random random(scene.seed ^ 0x7a05);
    const double small = 0.5 * scene.powder[0].size.cut_low, large = 0.5 * scene.powder[0].size.cut_high,
                 middle = 0.5 * scene.powder[0].size.d50;
    const double pitch = 6 * large;
    const std::array<double, 5> shares = {0.3, 0.8, 3, 30, 100};
    int cell = 0;
    const auto place = [&]() {
        const Vector at = {pitch * (cell % 5), pitch * (cell / 5 % 5), pitch * (1 + cell / 25)};
        ++cell;
        return at;
    };
    const auto add = [&](int material, double radius, const Vector& x) {
        bench.grains.push_back({material, radius, x, {}, {}});
        return static_cast<int>(bench.grains.size()) - 1;
    };
    const std::array<std::array<double, 2>, 3> radii = {{{small, small}, {middle, large}, {large, small}}};
    const std::array<std::array<int, 2>, 5> materials = {{{0, 0}, {0, 1}, {1, 1}, {0, 2}, {1, 2}}};
    for (const auto& m : materials)
        for (const auto& r : radii)
            for (const double depth : {5e-4, 3e-3, 1e-2, 3e-2}) {
                Probe probe;
                const Vector at = place(), n = any_direction(random);
                const double distance = r[0] + r[1] - depth * std::min(r[0], r[1]);
                probe.i = add(m[0], r[0], at + (0.5 * distance) * n);
                probe.j = add(m[1], r[1], at - (0.5 * distance) * n);
                probe.share = shares[bench.probes.size() % shares.size()];
                bench.probes.push_back(probe);
            }
    if (law.adhesive()) {
        const auto tear_off = [&](int a, int b, double r1, double r2) {
            const double r = r1 * r2 / (r1 + r2), e_star = law.constants(a, b).e_star;
            const double jkr = std::cbrt(2 * std::numbers::pi * law.work_of_adhesion() * r * r / e_star);
            return kJkrTearOffOverlap * jkr * jkr / r;
        };
        double way = 0;
        for (int a = 0; a < 2; ++a) way = std::max(way, -4 * tear_off(a, a, large, large));
        bench.pull_speed = way / (static_cast<double>(kSteps) * laboratory.time_step());
        for (const auto& m : {std::array{0, 0}, std::array{0, 1}, std::array{1, 1}})
            for (const auto& r : radii)
                for (const double part : {0.1, 0.25, 0.45, 0.7}) {
                    Probe probe;
                    probe.kind = Kind::stretched;
                    const Vector at = place();
                    const double overlap = part * tear_off(m[0], m[1], r[0], r[1]) + way;
                    probe.i = add(m[0], r[0], at);
                    probe.j = add(m[1], r[1], at + Vector{r[0] + r[1] - overlap, 0, 0});
                    probe.share = part;
                    bench.pulled.push_back(probe.j);
                    bench.probes.push_back(probe);
                }
    }
    bench.plane.axis = 2;
    bench.step.kind = Body::Kind::box;
    bench.step.x0 = bench.step.z0 = -1;
    int row = 0;
    for (int m = 0; m < 2; ++m)
        for (const double r : {small, middle, large})
            for (const double depth : {1e-3, 5e-3, 2e-2}) {
                const double distance = r * (1 - depth);
                Probe flat;
                flat.kind = Kind::wall;
                flat.body = bench.plane;
                flat.i = add(m, r, {0, -pitch * (2 + row), distance});
                flat.share = shares[row % shares.size()];
                bench.plane_grains.push_back(flat.i);
                bench.probes.push_back(flat);
                // above the block, before its face, and leaning over its edge at angles between
                const double angle = std::numbers::pi / 2 * (row % 9) / 8.0;
                Probe edge = flat;
                edge.body = bench.step;
                edge.share = shares[(row + 2) % shares.size()];
                edge.i = add(
                    m, r,
                    {distance * std::cos(angle), -pitch * (2 + row), distance * std::sin(angle) - 4 * pitch});
                edge.body.z1 = -4 * pitch;
                bench.step_grains.push_back(edge.i);
                bench.probes.push_back(edge);
                ++row;
            }
    bench.step.z1 = -4 * pitch;
    for (const Probe& probe : bench.probes)
        if (probe.kind != Kind::stretched) set_in_motion(probe, bench, laboratory, random);
    return bench;
}

std::string id_list(const std::vector<int>& grains) {
    std::string out;
    for (const int g : grains) out += fmt::format(" {}", g + 1);
    return out;
}

std::string data_text(const Scene& scene, const Bench& bench) {
    Vector low = bench.grains[0].x, high = low;
    for (const Grain& g : bench.grains)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], g.x[k] - 4 * g.radius);
            high[k] = std::max(high[k], g.x[k] + 4 * g.radius);
        }
    std::string out = "Contacts held still, two by two or at a wall\n\n";
    out += fmt::format("{} atoms\n3 atom types\n\n", bench.grains.size());
    for (int k = 0; k < 3; ++k)
        out += fmt::format("{0:.17g} {1:.17g} {2}lo {2}hi\n", low[k], high[k], "xyz"[k]);
    out += "\nAtoms # sphere\n\n";
    for (std::size_t g = 0; g < bench.grains.size(); ++g) {
        const Grain& grain = bench.grains[g];
        const double density = grain.material == kWallMaterial
                                   ? scene.wall.density
                                   : scene.powder[grain.material].material.density;
        out += fmt::format("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", g + 1, grain.material + 1,
                           2 * grain.radius, density, grain.x[0], grain.x[1], grain.x[2]);
    }
    out += "\nVelocities # sphere\n\n";
    for (std::size_t g = 0; g < bench.grains.size(); ++g) {
        const Grain& grain = bench.grains[g];
        out += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", g + 1, grain.v[0],
                           grain.v[1], grain.v[2], grain.w[0], grain.w[1], grain.w[2]);
    }
    return out;
}

std::string deck_text(const Bench& bench, const LammpsLaw& law, double time_step) {
    std::string out =
        "# Gradwright: forces of single contacts. No grain is integrated, so each contact keeps its geometry "
        "and\n"
        "# its velocities; only the second grains of stretched pairs are moved.\n"
        "units si\natom_style sphere\nboundary f f f\nnewton off\ncomm_modify vel yes\nread_data pairs.data\n"
        "pair_style granular\n";
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) out += fmt::format("pair_coeff {} {} {}\n", i + 1, j + 1, law.pair(i, j));
    out += fmt::format("neighbor {:.17g} bin\nneigh_modify every 1 delay 0 check yes\ntimestep {:.17g}\n",
                       kSkin, time_step);
    out += "group fixed type 3\nfix still fixed freeze\n";
    for (int m = 0; m < 2; ++m)
        for (const bool plane : {true, false}) {
            std::vector<int> of_material;
            for (const int g : plane ? bench.plane_grains : bench.step_grains)
                if (bench.grains[g].material == m) of_material.push_back(g);
            const std::string name = fmt::format("{}{}", plane ? "plane" : "step", m + 1);
            out += fmt::format("group {} id{}\n", name, id_list(of_material));
            if (!plane && m == 0)
                out +=
                    fmt::format("region step block {:.17g} {:.17g} -1 1 {:.17g} {:.17g} side out units box\n",
                                bench.step.x0, bench.step.x1, bench.step.z0, bench.step.z1);
            out += fmt::format("fix w_{0} {0} wall/gran{1} granular {2} {3}\n", name, plane ? "" : "/region",
                               law.wall(m), plane ? "zplane 0 NULL" : "region step");
        }
    if (!bench.pulled.empty())
        out += fmt::format("group pulled id{}\nfix pull pulled move linear {:.17g} 0 0 units box\n",
                           id_list(bench.pulled), bench.pull_speed);
    out += "thermo_style custom step atoms\n";
    const std::string columns =
        " id x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz modify sort id format float %.17g\n";
    out += "run 0\nwrite_dump all custom held.dump" + columns;
    out += fmt::format("run {} pre no\nwrite_dump all custom moved.dump", kSteps) + columns;
    if (!bench.pulled.empty()) out += "unfix pull\n";
    out +=
        "velocity all set 0 0 0 units box\nset group all omega 0 0 0\nrun 0\nwrite_dump all custom "
        "still.dump" +
        columns;
    return out;
}

/// What LAMMPS says of grain i of a probe.
struct Told {
    double normal = 0;
    Vector tangential{}, torque{};
};

Told told(const LammpsDump& dump, const Probe& probe, const Vector& n) {
    const std::size_t i = static_cast<std::size_t>(probe.i);
    const auto vector = [&](const char* x, const char* y, const char* z) {
        return Vector{dump.column(x)[i], dump.column(y)[i], dump.column(z)[i]};
    };
    const Vector force = vector("fx", "fy", "fz");
    Told out;
    out.normal = dot(force, n);
    out.tangential = force - out.normal * n;
    out.torque = vector("tqx", "tqy", "tqz");
    return out;
}

/// Positions, velocities and spins as the dump has them: what the forces beside them belong to.
std::vector<Grain> grains_of(const LammpsDump& dump, const std::vector<Grain>& grains) {
    std::vector<Grain> out = grains;
    const char* const names[3][3] = {{"x", "y", "z"}, {"vx", "vy", "vz"}, {"omegax", "omegay", "omegaz"}};
    for (std::size_t g = 0; g < out.size(); ++g)
        for (int k = 0; k < 3; ++k) {
            out[g].x[k] = dump.column(names[0][k])[g];
            out[g].v[k] = dump.column(names[1][k])[g];
            out[g].w[k] = dump.column(names[2][k])[g];
        }
    return out;
}

/// The larger error; one that is not a number is the largest of all.
double worse(double a, double b) {
    return std::isnan(a) || std::isnan(b) ? std::numeric_limits<double>::quiet_NaN() : std::max(a, b);
}

class Account {
  public:
    void add(const std::string& name, double difference, double scale, const std::string& of, bool decisive) {
        auto found =
            std::find_if(cases_.begin(), cases_.end(), [&](const auto& c) { return c.name == name; });
        if (found == cases_.end()) found = cases_.insert(cases_.end(), {name, 0, 0, of, decisive});
        ++found->contacts;
        // without friction or damping there is nothing to be relative to, and nothing may be there
        found->error = worse(found->error, scale != 0        ? std::fabs(difference) / scale
                                           : difference == 0 ? 0
                                                             : std::numeric_limits<double>::infinity());
    }
    std::vector<TwoBodyCase> take() { return std::move(cases_); }

  private:
    std::vector<TwoBodyCase> cases_;
};

}  // namespace

TwoBodyResult compare_two_body(const Scene& scene, const std::string& folder, const Scene* ours_scene,
                               const std::atomic<bool>* stop) {
    const LammpsProgram program = find_lammps(1);
    const LammpsLaw law(scene, false);
    const Laboratory laboratory(scene, law);
    Bench bench = make_bench(scene, laboratory, law);
    std::filesystem::create_directories(folder);
    const std::filesystem::path place(folder);
    write_deck_file(place / "pairs.data", data_text(scene, bench));
    write_deck_file(place / "in.pairs", deck_text(bench, law, laboratory.time_step()));
    LammpsRunOptions run;
    run.folder = folder;
    run.input = "in.pairs";
    run.stop = stop;
    const LammpsRun ran = run_lammps(program, run);
    if (ran.interrupted) {
        TwoBodyResult nothing;
        nothing.interrupted = true;
        return nothing;
    }
    const LammpsDump held = read_lammps_dump(place / "held.dump"),
                     moved = read_lammps_dump(place / "moved.dump"),
                     still = read_lammps_dump(place / "still.dump");
    const std::vector<Grain> at_held = grains_of(held, bench.grains),
                             at_moved = grains_of(moved, bench.grains),
                             at_still = grains_of(still, bench.grains);

    const LammpsLaw own_law(ours_scene ? *ours_scene : scene, false);
    const Laboratory own(ours_scene ? *ours_scene : scene, own_law);
    TwoBodyResult out;
    out.version = ran.version;
    out.seconds = ran.seconds;
    Account account;
    for (Probe& probe : bench.probes) {
        if (probe.kind == Kind::stretched) {
            const Answer ours = own.answer(probe, at_moved, 0);
            const Told theirs = told(moved, probe, ours.n);
            if (probe.share > kLammpsTearOff) {
                ++out.bonds_beyond;
                if (theirs.normal != 0) ++out.bonds_held_beyond;
                continue;
            }
            account.add("pair, stretched beyond touch (delta < 0), normal force", theirs.normal - ours.normal,
                        ours.pull_off, "pull-off force", true);
            ++out.bonds_stretched;
            if (told(still, probe, ours.n).normal != 0) ++out.bonds_kept;
            continue;
        }
        const bool wall = probe.kind == Kind::wall;
        const std::string who = wall ? "wall, " : "pair, ";
        Probe empty = probe;
        const Answer a = own.answer(empty, at_held, 0);
        const Answer b = own.answer(probe, at_moved, kSteps);
        const bool slipped = probe.slipped;
        const Answer c = own.answer(probe, at_still, 0);
        const Told ta = told(held, probe, a.n), tb = told(moved, probe, b.n), tc = told(still, probe, c.n);
        const double floor = std::max(std::fabs(c.normal), c.pull_off);
        account.add(who + "elastic normal force", tc.normal - c.normal, floor,
                    law.adhesive() && !wall ? "the larger of force and pull-off force" : "force", !wall);
        // Without damping or friction rounding is all there is; a millionth of the normal force is nothing
        // too.
        const double least = 1e-3 * floor;
        account.add(who + "damping normal force", (ta.normal - tc.normal) - (a.normal - c.normal),
                    std::max(std::fabs(a.normal - c.normal), least), "damping force", !wall);
        // a spring at nothing whose dashpot alone passes the limit: LAMMPS sets the force to zero
        if (length(a.tangential) < a.limit * (1 - 1e-9))
            account.add(who + "damping tangential force", length(ta.tangential - a.tangential),
                        std::max(length(a.tangential), least), "damping force", !wall);
        if (slipped) {
            account.add(who + "sliding force", length(tb.tangential - b.tangential),
                        std::max(length(b.tangential), least), "force", false);
            account.add(who + "spring left by sliding", length(tc.tangential - c.tangential),
                        std::max(length(c.tangential), least), "force", false);
        } else {
            account.add(who + "tangential force, spring and dashpot", length(tb.tangential - b.tangential),
                        std::max(length(b.tangential), least), "force", !wall);
            account.add(who + "elastic tangential force", length(tc.tangential - c.tangential),
                        std::max(length(c.tangential), least), "force", !wall);
        }
        account.add(who + "torque", length(tb.torque - b.torque),
                    std::max(length(b.torque), least * bench.grains[probe.i].radius), "torque", false);
    }
    out.cases = account.take();
    for (const TwoBodyCase& one : out.cases)
        if (one.decisive) out.max_relative_error = worse(out.max_relative_error, one.error);
    return out;
}

}  // namespace gradwright
