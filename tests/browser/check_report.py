#!/usr/bin/python3
"""Opens OUT/report.html in headless Chromium and holds what it draws against OUT/result.json and OUT/report_data.json.

    tests/browser/check_report.py OUT [--pictures FOLDER]

Marks are read back from the drawn figures, through the figures' own scales, into numbers. Exit code 0 when every one of them is
the JSON's, the grains are those of the particle files, nothing complains on the console, every control can be reached and worked
by keyboard, nothing is wider than a phone, and the page prints and works without WebGL. `--pictures` keeps screenshots at desk and
phone width and the paper version. Needs chromium, python3-h5py and poppler-utils.
"""
import argparse
import base64
import bisect
import json
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from chromium import Chromium  # noqa: E402

# Every figure as numbers: pixels go back through the plot's scales. A path has its coordinates rounded to 1e-3 px.
COLLECT = r"""(() => {
  const number = (node, name) => Number(node.getAttribute(name));
  const back = (scale, px) => (scale && scale.invert ? scale.invert(px) : px);
  return [...document.querySelectorAll("figure > .plot, .card > .plot")].map((box) => ({
    title: box.parentNode.querySelector("h3").textContent,
    plots: [...box.querySelectorAll("figure, svg")].filter((root) => root.scale).map((root) => {
      const x = root.scale("x"), y = root.scale("y"), colour = root.scale("color");
      const group = (name) => [...root.querySelectorAll(`g[aria-label="${name}"]`)];
      const title = (node) => node.querySelector("title")?.textContent ?? "";
      const rect = (r) => ({ x1: back(x, number(r, "x")), x2: back(x, number(r, "x") + number(r, "width")), y2: back(y, number(r, "y")), y1: back(y, number(r, "y") + number(r, "height")), fill: r.getAttribute("fill") ?? r.parentNode.getAttribute("fill"), title: title(r) });
      return {
        x: x?.domain, y: y?.domain, colours: colour?.apply && colour.type === "linear" ? [0, 0.25, 0.5, 0.75, 1].map((t) => colour.apply(t)) : null,
        dots: group("dot").map((g) => [...g.children].map((d) => {
          const moved = /translate\(([-\d.e]+),([-\d.e]+)\)/.exec(d.getAttribute("transform") ?? "");
          return [back(x, moved ? Number(moved[1]) : number(d, "cx")), back(y, moved ? Number(moved[2]) : number(d, "cy"))];
        })),
        lines: group("line").flatMap((g) => [...g.children].map((p) => [...p.getAttribute("d").matchAll(/(-?[\d.]+(?:e-?\d+)?),(-?[\d.]+(?:e-?\d+)?)/g)].map((m) => [back(x, Number(m[1])), back(y, Number(m[2]))]))),
        rects: group("rect").map((g) => [...g.children].map(rect)),
        bars: group("bar").map((g) => [...g.querySelectorAll("rect")].map(rect)),
        rules: group("rule").map((g) => [...g.children].map((l) => [back(x, number(l, "x1")), back(y, number(l, "y1")), back(y, number(l, "y2")), back(x, number(l, "x2"))])),
        texts: group("text").flatMap((g) => [...g.children].map((t) => t.textContent)),
      };
    }),
  }));
})()"""
# The colour that the figure called `title` gives to values.
COLOURS = r"""((title, nth, values) => {
  const box = [...document.querySelectorAll("figure > .plot")].find((b) => b.parentNode.querySelector("h3").textContent === title);
  const roots = [...box.querySelectorAll("figure, svg")].filter((root) => root.scale);
  return values.map((v) => roots[nth].scale("color").apply(v));
})"""


def known(value):
    return value is not None and math.isfinite(value)


class Figures:
    """The figures of the page by title, and the comparisons; `values` counts what was held against the JSON."""

    def __init__(self, browser):
        self._browser = browser
        self._all = browser.run(COLLECT)
        self.values, self.checked = 0, set()

    def titles(self):
        return [f["title"] for f in self._all]

    def plots(self, title):
        found = [f for f in self._all if f["title"] == title]
        assert len(found) == 1, f"the page has {len(found)} figures '{title}'; it has {self.titles()}"
        self.checked.add(title)
        return found[0]["plots"]

    def plot(self, title):
        (only,) = self.plots(title)
        return only

    def same(self, what, shown, wanted, domain):
        """Numbers equal to 1e-4 of the axis: 1e-3 px of a path are 1e-5 of the narrowest plot."""
        assert len(shown) == len(wanted), f"{what}: {len(shown)} drawn, {len(wanted)} in the JSON"
        allowed = 1e-4 * abs(domain[-1] - domain[0])
        for k, (a, b) in enumerate(zip(shown, wanted)):
            assert abs(a - b) <= allowed, f"{what}[{k}]: drawn {a}, in the JSON {b}"
        self.values += len(wanted)

    def points(self, what, plot, shown, wanted):
        self.same(what + " x", [p[0] for p in shown], [p[0] for p in wanted], plot["x"])
        self.same(what + " y", [p[1] for p in shown], [p[1] for p in wanted], plot["y"])

    def cells(self, title, nth, what, plot, cells, wanted):
        """`wanted`: (x, y, value) of every cell's centre; drawn as rectangles of the value's colour."""
        self.same(what + " x", [(c["x1"] + c["x2"]) / 2 for c in cells], [w[0] for w in wanted], plot["x"])
        self.same(what + " y", [(c["y1"] + c["y2"]) / 2 for c in cells], [w[1] for w in wanted], plot["y"])
        colours = self._browser.run(f"{COLOURS}({json.dumps(title)}, {nth}, {json.dumps([w[2] for w in wanted])})")
        for k, (cell, colour) in enumerate(zip(cells, colours)):
            assert cell["fill"] == colour, f"{what}[{k}]: drawn {cell['fill']}, the JSON's {wanted[k][2]} is {colour}"
        self.values += len(wanted)


def pairs(xs, ys, scale=1e3):
    return [(scale * x, y) for x, y in zip(xs, ys) if known(y)]


def check_gradation(figures, result, data):
    profile, plan = result["profile"], data["plan"]
    title = "GI(y): means along x" if result.get("field") else "Target, predicted and confirmed GI(y)"
    if title in figures.titles():
        plot, y = figures.plot(title), profile["y_m"]
        series = [pairs(y, profile[name]) for name in ("target", "predicted", "confirmed")]
        for name, line, wanted in zip(("target", "predicted", "confirmed"), plot["lines"], series):
            figures.points(f"{title}: line of {name}", plot, line, wanted)
        assert len(plot["lines"]) == sum(bool(s) for s in series), plot["lines"]
        left_out = pairs(y, (profile.get("left_out") or {}).get("confirmed") or [])
        for name, dots, wanted in zip(("predicted", "confirmed", "left out"), [g for g in plot["dots"] if g], [s for s in (*series[1:], left_out) if s]):
            figures.points(f"{title}: dots of {name}", plot, dots, wanted)
        bands = [(1e3 * a, low, high) for a, low, high in zip(y, profile["band_low"], profile["band_high"]) if known(low) and known(high)]
        drawn = plot["rects"][0] if plot["rects"] else []
        figures.same("band x", [(r["x1"] + r["x2"]) / 2 for r in drawn], [b[0] for b in bands], plot["x"])
        figures.same("band low", [r["y1"] for r in drawn], [b[1] for b in bands], plot["y"])
        figures.same("band high", [r["y2"] for r in drawn], [b[2] for b in bands], plot["y"])

        title = "x drift of each bin"
        plot, drift = figures.plot(title), result["x_drift"]["profile"]
        wanted = pairs(y, drift["difference"])
        asked = pairs(y, drift.get("target") or [])
        groups = [g for g in plot["dots"] if g]
        figures.points(title, plot, groups[-1], wanted)
        if asked:
            figures.points(title + ": asked", plot, groups[0], asked)
        errors = [drift["band_factor"] * (e or 0) for d, e in zip(drift["difference"], drift["standard_error"]) if known(d)]
        bars = plot["rules"][-1]
        figures.same(title + ": lower bound", [min(b[1], b[2]) for b in bars], [w[1] - e for w, e in zip(wanted, errors)], plot["y"])
        figures.same(title + ": upper bound", [max(b[1], b[2]) for b in bars], [w[1] + e for w, e in zip(wanted, errors)], plot["y"])
        tolerance = result["x_drift"]["tolerance"]
        figures.same(title + ": tolerance", sorted(r[1] for r in plot["rules"][0]), [-tolerance, tolerance], plot["y"])

    layers = result.get("layers") or []
    if len(layers) > 1:
        plot = figures.plot("GI(y) layer by layer")
        wanted = [p for layer in layers for p in pairs(layer["y_m"], layer["gi"])]
        figures.points("layers", plot, plot["dots"][-1], wanted)

    if data["map"]:
        cells = [(1e3 * x, 1e3 * y, gi) for (x, y), gi in
                 zip(((x, y) for y in data["map"]["y_m"] for x in data["map"]["x_m"]), data["map"]["gi"]) if known(gi)]
        plot = figures.plot("GI over the platform")
        figures.cells("GI over the platform", 0, "map", plot, plot["rects"][1], cells)
        # 0 is orange, 1 blue, and the middle lighter than both: what the legend and the words say
        red, _, blue = (int(v) for v in re.findall(r"\d+", plot["colours"][4]))
        assert blue > red + 100, plot["colours"]
        start = 1e3 * (plan["dispenser_length_m"] + plan["land_m"])
        plot = figures.plot("From the partition to the layer")
        drawn = next(g for g in plot["rects"] if len(g) == len(cells))
        figures.cells("From the partition to the layer", 0, "map in the plan", plot, drawn, [(start + x, y, gi) for x, y, gi in cells])

    def in_mm(points):
        return [(1e3 * x, 1e3 * y) for x, y in points]

    outlines, curves = ([in_mm(plan.get(k) or []) for k in keys] for keys in (("outline_a", "outline_b"), ("curve", "curve2")))
    for title, wanted in (("From the partition to the layer", outlines + 2 * curves), ("What to build", [*outlines, in_mm(plan["straight"]), *curves])):
        plot, wanted = figures.plot(title), [points for points in wanted if points]
        assert len(plot["lines"]) == len(wanted), f"{title}: {len(plot['lines'])} lines drawn, {len(wanted)} in the JSON"
        for k, (line, points) in enumerate(zip(plot["lines"], wanted)):
            figures.points(f"{title}: line {k}", plot, line, points)

    field = result.get("field")
    if field:
        title = f"Target, {field['of']} and their difference over x and y"
        for nth, (plot, name) in enumerate(zip(figures.plots(title), ("target", field["of"]))):
            wanted = []
            for j, y in enumerate(field["y_m"]):
                for i, x in enumerate(field["x_m"]):
                    value = field[name][j][i]
                    if not known(value):
                        value = (field["left_out"].get(name) or [[None] * len(field["x_m"])] * len(field["y_m"]))[j][i]
                    if known(value):
                        wanted.append((1e3 * x, 1e3 * y, value))
            figures.cells(title, nth, f"field, {name}", plot, plot["rects"][0], wanted)

    origin = data["origin"]
    if origin:
        n, length, platform = origin["cells"], 1e3 * origin["dispenser_length_m"], 1e3 * origin["platform_length_m"]
        wanted = [((k % n + 0.5) * platform / n, (k // n + 0.5) * length / n, 100 * share) for k, share in enumerate(origin["share"]) if share > 0]
        plot = figures.plot("Where the powder comes from")
        figures.cells("Where the powder comes from", 0, "origins", plot, plot["rects"][1], wanted)
        plot = figures.plot("W(origin): the dispenser's share in the part")
        figures.points("W", plot, plot["lines"][-1], [(i * length / n, w) for i, w in enumerate(origin["cumulative"]) if known(w)])
    heap = result.get("extrapolated")
    if heap:
        plot = figures.plot("Order of the dispenser left in the layer, strip by strip")
        figures.points("strips", plot, plot["dots"][-1], [(s["turnovers"], s["profile_order"]) for s in heap["strips"]])


def check_search(figures, result):
    for title, name in (("Convergence of the misfit", "misfit"), ("Convergence of the x drift", "x_drift")):
        if result["history"]:
            plot = figures.plot(title)
            figures.points(title, plot, plot["dots"][0], [(k + 1, e[name]) for k, e in enumerate(result["history"]) if known(e[name])])
            figures.same(title + ": tolerance", [plot["rules"][0][0][1]], [result[name]["tolerance"]], plot["y"])
    stages = {k: v for k, v in result["stage_seconds"].items() if known(v)}
    if stages:
        plot = figures.plot("Wall time by stage")
        figures.same("stages", [b["x2"] for b in plot["bars"][0]], sorted(stages.values(), reverse=True), plot["x"])


def check_sensitivity(figures, data):
    moved = data.get("sensitivity")
    if not moved:
        return
    plot = figures.plot("What moves GI")
    ranked = [r for r in moved["ranked"] if known(r["gi_rms"])]
    figures.same("tornado", [b["x2"] for b in plot["bars"][0]], [r["gi_rms"] for r in ranked], plot["x"])
    indices = {f"{row['name']}, {name}": row["gi_" + name] for row in moved["labels"] if known(row["gi_total"]) for name in ("first", "total")}
    if indices:
        plot = figures.plot("Sobol indices of the labels")
        bars = [bar for group in plot["bars"] for bar in group]
        assert {b["title"].rsplit(":", 1)[0] for b in bars} == set(indices), [b["title"] for b in bars]
        for bar in bars:
            value = indices[bar["title"].rsplit(":", 1)[0]]
            figures.same(bar["title"], [bar["x2"] if value >= 0 else bar["x1"]], [value], plot["x"])


def check_reductions(figures, data):
    cost = data.get("reduction_cost")
    if cost:
        plot = figures.plot("Speed against error of the reductions")
        # the axis of speed is logarithmic: what an eye can tell apart is a share of the value
        figures.same("speed-up", [math.log(p[0]) for p in plot["dots"][0]], [math.log(l["speed_up"]) for l in cost["levels"]], [math.log(v) for v in plot["x"]])
        figures.same("GI rms", [p[1] for p in plot["dots"][0]], [l["gi_rmse"] for l in cost["levels"]], plot["y"])
        figures.same("floors", [max(r[1], r[2]) for r in plot["rules"][0]], [cost["noise_allowed"] * l["noise_floor"] for l in cost["levels"]], plot["y"])


def check_words(browser, result, data):
    """Numbers of the first screen and of the tables, as text: rounded to the digits shown, never to others."""
    def shown(text, value, digits, what):
        assert abs(float(text) - value) <= 0.5000001 * 10**-digits, f"{what}: shown {text}, in the JSON {value}"

    tiles = browser.run('Object.fromEntries([...document.querySelectorAll(".tile")].map(t => [t.querySelector(".name").textContent, [t.querySelector(".big").textContent, t.querySelector(".small").textContent]]))')
    count = 0
    for name, (big, small) in tiles.items():
        what = result["x_drift"] if name == "x drift" else result["misfit"] if "misfit" in name else None
        if what and known(what["value"]):
            shown(big, what["value"], 3, name)
            found = re.findall(r"\d+\.\d+", small)
            for text, value in zip(found, (*what["interval"], what["noise_floor"], what["tolerance"])):
                shown(text, value, 3, name)
            count += 5
    for name, key in (("Powder laid", "capture_fraction"), ("Coverage", "coverage")):
        if known(result[key]):
            shown(tiles[name][0].split()[0], 100 * result[key], 0, name)
            count += 1
    assert browser.run('document.querySelector(".headline").textContent') == data["words"]["headline"]
    tables = browser.run('[...document.querySelectorAll("table")].map(t => [...t.rows].map(r => [...r.cells].map(c => c.textContent)))')
    corners = next(t for t in tables if t[0][0] == "corner")
    assert len(corners) == len(data["build"]) + 1
    for row, wanted in zip(corners[1:], data["build"]):
        for text, key, digits in zip(row[1:], ("x_mm", "y_mm", "length_mm", "angle_deg"), (3, 3, 3, 2)):
            if known(wanted[key]):
                shown(text, wanted[key], digits, f"corner {row[0]} {key}")
                count += 1
            else:
                assert text == "", text
    numbers = next((t for t in tables if t[0][0] == "y mm"), None)
    if numbers:
        for k, row in enumerate(numbers[1:]):
            shown(row[0], 1e3 * result["profile"]["y_m"][k], 2, "y")
            for text, key in zip(row[1:4], ("target", "predicted", "confirmed")):
                if known(result["profile"][key][k]):
                    shown(text, result["profile"][key][k], 3, f"table, {key} of bin {k}")
                    count += 1
                else:
                    assert text == "–", text
    inputs = next(t for t in tables if t[0][:2] == ["key", "value"])
    rows = {row[0]: row for row in inputs[1:] if len(row) == 4}
    for wanted in result["inputs"]:
        row = rows[wanted["key"]]
        assert row[1].startswith(wanted["value"]) and wanted["unit"] in row[1] and row[2] == wanted["origin"], (row, wanted)
        count += 1
    return count


def check_grains(folder, pictures):
    """Each grain of each picture is a grain of that instant's particle file, in place, size and powder."""
    import h5py

    count = 0
    instants = json.loads((folder / "particles.vtkhdf.series").read_text(encoding="utf-8"))["files"]
    for k, picture in enumerate(pictures):
        with h5py.File(folder / next(i["name"] for i in instants if i["time"] == picture["time"])) as file:
            points, radius, is_a = file["VTKHDF/Points"][()], file["VTKHDF/PointData/radius"][()], file["VTKHDF/PointData/is_a"][()]
        assert picture["grains"] == len(points), f"instant {k}: {picture['grains']} grains, {len(points)} in the file"
        order = sorted(range(len(points)), key=lambda i: points[i][2])
        heights = [float(points[i][2]) for i in order]
        width = picture["origin"][1] + picture["extent"][1] + 1e-9
        step = [max(e, 1e-6) / 65535 for e in picture["extent"]]
        records = struct.iter_unpack("<HHHBB", base64.b64decode(picture["data"]))
        seen = 0
        for x, y, z, r, flags in records:
            place = [picture["origin"][a] + q / 65535 * picture["extent"][a] for a, q in enumerate((x, y, z))]
            low, high = bisect.bisect_left(heights, place[2] - step[2]), bisect.bisect_right(heights, place[2] + step[2])
            found = any(abs(points[i][0] - place[0]) <= step[0] and abs(radius[i] - r / 255 * picture["radius_max"]) <= picture["radius_max"] / 255
                        and bool(is_a[i]) == bool(flags & 1) and (abs(points[i][1] - place[1]) <= 2 * step[1] or not 0 <= points[i][1] <= width)
                        for i in (order[j] for j in range(low, high)))
            assert found, f"instant {k}: a grain at {place} is in no file"
            seen += 1
        assert seen == picture["shown"], (seen, picture["shown"])
        count += seen
    return count


def check_scene(browser, data):
    """The 3-D view: both powders are seen, each instant is another picture, and keys turn and zoom it."""
    count_colours = """(() => { const c = document.querySelector("canvas.live"), d = document.createElement("canvas"); d.width = c.width; d.height = c.height;
      const pen = d.getContext("2d"); pen.drawImage(c, 0, 0); const p = pen.getImageData(0, 0, d.width, d.height).data; let a = 0, b = 0, sum = 0;
      for (let i = 0; i < p.length; i += 4) { if (p[i + 2] > p[i] + 60) ++a; if (p[i] > p[i + 2] + 60) ++b; sum = (sum * 31 + p[i] + 7 * p[i + 1] + 13 * p[i + 2]) % 2147483647; } return [a, b, sum]; })()"""
    browser.run('document.querySelector("canvas.live").scrollIntoView({block: "center"})')
    browser.settle()
    blue, orange, first = browser.run(count_colours)
    assert blue > 50 and orange > 50, f"before the spread: {blue} blue and {orange} orange pixels"
    browser.run('document.querySelector(".choice input[type=radio]").focus()')
    seen = [first]
    for k in range(1, len(data["pictures"])):
        browser.key("ArrowRight", number=39)
        browser.settle()
        assert browser.run('document.querySelector(".choice input:checked").value') == str(k)
        seen.append(browser.run(count_colours)[2])
        said = browser.run('document.querySelector(".scene [aria-live]").textContent')
        picture = data["pictures"][k]
        assert f"t = {1e3 * picture['time']:.1f} ms" in said and f"{picture['grains']:,} grains" in said, said
        if k + 1 < len(data["pictures"]):
            assert f"x = {1e3 * picture['blade_x']:.2f} mm" in said, said
    browser.run('document.querySelector("canvas.live").focus()')
    for key, code, number in (("ArrowLeft", "ArrowLeft", 37), ("ArrowUp", "ArrowUp", 38), ("+", "Equal", 187), ("0", "Digit0", 48)):
        browser.key(key, code, number, text=key if len(key) == 1 else None)
        browser.settle()
        seen.append(browser.run(count_colours)[2])
    # key 0 brings the first view of this instant back
    assert seen[-1] == seen[len(data["pictures"]) - 1], "0 does not reset the view"
    assert len(set(seen)) == len(seen) - 1, f"pictures that should differ are the same: {seen}"


def check_keyboard(browser):
    """Tab goes to every control, and what has the focus is marked."""
    browser.run("""(() => { const all = [...document.querySelectorAll("a[href], button, input, summary, [tabindex='0']")].filter((n) => n.checkVisibility() && !n.classList.contains("skip"));
      const groups = new Set(); window.wanted = all.filter((n) => n.type !== "radio" || (!groups.has(n.name) && groups.add(n.name))); window.reached = new Set(); window.unmarked = [];
      document.activeElement.blur(); window.scrollTo(0, 0); })()""")
    count = browser.run("window.wanted.length")
    for _ in range(count + 5):
        browser.key("Tab", number=9)
        browser.run("""(() => { const n = document.activeElement, first = n.type === "radio" ? window.wanted.find((w) => w.name === n.name) : n; window.reached.add(first);
          if (n !== document.body && getComputedStyle(n).outlineStyle === "none") window.unmarked.push(n.outerHTML.slice(0, 80)); })()""")
    missed = browser.run("window.wanted.filter((n) => !window.reached.has(n)).map((n) => n.outerHTML.slice(0, 120))")
    assert not missed, f"Tab never reaches {missed}"
    unmarked = browser.run("window.unmarked")
    assert not unmarked, f"focus is not to be seen on {unmarked}"
    return count


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("out", type=pathlib.Path)
    options.add_argument("--pictures", type=pathlib.Path)
    given = options.parse_args()
    page = given.out / "report.html"
    result = json.loads((given.out / "result.json").read_text(encoding="utf-8"))
    data = json.loads((given.out / "report_data.json").read_text(encoding="utf-8"))
    assert page.stat().st_size < 6 << 20, f"the page has {page.stat().st_size} bytes"
    if given.pictures:
        given.pictures.mkdir(parents=True, exist_ok=True)

    with Chromium() as browser:
        browser.size(1280, 1000)
        browser.open(page)
        in_page = json.loads(browser.run('document.getElementById("data").textContent'))
        assert in_page == data, "the page's data are not report_data.json's"
        assert in_page["result"] == result, "the page's result is not result.json's"
        figures = Figures(browser)
        check_gradation(figures, result, data)
        check_search(figures, result)
        check_sensitivity(figures, data)
        check_reductions(figures, data)
        drawn = {f["title"] for f in browser.run(COLLECT) if f["plots"]}
        assert drawn == figures.checked, f"figures that nothing holds against the JSON: {drawn - figures.checked}"
        print(f"{len(figures.checked)} figures with {figures.values} values are the JSON's")
        print(f"{check_words(browser, result, data)} numbers in words and tables are the JSON's")
        if data["pictures"]:
            print(f"{check_grains(given.out, data['pictures'])} grains at {len(data['pictures'])} instants are the particle files'")
            check_scene(browser, data)
        print(f"{check_keyboard(browser)} controls are reached by Tab")
        browser.run("window.scrollTo(0, 0)")
        if given.pictures:
            browser.open(page)
            browser.picture(given.pictures / "report_desk.png")
        with tempfile.TemporaryDirectory() as folder:
            paper = (given.pictures or pathlib.Path(folder)) / "report_paper.pdf"
            browser.paper(paper)
            text = subprocess.run(["pdftotext", paper, "-"], check=True, capture_output=True, text=True).stdout
            assert data["words"]["headline"] in text and "Make it again" in text, "the paper version lacks its beginning or end"
        if data["pictures"]:
            stills = browser.run('document.querySelectorAll(".stills canvas").length')
            assert stills == len(data["pictures"]), f"{stills} stills on paper"
        browser.size(390, 800, phone=True)
        browser.open(page)
        wide = browser.run("document.documentElement.scrollWidth")
        assert wide <= 390, f"{wide} px wide on a phone of 390 px"
        if given.pictures:
            browser.send("Emulation.setDeviceMetricsOverride", width=390, height=800, deviceScaleFactor=1, mobile=True)
            browser.settle()
            browser.picture(given.pictures / "report_phone.png")
        assert not browser.complaints, f"console: {browser.complaints}"
    with Chromium("--disable-3d-apis") as browser:
        browser.size(1280, 1000)
        browser.open(page)
        if data["pictures"]:
            assert browser.run('document.querySelectorAll(".stills canvas").length') == 1, "no still picture without WebGL"
            assert not browser.run('!!document.querySelector("canvas.live")')
        assert not browser.complaints, f"console without WebGL: {browser.complaints}"
    print("no console message; paper, phone and a browser without WebGL are served")


if __name__ == "__main__":
    try:
        main()
    except AssertionError as error:
        sys.exit(f"check_report: {error}")
