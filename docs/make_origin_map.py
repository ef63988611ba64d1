#!/usr/bin/env python3
"""Writes the tables of docs/origin-map.md from runs of the program. Usage, from the project's root:

    python3 docs/make_origin_map.py [turnover] [evidence] [light] [beds] [coverage] [unlike]

`light` adds a row to the evidence: the first study's partition with a powder B of 0.54 times the density.
Results are kept in runs/origin-map/, so that a second call only rewrites the page; --kept runs nothing at all. Needs nothing but Python's standard library.
"""
import json
import os
import sys

from measured import DOCS, ROOT, put, ran

RUNS = os.path.join(ROOT, "runs", "origin-map")
STUDY = "examples/01_linear_coupon.toml"


def program(arguments, name):
    """Output of one call as JSON, kept under runs/origin-map/NAME.json."""
    kept = os.path.join(RUNS, name + ".json")
    if not os.path.exists(kept) and "--kept" in sys.argv:
        return None
    if not os.path.exists(kept):
        os.makedirs(RUNS, exist_ok=True)
        done = ran([*arguments, "--json"])
        if done.returncode not in (0, 4):
            return None
        with open(kept, "wb") as file:
            file.write(done.stdout)
    with open(kept) as file:
        return json.load(file)


def turnover_table():
    rows = ["| L_d = L_b mm | land mm | captured f | supply ratio | mean origin / L_d, first -> last sixth of the platform | local sd / L_d | profile rms, best curve | its x drift | profile rms, best straight | its x drift |",
            "|---|---|---|---|---|---|---|---|---|---|"]
    for length, land in ((1.6, 0.2), (3.2, 0.2), (6.4, 0.2), (3.2, 3.2), (3.2, 6.4), (3.2, 12.8)):
        name = f"turnover-{length}-{land}"
        r = program(["design", STUDY, "--budget", "1", "--set", "run.map_spreads=1", "--force", "--out", os.path.join(RUNS, name),
                     "--set", f'machine.dispenser.length="{length} mm"', "--set", f'machine.platform.length="{length} mm"',
                     "--set", f'machine.land="{land} mm"',
                     "--set", f'target.footprint.x=["{length / 2} mm", "{length} mm"]'], name)
        if r is None or r["predicted"]["turnover"] is None:
            rows.append(f"| {length} | {land} | not measured | | | | | | | |")
            continue
        p, straight, t = r["predicted"], r["straight"], r["predicted"]["turnover"]
        mean, sd = t["origin_mean"], t["origin_deviation"]
        rows.append(f"| {length} | {land} | {p['capture_fraction']:.2f} | {p['supply_ratio']:.2f} | "
                    + " ".join("–" if m is None else f"{m:.2f}" for m in mean)
                    + f" | {min(s for s in sd if s is not None):.2f}-{max(s for s in sd if s is not None):.2f} | {p['misfit']['value']:.3f} (floor {p['misfit']['noise_floor']:.3f}) | "
                      f"{p['x_drift']['value']:.3f} (floor {p['x_drift']['noise_floor']:.3f}) | {straight['misfit']['value']:.3f} | "
                      f"{straight['x_drift']['value']:.3f} (floor {straight['x_drift']['noise_floor']:.3f}) |")
    return "\n".join(rows)


def rms(a, b, weight):
    pairs = [(x - y) ** 2 for x, y, w in zip(a, b, weight) if x is not None and y is not None and w]
    return (sum(pairs) / len(pairs)) ** 0.5 if pairs else float("nan")


def evidence_table():
    rows = ["| design, B | kinematic against DEM, rms | origin map against DEM, rms | noise of both, rms | captured f | x drift, DEM | beds |",
            "|---|---|---|---|---|---|---|"]
    # A material of the same stiffness and 0.54 times the density: only the motion differs.
    light = ["--set", 'powder.B.material={density="4309 kg/m3", youngs_modulus="195 GPa", poissons_ratio=0.3}']
    for label, study, extra in (("01, IN718 (density ratio 0.97)", STUDY, []),
                                ("02, IN718 (density ratio 0.97)", "examples/02_sigmoid_coupon.toml", []),
                                ("01, density ratio 0.54", STUDY, light)):
        stem = study.split("/")[1][:2]
        if extra and "light" not in sys.argv and not os.path.exists(os.path.join(RUNS, "light-" + stem + ".json")):
            continue
        designed = program(["design", study, "--force", "--out", os.path.join(RUNS, "design-" + stem)], "design-" + stem)
        if designed is None:
            rows.append(f"| {label} | not measured | | | | | |")
            continue
        folder = os.path.join(RUNS, "design-" + stem, "result.json")
        if extra:
            # the same partition, spread with the light powder on a bed of its own
            dem = program(["evaluate", study, "--fidelity", "full", "--design", folder, "--seed", "77", *extra], "light-" + stem)
            if dem is None:
                continue
            profile, beds, drift, f = dem["profile"]["gi"], 1, dem["x_drift"]["value"], dem["capture_fraction"]
            error = dem["profile"]["standard_error"]
        else:
            profile, beds = designed["profile"]["confirmed"], designed["spreads"]["full"]
            drift, f, error = designed["x_drift"]["value"], designed["capture_fraction"], designed["profile"]["standard_error"]
        kinematic = program(["evaluate", study, "--fidelity", "kinematic", "--design", folder], "kinematic-" + stem)
        weight = designed["profile"]["weight"]
        map_gi, map_error = designed["profile"]["predicted"], designed["profile"]["predicted_standard_error"]
        noise = rms([(a * a + b * b) ** 0.5 if a is not None and b is not None else None for a, b in zip(error, map_error)],
                    [0] * len(error), weight)
        rows.append(f"| {label} | {rms(kinematic['profile']['gi'], profile, weight):.3f} | {rms(map_gi, profile, weight):.3f} | {noise:.3f} | "
                    f"{f:.2f} | {drift:.3f} | {beds} |")
    return "\n".join(rows)


def beds_table():
    """Standard errors of single strips against what lies between sixteen of them, under the partition that the study's design has found."""
    out = os.path.join(RUNS, "design-01")
    if program(["design", STUDY, "--force", "--out", out], "design-01") is None:
        return "*Not measured yet with the present engine: the command above fills this table.*"
    beds = [program(["evaluate", STUDY, "--fidelity", "map", "--design", os.path.join(out, "result.json"), "--set", "run.map_spreads=1",
                     "--seed", str(seed)], f"bed-{seed}") for seed in range(11, 27)]
    if None in beds:
        return "*Not measured yet with the present engine: the command above fills this table.*"
    weight = beds[0]["profile"]["weight"]
    counting = [b for b, w in enumerate(weight) if w]

    def row(label, values, errors, ratio):
        n, between, told = len(values), 0, 0
        for b in counting:
            mean = sum(v[b] for v in values) / n
            between += sum((v[b] - mean) ** 2 for v in values) / (n - 1)
            told += sum(e[b] ** 2 for e in errors) / n
        between, told = (between / len(counting)) ** 0.5, (told / len(counting)) ** 0.5
        return f"| {label} | {between:.3f} | {told / ratio ** 0.5:.3f} | {(between / told) ** 2 * ratio:.2f} | {ratio} | {told:.3f} |"

    return "\n".join([
        "| rms over the bins that count | sd between 16 beds | error told by the blocks of one bed | ratio of the variances | allowed for | error quoted |",
        "|---|---|---|---|---|---|",
        row("GI, all grains of a strip for every y, mirrored", [b["profile"]["gi"] for b in beds],
            [b["profile"]["standard_error"] for b in beds], 2.5),
        row("its x drift", [b["x_drift"]["profile"]["difference"] for b in beds],
            [b["x_drift"]["profile"]["standard_error"] for b in beds], 2.1),
        row("GI, bins of their own grains", [b["plain_bins"]["gi"] for b in beds],
            [b["plain_bins"]["standard_error"] for b in beds], 2.3),
        row("its x drift", [b["plain_bins"]["x_drift"]["difference"] for b in beds],
            [b["plain_bins"]["x_drift"]["standard_error"] for b in beds], 1.25)])


SMALL = ["--set", 'machine.dispenser.length="1.6 mm"', "--set", 'machine.platform.length="1.6 mm"', "--set", 'machine.land="1.6 mm"',
         "--set", 'target.footprint.x=["0.8 mm", "1.6 mm"]']


def coverage_table():
    """How often the 95 % band of one bed holds what the nineteen others say on average."""
    rows = ["| simultaneous 95 % band of one bed | beds whose band holds every bin | single bins held | sd between beds, rms | error quoted, rms |", "|---|---|---|---|---|"]
    for fidelity, what in (("map", "strip"), ("full", "full width, both powders")):
        beds = [program(["evaluate", STUDY, "--fidelity", fidelity, "--set", "run.map_spreads=1", "--seed", str(seed), *SMALL], f"small-{fidelity}-{seed}")
                for seed in range(101, 121)]
        if None in beds:
            rows.append(f"| {what} | *not measured yet: the command above fills this row* | | | |")
            continue
        n = len(beds)
        counting = [b for b, w in enumerate(beds[0]["profile"]["weight"]) if w]

        def row(label, value, low, high):
            whole, bins, between, told = 0, 0, 0, 0
            for k, bed in enumerate(beds):
                inside = 0
                for b in counting:
                    others = sum(value(o)[b] for j, o in enumerate(beds) if j != k) / (n - 1)
                    inside += low(bed)[b] <= others <= high(bed)[b]
                bins += inside
                whole += inside == len(counting)
            for b in counting:
                mean = sum(value(o)[b] for o in beds) / n
                between += sum((value(o)[b] - mean) ** 2 for o in beds) / (n - 1) / len(counting)
            errors = [e for bed in beds for e in (bed["profile"]["standard_error"] if label.endswith("GI(y)") else bed["x_drift"]["profile"]["standard_error"])]
            told = sum(e * e for i, e in enumerate(errors) if i % len(beds[0]["profile"]["weight"]) in counting) / (n * len(counting))
            return f"| {label} | {whole} of {n} | {bins} of {n * len(counting)} | {between ** 0.5:.3f} | {told ** 0.5:.3f} |"

        def drift(bed, sign):
            p = bed["x_drift"]["profile"]
            return [d + sign * p["band_factor"] * s for d, s in zip(p["difference"], p["standard_error"])]

        rows.append(row(f"{what}: GI(y)", lambda e: e["profile"]["gi"], lambda e: e["profile"]["band_low"], lambda e: e["profile"]["band_high"]))
        rows.append(row(f"{what}: x drift", lambda e: e["x_drift"]["profile"]["difference"], lambda e: drift(e, -1), lambda e: drift(e, 1)))
    return "\n".join(rows)


def unlike_table():
    rows = ["| design | B beside A | one partition on a strip of B against A's strips, rms (noise) | predicted misfit, x drift | spreads | confirmed misfit (95 % bound, tolerance) | x drift (95 % bound, tolerance) | verdict |",
            "|---|---|---|---|---|---|---|---|"]
    for study, what in (("04_unlike_alloys", "0.54 times the density"), ("06_316l_cucrzr", "1.12 times the density"),
                        ("07_two_sizes", "D50 50 um beside 30 um")):
        r = program(["design", f"examples/{study}.toml", "--force", "--out", os.path.join(RUNS, "unlike-" + study)], "unlike-" + study)
        if r is None:
            rows.append(f"| {study[:2]} | {what} | not measured | | | | | |")
            continue
        gate, p, n = r["powder_gate"], r["predicted"], r["spreads"]
        m, d = r["misfit"], r["x_drift"]
        held = "no strip of B" if gate is None else f"{gate['difference']:.3f} ({gate['noise']:.3f})" + (" passes" if gate["passes"] else " fails")
        rows.append(f"| {study[:2]} | {what} | {held} | {p['misfit']['value']:.3f}, {p['x_drift']['value']:.3f} | "
                    f"{n['map']} strips, {n['full']} full | {m['value']:.3f} ({m['interval'][1]:.3f}, {m['tolerance']:.2f}) | "
                    f"{d['value']:.3f} ({d['interval'][1]:.3f}, {d['tolerance']:.2f}) | {r['verdict'].replace('_', ' ')} |")
    return "\n".join(rows)


def main():
    wanted = [a for a in sys.argv[1:] if a != "--kept"] or ["turnover", "evidence", "beds", "coverage", "unlike"]
    if "light" in wanted:
        wanted.append("evidence")
    for name, table in (("turnover", turnover_table), ("evidence", evidence_table), ("beds", beds_table), ("coverage", coverage_table),
                        ("unlike", unlike_table)):
        if name in wanted:
            put(os.path.join(DOCS, "origin-map.md"), name, table())


main()
