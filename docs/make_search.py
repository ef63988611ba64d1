#!/usr/bin/env python3
"""Writes the tables of docs/search.md from runs of the program. Usage, from the project's root:

    python3 docs/make_search.py [linear] [sigmoid]

What `compare` answered is kept in docs/data/search-NAME.json, so that a second call only rewrites the page; delete a file to measure
it again (about twenty minutes each on two free cores). GRADWRIGHT in the environment names another program than ./gradwright. Needs
nothing but Python's standard library.
"""
import json
import os
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGE = os.path.join(ROOT, "docs", "search.md")
DATA = os.path.join(ROOT, "docs", "data")
PROGRAM = os.environ.get("GRADWRIGHT", "./gradwright")

# A coupon of half the length and half the width of 01: some ten seconds a spread, so that plain methods can have the spreads they
# need. The sides are a period, as there; bins of 0.1 mm.
SMALL = ["machine.dispenser={length=\"1.6 mm\", width=\"0.8 mm\", depth=\"1 mm\"}", "machine.platform.length=\"1.6 mm\"",
         "machine.platform.width=\"0.8 mm\"", "machine.land=\"2.4 mm\"", "target.footprint.x=[\"0.8 mm\", \"1.6 mm\"]",
         "target.bin_width=\"0.1 mm\"", "design_space.partition={family=\"polyline\", knots=5, monotone=false}",
         # a quarter of the grains: twice the noise, and the tolerances that go with it
         "objective.tolerance=0.08", "objective.x_drift_tolerance=0.2"]
STUDIES = {"linear": ["target.from.y=\"0.2 mm\"", "target.to.y=\"0.6 mm\""],
           "sigmoid": []}
FILES = {"linear": "examples/01_linear_coupon.toml", "sigmoid": "examples/02_sigmoid_coupon.toml"}
SIGMOID = ["target.centre=\"0.45 mm\"", "target.width_10_90=\"0.3 mm\"",
           "machine={use=\"coupon-rig\", dispenser={length=\"1.6 mm\", width=\"0.8 mm\", depth=\"1 mm\"}, "
           "platform={length=\"1.6 mm\", width=\"0.8 mm\"}, land=\"2.4 mm\"}"]
CALL = ["--strategies", "map,bobyqa,cobyla,crs,ceres,mf", "--budget", "20", "--confirmations", "3"]


def words(name):
    settings = SMALL + STUDIES[name] if name == "linear" else SIGMOID + SMALL[4:]
    out = ["compare", FILES[name], *CALL]
    for setting in settings:
        out += ["--set", setting]
    return out


def answer(name):
    kept = os.path.join(DATA, f"search-{name}.json")
    if not os.path.exists(kept):
        command = [PROGRAM, *words(name), "--json", "--force", "--out", os.path.join(ROOT, "runs", f"search-{name}")]
        print("running:", " ".join(map(shlex.quote, command)), file=sys.stderr, flush=True)
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE)
        if done.returncode not in (0, 4):
            sys.exit(f"ended with exit code {done.returncode}")
        with open(kept, "wb") as file:
            file.write(done.stdout)
    with open(kept) as file:
        return json.load(file)


def objective(s):
    """What every strategy minimises, but for waste and coverage: sqrt(misfit^2 + x_drift_weight drift^2), weight 0.5 in both studies."""
    return None if s["x_drift"] is None else (s["confirmed_misfit"] ** 2 + 0.5 * s["x_drift"] ** 2) ** 0.5


def number(value, text="{:.3f}"):
    return "" if value is None else text.format(value)


def table(name):
    a = answer(name)
    rows = ["```\n./gradwright " + " ".join(map(shlex.quote, words(name))) + "\n```\n",
            "| strategy | spreads to its design | seconds | confirmed misfit | 95 % bounds | noise floor | x drift | objective | its own verdict | the judges' |",
            "|---|---|---|---|---|---|---|---|---|---|"]
    for s in a["strategies"]:
        if s["confirmed_misfit"] is None and not s["spreads"]:
            rows.append(f"| `{s['name']}` | not run | | | | | | | | |")
            continue
        if s["confirmed_misfit"] is None:
            rows.append(f"| `{s['name']}` | {s['spreads']} | {number(s['seconds_cold'], '{:.0f}')} | | | | | | {s['termination']}: {s['reason']} | |")
            continue
        low, high = s["interval"]
        rows.append(f"| `{s['name']}` | {s['spreads']} | {number(s['seconds_cold'], '{:.0f}')} | {number(s['confirmed_misfit'])} | "
                    f"{number(low)} to {number(high)} | {number(s['noise_floor'])} | {number(s['x_drift'])} | {number(objective(s))} | {s['own_verdict'].replace('_', ' ')} | {s['verdict'].replace('_', ' ')} |")
    return "\n".join(rows)


def main():
    with open(PAGE) as file:
        text = file.read()
    for name in sys.argv[1:] or list(STUDIES):
        begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
        head, rest = text.split(begin)
        text = head + begin + "\n" + table(name) + "\n" + end + rest.split(end)[1]
        with open(PAGE, "w") as file:
            file.write(text)


main()
