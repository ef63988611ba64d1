#!/usr/bin/env python3
"""Writes the numbers, tables and pictures of docs/paper.md from one run of the program. Usage, from the project's root:

    python3 docs/make_paper.py [--set KEY=VALUE ...] [--threads N] [--runs FOLDER]

The result is kept in runs/paper/, so that a second call only rewrites the page; delete that folder to measure anew. --set goes to
the program (a smaller bed while working on this page). Needs nothing but Python's standard library.
"""
import json
import argparse
import math
import os
import shutil
import sys

import measured
from measured import ROOT

STUDY = "examples/03_paper_five_degrees.toml"
MELT = ["--melt-depth", "100 um", "--melt-width", "120 um"]
PICTURES = ("beds", "gi_map", "heap_velocity", "heap_mixing", "gi_line", "composition")


def measure(runs, sets, threads):
    """evaluation.json of the spread; runs it when it is not there yet."""
    kept = os.path.join(runs, "evaluation.json")
    if not os.path.exists(kept):
        words = ["evaluate", STUDY, "--composition", *MELT, "--figures", "--out", runs, "--force", "--json", *measured.sets(sets)]
        if threads:
            words += ["--threads", str(threads)]
        measured.said(words)
    with open(kept) as file:
        result = json.load(file)
    if result["status"] != "ok":
        sys.exit(f"make_paper: the spread ended with '{result['status']}': {result['reason']}; delete {runs} to try again")
    return result


def number(value, digits=3):
    return "–" if value is None else f"{value:.{digits}g}"


def value_of(result, key):
    return next(row["value"] for row in result["inputs"] if row["key"] == key)


def picture(name, words):
    return f"![{words}](images/paper_{name}.svg)"


def run_text(r, sets):
    lengths = {key: value_of(r, key) for key in ("machine.dispenser.length", "machine.dispenser.width", "machine.platform.length",
                                                 "machine.land", "process.blade_speed")}
    text = (f"Bed {lengths['machine.dispenser.length']} x {lengths['machine.dispenser.width']}, land {lengths['machine.land']}, "
            f"platform {lengths['machine.platform.length']}, blade {lengths['process.blade_speed']}; {r['grains']} grains, "
            f"{r['steps']} steps, {r['grain_steps'] / 1e9:.2f}e9 grain-steps, {r['seconds'] / 60:.1f} min; seed {r['seed']}, state "
            f"`{r['state_hash']}`, program {r['provenance']['version'] + ' (' + r['provenance']['source'] + ')'}.")
    reductions = ", ".join(r["reductions"]) or "none"
    text += (f" Reductions: {reductions}. Captured {100 * r['capture_fraction']:.0f} % of the dosed powder, supply ratio "
             f"{r['supply_ratio']:.2f}, coverage {100 * r['coverage']:.0f} %, layer packing {r['packing_fraction']:.2f}, bond number "
             f"of the median grain {number(r['figures']['bed']['bond_number'])}.")
    if sets:
        text += "\n\n**Changed for this page:** " + ", ".join(f"`{one}`" for one in sets) + "."
    for warning in r["warnings"]:
        text += f"\n\nThe run warns: {warning}."
    return text


def fits(r):
    return {row["quantity"]: row for row in r["figures"]["line"]["fits"]}


def straightness(line_figure, fit):
    """Chi-squared of the bins about the fitted line by their standard errors, and its 95 % point (Wilson and Hilferty 1931)."""
    pairs = [(y, g, s) for y, g, s in zip(line_figure["y_m"], line_figure["gi"], line_figure["standard_error"])
             if g is not None and s and line_figure["partition_y_low_m"] <= y <= line_figure["partition_y_high_m"]]
    chi = sum(((g - fit["intercept"] - fit["slope_per_m"] * y) / s) ** 2 for y, g, s in pairs)
    free = len(pairs) - 2
    return chi, free, free * (1 - 2 / (9 * free) + 1.645 * math.sqrt(2 / (9 * free))) ** 3


def rotation(r):
    v = r["figures"]["velocity"]
    # the instants lie within a part of one turn of the heap: their deviation is quoted, not that over sqrt(n)
    return v, v["vorticity_per_s"], v["vorticity_deviation_per_s"]


def with_heap(r):
    """Instants between the dispenser's end, where all the powder has been gathered and no unmixed powder joins any more, and the
    platform's end."""
    left = float(value_of(r, "machine.dispenser.length").split()[0]) * 1e-3
    return [row for row in r["figures"]["mixing"]["rows"] if row["lacey_in_slices"] is not None and row["blade_x_m"] >= left]


def summary_text(r):
    rows = ["| figure | the paper's statement | here | |", "|---|---|---|---|"]
    line = fits(r).get("gi")
    if line and line["r_squared"] is not None:
        span = (r["figures"]["line"]["partition_y_high_m"] - r["figures"]["line"]["partition_y_low_m"]) * 1e3
        chi, free, most = straightness(r["figures"]["line"], line)
        rows.append(f"| 4, 7 | GI rises linearly across the layer | over the partition's extent of {span:.2f} mm a straight line has "
                    f"R² {line['r_squared']:.3f}; the bins lie about it as their errors let expect: chi² {chi:.1f} with {free} degrees of "
                    f"freedom (95 % point {most:.1f}) | agrees |" if chi < most else
                    f"| 4, 7 | GI rises linearly across the layer | over the partition's extent of {span:.2f} mm a straight line has "
                    f"R² {line['r_squared']:.3f}; the bins leave it by more than their errors: chi² {chi:.1f} with {free} degrees of "
                    f"freedom (95 % point {most:.1f}) | {'in the main' if line['r_squared'] > 0.9 else 'does not agree'} |")
    v, w, error = rotation(r)
    if w is not None and error is not None:
        sense = "rolls forward" if w < 0 else "rolls backward"
        rows.append(f"| 5 | the powder circulates in the x-z plane | mean vorticity {w:.0f} ± {error:.0f} 1/s between instants: {sense} | "
                    f"{'agrees' if abs(w) > 3 * error else 'no circulation found'} |")
    heap = with_heap(r)
    if heap:
        first, last = heap[0], heap[-1]
        grows = last["lacey_in_slices"] > first["lacey_in_slices"]
        rows.append(f"| 6 | the materials mix ahead of the recoater | Lacey index within slices of y from {first['lacey_in_slices']:.2f} "
                    f"(blade at {first['blade_x_m'] * 1e3:.1f} mm) to {last['lacey_in_slices']:.2f} "
                    f"({last['blade_x_m'] * 1e3:.1f} mm) | {'agrees' if grows else 'does not agree'} |")
        values = [x for x in r["figures"]["mixing"]["shown"][-1]["slices"]["lacey"] if x is not None]
        rows.append(f"| 6 | mixing varies along y | only {len(values)} of {len(r['figures']['mixing']['shown'][-1]['slices']['lacey'])} slices "
                    "hold both powders at the last instant drawn: the ramp of this bed is too narrow | cannot be judged |"
                    if len(values) < 4 else
                    f"| 6 | mixing varies along y | slices between {min(values):.2f} and {max(values):.2f} at the last instant drawn | "
                    f"{'agrees' if max(values) > 1.5 * min(values) else 'hardly'} |")
    melted, mass = fits(r).get("mass_fraction_a_melted"), fits(r).get("mass_fraction_a")
    if melted and mass:
        change = 100 * (melted["slope_per_m"] / line["slope_per_m"] - 1)
        rows.append(f"| 7 | the slope changes from powder to part because of melt mixing | mass fraction instead of volume and a pool of "
                    f"100 um x 120 um change it by {change:+.1f} % | the linear trend is kept as the paper says; its cause for the change "
                    "of slope is not confirmed |" if abs(change) < 10 else
                    f"| 7 | the slope changes from powder to part because of melt mixing | mass fraction instead of volume and a pool of "
                    f"100 um x 120 um change it by {change:+.1f} % | possible on this bed, whose ramp is hardly wider than the pool |")
    return "\n".join(rows)


def beds_text(r):
    made = r["figures"]["bed"]["made_d10_d50_d90_m"]
    asked = "/".join(value_of(r, f"powder.A.size.{key}").removesuffix(" um") for key in ("D10", "D50", "D90"))
    sizes = "/".join(f"{1e6 * d:.1f}" for d in made)
    return (picture("beds", "Powder in the dispenser before and on the platform after spreading, from above") +
            f"\n\nD10/D50/D90 by volume: asked for {asked} um, made {sizes} um after the cut at "
            f"{value_of(r, 'powder.A.size.cut_low')} and {value_of(r, 'powder.A.size.cut_high')}; the paper: D50 40 um. Packing of the "
            f"settled bed {r['figures']['bed']['packing_fraction']:.3f}.")


def map_text(r):
    drift = r["x_drift"]
    return (picture("gi_map", "Gradation index over the platform") +
            f"\n\nGI changes along y, as in the paper. Along x it drifts: last third of the platform minus first third, "
            f"{drift['value']:.3f} rms over y, of which {drift['noise_floor']:.3f} is noise. The paper's text is silent about x.")


def velocity_text(r):
    v, w, error = rotation(r)
    text = picture("heap_velocity", "Velocity of the powder ahead of the blade, as it stands and seen from the blade")
    if w is None:
        return text + "\n\nToo little powder ahead of the blade for a field."
    return text + (f"\n\nMean of {v['instants']} instants while the blade covers the platform's first half, cells of "
                   f"{v['cell_m'] * 1e6:.0f} um. The fastest cell moves at {v['fastest_m_s'] / v['blade_speed_m_s']:.2f} of the blade's "
                   f"speed. Circulation {v['circulation_m2_s'] * 1e6:.3g} mm²/s over {v['area_m2'] * 1e6:.3f} mm², that is a mean "
                   f"vorticity of {w:.0f} ± {error:.0f} 1/s (between instants, which lie within one turn and are not independent): "
                   f"{'clockwise, the heap rolls forward' if w < 0 else 'anticlockwise'}, one turn in "
                   f"{v['turn_length_m'] * 1e3:.2f} mm of the blade's way.")


def mixing_text(r):
    m = r["figures"]["mixing"]
    rows = ["| blade at mm | moving grains | Lacey, within slices of y | Lacey, all cells | GI of the heap |", "|---|---|---|---|---|"]
    for row in m["shown"]:
        rows.append(f"| {row['blade_x_m'] * 1e3:.2f} | {row['grains']} | {number(row['lacey_in_slices'])} | {number(row['lacey'])} | "
                    f"{number(row['gi'])} |")
    return (picture("heap_mixing", "The moving powder from above at four instants, mixing over the way, GI across the heap") + "\n\n" +
            "\n".join(rows) + f"\n\nCells of {m['cell_m'] * 1e6:.0f} um; powder counts when it moves at "
            f"{m['least_speed_m_s'] * 1e3:.0f} mm/s or more along x and lies above the blade's edge.")


def line_text(r):
    line = r["figures"]["line"]
    span = line["partition_y_high_m"] - line["partition_y_low_m"]
    text = picture("gi_line", "GI across the layer with the straight line through it")
    fit = fits(r).get("gi")
    if not fit:
        return text
    ratio = fit["slope_per_m"] / line["unmixed_slope_per_m"]
    text += (f"\n\nOver the partition's extent, {line['partition_y_low_m'] * 1e3:.3f}-{line['partition_y_high_m'] * 1e3:.3f} mm "
             f"({fit['bins']} bins): slope {fit['slope_per_m'] * 1e-3:.2f} ± {fit['slope_standard_error_per_m'] * 1e-3:.2f} per mm, R² "
             f"{fit['r_squared']:.3f}. A partition whose powder were mixed along x and not at all across would give 1/({span * 1e3:.2f} mm) "
             f"= {line['unmixed_slope_per_m'] * 1e-3:.2f} per mm; ours has {100 * ratio:.0f} % of it. To compare with another bed, take "
             f"slopes as shares of 1/(L_d tan 5°), never per mm.")
    middle = 0.5 * (line["partition_y_low_m"] + line["partition_y_high_m"])
    near = [((y - middle) / span, g, s) for y, g, s in zip(line["y_m"], line["gi"], line["standard_error"])
            if g is not None and s is not None and abs(y - middle) <= span]
    text += "\n\nThe shape, free of the bed's size (y from the partition's middle):\n\n| y / (L_d tan 5°) | GI ± standard error |\n|---|---|\n"
    return text + "\n".join(f"| {y:+.2f} | {g:.2f} ± {s:.2f} |" for y, g, s in near)


def melt_text(r):
    c, melt = r["composition"], r["composition"]["melt"]
    both = fits(r)
    rows = ["| slope over the partition's extent, per mm | |", "|---|---|"]
    names = {"gi": "GI by volume", "mass_fraction_a": "mass fraction of A: what EDS contents give, (c - c_B)/(c_A - c_B)",
             "mass_fraction_a_melted": "mass fraction after melting"}
    for key, words in names.items():
        if key in both:
            rows.append(f"| {words} | {both[key]['slope_per_m'] * 1e-3:.3f} |")
    base = melt["base_share"]
    alloys = "; ".join(f"{side} = {a['material']}: Fe {a['wt'].get('Fe', 0):.4g}, Ni {a['wt'].get('Ni', 0):.4g} wt% ({a['source']})"
                       for side, a in c["alloys"].items())
    table = ["| y mm | GI | wt% Fe | wt% Ni | wt% Fe melted | wt% Ni melted |", "|---|---|---|---|---|---|"]
    for b, y in enumerate(c["y_m"]):
        def banded(name):
            low, high = c["band_low"][name][b], c["band_high"][name][b]
            return number(c[name][b]) + ("" if low is None or high is None else f" ({low:.3g}-{high:.3g})")
        table.append(f"| {y * 1e3:.2f} | {number(r['profile']['gi'][b])} | {banded('wt_fe')} | {banded('wt_ni')} | "
                     f"{number(melt['wt_fe'][b])} | {number(melt['wt_ni'][b])} |")
    return (picture("composition", "Iron and nickel across the layer, powder and melted metal") + "\n\n" + "\n".join(rows) +
            f"\n\nIn brackets the simultaneous 95 % band of GI carried through. Bins of 0.2 mm are wider than the pool and so keep their "
            f"value after melting; the picture and the slopes use finer bins, where it shows.\n\n" + "\n".join(table) +
            f"\n\nNominal alloys: {alloys}. Of each pool {100 * melt['new_share']:.0f} % is new powder; of a base plate's composition "
            + ", ".join(f"{100 * share:.0f} %" for share in base[:5]) +
            f" are left in layers 1 to {min(5, len(base))}; of the scatter from layer to layer {100 * melt['scatter_factor']:.0f} %.")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    options.add_argument("--threads", type=int)
    options.add_argument("--runs", default=os.path.join(ROOT, "runs", "paper"))
    options.add_argument("--page", default=os.path.join(ROOT, "docs", "paper.md"), help="page to fill, in place")
    given = options.parse_args()
    runs = os.path.abspath(given.runs)
    r = measure(runs, given.set, given.threads)
    images = os.path.join(os.path.dirname(os.path.abspath(given.page)), "images")
    os.makedirs(images, exist_ok=True)
    for name in PICTURES:
        source = os.path.join(runs, name + ".svg")
        if os.path.exists(source):
            shutil.copyfile(source, os.path.join(images, f"paper_{name}.svg"))
    parts = {"run": lambda: run_text(r, given.set), "summary": lambda: summary_text(r), "beds": lambda: beds_text(r),
             "map": lambda: map_text(r), "velocity": lambda: velocity_text(r), "mixing": lambda: mixing_text(r),
             "line": lambda: line_text(r), "melt": lambda: melt_text(r)}
    for name, part in parts.items():
        measured.put(given.page, name, part())


main()
