#!/usr/bin/env python3
"""Writes the tables of docs/bulk.md from runs of the program. Usage, from the project's root:

    python3 docs/make_bulk.py [repose] [gi] [layer] [plate] [flight] [--kept]

--kept runs nothing: rows without an answer say so.

Answers are kept in runs/bulk/, so that a second call only rewrites the page; an hour or two on one core in all. Needs
nothing but Python's standard library.
"""
import math
import os
import sys

from measured import ROOT, answer, fill, sets

RUNS = os.path.join(ROOT, "runs", "bulk")
PAGE = os.path.join(ROOT, "docs", "bulk.md")
STUDY = "docs/bulk.toml"
D90 = 54.8e-6  # of the powder without fines, as `check` prints it

# one factor at a time; the first is what everything is compared with
FACTORS = [
    ("paper, adhesion by cohesion number (0.02 J/m2 is of the real powder)", "base", []),
    ("0.02 J/m2 is of the softened powder", "none", ['numerics.adhesion_scaling="none"']),
    ("no adhesion", "dry", ['interaction.work_of_adhesion="0 J/m2"']),
    ("softening 1e-3", "s3", ["numerics.softening=1e-3"]),
    ("softening 1e-2", "s2", ["numerics.softening=1e-2"]),
    ("softening 1e-3, 0.02 J/m2 of the softened powder", "s3none", ["numerics.softening=1e-3", 'numerics.adhesion_scaling="none"']),
    ("softening 1e-3, no adhesion", "s3dry", ["numerics.softening=1e-3", 'interaction.work_of_adhesion="0 J/m2"']),
    ("no rolling resistance", "roll0", ['interaction.rolling_model="none"']),
    ("rolling spring", "rollspring", ['interaction.rolling_model="spring"']),
    ("rolling as in EDEM", "rolledem", ['interaction.rolling_model="edem"']),
    ("friction cap normal", "capnormal", ['interaction.friction_cap="normal"']),
    ("friction cap edem_repulsive", "capedem", ['interaction.friction_cap="edem_repulsive"']),
    ("static friction 0.3", "mu3", ["interaction.static_friction=0.3"]),
    ("time step 0.1 T_R", "dt1", ["numerics.time_step.rayleigh_fraction=0.1"]),
]


def program(name, arguments):
    """Answer of one call, kept in runs/bulk/NAME.json; None when the simulation failed (its reason is printed)."""
    kept = os.path.join(RUNS, name + ".json")
    if not os.path.exists(kept) and "--kept" in sys.argv:
        return {"status": "not measured"}
    return answer(kept, [*arguments, "--json", "--quiet"], (0, 4, 5))


def spread(name, values, seed=1):
    return program(f"{name}-{seed}", ["evaluate", STUDY, "--fidelity", "map", "--seed", str(seed), *sets(values)])


def number(value, digits=2):
    return "–" if value is None else f"{value:.{digits}f}"


def repose():
    rows = ["| one factor changed | Bond number | packing | contacts a grain | angle of repose, degrees | powder left | height at the edge, um | at rest |",
            "|---|---|---|---|---|---|---|---|"]
    for label, name, values in FACTORS:
        r = program("repose-" + name, ["bulk", STUDY, *sets(values)])
        if r["status"] != "ok":
            rows.append(f"| {label} | | | | {r['status']} | | | |")
            continue
        rows.append(f"| {label} | {r['bond_number']:.3g} | {number(r['packing_fraction'], 3)} | {number(r['mean_coordination'], 1)} | "
                    f"{number(r['angle_of_repose_deg'], 1)} ± {number(r['angle_standard_error_deg'], 1)} | {100 * r['left_fraction']:.0f} % | "
                    f"{1e6 * r['gate_height_m']:.0f} | {'yes' if r['at_rest'] else 'creeps'} |")
    return "\n".join(rows)


def rms(a, b):
    pairs = [(x - y) ** 2 for x, y in zip(a, b) if x is not None and y is not None]
    return math.sqrt(sum(pairs) / len(pairs)) if pairs else None


def gi():
    rows = ["| one factor changed | packing of the layer | captured | coverage | GI(y) against the first row, rms | x drift |",
            "|---|---|---|---|---|---|"]
    base = spread("gi-base", [])
    for label, name, values in FACTORS + [("paper, another bed (noise of every difference)", "base", None)]:
        r = spread("gi-" + name, [], 2) if values is None else spread("gi-" + name, values)
        if r["status"] != "ok":
            rows.append(f"| {label} | {r['status']} | | | | |")
            continue
        rows.append(f"| {label} | {number(r['packing_fraction'], 3)} | {number(r['capture_fraction'])} | {number(r['coverage'])} | "
                    f"{number(rms(r['profile']['gi'], base['profile']['gi']), 3)} | {number(r['x_drift']['value'], 3)} |")
    return "\n".join(rows)


def along(r, gap):
    """Packing along x: solid volume of the map's columns over gap and plan area. GI is by volume, so a cell's density is its mean."""
    x = r["map"]["x_m"]
    cell, width = x[1] - x[0], 1.6e-3  # the map answers for the full width
    solid = [sum(m[k] / (8200 + (7980 - 8200) * g[k]) for m, g in zip(r["map"]["mass_kg"], r["map"]["gi"]) if m[k] and g[k] is not None)
             for k in range(len(x))]
    return [v / (gap * cell * width) for v in solid]


def layer():
    rows = ["| gap/D90 | gap um | blade mm/s | flight v sqrt(2 gap/g), mm | packing, whole platform | packing, second half | coverage |",
            "|---|---|---|---|---|---|---|"]
    for ratio, speed in [(r, 100) for r in (1.0, 1.5, 2.0, 2.5, 3.0, 4.0)] + [(2.5, s) for s in (30, 60, 200, 300)]:
        gap = ratio * D90
        r = spread(f"layer-{ratio}-{speed}", [f'process.gap="{gap * 1e6:.1f} um"', f'process.blade_speed="{speed} mm/s"',
                                              'machine.platform.length="3 mm"', "design_space.dosage_factor=3.5"])
        flight = speed * 1e-3 * math.sqrt(2 * gap / 9.81)
        if r["status"] != "ok":
            rows.append(f"| {ratio:.1f} | {gap * 1e6:.0f} | {speed} | {flight * 1e3:.2f} | {r['status']} | | |")
            continue
        packing = along(r, gap)
        half = packing[len(packing) // 2:]
        rows.append(f"| {ratio:.1f} | {gap * 1e6:.0f} | {speed} | {flight * 1e3:.2f} | {number(r['packing_fraction'], 3)} | "
                    f"{sum(half) / len(half):.3f} | {number(r['coverage'])} |")
    return "\n".join(rows)


def plate():
    rows = ["| on gap/D90 = 1.8 | packing, whole platform | packing, second half | coverage |", "|---|---|---|---|"]
    gap = 1.8 * D90
    common = [f'process.gap="{gap * 1e6:.1f} um"', 'machine.platform.length="3 mm"']
    bare = ['process.substrate="plate"']
    slow = ['process.blade_speed="30 mm/s"']
    dry = ['interaction.work_of_adhesion="0 J/m2"']
    for label, name, values in [("bare plate, 100 mm/s", "bare", bare), ("fused", "fused", []),
                                ("bare, no adhesion", "dry", bare + dry), ("bare, 30 mm/s", "slow", bare + slow),
                                ("bare, no adhesion, 30 mm/s", "slowdry", bare + slow + dry),
                                ("bare, friction 0.3", "mu3", bare + ["interaction.static_friction=0.3"]),
                                ("bare, rolling spring, rolling friction 0.4", "stiffroll",
                                 bare + ['interaction.rolling_model="spring"', "interaction.rolling_friction=0.4"])]:
        r = spread("plate-" + name, common + values)
        if r["status"] != "ok":
            rows.append(f"| {label} | {r['status']} | | |")
            continue
        packing = along(r, gap)
        half = packing[len(packing) // 2:]
        rows.append(f"| {label} | {number(r['packing_fraction'], 3)} | {sum(half) / len(half):.3f} | {number(r['coverage'])} |")
    return "\n".join(rows)


def flight():
    rows = ["| blade mm/s | gravity m/s2 | flight mm | captured | packing along x, columns of 0.2 mm |", "|---|---|---|---|---|"]
    gap = 140e-6
    for speed, gravity in ((50, 9.81), (100, 9.81), (200, 9.81), (200, 39.24)):
        r = spread(f"flight-{speed}-{gravity}", [f'process.blade_speed="{speed} mm/s"', f'process.gravity="{gravity} m/s2"'])
        fly = speed * 1e-3 * math.sqrt(2 * gap / gravity)
        if r["status"] != "ok":
            rows.append(f"| {speed} | {gravity:g} | {fly * 1e3:.2f} | {r['status']} | |")
            continue
        rows.append(f"| {speed} | {gravity:g} | {fly * 1e3:.2f} | {number(r['capture_fraction'])} | "
                    + " ".join(f"{p:.2f}" for p in along(r, gap)) + " |")
    return "\n".join(rows)


fill(PAGE, {"flight": flight, "repose": repose, "gi": gi, "layer": layer, "plate": plate})
