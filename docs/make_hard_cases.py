#!/usr/bin/env python3
"""Writes the tables of docs/hard-cases.md from runs of the program. Usage, from the project's root:

    python3 docs/make_hard_cases.py [cases] [edges] [sticking]

Needs nothing but Python's standard library. Nothing is kept between calls: the page is what the program of today does.
GRADWRIGHT in the environment names another program than ./gradwright.
"""
import json
import os

from measured import ROOT, fill, said

PAGE = os.path.join(ROOT, "docs", "hard-cases.md")


def limits(part):
    """What `gradwright limits --part PART` answers."""
    return json.loads(said(["limits", "--part", part, "--json", "--quiet"], (0, 4)))


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


fill(PAGE, {"cases": cases_table, "edges": edges_table, "sticking": sticking_table})
