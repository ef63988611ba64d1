// Builds the report from the JSON block of the page: first screen, figures (Observable Plot), tables. All text goes in as text
// nodes, never as markup.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const { result, words, plan, map, origin, pictures } = data;
  const page = document.getElementById("page");

  // ---- small helpers -------------------------------------------------------------------------------------------------
  function h(tag, attributes = {}, ...children) {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) if (value != null) node.setAttribute(key, value);
    node.append(...children.flat().filter((c) => c != null));
    return node;
  }
  const known = (v) => v != null && Number.isFinite(v);
  const gi = (v) => (known(v) ? v.toFixed(3) : "–");
  const percent = (v) => (known(v) ? `${(100 * v).toFixed(0)} %` : "–");
  const mm = (v) => (known(v) ? (v * 1e3).toFixed(3) : "–");
  const duration = (s) => {
    if (!known(s)) return "–";
    if (s < 9.95) return `${s.toFixed(1)} s`;
    const w = Math.round(s), two = (n) => String(n).padStart(2, "0");
    return w < 60 ? `${w} s` : w < 3600 ? `${Math.floor(w / 60)} min ${two(w % 60)} s` : `${Math.floor(w / 3600)} h ${two(Math.floor((w % 3600) / 60))} min`;
  };
  const big = (v) => (!known(v) ? "–" : v >= 1e9 ? `${(v / 1e9).toFixed(2)}e9` : v >= 1e6 ? `${(v / 1e6).toFixed(2)}e6` : Math.round(v).toLocaleString("en-GB"));
  const blue = "#0072B2", orange = "#E69F00", green = "#007a5a";
  const gi_colour = d3.scaleLinear([0, 0.5, 1], [orange, "#f6f1e4", blue]).interpolate(d3.interpolateLab);
  const gi_scale = { type: "linear", domain: [0, 1], interpolate: gi_colour, label: "GI (1 = A, 0 = B)" };

  function table(head, rows, class_name) {
    const right = head.map((c) => (typeof c === "string" ? false : c.right));
    const name = (c) => (typeof c === "string" ? c : c.name);
    return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "table: " + head.map(name).join(", ") },
      h("table", { class: class_name },
        h("thead", {}, h("tr", {}, head.map((c, i) => h("th", { class: right[i] ? "r" : null, scope: "col" }, name(c))))),
        h("tbody", {}, rows.map((row) => h("tr", {}, row.map((cell, i) => h("td", { class: right[i] ? "r" : null }, cell ?? "–")))))));
  }
  const R = (name) => ({ name, right: true });

  // Every figure redraws when its box changes width, so a phone gets a phone's figure.
  const drawn = [];
  function figure(width_class, title, caption, draw, after) {
    const box = h("div", { class: "plot" });
    const node = h("figure", { class: width_class }, h("h3", {}, title), box, h("figcaption", {}, caption), after);
    drawn.push({ box, draw, title, width: 0 });
    return node;
  }
  function redraw() {
    for (const item of drawn) {
      const width = Math.floor(item.box.clientWidth);
      if (!width || width === item.width) continue;
      item.width = width;
      if (item.keep) { item.keep(width); continue; }
      const made = [item.draw(width)].flat().filter(Boolean);
      item.box.replaceChildren(...made);
      for (const svg of item.box.querySelectorAll("svg"))
        if (!svg.getAttribute("aria-label")) { svg.setAttribute("role", "img"); svg.setAttribute("aria-label", item.title); }
    }
  }
  const heap = result.extrapolated;
  const style = { fontSize: "12px", background: "none", overflow: "visible" };
  const section = (id, title, ...children) => page.append(h("h2", { id }, title), ...children);

  // ---- first screen --------------------------------------------------------------------------------------------------
  // Interval, value and tolerance on one line.
  function gauge(m, name) {
    if (!known(m.value)) return null;
    const W = 240, top = Math.max(1.35 * m.tolerance, 1.1 * (m.interval[1] ?? 0), 1.1 * m.value), x = (v) => 2 + (W - 4) * Math.min(1, v / top);
    const svg = d3.create("svg").attr("class", "gauge").attr("viewBox", `0 0 ${W} 30`).attr("preserveAspectRatio", "none").attr("role", "img")
      .attr("aria-label", `${name} ${gi(m.value)}, tolerance ${gi(m.tolerance)}`);
    svg.append("rect").attr("x", 2).attr("y", 11).attr("width", W - 4).attr("height", 8).attr("rx", 4).attr("fill", "#e7eaee");
    svg.append("rect").attr("x", 2).attr("y", 11).attr("width", x(m.tolerance) - 2).attr("height", 8).attr("rx", 4).attr("fill", "#cfe6dc");
    if (known(m.interval[0]) && known(m.interval[1]))
      svg.append("rect").attr("x", x(m.interval[0])).attr("y", 8.5).attr("width", Math.max(1, x(m.interval[1]) - x(m.interval[0]))).attr("height", 13).attr("rx", 3).attr("fill", "#5b6b7b").attr("opacity", 0.55);
    svg.append("rect").attr("x", x(m.value) - 1.5).attr("y", 5).attr("width", 3).attr("height", 20).attr("fill", "#111");
    svg.append("path").attr("d", `M${x(m.tolerance)} 3V27`).attr("stroke", green).attr("stroke-width", 2).attr("stroke-dasharray", "3 2");
    return svg.node();
  }
  const tile = (name, value, small, extra) => h("div", { class: "card tile" }, h("div", { class: "name" }, name), h("div", { class: "big" }, value), extra, h("div", { class: "small" }, small));
  const spoken = { rmse: "rms misfit", mean_absolute: "mean absolute misfit", max: "largest misfit" };
  const proved = result.confirmations.length > 0;
  const norm_name = `${proved ? "Confirmed" : "Predicted"} ${spoken[result.misfit.norm] ?? "misfit"}`;
  const interval = (m) => `95 % bounds ${gi(m.interval[0])} and ${gi(m.interval[1])}, noise floor ${gi(m.noise_floor)}, tolerance ${gi(m.tolerance)}`;

  if (result.warnings.length) page.append(h("div", { class: "warn", role: "note" }, h("strong", {}, "Before you rely on it"), h("ul", {}, result.warnings.map((w) => h("li", {}, w)))));
  page.append(h("div", { class: "grid", style: "margin-top:16px" },
    h("div", { class: "w12 tiles" },
      tile(norm_name, gi(result.misfit.value), interval(result.misfit), gauge(result.misfit, norm_name)),
      tile("x drift", gi(result.x_drift.value), interval(result.x_drift), gauge(result.x_drift, "x drift")),
      tile("Powder laid", percent(result.capture_fraction), `of the dosed solid; ${percent(result.waste_fraction)} overflows, ${percent(result.waste_a_share)} of that is A${result.capture_fraction + result.waste_fraction > 1 ? " (more than the dose in all: the blade also drags grains from below its edge)" : ""}; supply ratio ${known(result.supply_ratio) ? result.supply_ratio.toFixed(2) : "–"}`),
      tile("Coverage", percent(result.coverage), `of the part's cells; layer packing ${known(result.packing_fraction) ? result.packing_fraction.toFixed(2) : "–"}`),
      tile("Spent", duration(result.seconds), `${result.spreads.map} map strip${result.spreads.map === 1 ? "" : "s"} and ${result.spreads.full} full spread${result.spreads.full === 1 ? "" : "s"}; ${duration(result.seconds_cold)} with an empty cache`)),
    h("div", { class: "card w7" }, h("h3", {}, "What to build"),
      (() => { const box = h("div", { class: "plot" }); drawn.push({ box, draw: (w) => dispenser(w), title: "Plan view of the dispenser with the partition", width: 0 }); return box; })(),
      h("p", { class: "note", style: "margin:.5rem 0" }, "Plan view of the dispenser. A is the powder on the left of the partition, seen from P1 on. Drawing to scale: ", h("a", { href: "partition.svg" }, "partition.svg"), "."),
      table(["corner", R("x mm"), R("y mm"), R("length mm"), R("angle °")],
        data.build.map((p) => [p.name ?? `P${p.number}`, p.x_mm.toFixed(3), p.y_mm.toFixed(3), known(p.length_mm) ? p.length_mm.toFixed(3) : "", known(p.angle_deg) ? p.angle_deg.toFixed(2) : ""]))),
    h("div", { class: "w5 stack" },
      h("div", { class: "card" }, h("h3", {}, "What to fill"),
        h("ul", { class: "plain" }, words.fill.map((line, i) => h("li", {}, h("span", { class: "key " + "AB"[i] }), line)), h("li", {}, words.dose))),
      h("div", { class: "card" }, h("h3", {}, "How sure"), h("p", { style: "margin:0 0 .5rem" }, words.sure),
        h("p", { class: "note", style: "margin:0" }, `Search ended: ${result.termination}${result.message ? ". " + result.message : ""}`)),
      h("div", { class: "card" }, h("h3", {}, "Compared on the same target"), comparison()))));
  page.append(h("nav", { "aria-label": "sections" }, [["figures", "Gradation"], pictures.length ? ["grains", "Bed and layer"] : null, data.sensitivity ? ["sensitivity", "Sensitivity"] : null, ["search", "Search"], ["inputs", "Inputs"], ["provenance", "Provenance"]].filter(Boolean).map(([id, name]) => h("a", { href: "#" + id }, name))));

  function comparison() {
    const row = (name, e) => e && e.status !== "not_run" ? [name, gi(e.misfit.value), gi(e.x_drift.value)] : null;
    const rows = [
      proved ? [h("strong", {}, "this design, confirmed"), gi(result.misfit.value), gi(result.x_drift.value)] : null,
      ...result.confirmations.map((c) => row(`confirmation, seed ${c.seed}`, c)),
      row("this design, on the map", result.predicted), row("best straight partition, on the map", result.straight), row("kinematic picture", result.kinematic)].filter(Boolean);
    return table(["", R("misfit"), R("x drift")], rows);
  }

  // ---- plan view -----------------------------------------------------------------------------------------------------
  const point = (p) => ({ x: p[0] * 1e3, y: p[1] * 1e3 });
  const second = plan.curve2 ?? [];  // data of earlier versions has one curve
  function dispenser(width) {
    const L = plan.dispenser_length_m * 1e3, W = plan.width_m * 1e3, left = 44, right = 14, top = 44, bottom = 40;
    const scale = (width - left - right) / L, height = Math.min(520, Math.max(90, scale * W)) + top + bottom;
    const outline = (points, fill) => points.length ? Plot.line(points.map(point), { x: "x", y: "y", fill, fillOpacity: 0.26, stroke: "none", curve: "linear-closed" }) : null;
    const named = (points, letter) => points.map(point).map((p, i, all) => ({ ...p, name: `${letter}${i + 1}`, first: i === 0, last: i === all.length - 1 }));
    const corners = [...named(plan.curve, "P"), ...named(second, "Q")];
    const step = corners.length > 24 ? Math.ceil(corners.length / 12) : 1, shown = corners.filter((c, i) => i % step === 0 || c.last);
    return Plot.plot({
      width, height, marginLeft: left, marginRight: right, marginTop: top, marginBottom: bottom, style,
      x: { domain: [0, L], label: "x, spreading direction (mm)", ticks: Math.max(3, width / 90) }, y: { domain: [0, W], label: "y, across (mm)", ticks: 5 },
      marks: [
        outline(plan.outline_a, blue), outline(plan.outline_b, orange),
        Plot.rect([0], { x1: 0, x2: L, y1: 0, y2: W, fill: "none", stroke: "#111", strokeWidth: 1.5 }),
        plan.straight.length ? Plot.line(plan.straight.map(point), { x: "x", y: "y", stroke: "#777", strokeDasharray: "3 4" }) : null,
        ...[plan.curve, second].map((c) => Plot.line(c.map(point), { x: "x", y: "y", stroke: "#111", strokeWidth: 2.6, strokeLinejoin: "round" })),
        Plot.dot(shown, { x: "x", y: "y", r: 4, fill: "#fff", stroke: "#111", strokeWidth: 1.5 }),
        ...shown.map((c) => Plot.text([c], { x: "x", y: "y", text: "name", dy: -12, dx: (c.first || c.last) && c.x < 0.04 * L ? 12 : (c.first || c.last) && c.x > 0.96 * L ? -12 : 0, fontWeight: 650, fill: "#111", stroke: "#fff", strokeWidth: 4 })),
        ...["a", "b"].map((s) => plan["outline_" + s].length ? Plot.text([point(plan["centre_" + s])], { x: "x", y: "y", text: () => s.toUpperCase(), fontSize: 26, fontWeight: 700, fill: s === "a" ? blue : "#8f6200" }) : null),
        ...["a", "b"].map((s) => plan["outline_" + s].length ? Plot.text([point(plan["centre_" + s])], { x: "x", y: "y", text: () => (data.chambers ?? data.materials)[s.toUpperCase()], dy: 20, fill: "#333" }) : null),
        ...(plan.more_centres ?? []).map((c) => Plot.text([point(c.at)], { x: "x", y: "y", text: () => c.side.toUpperCase(), fontSize: 26, fontWeight: 700, fill: c.side === "a" ? blue : "#8f6200" })),
        Plot.arrow([0], { x1: L * 0.25, x2: L * 0.75, y1: W, y2: W, dy: -17, headLength: 9, strokeWidth: 2, stroke: "#111", insetEnd: 0 }),
        Plot.text([0], { x: L / 2, y: W, dy: -29, text: () => "spreading direction", fill: "#111" }),
      ],
    });
  }

  // Dispenser, land and platform in one picture: where each GI comes from.
  function whole_plan(width) {
    const L = plan.dispenser_length_m * 1e3, W = plan.width_m * 1e3, land = plan.land_m * 1e3, P = plan.platform_length_m * 1e3, end = L + land + P;
    const left = 36, right = 8, top = 30, bottom = 40;
    const height = Math.max(56, ((width - left - right) / end) * W) + top + bottom;
    const x0 = L + land, foot = plan.footprint.map((v) => v * 1e3);
    const outline = (points, fill) => points.length ? Plot.line(points.map(point), { x: "x", y: "y", fill, fillOpacity: 0.85, stroke: "none", curve: "linear-closed" }) : null;
    const names = [["dispenser", L / 2], ["land", L + land / 2], ["platform", x0 + P / 2]].filter(([n]) => n !== "land" || land / end > 0.08);
    return Plot.plot({
      width, height, marginLeft: left, marginRight: right, marginTop: top, marginBottom: bottom, style,
      x: { domain: [0, end], label: "x (mm)", ticks: Math.max(4, width / 100) }, y: { domain: [0, W], label: "y (mm)", ticks: 3 }, color: gi_scale,
      marks: [
        outline(plan.outline_a, blue), outline(plan.outline_b, orange),
        ...[plan.curve, second].map((c) => Plot.line(c.map(point), { x: "x", y: "y", stroke: "#fff", strokeWidth: 3 })),
        ...[plan.curve, second].map((c) => Plot.line(c.map(point), { x: "x", y: "y", stroke: "#111", strokeWidth: 1.4 })),
        Plot.rect([0], { x1: L, x2: x0, y1: 0, y2: W, fill: "#dfe3e8" }),
        Plot.arrow([0], { x1: L + land * 0.15, x2: L + land * 0.85, y1: W / 2, y2: W / 2, strokeWidth: 2, stroke: "#57606a", headLength: 9, insetEnd: 0 }),
        Plot.rect([0], { x1: x0, x2: end, y1: 0, y2: W, fill: "#e7eaee" }),
        map ? Plot.rect(map_cells().filter((c) => known(c.gi)), { x1: (c) => x0 + c.x1, x2: (c) => x0 + c.x2, y1: "y1", y2: "y2", fill: "gi", inset: -0.3 }) : null,
        ...[[0, L], [x0, end]].map(([a, b]) => Plot.rect([0], { x1: a, x2: b, y1: 0, y2: W, fill: "none", stroke: "#111", strokeWidth: 1.2 })),
        Plot.rect([0], { x1: x0 + foot[0], x2: x0 + foot[1], y1: Math.max(0, foot[2]), y2: Math.min(W, foot[3]), fill: "none", stroke: "#111", strokeDasharray: "4 3", inset: 1.5 }),
        Plot.text(names, { x: (d) => d[1], y: W, text: (d) => d[0], dy: -11, fill: "#333" }),
      ],
    });
  }

  // ---- gradation -----------------------------------------------------------------------------------------------------
  function map_cells() {
    const dx = map.x_m.length > 1 ? map.x_m[1] - map.x_m[0] : 2 * map.x_m[0], dy = map.y_m.length > 1 ? map.y_m[1] - map.y_m[0] : 2 * map.y_m[0];
    return map.gi.map((value, k) => {
      const x = map.x_m[k % map.x_m.length], y = map.y_m[Math.floor(k / map.x_m.length)];
      return { x1: (x - dx / 2) * 1e3, x2: (x + dx / 2) * 1e3, y1: (y - dy / 2) * 1e3, y2: (y + dy / 2) * 1e3, gi: value };
    });
  }
  const profile = result.profile, bins = profile.y_m.map((y, b) => ({ y: y * 1e3, target: profile.target[b], predicted: profile.predicted[b], confirmed: profile.confirmed[b], low: profile.band_low[b], high: profile.band_high[b], left: profile.left_out?.confirmed[b] }));
  const half_bin = data.bin_width_m * 500, series = ["target", "predicted", "confirmed"], shades = ["#111", "#a05195", green];
  const y_end = Math.max(plan.width_m * 1e3, ...bins.map((b) => b.y + half_bin));

  function profile_figure(width) {
    const has = (s) => bins.filter((b) => known(b[s]));
    const tip = (b) => `y ${b.y.toFixed(2)} mm\ntarget ${gi(b.target)}\npredicted ${gi(b.predicted)}\nconfirmed ${gi(b.confirmed)}${known(b.low) ? `\nband ${gi(b.low)} to ${gi(b.high)}` : ""}`;
    return Plot.plot({
      width, height: Math.max(280, Math.min(420, width * 0.62)), marginLeft: 44, marginRight: 12, marginBottom: 42, style, grid: true,
      x: { domain: [0, y_end], label: "y across the spreading direction (mm)" }, y: { domain: [0, 1], nice: true, label: "gradation index GI" },
      color: { domain: series.filter((s) => has(s).length), range: shades.filter((_, i) => has(series[i]).length), legend: true },
      marks: [
        Plot.rect(bins.filter((b) => known(b.low) && known(b.high)), { x1: (b) => b.y - half_bin, x2: (b) => b.y + half_bin, y1: "low", y2: "high", fill: green, fillOpacity: 0.18, insetLeft: 0.5, insetRight: 0.5 }),
        Plot.ruleY([0, 1], { stroke: "#999", strokeWidth: 0.7 }),
        Plot.line(has("target"), { x: "y", y: "target", stroke: () => "target", strokeWidth: 2, strokeDasharray: "7 4" }),
        Plot.line(has("predicted"), { x: "y", y: "predicted", stroke: () => "predicted", strokeWidth: 1.6 }),
        Plot.dot(has("predicted"), { x: "y", y: "predicted", stroke: () => "predicted", fill: "#fff", symbol: "square", r: 3.5 }),
        Plot.line(has("confirmed"), { x: "y", y: "confirmed", stroke: () => "confirmed", strokeWidth: 2.2 }),
        Plot.dot(has("confirmed"), { x: "y", y: "confirmed", fill: () => "confirmed", symbol: "circle", r: 4 }),
        Plot.dot(bins.filter((b) => known(b.left)), { x: "y", y: "left", stroke: "#888", fill: "#fff", symbol: "circle", r: 3.5, title: (b) => `y ${b.y.toFixed(2)} mm: ${gi(b.left)}, left out of the misfit` }),
        Plot.tip(bins.filter((b) => known(b.confirmed) || known(b.predicted)), Plot.pointerX({ x: "y", y: (b) => b.confirmed ?? b.predicted, title: tip })),
      ],
    });
  }
  function map_figure(width) {
    const P = plan.platform_length_m * 1e3, W = plan.width_m * 1e3, left = 44, right = 12, bottom = 42, top = 14;
    const foot = plan.footprint.map((v) => v * 1e3);
    return Plot.plot({
      width, height: Math.min(460, ((width - left - right) / P) * W) + top + bottom, marginLeft: left, marginRight: right, marginTop: top, marginBottom: bottom, style,
      x: { domain: [0, P], label: "x along the platform (mm)" }, y: { domain: [0, W], label: "y (mm)", ticks: 5 }, color: { ...gi_scale, legend: true },
      marks: [
        Plot.rect([0], { x1: 0, x2: P, y1: 0, y2: W, fill: "#e7eaee" }),
        Plot.rect(map_cells().filter((c) => known(c.gi)), { x1: "x1", x2: "x2", y1: "y1", y2: "y2", fill: "gi", inset: 0.25, title: (c) => `GI ${gi(c.gi)}` }),
        Plot.rect([0], { x1: foot[0], x2: foot[1], y1: Math.max(0, foot[2]), y2: Math.min(W, foot[3]), fill: "none", stroke: "#111", strokeWidth: 1.5, strokeDasharray: "5 4" }),
      ],
    });
  }
  // A target over x and y: asked for, found, and the difference, one panel each, to scale.
  const field = result.field;
  function field_cells() {
    const edges = (m, k, ends) => { const step = m.length > 1 ? m[1] - m[0] : ends; return [(m[k] - step / 2) * 1e3, (m[k] + step / 2) * 1e3]; };
    const found = (j, i) => (field.of === "confirmed" ? field.confirmed[j][i] ?? field.left_out.confirmed[j][i] : field.predicted[j][i]);
    return field.y_m.flatMap((y, j) => field.x_m.map((x, i) => {
      const [x1, x2] = edges(field.x_m, i, plan.footprint[1] - plan.footprint[0]), [y1, y2] = edges(field.y_m, j, data.bin_width_m);
      const asked = field.target[j][i] ?? field.left_out.target[j][i], got = found(j, i), counts = field.weight[j][i] > 0;
      return { x1, x2, y1, y2, asked, got, counts, off: known(asked) && known(got) ? got - asked : null, band: [field.band_low[j][i], field.band_high[j][i]] };
    }));
  }
  function field_figure(width) {
    const cells = field_cells(), names = ["target", field.of, `${field.of} − target`], left = 44, right = 12, bottom = 42, top = 24;
    const across = width > 620 ? 3 : 1, each = Math.floor(width / across);
    const [x0, x1] = d3.extent(cells.flatMap((c) => [c.x1, c.x2])), y1 = d3.max(cells, (c) => c.y2);
    const reach = Math.max(0.05, ...cells.filter((c) => c.counts && known(c.off)).map((c) => Math.abs(c.off)));
    const colours = [gi_scale, gi_scale, { type: "linear", domain: [-reach, reach], interpolate: d3.scaleLinear([0, 0.5, 1], ["#8e0152", "#f7f7f7", "#276419"]).interpolate(d3.interpolateLab), label: "difference in GI", tickFormat: "+.2f" }];
    const tip = (c) => `x ${c.x1.toFixed(2)} to ${c.x2.toFixed(2)} mm, y ${c.y1.toFixed(2)} to ${c.y2.toFixed(2)} mm\ntarget ${gi(c.asked)}\n${field.of} ${gi(c.got)}${known(c.band[0]) ? `\nband ${gi(c.band[0])} to ${gi(c.band[1])}` : ""}${c.counts ? "" : "\nleft out of the misfit"}`;
    return h("div", { style: "display:flex;flex-wrap:wrap" }, ["asked", "got", "off"].map((key, k) => Plot.plot({
      width: each, height: Math.max(180, Math.min(420, ((each - left - right) / (x1 - x0)) * y1)) + top + bottom, marginLeft: left, marginRight: right, marginTop: top, marginBottom: bottom, style,
      x: { domain: [x0, x1], label: "x along the platform (mm)", ticks: 4 }, y: { domain: [0, y1], label: "y (mm)", ticks: 5 }, color: { ...colours[k], legend: true },
      ariaLabel: names[k], ariaDescription: `${names[k]} over the cells of x and y`,
      marks: [
        Plot.rect(cells.filter((c) => known(c[key])), { x1: "x1", x2: "x2", y1: "y1", y2: "y2", fill: key, fillOpacity: (c) => (c.counts ? 1 : 0.35), inset: 0.5, title: tip }),
        Plot.text(cells.filter((c) => known(c[key])), { x: (c) => (c.x1 + c.x2) / 2, y: (c) => (c.y1 + c.y2) / 2, text: (c) => (key === "off" ? d3.format("+.2f")(c[key]) : c[key].toFixed(2)), fontSize: 10, fill: (c) => ((key === "off" ? Math.abs(c.off) > 0.6 * reach : Math.abs(c[key] - 0.5) > 0.42) ? "#fff" : "#222") }),
        Plot.text([names[k]], { frameAnchor: "top", text: (d) => d, dy: -14, fontWeight: 600 }),
      ],
    })));
  }
  const field_rows = () => field_cells().map((c) => [`${c.x1.toFixed(2)} to ${c.x2.toFixed(2)}`, `${c.y1.toFixed(2)} to ${c.y2.toFixed(2)}`, gi(c.asked), gi(c.got), known(c.off) ? d3.format("+.3f")(c.off) : "–", known(c.band[0]) ? `${gi(c.band[0])} to ${gi(c.band[1])}` : "–", c.counts ? "" : "left out"]);
  function drift_figure(width) {
    const d = result.x_drift.profile, t = result.x_drift.tolerance;
    const rows = d.difference.map((v, b) => ({ y: (profile.y_m[b] ?? 0) * 1e3, v, e: (d.band_factor ?? 0) * (d.standard_error[b] ?? 0) })).filter((r) => known(r.v));
    const reach = Math.max(1.6 * t, ...(d.target ?? []).map((v) => 1.2 * Math.abs(v ?? 0)), ...rows.map((r) => 1.08 * (Math.abs(r.v) + r.e)));
    return Plot.plot({
      width, height: Math.max(240, Math.min(360, width * 0.55)), marginLeft: 50, marginRight: 12, marginBottom: 42, style, grid: true,
      x: { domain: [0, y_end], label: "y across the spreading direction (mm)" }, y: { domain: [-reach, reach], label: "GI, last third − first third", tickFormat: "+.2f" },
      marks: [
        Plot.rect([0], { x1: 0, x2: y_end, y1: -t, y2: t, fill: green, fillOpacity: 0.09 }),
        Plot.ruleY([-t, t], { stroke: green, strokeDasharray: "5 4" }), Plot.ruleY([0], { stroke: "#555" }),
        Plot.ruleX(rows, { x: "y", y1: (r) => r.v - r.e, y2: (r) => r.v + r.e, stroke: "#333", strokeWidth: 1.4 }),
        Plot.dot((d.target ?? []).map((v, b) => ({ y: (profile.y_m[b] ?? 0) * 1e3, v })).filter((r) => known(r.v)), { x: "y", y: "v", r: 5, stroke: green, fill: "#fff" }),
        Plot.dot(rows, { x: "y", y: "v", r: 4.5, fill: "#333", stroke: "#fff", title: (r) => `y ${r.y.toFixed(2)} mm: ${r.v.toFixed(3)} ± ${r.e.toFixed(3)}` }),
      ],
    });
  }
  const layers = result.layers ?? [];
  function layers_figure(width) {
    const name = (l) => `layer ${l.number}`, shade = d3.scaleSequential([0, Math.max(1, layers.length - 1)], d3.interpolateViridis);
    const points = layers.flatMap((l) => l.gi.map((v, b) => ({ name: name(l), y: l.y_m[b] * 1e3, v, low: l.band_low[b], high: l.band_high[b] }))).filter((p) => known(p.v));
    return Plot.plot({
      width, height: Math.max(260, Math.min(400, width * 0.5)), marginLeft: 44, marginRight: 12, marginBottom: 42, style, grid: true,
      x: { domain: [0, y_end], label: "y across the spreading direction (mm)" }, y: { domain: [0, 1], nice: true, label: "gradation index GI" },
      color: { domain: layers.map(name), range: layers.map((_, i) => shade(0.9 * i)), legend: true },
      marks: [
        Plot.line(bins.filter((b) => known(b.target)), { x: "y", y: "target", stroke: "#111", strokeWidth: 1.5, strokeDasharray: "7 4" }),
        Plot.line(points, { x: "y", y: "v", stroke: "name", strokeWidth: 2 }),
        Plot.dot(points, { x: "y", y: "v", fill: "name", r: 3.5, title: (p) => `${p.name}, y ${p.y.toFixed(2)} mm: ${gi(p.v)}${known(p.low) ? `, band ${gi(p.low)} to ${gi(p.high)}` : ""}` }),
      ],
    });
  }
  const layers_table = h("details", {}, h("summary", {}, "The numbers"), table(["layer", R("misfit"), R("x drift"), R("captured"), R("overflow"), R("coverage"), R("packing")],
    layers.map((l) => [`${l.number}${l.judged ? " (judged)" : ""}`, gi(l.misfit.value), gi(l.x_drift.value), percent(l.capture_fraction), percent(l.waste_fraction), percent(l.coverage), gi(l.packing_fraction)])));
  const profile_table = h("details", {}, h("summary", {}, "The numbers"), table(["y mm", R("target"), R("predicted"), R("confirmed"), R("band")],
    bins.map((b) => [b.y.toFixed(2), gi(b.target), gi(b.predicted), gi(b.confirmed), known(b.low) ? `${gi(b.low)} to ${gi(b.high)}` : "–"])));

  section("figures", "Gradation", h("div", { class: "grid" },
    figure("w12", "From the partition to the layer", "Plan view to scale: chambers A (blue) and B (orange) in the dispenser, the land that the blade crosses, and the GI of the layer on the platform. Dashed: the part's footprint, where everything is judged.", whole_plan),
    field ? figure("w12", `Target, ${field.of} and their difference over x and y`, "GI of the cells that the verdict is about: bins along y, equal parts of the footprint along x. Pale: cells left out of the misfit.", field_figure,
      h("details", {}, h("summary", {}, "The numbers"), table(["x mm", "y mm", R("target"), R(field.of), R("difference"), R("band"), ""], field_rows()))) : null,
    bins.length ? figure("w6", field ? "GI(y): means along x" : "Target, predicted and confirmed GI(y)", proved ? `Predicted: relabelled origin map. Confirmed: mean of ${result.confirmations.length} spread${result.confirmations.length === 1 ? "" : "s"} with both powders; boxes: its 95 % band, simultaneous over the bins.${bins.some((b) => known(b.left)) ? ' Hollow grey: bins beside a wall or the periodic seam, left out of the misfit.' : ''}` : heap ? "Predicted by the longest strip's layer, stretched to the machine; boxes: the 95 % band with what the extrapolation carries. No bed of this size was spread." : "Predicted on the origin map only; no confirming spread was made.", profile_figure, profile_table) : null,
    bins.length ? figure("w6", "x drift of each bin", "GI in the last third of the footprint minus the first third; the 95 % error bars hold for all bins together; shaded: tolerance (on the rms over the bins)." + (field ? " Hollow: what the target itself asks to change; the misfit is of the difference." : ""), drift_figure) : null,
    layers.length > 1 ? figure("w12", "GI(y) layer by layer", `The same partition, ${layers.length} doses and passes${proved ? `; mean of ${result.confirmations.length} spread${result.confirmations.length === 1 ? "" : "s"} with both powders` : "; predicted on the origin map"}. Judged: ${result.judged_layer === "all" ? "all layers pooled" : `layer ${result.judged_layer}`}.`, layers_figure, layers_table) : null,
    map ? figure("w6", "GI over the platform", `Cells of ${mm(map.x_m.length > 1 ? map.x_m[1] - map.x_m[0] : null)} mm, ${map.of}. Dashed: the part's footprint. Grey: no powder.`, map_figure) : null,
    origin ? figure("w6", "Where the powder comes from", `Share of the laid solid by place in the dispenser and on the platform (${origin.layers} map layer${origin.layers === 1 ? "" : "s"}). A layer that takes the same mixture of places at every x has no drift.${heap ? " Measured on the longest strip and stretched to the machine." : ""}`, origin_figure) : null,
    origin ? figure("w12", "W(origin): the dispenser's share in the part", "Solid laid in the footprint that came from before x. The straight line would be a dispenser emptied evenly; the partition's first guess is read from this curve.", cumulative_figure) : null,
    heap ? figure("w12", "Order of the dispenser left in the layer, strip by strip", `Dots: strips, by length and dosage. Zero: every grain of the layer comes from anywhere; below, from the dispenser's front, above, from its back. ${heap.law.fitted ? `Dashed: a law of the heap's turnovers; the strips scatter about it by ${gi(heap.law.collapse_error)}, and the design does not use it.` : "Too few strips for a law."}`, heap_figure,
      h("details", {}, h("summary", {}, "What this rests on"), h("ul", {}, heap.rests_on.map((line) => h("li", {}, line))))) : null));

  // Order of every strip (rms error of the fully mixed picture) against its turnovers, with the law, out to the machine.
  function heap_figure(width) {
    const law = heap.law, top = 1.06 * heap.turnovers, steps = d3.range(1, top, top / 240);
    const envelope = (n) => law.amplitude * Math.exp(-n / law.memory), at = (n) => envelope(n) * Math.cos((2 * Math.PI * n) / law.turn + law.phase);
    const reach = 1.25 * d3.max(heap.strips, (s) => Math.abs(s.profile_order));
    return Plot.plot({
      width, height: Math.max(240, Math.min(320, width * 0.36)), marginLeft: 48, marginRight: 16, marginBottom: 42, style, grid: true,
      x: { domain: [0, top], label: "turnovers of the heap, N = √(dispenser length / dose)" },
      y: { domain: [-reach, reach], label: "order left in the layer (GI)", clamp: true },
      marks: [
        Plot.ruleY([0], { stroke: "#888" }),
        law.fitted ? Plot.line(steps, { x: (n) => n, y: (n) => (Math.abs(at(n)) > reach ? NaN : at(n)), stroke: "#5b6b7b", strokeWidth: 1.5, strokeDasharray: "4 4" }) : null,
        Plot.ruleX([heap.turnovers], { stroke: green, strokeWidth: 2, strokeDasharray: "5 4" }),
        Plot.text([heap.turnovers], { x: (n) => n, y: 0.9 * reach, text: () => "this machine", textAnchor: "end", dx: -6, fill: green }),
        Plot.dot(heap.strips, { x: "turnovers", y: "profile_order", r: 5, fill: "#111", stroke: "#fff", title: (s) => `${mm(s.dispenser_length_m)} mm, dosage ${s.dosage_factor.toFixed(2)}: ${s.profile_order.toFixed(3)}` }),
        ...[0, 1].map((odd) => Plot.text(heap.strips.filter((s, i) => i % 2 === odd), { x: "turnovers", y: "profile_order", dx: odd ? 7 : -7, dy: odd ? 12 : -9, textAnchor: odd ? "start" : "end", fontSize: 11, text: (s) => `${+(1e3 * s.dispenser_length_m).toFixed(1)} mm × ${+s.dosage_factor.toFixed(1)}` })),
      ].filter((m) => m),
    });
  }

  function origin_figure(width) {
    const n = origin.cells, L = origin.dispenser_length_m * 1e3, P = origin.platform_length_m * 1e3;
    const cells = origin.share.map((share, k) => ({ o: (Math.floor(k / n) * L) / n, d: ((k % n) * P) / n, share: 100 * share })).filter((c) => c.share > 0);
    const foot = plan.footprint.map((v) => v * 1e3);
    return Plot.plot({
      width, height: Math.max(280, Math.min(420, width * 0.62)) + 40, marginLeft: 44, marginRight: 12, marginBottom: 42, style,
      x: { domain: [0, P], label: "laid at x on the platform (mm)" }, y: { domain: [0, L], label: "came from x in the dispenser (mm)" },
      color: { scheme: "viridis", label: "share of the laid solid (%)", legend: true, domain: [0, d3.quantileSorted(cells.map((c) => c.share).sort(d3.ascending), 0.995) || 1], clamp: true },
      marks: [
        Plot.rect([0], { x1: 0, x2: P, y1: 0, y2: L, fill: "#440154" }),
        Plot.rect(cells, { x1: "d", x2: (c) => c.d + P / n, y1: "o", y2: (c) => c.o + L / n, fill: "share", inset: -0.2 }),
        Plot.ruleX([foot[0], foot[1]], { stroke: "#fff", strokeDasharray: "5 4" }),
        Plot.text([0], { x: (foot[0] + foot[1]) / 2, y: L, text: () => "footprint", fill: "#fff", dy: 12 }),
      ],
    });
  }
  function cumulative_figure(width) {
    const L = origin.dispenser_length_m * 1e3, rows = origin.cumulative.map((w, i) => ({ x: (i * L) / origin.cells, w })).filter((r) => known(r.w));
    return Plot.plot({
      width, height: Math.max(200, Math.min(260, width * 0.4)), marginLeft: 44, marginRight: 12, marginBottom: 42, style, grid: true,
      x: { domain: [0, L], label: "origin x in the dispenser (mm)" }, y: { domain: [0, 1], label: "W" },
      marks: [Plot.line([[0, 0], [L, 1]], { stroke: "#888", strokeDasharray: "5 4" }), Plot.areaY(rows, { x: "x", y: "w", fill: "#555", fillOpacity: 0.1 }), Plot.line(rows, { x: "x", y: "w", stroke: "#111", strokeWidth: 2 })],
    });
  }

  // ---- grains --------------------------------------------------------------------------------------------------------
  if (pictures.length) {
    const last = pictures.length > 1 ? pictures.at(-1) : null, grains = [pictures[0], last].filter(Boolean).map(Grains.unpack), L = plan.dispenser_length_m, W = plan.width_m, x0 = L + plan.land_m, P = plan.platform_length_m;
    const reach = Math.min(4e-3, Math.max(L, P)); // longer pictures would have grains below a pixel
    const lands = [[-1, 0, 0], [L, x0, 0], [x0, x0 + P, -plan.gap_m], [x0 + P, 1e3, 0]];
    const r_max = pictures[0].radius_max, bed_floor = -plan.bed_depth_m - r_max;
    const before = [Math.max(0, L - reach), L], after = [x0 + Math.max(0, P - reach), x0 + P];
    const rise = plan.dose_height_m + 2 * r_max;
    const depth = Math.max(plan.bed_depth_m, plan.gap_m) + 2 * r_max;
    const views = [
      ["w6", "Before: the dispenser from above", `Levelled bed, raised by the dose of ${mm(plan.dose_height_m)} mm; ${pictures[0].grains.toLocaleString("en-GB")} mobile grains in the run.`, (w) => Grains.plan(grains[0], w, [...before, 0, W], "#3a3f45", "the bed before the spread from above")],
      last ? ["w6", "After: the layer from above", "Grains on the platform when the blade has passed; grey: the substrate below.", (w) => Grains.plan(grains[1], w, [...after, 0, W], "#aab2bb", "the layer after the spread from above")] : null,
      ["w12", "Before: cut along the middle of the dispenser", "Cut at half the width, to scale, circles are true sections of grains. Dashed: z = 0, the blade's edge.", (w) => Grains.slice(grains[0], w, [...before, -depth, rise], W / 2, [[-1, 1e3, bed_floor]], "the bed before the spread, cut")],
      last ? ["w12", "After: cut along the middle of the platform", `Same scale. Grey: the substrate's mean plane, ${mm(plan.gap_m)} mm below the blade's edge.`, (w) => Grains.slice(grains[1], w, [...after, -depth, rise / 2], W / 2, lands, "the layer after the spread, cut")] : null];
    section("grains", "Bed and layer",
      h("p", { class: "note", style: "margin:0" }, h("span", { class: "key A" }), `A, ${data.materials.A} `, h("span", { class: "key B", style: "margin-left:1em" }), `B, ${data.materials.B}`),
      h("div", { class: "grid" }, spread_figure(), views.filter(Boolean).map((v) => figure(...v))));
  }
  // Its nodes stay, and it draws itself anew: only the width is handed on.
  function spread_figure() {
    const view = SpreadScene.build(pictures, plan, h), box = h("div", { class: "plot scene" }, view.nodes);
    drawn.push({ box, title: "The spread in 3-D", width: 0, keep: view.redraw });
    return h("figure", { class: "w12" }, h("h3", {}, "The spread in 3-D: before, during, after"), box, h("figcaption", {}, `Dispenser, land and platform to scale, from the first confirming spread. Grains: A blue, B orange, places to ${(1e6 * Math.max(...pictures.flatMap((p) => p.extent)) / 65535).toFixed(2)} µm. Before: the bed raised by the dose, and where the partition stood while it was filled (dark; drawn higher than the bed). During: the blade is see-through. ${plan.periodic ? "The two long sides are joined: what leaves one comes in at the other. " : ""}${view.note}`), result.files.includes("film.webp") ? h("p", { class: "note" }, "The same spread as an animated picture: ", h("a", { href: "film.webp" }, "film.webp"), ".") : null);
  }

  // ---- sensitivity: there when `gradwright sensitivity OUT` has run ---------------------------------------------------
  const moved = data.sensitivity;
  if (moved) {
    const ranked = moved.ranked.filter((r) => known(r.gi_rms)), floor = moved.noise_floor, budget = moved.budget;
    const names = ranked.map((r) => r.name), kinds = ["label: on the map", "moves grains: on strips"];
    const kind = (r) => kinds[+r.moves_grains];
    const room = Math.min(230, 24 + 6.6 * d3.max(names, (n) => n.length));
    const tornado = (width) => Plot.plot({
      width, height: 70 + 24 * ranked.length, marginLeft: room, marginRight: 56, marginBottom: 42, style,
      color: { domain: kinds, range: [blue, orange], legend: ranked.some((r) => r.moves_grains) },
      x: { label: "change of GI over the input's range, rms over the bins", grid: true, domain: [0, 1.12 * Math.max(floor, d3.max(ranked, (r) => r.gi_rms + (r.error ?? 0)))] }, y: { label: null, domain: names },
      marks: [Plot.barX(ranked, { x: "gi_rms", y: "name", fill: kind }),
        Plot.ruleY(ranked.filter((r) => known(r.error)), { x1: (r) => Math.max(0, r.gi_rms - r.error), x2: (r) => r.gi_rms + r.error, y: "name", stroke: "#111", strokeWidth: 1.5 }),
        Plot.ruleX([floor], { stroke: "#555", strokeDasharray: "5 4" }), Plot.ruleX([0]),
        Plot.text(ranked, { x: (r) => r.gi_rms + (r.error ?? 0), y: "name", text: (r) => gi(r.gi_rms) + (r.unmeasured ? " *" : ""), textAnchor: "start", dx: 5, stroke: "#fff", strokeWidth: 4, fill: "#111" })],
    });
    const indices = moved.labels.filter((l) => known(l.gi_total)).flatMap((l) => [{ name: l.name, index: "first", v: l.gi_first }, { name: l.name, index: "total", v: l.gi_total }]);
    const order = names.filter((n) => indices.some((d) => d.name === n));
    const sobol = (width) => Plot.plot({
      width, height: 70 + 30 * order.length, marginLeft: room, marginRight: 40, marginBottom: 42, style,
      color: { domain: ["first", "total"], range: [blue, "#9aa5b1"], legend: true }, x: { label: "share of GI's variance", grid: true, domain: [Math.min(0, d3.min(indices, (d) => d.v)), Math.max(1, d3.max(indices, (d) => d.v))] },
      fy: { label: null, domain: order, axis: "left" }, y: { axis: null, domain: ["first", "total"] },
      marks: [Plot.barX(indices, { x: "v", y: "index", fy: "name", fill: "index", title: (d) => `${d.name}, ${d.index}: ${d.v.toFixed(3)}` }), Plot.ruleX([0])],
    });
    const um = (v) => (known(v) ? `±${(1e6 * v).toFixed(0)} µm` : "any");
    section("sensitivity", "What moves it, and what tolerances it needs", h("div", { class: "grid" },
      figure("w6", "What moves GI", `Each input over its range; dashed: the map's noise floor (${gi(floor)}).${ranked.some((r) => r.unmeasured) ? " * not measured: a default." : ""}${known(moved.surrogate.leave_one_out_gi_rms) ? ` The line through ${moved.surrogate.strips} strips misses one it has not seen by ${gi(moved.surrogate.leave_one_out_gi_rms)}.` : ""}`, tornado),
      indices.length ? figure("w6", "Sobol indices of the labels", "First: alone; total: with all it acts through. Of GI, all bins that count together.", sobol) : null,
      h("div", { class: "card w12" }, h("h3", {}, `Tolerance budget, ${budget.class}`),
        h("p", { class: "note" }, `GI error ${gi(budget.worst_case_rms)} at worst, ${gi(budget.rss_rms)} root sum of squares, 95 % of plates within ${gi(budget.band_95_rms)} (tried on ${budget.check_on_maps.plates} plates on the map: ${(100 * budget.check_on_maps.inside).toFixed(1)} % of the bins inside). Needed: for a GI error of ${gi(budget.gi_error_promised)}${budget.gi_error_promised > budget.gi_error_asked ? `, the noise floor; ${gi(budget.gi_error_asked)} was asked` : ""}.`),
        table(["dimension", R("nominal mm"), R("general"), R("share of the error"), R("needed"), ""], budget.dimensions.map((d) => [d.name, mm(d.nominal_m), um(d.tolerance_m), percent(d.share), um(d.needed_m), d.tighter_than_general ? "tighter than general" : ""])))));
  }

  // ---- search --------------------------------------------------------------------------------------------------------
  const history = result.history.map((e, i) => ({ ...e, i: i + 1 }));
  const stages = [...new Set(history.map((e) => e.stage))];
  const stage_colour = { domain: stages, range: ["#555", "#a05195", green, "#d55e00", "#56b4e9", "#332288"].slice(0, stages.length), legend: true };
  const convergence = (field, tolerance, label) => (width) => {
    const rows = history.filter((e) => known(e[field]));
    return Plot.plot({
      width, height: 270, marginLeft: 48, marginRight: 12, marginBottom: 42, style, grid: true, color: stage_colour,
      x: { label: "evaluation", domain: [0.5, Math.max(2, history.length) + 0.5], ticks: Math.min(history.length, Math.floor(width / 60)), tickFormat: "d" },
      y: { label, domain: [0, 1.1 * Math.max(tolerance * 1.3, ...rows.map((e) => e[field]))] },
      marks: [Plot.ruleY([tolerance], { stroke: green, strokeDasharray: "5 4" }), Plot.text([0], { x: Math.max(2, history.length) + 0.5, y: tolerance, text: () => "tolerance", textAnchor: "end", dy: -7, fill: green }),
        Plot.line(rows, { x: "i", y: field, stroke: "#bbb" }),
        Plot.dot(rows, { x: "i", y: field, fill: "stage", r: 4.5, title: (e) => `${e.stage} (${e.fidelity}), ${label} ${gi(e[field])}, ${e.spreads} spreads, ${duration(e.seconds)}${e.note ? "\n" + e.note : ""}` })],
    });
  };
  const stage_rows = Object.entries(result.stage_seconds).map(([stage, seconds]) => ({ stage, seconds })).filter((r) => known(r.seconds)).sort((a, b) => b.seconds - a.seconds);
  section("search", "Search and cost", h("div", { class: "grid" },
    history.length ? figure("w6", "Convergence of the misfit", "Every step of the search in order; colour: stage.", convergence("misfit", result.misfit.tolerance, "misfit")) : null,
    history.length ? figure("w6", "Convergence of the x drift", "The same steps. The confirming spreads carry both powders, each with its own density and stiffness.", convergence("x_drift", result.x_drift.tolerance, "x drift")) : null,
    stage_rows.length ? figure("w6", "Wall time by stage", `${duration(result.seconds)} in all; ${duration(result.seconds_cold)} had nothing been in the cache.`, (width) => Plot.plot({
      width, height: 62 + 30 * stage_rows.length, marginLeft: 110, marginRight: 92, marginBottom: 42, style, x: { label: "seconds", grid: true, ticks: Math.max(3, width / 120) }, y: { label: null, domain: stage_rows.map((r) => r.stage) },
      marks: [Plot.barX(stage_rows, { x: "seconds", y: "stage", fill: "#5b6b7b" }), Plot.text(stage_rows, { x: "seconds", y: "stage", text: (r) => duration(r.seconds), textAnchor: "start", dx: 5 }), Plot.ruleX([0])] })) : null,
    h("div", { class: "card w6" }, h("h3", {}, "Speed of the confirming spreads"), data.speed.length ? table(["seed", R("grains"), R("steps"), R("grain-steps"), R("time"), R("grain-steps/s")],
      data.speed.map((s) => [String(s.seed), big(s.grains), big(s.steps), big(s.grain_steps), duration(s.seconds_cold ?? s.seconds), known(s.grain_steps) && (s.seconds_cold ?? s.seconds) > 0 ? big(s.grain_steps / (s.seconds_cold ?? s.seconds)) : "–"])) : h("p", { class: "note" }, "No confirming spread was made."),
      h("p", { class: "note" }, "Only grains whose forces were evaluated count. Times are those of an empty cache."),
      result.beds.length ? h("div", {}, h("h3", { style: "margin-top:1rem" }, "Settled beds"), table([R("packing"), R("coordination"), R("overlap / r"), R("speed / √(g d)"), R("carried weight")],
        result.beds.map((b) => [known(b.packing_fraction) ? b.packing_fraction.toFixed(3) : "–", known(b.mean_coordination) ? b.mean_coordination.toFixed(2) : "–", known(b.max_overlap_ratio) ? b.max_overlap_ratio.toFixed(4) : "–", known(b.speed_number) ? b.speed_number.toExponential(1) : "–", known(b.carried_weight_ratio) ? b.carried_weight_ratio.toFixed(4) : "–"]))) : null),
    ...reduction_figures(),
    result.constraints?.length ? h("div", { class: "card w12" }, h("h3", {}, "Constraints and limits, as the design found stands to them"), table(["name", R("value"), R("at least"), R("at most"), R("slack"), "kept"],
      result.constraints.map((c) => { const show = (v) => (!known(v) ? "–" : c.unit === "m" ? `${mm(v)} mm` : c.unit === "rad" ? `${((v * 180) / Math.PI).toFixed(3)}°` : v.toFixed(4)); return [c.name, show(c.value), show(c.at_least), show(c.at_most), show(c.slack), c.kept ? "yes" : "NO"]; }))) : null,
    result.given_used.length ? h("div", { class: "card w12" }, h("h3", {}, "Options of the search, given and used"), table(["option", "given → used"], result.given_used.map((g) => [g.option, g.given_used]))) : null));

  // What the reductions in use are known to cost; function declarations are hoisted above their use.
  function reduction_figures() {
    const cost = data.reduction_cost, names = result.reductions.length ? result.reductions.join(", ") : "none";
    if (cost === undefined) return []; // data of earlier versions
    if (!cost) return [h("div", { class: "card w12" }, h("h3", {}, "Speed against error"), h("p", { class: "note" }, `Reductions in use: ${names}. What this set gains and costs has not been measured. This spreads it beside finer ones and puts the table here:`), h("pre", { tabindex: "0" }, "gradwright tradeoff OUT --around study"))];
    const levels = cost.levels, used = levels.find((l) => l.name === cost.used), allowed = cost.noise_allowed * used.noise_floor, kinds = ["in use", "finest", "another set"];
    const kind = (l) => (l === used ? kinds[0] : l.name === "finest" ? kinds[1] : kinds[2]);
    const draw = (width) => Plot.plot({
      width, height: Math.max(240, Math.min(320, width * 0.55)), marginLeft: 52, marginRight: 16, marginBottom: 42, style, grid: true,
      color: { domain: kinds, range: ["#111", "#6b7280", "#56b4e9"], legend: true }, symbol: { domain: kinds, range: ["star", "diamond2", "circle"] },
      x: { type: "log", label: "speed-up against the finest level", domain: [0.85 * d3.min(levels, (l) => l.speed_up), 1.25 * d3.max(levels, (l) => l.speed_up)], ticks: width < 500 ? 4 : 8, tickFormat: String },
      y: { label: "GI rms difference to the finest", domain: [0, 1.12 * d3.max(levels, (l) => Math.max(l.gi_rmse, cost.noise_allowed * l.noise_floor))] },
      marks: [
        Plot.ruleX(levels, { x: "speed_up", y1: 0, y2: (l) => cost.noise_allowed * l.noise_floor, stroke: "#b7c0c9", strokeWidth: 7, strokeOpacity: 0.6 }),
        Plot.dot(levels, { x: "speed_up", y: "gi_rmse", fill: kind, symbol: kind, stroke: "#fff", sort: null, r: (l) => (l === used ? 8 : 5), title: (l) => `${l.name}: ${l.meaning}\nspeed-up ${l.speed_up.toFixed(2)}, GI rms ${gi(l.gi_rmse)}, noise floor ${gi(l.noise_floor)}` }), Plot.ruleY([0])],
    });
    const per_million = (share) => (!known(share) ? "–" : share > 0 && share < 1e-6 ? "< 1" : (1e6 * share).toFixed(0));
    const word = (l) => (l === used ? "in use" : l.name === "finest" ? "" : !l.within_noise ? "beyond the noise" : !l.overlap_rule_kept ? "overlaps too large" : "free");
    const said = `Reductions in use: ${names}. On ${cost.own ? "this study" : `another study (${cost.study}; ${cost.source})`} this set is ${used.speed_up.toFixed(1)} times as fast as the finest level, and its GI(y) differs from the finest's by ${gi(used.gi_rmse)} rms, ${used.gi_rmse <= allowed ? "within" : "beyond"} ${cost.noise_allowed} noise floors of ${gi(used.noise_floor)} each; its largest overlap is ${(100 * used.max_overlap_ratio).toFixed(1)} % of a radius${used.max_overlap_ratio <= 0.03 || !known(used.deep_contact_share) ? "" : `, where 3 % is the rule (${per_million(used.deep_contact_share)} contacts in a million went beyond)`}.`;
    return [figure("w6", "Speed against error of the reductions", `Grey bars: ${cost.noise_allowed} noise floors; a mark within its bar cannot be told from the finest with ${cost.seeds} beds.`, draw),
      h("div", { class: "card w6" }, h("h3", {}, "What the reductions in use cost"), h("p", {}, said), table(["level", R("speed-up"), R("GI rms"), R("floor"), R("packing"), R("overlap / r"), R("deep"), ""],
        levels.map((l) => [l.name, l.speed_up.toFixed(2), gi(l.gi_rmse), gi(l.noise_floor), `${(100 * l.packing_error).toFixed(1)} %`, `${(100 * l.max_overlap_ratio).toFixed(1)} %`, per_million(l.deep_contact_share), word(l)])), h("p", { class: "note" }, "Deep: contacts in a million that overlap by more than 3 % of a radius. ", cost.own ? "Measured by" : "Measured by the command below. For this study itself: gradwright tradeoff OUT --around study."), h("pre", { tabindex: "0" }, cost.command))];
  }

  // ---- inputs and provenance -----------------------------------------------------------------------------------------
  const body = h("tbody");
  let group = "";
  for (const input of result.inputs) {
    const head = input.key.includes(".") ? input.key.split(".")[0] : "study";
    if (head !== group) body.append(h("tr", { class: "group" }, h("td", { colspan: "4" }, (group = head))));
    const origin_class = { given: "given", assumed: "assumed" }[input.origin] ?? "";
    const shown = input.unit && !input.value.endsWith(input.unit) ? `${input.value} ${input.unit}` : input.value;
    body.append(h("tr", {}, h("td", {}, input.key), h("td", {}, shown), h("td", {}, h("span", { class: "tag " + origin_class }, input.origin)), h("td", { class: "note" }, input.note)));
  }
  section("inputs", "Every input", h("div", { class: "card scroll", tabindex: "0", role: "region", "aria-label": "inputs" },
    result.reductions.length ? h("p", { style: "margin-top:0" }, "Named reductions: ", h("strong", {}, result.reductions.join(", "))) : null,
    h("table", { class: "wide" }, h("thead", {}, h("tr", {}, ["key", "value", "origin", "note"].map((t) => h("th", { scope: "col" }, t)))), body)));

  const p = result.provenance, facts = [["program", `${p.program} ${p.version} (${p.source})`], ["compiler", p.compiler], ["flags", p.flags], ["compiled for", p.instruction_set], ["host", `${p.host.isa || "unknown"}, ${p.host.cores} cores, ${p.host.threads} threads used`], ["HDF5", p.hdf5], ["seed", String(result.seed)], ["study file", result.study_file], ["machine", result.machine]];
  section("provenance", "Provenance", h("div", { class: "grid" },
    h("div", { class: "card w6" }, h("h3", {}, "Made by"), h("dl", {}, facts.flatMap(([k, v]) => [h("dt", {}, k), h("dd", {}, v ?? "–")]))),
    h("div", { class: "card w6" }, h("h3", {}, "Make it again"), h("pre", { tabindex: "0" }, data.command), h("p", { class: "note" }, "The same study, seed and program give the same numbers on any number of threads."),
      result.files.length ? h("div", {}, h("h3", {}, "Files beside this page"), h("p", { class: "note", style: "margin:0" }, result.files.join("  ·  "))) : null),
    h("div", { class: "card w12" }, h("h3", {}, "Study file, as written"), h("pre", { tabindex: "0" }, data.study_text))));
  document.body.append(h("footer", {}, "Figures drawn with Observable Plot 0.6 and D3 7 (ISC licence), the grains in 3-D with three.js (MIT licence), contained in this page. Colours after Okabe and Ito. Lengths in mm on this page, in m in the JSON and HDF5 files."));

  // Folded numbers would be lost on paper.
  const unfolded = [];
  window.addEventListener("beforeprint", () => { for (const d of document.querySelectorAll("details:not([open])")) { d.open = true; unfolded.push(d); } });
  window.addEventListener("afterprint", () => { for (const d of unfolded.splice(0)) d.open = false; });

  redraw();
  let waiting = 0;
  new ResizeObserver(() => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(redraw); }).observe(page);
})();
