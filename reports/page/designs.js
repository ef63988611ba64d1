// Finished designs side by side: numbers with their bounds, GI(y), partitions, inputs that differ. All text goes in as text nodes.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const page = document.getElementById("page"), designs = data.designs;
  const known = (v) => v != null && Number.isFinite(v);
  const fixed = (v, n) => (known(v) ? v.toFixed(n) : "–");
  const percent = (v) => (known(v) ? `${(100 * v).toFixed(0)} %` : "–");
  function h(tag, attributes = {}, ...children) {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) if (value != null) node.setAttribute(key, value);
    node.append(...children.flat().filter((c) => c != null));
    return node;
  }
  const style = { fontSize: "12px", background: "none", overflow: "visible" };
  // Okabe and Ito, with a symbol each: told apart without colours too
  const names = designs.map((d) => d.name), palette = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#111111"];
  const colours = { domain: names, range: names.map((_, i) => palette[i % palette.length]), legend: true };
  const marks = ["circle", "square", "triangle", "diamond", "star", "cross", "wye"], symbols = { domain: names, range: names.map((_, i) => marks[i % marks.length]) };

  const drawn = [];
  function figure(width_class, title, caption, draw) {
    const box = h("div", { class: "plot" });
    drawn.push({ box, draw, title, width: 0 });
    return h("figure", { class: width_class }, h("h3", {}, title), box, h("figcaption", {}, caption));
  }
  function redraw() {
    for (const item of drawn) {
      const width = Math.floor(item.box.clientWidth);
      if (!width || width === item.width) continue;
      item.width = width;
      item.box.replaceChildren(item.draw(width));
      for (const svg of item.box.querySelectorAll("svg"))
        if (!svg.getAttribute("aria-label")) { svg.setAttribute("role", "img"); svg.setAttribute("aria-label", item.title); }
    }
  }

  const room = Math.min(200, 24 + 7 * d3.max(names, (n) => n.length));
  const judged = (key, label) => (width) => {
    const rows = designs.filter((d) => known(d[key].value)), bounds = rows.filter((d) => known(d[key].interval[0]) && known(d[key].interval[1]));
    return Plot.plot({
      width, height: 60 + 30 * designs.length, marginLeft: Math.min(room, width * 0.4), marginRight: 16, marginBottom: 42, style, symbol: symbols, color: { ...colours, legend: false },
      x: { label, grid: true, domain: [0, 1.1 * d3.max(rows, (d) => Math.max(d[key].value, d[key].interval[1] ?? 0, d[key].tolerance))] }, y: { domain: names, label: null },
      marks: [
        Plot.tickX(rows, { x: (d) => d[key].tolerance, y: "name", stroke: "#007a5a", strokeWidth: 2.5, strokeDasharray: "4 2" }),
        Plot.ruleY(bounds, { x1: (d) => d[key].interval[0], x2: (d) => d[key].interval[1], y: "name", stroke: "#5b6b7b", strokeWidth: 5, strokeOpacity: 0.5 }),
        Plot.dot(rows, { x: (d) => d[key].value, y: "name", fill: "name", symbol: "name", r: 6, sort: null, title: (d) => `${d.name}: ${fixed(d[key].value, 3)}, noise floor ${fixed(d[key].noise_floor, 3)}` })],
    });
  };
  const of = (d) => (d.profile.confirmed.some(known) ? d.profile.confirmed : d.profile.predicted);
  const points = designs.flatMap((d) => d.profile.y_m.map((y, b) => ({ name: d.name, y: 1e3 * y, gi: of(d)[b], low: d.profile.band_low[b], high: d.profile.band_high[b] }))).filter((p) => known(p.gi));
  const asked = (data.same_target ? designs.slice(0, 1) : designs).flatMap((d) => d.profile.y_m.map((y, b) => ({ name: d.name, y: 1e3 * y, gi: d.profile.target[b] }))).filter((p) => known(p.gi));
  const profiles = (width) => Plot.plot({
    width, height: Math.max(280, Math.min(440, width * 0.5)), marginLeft: 44, marginRight: 12, marginBottom: 42, style, grid: true, color: { ...colours, legend: false }, symbol: { ...symbols, legend: true },
    x: { label: "y across the spreading direction (mm)" }, y: { domain: [0, 1], label: "gradation index GI" },
    marks: [
      Plot.line(asked, data.same_target ? { x: "y", y: "gi", stroke: "#111", strokeDasharray: "7 4" } : { x: "y", y: "gi", z: "name", stroke: "name", strokeDasharray: "7 4" }),
      Plot.line(points, { x: "y", y: "gi", z: "name", stroke: "name", strokeWidth: 2 }),
      Plot.dot(points, { x: "y", y: "gi", fill: "name", symbol: "name", r: 4.5, title: (p) => `${p.name}, y ${p.y.toFixed(2)} mm: ${fixed(p.gi, 3)}${known(p.low) ? `, band ${fixed(p.low, 3)} to ${fixed(p.high, 3)}` : ""}` })],
  });
  const mm = (p) => ({ x: 1e3 * p[0], y: 1e3 * p[1] });
  const plan = (d) => (width) => {
    const L = 1e3 * d.plan.dispenser_length_m, W = 1e3 * d.plan.width_m, left = 40, right = 10, top = 24, bottom = 40, scale = Math.min((width - left - right) / L, 360 / W);
    const fill = (outline, colour) => (outline.length ? Plot.line(outline.map(mm), { x: "x", y: "y", fill: colour, fillOpacity: 0.3, stroke: "none", curve: "linear-closed" }) : null);
    return Plot.plot({
      width: scale * L + left + right, height: scale * W + top + bottom, marginLeft: left, marginRight: right, marginTop: top, marginBottom: bottom, style,
      x: { domain: [0, L], label: "x (mm)", ticks: 4 }, y: { domain: [0, W], label: "y (mm)", ticks: 4 },
      marks: [fill(d.plan.outline_a, "#0072B2"), fill(d.plan.outline_b, "#E69F00"), Plot.rect([0], { x1: 0, x2: L, y1: 0, y2: W, fill: "none", stroke: "#111" }),
        ...[d.plan.curve, d.plan.curve2].map((c) => Plot.line(c.map(mm), { x: "x", y: "y", stroke: "#111", strokeWidth: 2.4 }))],
    });
  };
  function table(label, head, rows) {
    return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, h("table", {},
      h("thead", {}, h("tr", {}, head.map((c) => h("th", { scope: "col" }, c)))),
      h("tbody", {}, rows.map((row) => h("tr", {}, row.map((cell) => h("td", {}, cell ?? "–")))))));
  }
  const bounded = (m) => `${fixed(m.value, 3)} (${fixed(m.interval[0], 3)} to ${fixed(m.interval[1], 3)}, floor ${fixed(m.noise_floor, 3)}, tolerance ${fixed(m.tolerance, 3)})`;
  const lines = [
    ["study", (d) => d.study], ["target", (d) => d.target], ["verdict", (d) => d.verdict.replace("_", " ")], ["misfit (95 % bounds)", (d) => bounded(d.misfit)], ["x drift (95 % bounds)", (d) => bounded(d.x_drift)],
    ["coverage", (d) => percent(d.coverage)], ["powder laid", (d) => percent(d.capture_fraction)], ["waste", (d) => percent(d.waste_fraction)], ["layer packing", (d) => fixed(d.packing_fraction, 3)], ["supply ratio", (d) => fixed(d.supply_ratio, 2)],
    ["partition", (d) => d.design.partition.family], ["dosage factor", (d) => fixed(d.design.dosage_factor, 3)], ["land (mm)", (d) => fixed(1e3 * d.design.land_m, 3)],
    ["reductions", (d) => d.reductions.join(", ") || "none"], ["spreads", (d) => `${d.spreads.map} strips, ${d.spreads.full} full`], ["seconds, empty cache", (d) => fixed(d.seconds_cold, 0)], ["seed", (d) => String(d.seed)], ["folder", (d) => d.folder]];

  page.append(h("div", { class: "grid", id: "figures" },
    figure("w6", "Misfit of each design", "Mark: value; grey bar: 95 % bounds; dashed tick: tolerance.", judged("misfit", "misfit of GI")),
    figure("w6", "x drift of each design", "Mark: value; grey bar: 95 % bounds; dashed tick: tolerance.", judged("x_drift", "x drift")),
    figure("w12", "GI(y) of each design", `Confirmed where it was, else predicted. Dashed: ${data.same_target ? "the target" : "each design's own target, in its colour"}.`, profiles),
    designs.map((d) => figure("w6", `Partition: ${d.name}`, "Dispenser from above, to scale; A blue, B orange.", plan(d))),
    h("div", { class: "card w12" }, h("h3", {}, "Side by side"), table("designs side by side", ["", ...names], lines.map(([name, value]) => [name, ...designs.map(value)]))),
    h("div", { class: "card w12" }, h("h3", {}, "Inputs that differ"), data.differences.length ? table("inputs that differ", ["key", ...names], data.differences.map((d) => [d.key, ...d.values])) : h("p", { class: "note" }, "Every input is the same."))));
  document.body.append(h("footer", {}, "Figures drawn with Observable Plot 0.6 and D3 7 (ISC licence), contained in this page. Colours after Okabe and Ito."));
  redraw();
  let waiting = 0;
  new ResizeObserver(() => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(redraw); }).observe(page);
})();
