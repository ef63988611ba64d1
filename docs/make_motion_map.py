#!/usr/bin/env python3
"""Writes the tables of docs/motion-map.md from runs of the program. Usage, from the project's root:

    python3 docs/make_motion_map.py

Fifteen narrow strips (five lands, three dosage factors; six minutes on two cores), each read at three places of the part. What the
program answered is kept in docs/data/motion-map.json; delete it to measure again. GRADWRIGHT in the environment names another program
than ./gradwright, THREADS the number of threads. Needs nothing but Python's standard library.
"""
import json
import os

from measured import ROOT, put, ran

PAGE = os.path.join(ROOT, "docs", "motion-map.md")
DATA = os.path.join(ROOT, "docs", "data", "motion-map.json")
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
                command = [*words(land, dose, place), "--json", "--quiet", "--force", "--out",
                           os.path.join(ROOT, "runs", "motion-map")]
                if "THREADS" in os.environ:
                    command += ["--threads", os.environ["THREADS"]]
                done = ran(command)
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


def turnovers(row):
    """Way to the part's middle in heap lengths: (land + middle) / sqrt(h L_d), h = dosage factor x 40 um, L_d = 3.2 mm."""
    return (row["land_mm"] + 2.4 + row["place_mm"]) / (row["dosage_factor"] * 0.04 * 3.2) ** 0.5


def rms(values):
    return (sum(v * v for v in values) / len(values)) ** 0.5


def law_table(rows):
    out = ["| turnovers on the way to the part | motions | x drift of the best straight partition, rms | its noise floor, rms | its misfit, rms | best folded curve: 95 % bound of its drift, median |",
           "|---|---|---|---|---|---|"]
    for low, high in ((2, 4), (4, 6), (6, 7.5), (7.5, 9.6), (9.6, 11.5), (11.5, 18)):
        some = [r for r in rows if low <= turnovers(r) < high]
        bounds = sorted(r["x_drift"]["interval"][1] for r in some)
        out.append(f"| {low} to {high} | {len(some)} | {rms([r['straight']['x_drift']['value'] for r in some]):.2f} | "
                   f"{rms([r['straight']['x_drift']['noise_floor'] for r in some]):.2f} | {rms([r['straight']['misfit']['value'] for r in some]):.3f} | "
                   f"{bounds[len(bounds) // 2]:.2f} |")
    return "\n".join(out)


def motions_table(rows):
    out = ["| land mm | dosage factor | captured f | coverage | mean origin / L_d by sixths of the platform | x drift (floor) of the best straight partition, part at 0 to 1.6 mm | at 0.8 to 2.4 mm | at 1.6 to 3.2 mm |",
           "|---|---|---|---|---|---|---|---|"]
    for land in LANDS:
        for dose in DOSES:
            three = [r for r in rows if r["land_mm"] == land and r["dosage_factor"] == dose]
            last = three[-1]
            cells = [f"{r['straight']['x_drift']['value']:.2f} ({r['straight']['x_drift']['noise_floor']:.2f}), N {turnovers(r):.1f}" for r in three]
            origins = " ".join(f"{m:.2f}" for m in last["turnover"]["origin_mean"])
            out.append(f"| {land} | {dose} | {last['capture_fraction']:.2f} | {last['coverage']:.2f} | {origins} | {' | '.join(cells)} |")
    return "\n".join(out)


def figure(rows):
    """x drift of the best straight partition against turnovers, one mark a motion, as SVG."""
    width, height, left, bottom, top, right = 720, 360, 62, 52, 18, 150
    x = lambda n: left + (n - 1) / 17 * (width - left - right)
    y = lambda d: height - bottom - d / 0.35 * (height - bottom - top)
    colours = dict(zip(LANDS, ("#0072b2", "#56b4e9", "#009e73", "#e69f00", "#d55e00")))  # Okabe and Ito, safe for the colour-blind
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13" role="img" '
           'aria-label="x drift of the best straight partition against turnovers of the heap on the way to the part">',
           f'<rect width="{width}" height="{height}" fill="#fff"/>',
           f'<rect x="{x(7.5):.1f}" y="{top}" width="{x(9.6) - x(7.5):.1f}" height="{height - bottom - top}" fill="#eef3e6"/>']
    for d in (0, 0.1, 0.2, 0.3):
        out.append(f'<path d="M{left} {y(d):.1f}H{width - right}" stroke="{"#888" if d == 0.1 else "#ddd"}" {"stroke-dasharray=" + chr(34) + "5 4" + chr(34) if d == 0.1 else ""}/>'
                   f'<text x="{left - 8}" y="{y(d) + 4:.1f}" text-anchor="end">{d:g}</text>')
    for n in range(2, 19, 2):
        out.append(f'<text x="{x(n):.1f}" y="{height - bottom + 18}" text-anchor="middle">{n}</text>')
    for r in rows:
        cx, cy, c = x(turnovers(r)), y(r["straight"]["x_drift"]["value"]), colours[r["land_mm"]]
        size = {2.0: 3.5, 3.0: 5.0, 4.5: 6.5}[r["dosage_factor"]]
        out.append(f'<circle cx="{cx:.1f}" cy="{cy:.1f}" r="{size}" fill="{c}" fill-opacity="0.75" stroke="#333" stroke-width="0.6"/>')
    for k, land in enumerate(LANDS):
        out.append(f'<circle cx="{width - right + 20}" cy="{top + 14 + 20 * k}" r="5" fill="{colours[land]}"/><text x="{width - right + 32}" y="{top + 18 + 20 * k}">land {land} mm</text>')
    for k, dose in enumerate(DOSES):
        out.append(f'<circle cx="{width - right + 20}" cy="{top + 130 + 20 * k}" r="{[3.5, 5, 6.5][k]}" fill="none" stroke="#333"/><text x="{width - right + 32}" y="{top + 134 + 20 * k}">dosage {dose:g}</text>')
    out.append(f'<text x="{(left + width - right) / 2}" y="{height - 10}" text-anchor="middle">turnovers of the heap on the way to the part, (land + middle of the part) / √(h L)</text>')
    out.append(f'<text transform="translate(18 {(height - bottom) / 2 + top}) rotate(-90)" text-anchor="middle">x drift, straight partition</text>')
    out.append("</svg>\n")
    with open(os.path.join(ROOT, "docs", "images", "motion_map.svg"), "w") as file:
        file.write("\n".join(out))


def main():
    if not os.path.exists(DATA):
        rows = measure()
        os.makedirs(os.path.dirname(DATA), exist_ok=True)
        with open(DATA, "w") as file:
            json.dump(rows, file, indent=1)
    with open(DATA) as file:
        rows = [row for row in json.load(file) if row.get("turnover")]
    put(PAGE, "law", law_table(rows))
    put(PAGE, "motions", motions_table(rows))
    figure(rows)


main()
