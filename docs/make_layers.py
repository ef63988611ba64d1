#!/usr/bin/env python3
"""Writes the tables of docs/layers.md from runs of the program. Usage, from the project's root:

    python3 docs/make_layers.py [fused] [powder] [plate]

What `evaluate` answered is kept in docs/data/layers-NAME.json, without its maps and inputs, so that a second call only rewrites the
page; delete a file to measure it again (a minute or two each on one free core). GRADWRIGHT in the environment names another program
than ./gradwright. Needs nothing but Python's standard library.
"""
import json
import math
import os

from measured import ROOT, fill, said, sets, shown

PAGE = os.path.join(ROOT, "docs", "layers.md")
DATA = os.path.join(ROOT, "docs", "data")

# A sixth of 01's length and a quarter of its width, and layers of 70 um: over powder and plates the gap is one layer, which must let grains of 62 um
# through.
SMALL = ["machine.dispenser={length=\"0.5 mm\", width=\"0.4 mm\", depth=\"1 mm\"}",
         "machine.platform={length=\"0.5 mm\", width=\"0.4 mm\"}", "machine.land=\"0.3 mm\"", "machine.second_land=\"0.5 mm\"",
         "machine.blade.thickness=\"0.3 mm\"", "process.layer_thickness=\"70 um\"", "design_space.dosage_factor=2.5",
         "target.from.y=\"0.1 mm\"", "target.to.y=\"0.3 mm\"", "target.bin_width=\"0.05 mm\"", "process.allow_starved=true"]
CASES = {"fused": [], "powder": ["process.substrate=\"powder\"", "process.gap=\"layer\""],
         "plate": ["process.substrate=\"plate\"", "process.gap=\"layer\""]}


def words(name):
    return ["evaluate", "examples/12_three_layers.toml", *sets(SMALL + CASES[name])]


def answer(name):
    kept = os.path.join(DATA, f"layers-{name}.json")
    if not os.path.exists(kept):
        told = json.loads(said([*words(name), "--json", "--quiet", "--threads", "1"]))
        for key in ("map", "inputs", "design"):
            told.pop(key)
        for layer in told["layers"]:
            layer.pop("map")
        told["provenance"].pop("built", None)
        with open(kept, "w") as file:
            json.dump(told, file, indent=1)
            file.write("\n")
    with open(kept) as file:
        return json.load(file)


def rms_against(first, layer):
    """rms over the bins of the difference of two layers' GI, and what their standard errors let it be by chance."""
    pairs = [(a, b, s, t) for a, b, s, t in zip(first["gi"], layer["gi"], first["standard_error"], layer["standard_error"])
             if None not in (a, b, s, t)]
    value = math.sqrt(sum((a - b) ** 2 for a, b, _, _ in pairs) / len(pairs))
    noise = math.sqrt(sum(s * s + t * t for _, _, s, t in pairs) / len(pairs))
    return f"{value:.3f} ({noise:.3f})"


def table(name):
    a = answer(name)
    rows = ["```\n" + shown(words(name)) + "\n```\n",
            f"{a['grains']} grains, {a['steps']} steps.\n",
            "| layer | gap um | GI against layer 1, rms (noise) | misfit | x drift | captured | overflow | coverage | packing | over the rim / dose | carried off / dose |",
            "|---|---|---|---|---|---|---|---|---|---|---|"]
    first = a["layers"][0]
    for one in a["layers"]:
        dose = one["dosed_solid_m3"]
        rows.append(f"| {one['number']} | {1e6 * one['gap_m']:.0f} | {'' if one is first else rms_against(first, one)} | "
                    f"{one['misfit']['value']:.3f} | {one['x_drift']['value']:.3f} | {one['capture_fraction']:.2f} | "
                    f"{one['waste_fraction']:.2f} | {one['coverage']:.2f} | {one['packing_fraction']:.2f} | "
                    f"{one['raised_solid_m3'] / dose:.2f} | {one['carried_off_solid_m3'] / dose:.3f} |")
    return "\n".join(rows)


fill(PAGE, {name: lambda name=name: table(name) for name in CASES})
