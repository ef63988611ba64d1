#!/usr/bin/env python3
"""Writes the tables of docs/search.md from runs of the program. Usage, from the project's root:

    python3 docs/make_search.py [linear] [sigmoid] [three]            # tables; measures what is missing
    python3 docs/make_search.py --kept                                # tables of what was measured
    python3 docs/make_search.py --only STRATEGY linear|sigmoid|three  # measures one strategy, writes no table

What `compare` answered is kept in docs/data/search-NAME-STRATEGY.json, so that a second call only rewrites the page; delete a file to
measure it again (about ten minutes each on one core). A strategy's numbers do not depend on those beside it: start, bed and judges
come from the study's seed. GRADWRIGHT in the environment names another program than ./gradwright. Needs
nothing but Python's standard library.
"""
import os
import sys

from measured import DOCS, ROOT, answer, fill, sets, shown

PAGE = os.path.join(DOCS, "search.md")

# A coupon of half the length and half the width of 01: some ten seconds a spread, so that plain methods can have the spreads they
# need. The sides are a period, as there; bins of 0.1 mm.
SMALL = ["machine.dispenser={length=\"1.6 mm\", width=\"0.8 mm\", depth=\"1 mm\"}", "machine.platform.length=\"1.6 mm\"",
         "machine.platform.width=\"0.8 mm\"", "machine.land=\"2.4 mm\"", "target.footprint.x=[\"0.8 mm\", \"1.6 mm\"]",
         "target.bin_width=\"0.1 mm\"", "design_space.partition={family=\"polyline\", knots=5, monotone=false}",
         # a quarter of the grains: twice the noise, and the tolerances that go with it
         "objective.tolerance=0.08", "objective.x_drift_tolerance=0.2"]
COUPON = ["machine={use=\"coupon-rig\", dispenser={length=\"1.6 mm\", width=\"0.8 mm\", depth=\"1 mm\"}, "
          "platform={length=\"1.6 mm\", width=\"0.8 mm\"}, land=\"2.4 mm\"}"]
RAMP = ["target.from.y=\"0.2 mm\"", "target.to.y=\"0.6 mm\""]
STRATEGIES = ("map", "bobyqa", "cobyla", "crs", "ceres", "mf")
STUDIES = {
    # name: study, its settings, evaluations a strategy
    "linear": ("examples/01_linear_coupon.toml", SMALL + RAMP, 20),
    "sigmoid": ("examples/02_sigmoid_coupon.toml",
                COUPON + SMALL[4:] + ["target.centre=\"0.45 mm\"", "target.width_10_90=\"0.3 mm\""], 20),
    # a plate that is there already: what remains are the dose and how much of it each chamber's own piston gives
    "three": ("examples/01_linear_coupon.toml",
              SMALL + RAMP + ["design_space.partition={family=\"straight\", angle=\"18 deg\", offset=\"0.05 mm\"}",
                              "design_space.dosage_factor=[2.0, 4.5]", "design_space.dose={A=[0.7, 1.4], B=[0.7, 1.4]}"], 16)}


def words(name, strategies=STRATEGIES):
    study, settings, budget = STUDIES[name]
    return ["compare", study, "--strategies", ",".join(strategies), "--budget", str(budget), "--confirmations", "3",
            *sets(settings)]


def objective(s):
    """What every strategy minimises, but for waste and coverage: sqrt(misfit^2 + x_drift_weight drift^2), weight 0.5 in both studies."""
    return None if s["x_drift"] is None else (s["confirmed_misfit"] ** 2 + 0.5 * s["x_drift"] ** 2) ** 0.5


def number(value, text="{:.3f}"):
    return "" if value is None else text.format(value)


def measured(name, strategy):
    """What came of one strategy; None when it was not measured and is not to be."""
    kept = os.path.join(DOCS, "data", f"search-{name}-{strategy}.json")
    if not os.path.exists(kept) and "--kept" in sys.argv:
        return None
    out = os.path.join(ROOT, "runs", f"search-{name}-{strategy}")
    return answer(kept, [*words(name, (strategy,)), "--json", "--force", "--out", out], (0, 4))["strategies"][0]


def table(name):
    rows = ["```\n" + shown(words(name)) + "\n```\n",
            "| strategy | spreads to its design | seconds | confirmed misfit | 95 % bounds | noise floor | x drift | objective | its own verdict | the judges' |",
            "|---|---|---|---|---|---|---|---|---|---|"]
    for strategy in STRATEGIES:
        s = measured(name, strategy)
        if s is None:
            rows.append(f"| `{strategy}` | not measured | | | | | | | | |")
            continue
        if s["confirmed_misfit"] is None:
            rows.append(f"| `{s['name']}` | {s['spreads']} | {number(s['seconds_cold'], '{:.0f}')} | | | | | | {s['termination']}: {s['reason']} | |")
            continue
        low, high = s["interval"]
        rows.append(f"| `{s['name']}` | {s['spreads']} | {number(s['seconds_cold'], '{:.0f}')} | {number(s['confirmed_misfit'])} | "
                    f"{number(low)} to {number(high)} | {number(s['noise_floor'])} | {number(s['x_drift'])} | {number(objective(s))} | {s['own_verdict'].replace('_', ' ')} | {s['verdict'].replace('_', ' ')} |")
    return "\n".join(rows)


if "--only" in sys.argv:
    strategy, name = sys.argv[sys.argv.index("--only") + 1:]
    measured(name, strategy)
else:
    fill(PAGE, {name: lambda name=name: table(name) for name in STUDIES})
