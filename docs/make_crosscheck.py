#!/usr/bin/env python3
"""Writes the tables of docs/crosscheck.md from runs of the program. Usage, from the project's root:

    python3 docs/make_crosscheck.py [forces] [beds] [speed] [blade] [skin]

Results are kept in runs/crosscheck/, so that a second call only rewrites the page. `beds` takes some 45 minutes on one free
core, `speed` 15 on two, `blade` five, `skin` two. Needs LAMMPS (Debian's package lammps) and nothing but Python's standard library.
"""
import json
import os
import re
import resource
import subprocess
import sys

import measured
from measured import ROOT

RUNS = os.path.join(ROOT, "runs", "crosscheck")
PAGE = os.path.join(ROOT, "docs", "crosscheck.md")
STUDY = "examples/01_linear_coupon.toml"


def crosscheck(name="strip", study=STUDY, extra=("--seeds", "6", "--threads", "1", "--ranks", "1")):
    """The answer of one run. Tables `forces` and `beds` are read from the same."""
    out = os.path.join(RUNS, name)
    kept = os.path.join(out, "crosscheck.json")
    words = ["crosscheck", "lammps", study, *extra, "--force", "--out", out]
    answer = measured.answer(kept, words, (0, 4), writes=True)
    if answer["status"] != "ok":
        sys.exit(f"{name}: ended with '{answer['status']}': {answer['reason']}; delete {out} to try again")
    return answer


def forces_table():
    two = crosscheck()["two_body"]
    rows = ["| compared | contacts | largest difference | relative to the |", "|---|---|---|---|"]
    rows += [f"| {c['name']} | {c['contacts']} | {c['max_relative_error']:.1e} | {c['relative_to']} |" for c in two["cases"]]
    rows += ["", f"Stretched bonds that LAMMPS still had after its next neighbour rebuild: {two['bonds_kept_after_a_rebuild_in_lammps']} of "
             f"{two['bonds_stretched']}. Bonds stretched beyond {two['lammps_tear_off_share']:.2f} of the tear-off overlap that LAMMPS still "
             f"held: {two['bonds_held_beyond_in_lammps']} of {two['bonds_beyond_lammps_tear_off']}."]
    return rows


def mean_of(values, form="{:.3f}"):
    """Mean of the beds and its standard error."""
    values = [v for v in values if v is not None]
    mean = sum(values) / len(values)
    error = (sum((v - mean) ** 2 for v in values) / max(1, len(values) - 1) / len(values)) ** 0.5
    return f"{form.format(mean)} +- {form.format(error)}"


def beds_table():
    r = crosscheck()
    ours, theirs = r["engines"]["gradwright"], r["engines"]["lammps"]

    def both(name, key, scale=1, form="{:.3f}"):
        value = r
        for part in key.split("."):
            value = value[part]
        return f"| {name} | " + " | ".join(mean_of([scale * v for v in value[f"{engine}_beds"]], form) for engine in ("gradwright", "lammps")) + " |"

    rows = [f"| mean of {len(r['beds'])} beds, +- its standard error | gradwright {ours['version']} | LAMMPS {theirs['version']} |", "|---|---|---|",
            both("packing of the layer", "packing"), both("captured share of the dose", "capture_fraction"), both("coverage", "coverage"),
            both("heap: length (95 % of the solid) mm", "heap.length_m", 1e3),
            both("heap: centre of the solid ahead of the blade mm", "heap.centre_m", 1e3),
            both("heap: section of solid mm2", "heap.solid_section_m2", 1e6, "{:.4f}")]
    profile = r["profile"]
    for k, (y, weight) in enumerate(zip(profile["y_m"], profile["weight"])):
        if weight > 0:
            rows.append(f"| GI at y = {1e3 * y:.1f} mm | " + " | ".join(mean_of([bed[engine]["gi"][k] for bed in r["beds"]]) for engine in ("gradwright", "lammps")) + " |")
    rows += ["", f"GI of LAMMPS less GI of ours on the same bed: rms {r['gi_rmse']:.4f} (of the means {r['gi_rmse_of_means']:.4f}, bias "
             f"{r['gi_bias']:+.4f} +- {r['gi_bias_standard_error']:.4f}). One engine between two beds: rms {r['noise_rms']:.4f}, ratio "
             f"{r['gi_rmse'] / r['noise_rms']:.2f}. Were both engines the same, a difference of the means as large would come by chance in "
             f"a share {r['gi_p_value']:.2f} of such runs; below {r['differs_below']} they would be called different."]
    rows += ["", "What was not the same in that run:", ""] + [f"- {d}" for d in r["differences"]]
    return rows


def speed_table():
    r = crosscheck("two-ranks", extra=("--seeds", "3", "--threads", "2", "--ranks", "2"))
    ours, theirs = r["engines"]["gradwright"], r["engines"]["lammps"]
    return [f"{len(r['beds'])} whole spreads, 2 threads against 2 ranks: {ours['seconds']:.0f} s against {theirs['seconds']:.0f} s, "
            f"**{r['speed_ratio']:.1f} times** as long in LAMMPS."]


def blade_table():
    rows = ["| blade in LAMMPS | captured share, bed by bed | ours on the same beds | GI between beds, rms | GI of LAMMPS less ours, rms |",
            "|---|---|---|---|---|"]
    for name, extra in (("rigid", ["--seeds", "3", "--rigid-blade"]), ("soft", ["--seeds", "3"])):
        r = crosscheck(f"blade-{name}", "docs/crosscheck.toml", extra)
        beds = [" ".join(f"{c:.2f}" for c in r["capture_fraction"][f"{engine}_beds"]) for engine in ("lammps", "gradwright")]
        rows.append(f"| {name} | {beds[0]} | {beds[1]} | {r['noise_rms']:.3f} | {r['gi_rmse']:.3f} |")
    return rows


def skin_table():
    """CPU seconds of LAMMPS for the first steps of a deck, by skin and by the interval of balancing: what a loaded machine
    can still tell."""
    crosscheck()
    folder = os.path.join(RUNS, "strip", "bed-1")
    with open(os.path.join(folder, "in.spread")) as file:
        deck = file.read()
    steps = 20000
    with open(os.path.join(folder, "in.skin"), "w") as file:
        file.write(deck[:deck.index("\nrun ")] + f"\nrun {steps}\n")
    rows = [f"| skin um | CPU s for {steps} steps, one rank | neighbour lists built |", "|---|---|---|"]
    for skin in (4, 6, 8, 12):
        kept = os.path.join(RUNS, f"skin-{skin}.json")
        if not os.path.exists(kept):
            # the deck may have been made for more ranks
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            log = os.path.join(RUNS, f"skin-{skin}.log")
            with open(os.path.join(folder, "in.skin")) as file:
                text = re.sub(r"\nprocessors .*|\nfix even .*", "", file.read())
            subprocess.run(["lmp", "-in", "/dev/stdin", "-log", log, "-nocite", "-var", "skin", f"{skin}e-6"], cwd=folder, check=True,
                           input=text.encode(), stdout=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"})
            used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
            with open(log) as file:
                built = int(re.search(r"Neighbor list builds = (\d+)", file.read()).group(1))
            with open(kept, "w") as file:
                json.dump({"seconds": used, "built": built}, file)
        with open(kept) as file:
            r = json.load(file)
        rows.append(f"| {skin} | {r['seconds']:.1f} | {r['built']} |")
    return rows


TABLES = {"forces": forces_table, "beds": beds_table, "speed": speed_table, "blade": blade_table, "skin": skin_table}
measured.fill(PAGE, {name: lambda table=table: "\n".join(table()) for name, table in TABLES.items()})
