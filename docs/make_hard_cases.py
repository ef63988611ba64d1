#!/usr/bin/env python3
"""Writes the tables of docs/hard-cases.md from runs of the program. Usage, from the project's root:

    python3 docs/make_hard_cases.py [cases] [edges] [sticking]

Needs nothing but Python's standard library. Nothing is kept between calls: the page is what the program of today does.
GRADWRIGHT in the environment names another program than ./gradwright.
"""
import json
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGE = os.path.join(ROOT, "docs", "hard-cases.md")


def limits(part):
    """What `gradwright limits --part PART` answers."""
    print("running: gradwright limits --part", part, file=sys.stderr, flush=True)
    done = subprocess.run([os.environ.get("GRADWRIGHT", "./gradwright"), "limits", "--part", part, "--json", "--quiet"], cwd=ROOT, stdout=subprocess.PIPE)
    if done.returncode not in (0, 4):
        sys.exit(f"gradwright limits --part {part} ended with {done.returncode}")
    return json.loads(done.stdout)


def cell(text):
    return text.replace("|", "\\|")


def cases_table():
    rows = ["| case | tried | must | happened | |", "|---|---|---|---|---|"]
    for c in limits("cases")["cases"]:
        rows.append(f"| `{c['id']}` | {cell(c['tried'])} | {cell(c['expected'])} | {cell(c['happened'])} | {'as it must' if c['pass'] else '**not as it must**'} |")
    return "\n".join(rows)


def edges_table():
    answer = limits("edges")
    edges = answer["edges"]
    rows = []
    for packing, first in (("heap", "size ratio"), ("wedge", None)):
        mine = [e for e in edges if e["packing"] == packing]
        laws = list(dict.fromkeys(e["law"] for e in mine))
        if packing == "heap":
            rows.append("Heap under load, by size ratio and largest overlap asked for (of the smaller radius); in brackets what the law and "
                        "the load came to:\n")
        else:
            rows.append("\nOne grain wedged between two plates, by overlap on either side:\n")
        columns = [e for e in mine if e["law"] == laws[0]]
        heads = [f"{e['size_ratio']:.0f}, {100 * e['overlap_asked']:.1f} %" if packing == "heap" else f"{100 * e['overlap_asked']:.1f} %"
                 for e in columns]
        rows.append("| law | " + " | ".join(heads) + " |")
        rows.append("|---|" + "---|" * len(heads))
        for law in laws:
            rows.append(f"| {law} | " + " | ".join(f"{e['edge']:.2f} ({100 * e['overlap']:.1f} %)" for e in mine if e["law"] == law) + " |")
    small = [e for e in edges if e["overlap"] < 0.15 and "e 0.5" in e["law"] and "unlimited" not in e["law"]]
    lowest = min(small, key=lambda e: e["edge"])
    rows.append(f"\nLowest with e = 0.5, to 10 % overlap: {lowest['edge']:.2f} ({lowest['law']}, {lowest['packing']}"
                + (f", size ratio {lowest['size_ratio']:.0f}" if lowest["packing"] == "heap" else "")
                + f"). The program takes {answer['stability_edge']:.2f} as the edge; the default step of 0.2 is a factor "
                f"{lowest['edge'] / 0.2:.1f} below the lowest.")
    return "\n".join(rows)


def sticking_table():
    rows = ["| size ratio | 1 to 30 degrees, exact ms | engine ms | engine | with half-step velocities |", "|---|---|---|---|---|"]

    def end(one):
        return f"falls, last on the saddle at {one['farthest_angle_deg']:.0f} degrees" if one["fell"] else "**sticks**: goes round and does not fall"

    for s in limits("sticking")["sticking"]:
        rows.append(f"| {s['size_ratio']:.0f} | {1e3 * s['expected_seconds']:.2f} | {1e3 * s['seconds']:.2f} | {end(s)} | {end(s['late_velocity'])} |")
    return "\n".join(rows)


def main():
    parts = {"cases": cases_table, "edges": edges_table, "sticking": sticking_table}
    chosen = sys.argv[1:] or list(parts)
    unknown = [c for c in chosen if c not in parts]
    if unknown:
        sys.exit(f"unknown part {unknown[0]}: choose from {', '.join(parts)}")
    for name in chosen:
        table = parts[name]()
        with open(PAGE) as file:
            page = file.read()
        begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
        head, rest = page.split(begin)
        tail = rest.split(end)[1]
        with open(PAGE, "w") as file:
            file.write(head + begin + "\n" + table + "\n" + end + tail)


if __name__ == "__main__":
    main()
