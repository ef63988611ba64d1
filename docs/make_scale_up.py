#!/usr/bin/env python3
"""Writes the tables of docs/scale-up.md from runs of the program. Usage, from the project's root:

    python3 docs/make_scale_up.py [machine] [check]

`machine` designs the example (about eight minutes on two cores), `check` does so with one strip of twice the longest (half an
hour more). Answers are kept in runs/scale-up/; delete one to measure it again. GRADWRIGHT in the environment names another
program than ./gradwright. Needs nothing but Python's standard library.
"""
import os
import shutil

import measured
from measured import ROOT, shown

RUNS = os.path.join(ROOT, "runs", "scale-up")
PAGE = os.path.join(ROOT, "docs", "scale-up.md")
MACHINE = ["design", "examples/05_machine_bed.toml"]
CHECK = [*MACHINE, "--set", 'scale_up.lengths=["1.6 mm", "3.2 mm", "6.4 mm", "12.8 mm", "25.6 mm"]']


def answer(name, words):
    out = os.path.join(RUNS, name)
    kept = os.path.join(out, "result.json")
    return measured.answer(kept, [*words, "--force", "--out", out], (0, 4), writes=True), out


def law_line(heap):
    law = heap["law"]
    return (f"Last doubling: W moved by **{heap['profile_step']:.3f}**, its drift by **{heap['drift_step']:.3f}**; doses at one length "
            f"differ by up to {heap['dose_step']:.3f}. Carried to 100 mm: {heap['profile_error']:.3f} in GI, {heap['drift_error']:.3f} in x drift.\n\n"
            f"Law of the order, not used: amplitude {law['amplitude']:.2f}, memory {law['memory']:.1f} turnovers, one turn in {law['turn']:.1f}; "
            f"collapse error **{law['collapse_error']:.3f}**; the longest strip by the law of the others: off by {law['longest_miss']:+.3f}.")


def strips_table(name, words):
    a, out = answer(name, words)
    heap = a["extrapolated"]
    host = a["provenance"]["host"]
    rows = [f"`{shown(words)}` ({host['threads']} threads, {host['isa']}; {a['seconds_cold']:.0f} s with an empty cache):\n",
            "| dispenser mm | dosage factor | turnovers N | profile order | rest | drift order | captured f | lateral variance / D50² N | seconds |",
            "|---|---|---|---|---|---|---|---|---|"]
    for s in heap["strips"]:
        rows.append(f"| {1e3 * s['dispenser_length_m']:.1f} | {s['dosage_factor']:.1f} | {s['turnovers']:.1f} | {s['profile_order']:+.3f} | {s['profile_rest']:.3f} | "
                    f"{s['drift_order']:.3f} | {s['capture_fraction']:.2f} | {s['lateral']:.2f} | {s['seconds_cold']:.0f} |")
    rows.append("\n" + law_line(heap))
    rows.append(f"\nVerdict: **{a['verdict']}**: misfit {a['misfit']['value']:.3f} (95 % bounds {a['misfit']['interval'][0]:.3f} and {a['misfit']['interval'][1]:.3f}, "
                f"tolerance {a['misfit']['tolerance']:.2f}), x drift {a['x_drift']['value']:.3f} ({a['x_drift']['interval'][0]:.3f} and "
                f"{a['x_drift']['interval'][1]:.3f}, tolerance {a['x_drift']['tolerance']:.2f}).")
    images = os.path.join(ROOT, "docs", "images")
    shutil.copyfile(os.path.join(out, "heap_order.svg"), os.path.join(images, f"scale_up_{name}.svg"))
    rows.append(f"\n![order of the strips against turnovers, with the law](images/scale_up_{name}.svg)")
    return "\n".join(rows)


measured.fill(PAGE, {name: lambda name=name, words=words: strips_table(name, words) for name, words in (("machine", MACHINE), ("check", CHECK))})
