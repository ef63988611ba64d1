#!/usr/bin/env python3
"""Writes the tables of docs/speed-against-error.md from runs of the program. Usage, from the project's root:

    python3 docs/make_speed.py [ladder] [around] [shipped] [threads] [heap] [sizes] [lammps]

Answers are kept in runs/speed/, so that a second call only rewrites the page; delete one to measure it again. `ladder` takes an
hour on two free cores, `around` a quarter of one and `shipped` half of one after it, `threads`, `heap` and `sizes` a minute or two each
once their beds are cached. Nothing else may run meanwhile.
GRADWRIGHT in the environment names another program than ./gradwright. Needs nothing but Python's standard library.
"""
import json
import os
import sys

import measured
from measured import ROOT, shown

RUNS = os.path.join(ROOT, "runs", "speed")
PAGE = os.path.join(ROOT, "docs", "speed-against-error.md")

# Each reduction alone, from the finest level, on the whole of the first example
LADDER = ["tradeoff", "examples/01_linear_coupon.toml"]
# One step away from the study
AROUND = ["tradeoff", "examples/01_linear_coupon.toml", "--around", "study"]
# The same spreads, read for another target
SAME_RIG = ["02_sigmoid_coupon", "08_a_b_a", "09_table", "10_premixed_sigmoid"]
# Other powders, another motion, a field: the set as a whole, on the rig at half its length
HALF = ["--level", "study", "--set", 'machine.dispenser.length="1.6 mm"', "--set", 'machine.platform.length="1.6 mm"', "--set", 'machine.land="1.6 mm"',
        "--set", 'target.footprint.x=["0.8 mm", "1.6 mm"]']
OTHERS = {"03_paper_five_degrees": ["--level", "study", "--seeds", "2", *HALF[2:6]], "04_unlike_alloys": HALF, "06_316l_cucrzr": HALF, "07_two_sizes": HALF,
          "11_joint_search": [*HALF, "--set", 'design_space.footprint_offset=["-0.4 mm", "0 mm"]'],
          "12_three_layers": ["--level", "study", "--seeds", "2"], "13_field": HALF}
THREADS = ["bench", "--grains", "17000", "--threads", "1", "--threads", "2", "--state", "settled", "--state", "flowing", "--steps", "2000"]
SIZES = ["bench", "--grains", "7000", "--grains", "20000", "--grains", "70000", "--grains", "200000", "--grains", "700000", "--threads", "1", "--steps", "100"]
HEAP = ["bench", "--state", "spread", "--grains", "20000", "--threads", "1", "--threads", "2", "--steps", "8000"]
LAMMPS = ["crosscheck", "lammps", "examples/01_linear_coupon.toml", "--speed", "--full-width"]


def answer(name, words):
    kept = os.path.join(RUNS, name + ".json")
    out = [] if words[0] == "bench" else ["--force", "--out", os.path.join(RUNS, name)]
    return measured.answer(kept, [*words, "--json", *out])


def deep(level):
    """Contacts in a million that overlap by more than 3 %"""
    share = level["deep_contact_share"]
    return "< 1" if 0 < share < 1e-6 else f"{1e6 * share:.0f}"


def tradeoff_table(name, words):
    a = answer(name, words)
    rows = [f"`{shown(words)}` ({a['seeds']} beds a level, {a['provenance']['host']['threads']} threads, {a['provenance']['host']['isa']}):\n",
            "| level | grains | steps | awake grain-steps | seconds | speed-up | GI rms to the finest | noise floor | packing | largest overlap / r | deep | |", "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for l in a["levels"]:
        if l["grains"] is None:
            rows.append(f"| {l['name']} | | | | | | | | | | | {l['status']}: {l['reason']} |")
            continue
        word = "recommended" if l["name"] == a["recommended"] else "" if l["name"] == "finest" else "beyond the noise" if not l["within_noise"] else "overlaps too large" if not l["overlap_rule_kept"] else "free"
        rows.append(f"| {l['name']} | {l['grains']:.0f} | {l['steps']:.0f} | {l['grain_steps']:.2e} | {l['seconds']:.0f} | {l['speed_up']:.2f} | {l['gi_rmse']:.3f} | {l['noise_floor']:.3f} | {100 * l['packing_error']:+.1f} % | {100 * l['max_overlap_ratio']:.1f} % | {deep(l)} | {word} |")
    rows.append("\nWhat the levels are: " + "; ".join(f"*{l['name']}*: {l['meaning']}" for l in a["levels"]) + ".")
    if a["recommended"]:
        rows.append(f"\nRecommended: **{a['recommended']}**, {a['why']}.")
    return "\n".join(rows)


def shipped_table():
    """On the first example's rig the same spreads read for other targets, from the cache once `ladder` has run; then the rest."""
    rows = ["| example | level | seconds | speed-up | GI rms to the finest | noise floor | within two | largest overlap / r | deep |", "|---|---|---|---|---|---|---|---|---|"]
    runs = [(name, f"ladder-{name}", []) for name in SAME_RIG] + [(name, f"study-{name}", words) for name, words in sorted(OTHERS.items())]
    for name, kept, words in runs:
        a = answer(kept, ["tradeoff", f"examples/{name}.toml", *words])
        where = (", half the length" if HALF[3] in words else "") + (f", {a['seeds']} beds" if a["seeds"] != 3 else "")
        for l in a["levels"]:
            if l["name"] != "study" and (l["name"] != a["recommended"] or name not in SAME_RIG):
                continue
            word = " (recommended)" if l["name"] == a["recommended"] and name in SAME_RIG else ""
            rows.append(f"| {name}{where} | {l['name']}{word} | {l['seconds']:.0f} | {l['speed_up']:.2f} | {l['gi_rmse']:.4f} | {l['noise_floor']:.4f} | {'yes' if l['within_noise'] else 'no'} | {100 * l['max_overlap_ratio']:.1f} % | {deep(l)} |")
    return "\n".join(rows)


def sizes_table():
    a = answer("sizes", SIZES)
    rows = [f"`{shown(SIZES)}` on {a['host']['cores']} cores, {a['host']['isa']}:\n",
            "| state | grains | steps at once | million grain-steps/s | bytes a grain | contacts a grain |", "|---|---|---|---|---|---|"]
    for c in a["cases"]:
        rows.append(f"| {c['name']} | {c['grains']} | {c['steps_at_once']} | {c['grain_steps_per_second'] / 1e6:.1f} | {c['bytes_per_grain']:.0f} | {c['contacts_per_grain']:.2f} |")
    speeds = [c["grain_steps_per_second"] for c in a["cases"]]
    rows.append(f"\nCost of a grain-step, dearest size over cheapest: {max(speeds) / min(speeds):.2f}.")
    return "\n".join(rows)


def two_threads_table(name, words):
    """The same command four times: the cores of a virtual machine are not always the same distance apart."""
    answers = [answer(f"{name}-{k}", words) for k in range(1, 5)]
    rows = [f"`{shown(words)}` on {answers[0]['host']['cores']} cores, {answers[0]['host']['isa']}, four times:\n",
            "| state | awake grains | bytes a grain | one thread, million grain-steps/s | two threads | ratio | core to core and back, ns |", "|---|---|---|---|---|---|---|"]
    for a in answers:
        for state in dict.fromkeys(c["name"] for c in a["cases"]):
            one, two = (c for c in a["cases"] if c["name"] == state)
            speed = [c["grain_steps_per_second"] / 1e6 for c in (one, two)]
            rows.append(f"| {state} | {one['grains'] * one['awake_share']:.0f} of {one['grains']} | {one['bytes_per_grain']:.0f}, {two['bytes_per_grain']:.0f} | {speed[0]:.1f} | {speed[1]:.1f} | {speed[1] / speed[0]:.2f} | {two['core_round_trip_ns']:.0f} |")
    return "\n".join(rows)


def lammps_table():
    a = answer("lammps", LAMMPS)
    rows = [f"`{shown(LAMMPS)}` ({a['threads']} thread against {a['ranks']} rank of LAMMPS {a['lammps_version']}, {a['steps']} steps, {a['provenance']['instruction_set']}):\n",
            "| state | grains | Gradwright, million grain-steps/s | LAMMPS | its best skin | ratio |", "|---|---|---|---|---|---|"]
    for c in a["speed"]:
        rows.append(f"| {c['name']} | {c['grains']} | {c['gradwright_grain_steps_per_second'] / 1e6:.1f} | {c['lammps_grain_steps_per_second'] / 1e6:.2f} | {c['lammps_best_skin_m'] * 1e6:.0f} um | {c['speed_ratio']:.1f} |")
    return "\n".join(rows)


def keep_levels():
    """What the two tables say of each set of reductions, for the reports of designs that use it: linked into the program."""
    of_setting = ("names", "softening", "rayleigh_fraction", "coarse_factor", "sleep")
    of_level = ("name", "meaning", "status", "reason", "grains", "steps", "seconds", "speed_up", "gi_rmse", "noise_floor", "packing_error", "max_overlap_ratio", "deep_contact_share", "within_noise", "overlap_rule_kept")
    tables = []
    for name, words in (("around", AROUND), ("ladder", LADDER)):
        a = answer(name, words)
        levels = [{**{k: l[k] for k in of_level}, "reductions": {k: l["reductions"][k] for k in of_setting}} for l in a["levels"] if l["grains"] is not None]
        tables.append({"command": shown(words), "study": a["study"], "seeds": a["seeds"], "noise_allowed": a["noise_allowed"], "isa": a["provenance"]["host"]["isa"], "levels": levels})
    with open(os.path.join(measured.DOCS, "data", "speed-against-error.json"), "w") as file:
        json.dump(tables, file, indent=1, sort_keys=True)
        file.write("\n")


TABLES = {"lammps": lammps_table, "ladder": lambda: tradeoff_table("ladder", LADDER), "around": lambda: tradeoff_table("around", AROUND), "shipped": shipped_table, "threads": lambda: two_threads_table("threads", THREADS), "heap": lambda: two_threads_table("heap", HEAP), "sizes": sizes_table}
measured.fill(PAGE, TABLES)
if {"ladder", "around"} & set(sys.argv[1:] or TABLES):
    keep_levels()
