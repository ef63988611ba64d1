#include "dem/verification/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "dem/verification/cooling.h"
#include "dem/verification/curves.h"
#include "dem/verification/line_chart.h"

namespace gradwright {
namespace {

using namespace verification;
using Look = ChartSeries::Look;

const char* law_name(Precision precision) {
    return precision == Precision::double_law ? "double" : "single";
}

/// Error over tolerance; cases that must be exact count 0 or infinity.
double strain(const VerificationCase& c) {
    if (c.tolerance > 0) return c.error / c.tolerance;
    return c.pass ? 0 : 1e300;
}

/// In a table of Markdown a bar ends the cell.
std::string table_cell(const std::string& text) {
    std::string out = " ";
    for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
    return out + " |";
}

std::string rung_table(const std::vector<VerificationRun>& runs) {
    std::string out = "| rung | claim |";
    for (const auto& run : runs) out += fmt::format(" {} law: passed |", law_name(run.precision));
    out += " nearest to its tolerance |\n|---|---|";
    for (std::size_t k = 0; k < runs.size(); ++k) out += "---|";
    out += "---|\n";
    for (const VerificationRung& rung : verification_ladder()) {
        out += fmt::format("| {} | {} |", rung.id, rung.claim);
        const VerificationCase* worst = nullptr;
        const char* law = "";
        for (const auto& run : runs) {
            std::size_t passed = 0, all = 0;
            for (const auto& c : run.cases) {
                if (c.id != rung.id) continue;
                ++all;
                passed += c.pass;
                if (!worst || strain(c) > strain(*worst)) worst = &c, law = law_name(run.precision);
            }
            out += fmt::format(" {} of {} |", passed, all);
        }
        if (worst)
            out += table_cell(fmt::format("{}: {} (error {:.2g}, tolerance {:.2g}, {})", worst->name,
                                          worst->quantity, worst->error, worst->tolerance, law));
        out += "\n";
    }
    return out;
}

std::string mutation_table(const std::function<void(const std::string&, double)>& progress) {
    std::string out = "| `--mutate` | what is broken | cases that turn red, of those run |\n|---|---|---|\n";
    double done = 0;
    for (const Mutation& m : mutations()) {
        VerificationOptions options;
        options.fault = m.fault;
        std::string cells;
        for (const VerificationRung& rung : verification_ladder()) {
            if (std::find(m.red.begin(), m.red.end(), rung.id) == m.red.end()) continue;
            const auto cases = rung.run(options);
            const auto red = std::count_if(cases.begin(), cases.end(), [](const auto& c) { return !c.pass; });
            cells += fmt::format("{}{}: {} of {}", cells.empty() ? "" : "; ", rung.id, red, cases.size());
        }
        out += fmt::format("| `{}` | {} | {} |\n", m.name, m.fault_text, cells);
        progress("mutations", ++done / static_cast<double>(mutations().size()));
    }
    return out;
}

ChartSeries series(const std::string& name, Look look, int colour) {
    ChartSeries s;
    s.name = name;
    s.look = look;
    s.colour = colour;
    return s;
}

std::string oblique_svg(const VerificationOptions& options) {
    Chart charts[3];
    const char* titles[] = {"Tangential restitution", "Spin after the impact",
                            "Rebound of the contact point"};
    const char* units[] = {"e_t = v_t'/v_t [-]", "spin [rad/s]", "rebound angle [deg]"};
    for (int k = 0; k < 3; ++k) {
        charts[k].title = titles[k];
        charts[k].x_label = "angle of impact from the normal [deg]";
        charts[k].y_label = units[k];
        charts[k].series = {series("engine", Look::line, 1),
                            series("closed form, gross sliding", Look::dashed, 2),
                            series("digitised, Chung & Ooi 2011", Look::points, 0)};
    }
    auto add = [&](int which, const ObliquePoint& p) {
        const double y[] = {p.tangential_restitution, p.spin, p.rebound_deg};
        for (int k = 0; k < 3; ++k) {
            charts[k].series[which].x.push_back(p.angle_deg);
            charts[k].series[which].y.push_back(y[k]);
        }
    };
    for (double angle = 2; angle <= 88; angle += 2) add(0, oblique_impact(options, angle));
    for (const auto& p : sliding_oblique_impacts()) add(1, p);
    for (const auto& p : digitised_oblique_impacts()) add(2, p);
    return charts_svg({charts[0], charts[1], charts[2]});
}

std::string jkr_svg(const VerificationOptions& options) {
    const JkrLoop loop = jkr_loop(options);
    Chart c;
    c.title = "Push and pull of two adhesive grains";
    c.x_label = "overlap / tear-off overlap";
    c.y_label = "force / pull-off force (repulsion > 0)";
    c.series = {series("JKR 1971, with its unstable branch", Look::dashed, 0),
                series("engine, pushed together", Look::points, 1),
                series("engine, pulled apart", Look::points, 2)};
    c.series[0].x = loop.curve_overlap, c.series[0].y = loop.curve_force;
    c.series[1].x = loop.in_overlap, c.series[1].y = loop.in_force;
    c.series[2].x = loop.out_overlap, c.series[2].y = loop.out_force;
    // the pull-off stands at s^3 = 3/4 of the reduced curve: overlap -3^(-2/3) of the tear-off's
    c.notes = {{"pull-off", -std::pow(3.0, -2.0 / 3), -1, false, 26},
               {"tear-off", -1, -5.0 / 9, false, 0},
               {"made", 0, -8.0 / 9, false, -12}};
    return charts_svg({c});
}

struct ProductionRange {
    double least = 1e300, most = 0;
};

std::string restitution_svg(const VerificationOptions& options, ProductionRange& at_tenth) {
    Chart sticky;
    sticky.title = "Adhesive grains: rebound over impact speed";
    sticky.x_label = "impact speed [m/s]";
    sticky.y_label = "v'/v [-]";
    sticky.log_x = true;
    const double stick = elastic_sticking_speed();
    sticky.series = {series("e = 1: sqrt(1 - (v_stick/v)^2)", Look::dashed, 0),
                     series("e = 1, engine", Look::points, 1), series("e = 0.5, engine", Look::points, 2),
                     series("e = 0.5 without adhesion", Look::dashed, 2)};
    for (double v = 1.0005 * stick; v < 0.2; v *= v < 1.05 * stick ? 1.002 : 1.03) {
        sticky.series[0].x.push_back(v);
        sticky.series[0].y.push_back(std::sqrt(1 - stick * stick / (v * v)));
    }
    for (double v = 0.5 * stick; v < 0.2; v *= 1.25) {
        int k = 1;
        for (const double e : {1.0, 0.5}) {
            sticky.series[k].x.push_back(v);
            sticky.series[k].y.push_back(adhesive_rebound(options, e, v, 1e-8) / v);
            ++k;
        }
    }
    sticky.series[3].x = {0.5 * stick, 0.2};
    sticky.series[3].y = {0.5, 0.5};

    Chart production;
    production.title = "At the production time step, 0.2 T_Rayleigh";
    production.x_label = "impact speed [m/s]";
    production.y_label = "v'/v - e [-]";
    production.log_x = true;
    int colour = 1;
    for (const double e : {0.9, 0.5, 0.1}) {
        ChartSeries got = series(fmt::format("e = {:g}, ten phases", e), Look::points, colour++);
        for (double v = 0.001; v < 1.01; v *= std::pow(10.0, 0.25))
            for (int phase = 0; phase < 10; ++phase) {
                got.x.push_back(v);
                got.y.push_back(production_rebound(options, e, v, 0.1 * phase + 0.03) / v - e);
            }
        production.series.push_back(got);
    }
    for (int phase = 0; phase < 50; ++phase) {
        const double e = production_rebound(options, 0.5, 0.1, 0.02 * phase + 0.01) / 0.1;
        at_tenth.least = std::min(at_tenth.least, e);
        at_tenth.most = std::max(at_tenth.most, e);
    }
    return charts_svg({sticky, production});
}

std::string cooling_svg(const VerificationOptions& options) {
    Chart c;
    c.title = "2744 smooth grains cool, 10 % solid";
    c.x_label = "time / tau";
    c.y_label = "temperature / first temperature";
    c.log_y = true;
    c.series = {series("1/(1 + t/tau)^2", Look::dashed, 0)};
    for (double t = 0; t <= 2.001; t += 0.05) {
        c.series[0].x.push_back(t);
        c.series[0].y.push_back(1 / ((1 + t) * (1 + t)));
    }
    int colour = 1;
    for (const double e : {0.9, 0.8}) {
        ChartSeries s = series(fmt::format("engine, e = {:g}", e), Look::points, colour++);
        for (const auto& p : cool(options, {.restitution = e, .end = 2, .points = 20})) {
            s.x.push_back(p.time);
            s.y.push_back(p.temperature);
        }
        c.series.push_back(s);
    }
    return charts_svg({c});
}

std::string order_svg(const VerificationOptions& options) {
    const StepErrors errors = step_errors(options);
    Chart c;
    c.title = "Error of the overlap at 0.7 contact times";
    c.x_label = "steps in one contact time";
    c.y_label = "error / largest overlap";
    c.log_x = c.log_y = true;
    c.series = {series("e = 1, from first touch", Look::points, 1),
                series("e = 0.5, started inside the contact", Look::points, 3),
                series("e = 0.5, from first touch", Look::points, 2), series("order 2", Look::dashed, 0),
                series("order 1.25: damping starts as overlap^(1/4)", Look::dashed, 5)};
    c.series[0].y = errors.elastic;
    c.series[1].y = errors.damped_inside;
    c.series[2].y = errors.damped_from_touch;
    for (int k = 0; k < 5; ++k) c.series[k].x = errors.steps;
    for (const double n : errors.steps) {
        c.series[3].y.push_back(errors.elastic[2] * std::pow(n / errors.steps[2], -2));
        c.series[4].y.push_back(errors.damped_from_touch[2] * std::pow(n / errors.steps[2], -1.25));
    }
    return charts_svg({c});
}

std::string energy_svg(const VerificationOptions& options) {
    Chart c;
    c.title = "96 adhesive grains pushed over a plane";
    c.x_label = "way of the blade [mm]";
    c.y_label = "energy [nJ]";
    c.series = {series("work of the blade", Look::line, 0),
                series("all losses + what is held more", Look::dashed, 2),
                series("sliding", Look::line, 1),
                series("damping, normal and tangential", Look::line, 3),
                series("rolling", Look::line, 4),
                series("adhesive bonds made and torn", Look::line, 6),
                series("held: motion, height, contacts", Look::line, 5)};
    for (const auto& [way, e] : pushed_pile_account(options)) {
        const double held = e.held() - e.start;
        const double y[] = {e.work_of_bodies,
                            e.dissipated() + held,
                            e.sliding,
                            e.normal_damping + e.tangential_damping,
                            e.rolling,
                            e.bonds,
                            held};
        for (int k = 0; k < 7; ++k) {
            c.series[k].x.push_back(1e3 * way);
            c.series[k].y.push_back(1e9 * y[k]);
        }
    }
    return charts_svg({c});
}

}  // namespace

VerificationPage verification_page(const std::vector<VerificationRun>& runs,
                                   const std::function<void(const std::string&, double)>& progress) {
    VerificationPage page;
    VerificationOptions single;  // the plots show the law as it is used
    single.precision = Precision::single_law;
    double done = 0;
    auto image = [&](const std::string& name, const std::string& svg) {
        page.images.emplace_back("verification_" + name + ".svg", svg);
        progress("plots", ++done / 6);
    };
    ProductionRange range;
    image("oblique", oblique_svg(single));
    image("jkr", jkr_svg(single));
    image("restitution", restitution_svg(single, range));
    image("cooling", cooling_svg(single));
    image("order", order_svg(single));
    image("energy", energy_svg(single));

    std::size_t cases = 0, passed = 0;
    for (const auto& run : runs)
        for (const auto& c : run.cases) ++cases, passed += c.pass;
    page.markdown = fmt::format(
        R"(# Are the grains right?

Every number and every plot on this page is written by

```
./gradwright verify --docs docs
```

which runs the verification ladder through the same stepping code as a spread, compares with formulas and published values, and
ends with exit code 0 only when every case is within its tolerance. `gradwright verify` alone prints all cases with expected and
obtained value, error, tolerance and source; `--only V5` runs one rung, `--json` is for scripts. The same cases are tests
(`tests/dem/verification_test.cpp`), and their code is `dem/verification/`, one file a subject.

{} of {} cases pass, with the contact law in double and in single precision (the latter is what a spread uses: eight contacts at
a time in float, positions and motion in double).

{}
V14, the same beds in an outside engine, is a command of its own: `gradwright crosscheck lammps STUDY`.

## Would it notice?

`gradwright verify --mutate NAME` breaks the law on purpose. A ladder that stays green then proves nothing; this one turns red
(and the command ends with a code other than 0):

{}
## Oblique impact

A sphere of aluminium oxide meets a plane at 3.9 m/s (Chung & Ooi 2011, test 4; no tangential damping, as there). Sticking,
micro-slip and gross sliding leave their marks on spin and rebound.

![Tangential restitution, spin and rebound angle against the angle of impact](images/verification_oblique.svg)

## Adhesion: made at touch, torn off late

Two grains of 40 um with softened modulus and adhesion, pushed together and pulled apart so slowly that only the law speaks.
The contact is made at overlap 0 with 8/9 of the pull-off force and lives on to the tear-off overlap; the area between the
ways is the work of one make-and-break.

![Force against overlap of a JKR contact](images/verification_jkr.svg)

## Restitution against speed

Left: adhesive grains stay together below the sticking speed and lose less and less above it. Right: what the time step of a
spread does to the coefficient of restitution: at 0.1 m/s, e = 0.5 comes back as {:.3f} to {:.3f}, depending on where in a step
the grains touch.

![Rebound speed over impact speed](images/verification_restitution.svg)

## A cooling gas

Smooth inelastic grains, periodic on all sides, without gravity: Haff's law with Enskog's collision frequency, no fitted number.
At e = 0.8 the gas leaves the law when vortices form; rung V12 judges it before that.

![Granular temperature against time](images/verification_cooling.svg)

## Order of the time step

Velocity Verlet with velocities predicted for the damping is of second order. From first touch a damped contact is not: its
dashpot sets in as the fourth root of the overlap.

![Error against the number of steps](images/verification_order.svg)

## Where the blade's work goes

Energy is booked contact by contact, beside the run and in double: what damping, sliding, rolling and torn bonds take, and what
motion, height, contacts and springs hold. Rung V16 closes this account to 1 % for piles with each rolling model and for a
whole spread.

![Energies against the way of the blade](images/verification_energy.svg)
)",
        passed, cases, rung_table(runs), mutation_table(progress), range.least, range.most);
    return page;
}

}  // namespace gradwright
