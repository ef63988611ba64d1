#!/usr/bin/env python3
"""Writes the tables of docs/motion-map.md from runs of the program. Usage, from the project's root:

    python3 docs/make_motion_map.py

Fifteen narrow strips (five lands, three dosage factors; six minutes on two cores), each read at three places of the part. What the
program answered is kept in docs/data/motion-map.json; delete it to measure again. GRADWRIGHT in the environment names another program
than ./gradwright, THREADS the number of threads. Needs nothing but Python's standard library.
"""
import json
import os
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGE = os.path.join(ROOT, "docs", "motion-map.md")
DATA = os.path.join(ROOT, "docs", "data", "motion-map.json")
PROGRAM = os.environ.get("GRADWRIGHT", "./gradwright")
LANDS = [0.8, 1.6, 3.2, 4.8, 6.4]
DOSES = [2.0, 3.0, 4.5]
PLACES = [-1.6, -0.8, 0.0]  # shift of a footprint of 1.6 mm that else ends with the platform


def words(land, dose, place):
    return ["design", "examples/01_linear_coupon.toml", "--set", f'design_space.land="{land} mm"', "--set",
            f"design_space.dosage_factor={dose}", "--set", f'design_space.footprint_offset="{place} mm"', "--set",
            "run.map_spreads=1", "--set", "run.max_spreads=1"]


def measure():
    rows = []
    for land in LANDS:
        for dose in DOSES:
            for place in PLACES:
                command = [PROGRAM, *words(land, dose, place), "--json", "--quiet", "--force", "--out",
                           os.path.join(ROOT, "runs", "motion-map")]
                if "THREADS" in os.environ:
                    command += ["--threads", os.environ["THREADS"]]
                print("running:", " ".join(map(shlex.quote, command)), file=sys.stderr, flush=True)
                done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE)
                row = {"land_mm": land, "dosage_factor": dose, "place_mm": place}
                if done.returncode in (0, 4, 5) and done.stdout:
                    a = json.loads(done.stdout)
                    row |= {key: a.get(key) for key in ("termination", "message", "misfit", "x_drift", "capture_fraction", "supply_ratio",
                                                        "coverage", "waste_fraction", "seconds_cold")}
                    row["turnover"] = (a.get("predicted") or {}).get("turnover")
                    row["straight"] = {key: (a.get("straight") or {}).get(key) for key in ("misfit", "x_drift")}
                else:
                    row["message"] = f"exit code {done.returncode}"
                rows.append(row)
    return rows


def main():
    if not os.path.exists(DATA):
        rows = measure()
        with open(DATA, "w") as file:
            json.dump(rows, file, indent=1)
    with open(DATA) as file:
        rows = json.load(file)
    print(json.dumps(rows[0], indent=1)[:3000])


main()
