// Speed against error: scatter of the levels, their profiles, the table. All text goes in as text nodes.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const page = document.getElementById("page");
  const known = (v) => v != null && Number.isFinite(v);
  const per_million = (v) => (!known(v) ? "–" : v > 0 && v < 1e-6 ? "< 1" : (1e6 * v).toFixed(0));
  const fixed = (v, n) => (known(v) ? v.toFixed(n) : "–");
  function h(tag, attributes = {}, ...children) {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) if (value != null) node.setAttribute(key, value);
    node.append(...children.flat().filter((c) => c != null));
    return node;
  }
  const style = { fontSize: "12px", background: "none", overflow: "visible" };
  const blue = "#0072B2", orange = "#E69F00", grey = "#6b7280", green = "#007a5a";
  const ran = data.levels.filter((l) => known(l.gi_rmse) && known(l.speed_up));
  const kind = (l) => (l.name === data.recommended ? "recommended" : l.name === "finest" ? "finest" : !l.within_noise ? "error beyond the noise" : !l.overlap_rule_kept ? "overlaps too large" : "free");
  const colours = { domain: ["recommended", "free", "error beyond the noise", "overlaps too large", "finest"], range: [green, blue, orange, "#cc79a7", grey] };
  const shapes = { domain: colours.domain, range: ["star", "circle", "triangle", "square", "diamond2"] };

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

  // Names beside the dots, pushed apart downwards where dots lie close.
  function placed(width, x, y) {
    const labels = ran.map((l) => ({ l, px: x(l.speed_up), py: y(l.gi_rmse) })).sort((a, b) => a.py - b.py || a.px - b.px);
    const taken = [];
    for (const one of labels) {
      const left = one.px > width - 150, size = 7 * one.l.name.length;
      one.anchor = left ? "end" : "start";
      one.x0 = left ? one.px - 9 - size : one.px + 9;
      one.ty = one.py;
      for (let again = true; again; ) {
        again = false;
        for (const other of taken)
          if (Math.abs(other.ty - one.ty) < 13 && one.x0 < other.x0 + other.size && other.x0 < one.x0 + size) { one.ty = other.ty + 13; again = true; }
      }
      taken.push({ ty: one.ty, x0: one.x0, size });
    }
    return labels;
  }
  function scatter(width) {
    const height = Math.max(300, Math.min(460, width * 0.5)), marginLeft = 58, marginRight = 24, marginTop = 24, marginBottom = 46;
    const fastest = Math.max(...ran.map((l) => l.speed_up)), slowest = Math.min(...ran.map((l) => l.speed_up));
    const domain = [0.85 * slowest, 1.3 * fastest], top = 1.15 * Math.max(...ran.map((l) => Math.max(l.gi_rmse, data.noise_allowed * l.noise_floor)));
    const x = d3.scaleLog(domain, [marginLeft, width - marginRight]), y = d3.scaleLinear([0, top], [height - marginBottom, marginTop]);
    const labels = placed(width, x, y);
    return Plot.plot({
      width, height, marginLeft, marginRight, marginTop, marginBottom, style,
      x: { type: "log", domain, label: "speed-up against the finest level →", grid: true, ticks: width < 500 ? 4 : 8, tickFormat: (v) => String(v) },
      y: { domain: [0, top], label: "↑ GI rms difference to the finest", grid: true }, color: { ...colours, legend: true }, symbol: shapes,
      marks: [
        Plot.ruleX(ran, { x: "speed_up", y1: 0, y2: (l) => data.noise_allowed * l.noise_floor, stroke: "#b7c0c9", strokeWidth: 7, strokeOpacity: 0.55 }),
        ...["start", "end"].map((anchor) => Plot.text(labels.filter((o) => o.anchor === anchor), { x: (o) => o.l.speed_up, y: (o) => y.invert(o.ty), text: (o) => o.l.name, textAnchor: anchor, dx: anchor === "start" ? 9 : -9, fill: "#1b1f24", stroke: "#fff", strokeWidth: 3 })),
        Plot.dot(ran, { x: "speed_up", y: "gi_rmse", fill: kind, symbol: kind, stroke: "#fff", strokeWidth: 1, r: (l) => (l.name === data.recommended ? 9 : 6), tip: true, title: (l) => `${l.name}: ${l.meaning}\nspeed-up ${fixed(l.speed_up, 2)}, GI rms ${fixed(l.gi_rmse, 3)}, floor ${fixed(l.noise_floor, 3)}` }),
        Plot.ruleY([0]),
      ],
    });
  }
  function profiles(width) {
    const points = ran.flatMap((l) => l.gi.map((gi, b) => ({ name: l.name, y: data.profile.y_m[b] * 1e3, gi, counts: data.profile.weight[b] > 0 }))).filter((p) => known(p.gi) && p.counts);
    const marked = new Set(["finest", "study", data.recommended]);
    return Plot.plot({
      width, height: Math.max(260, Math.min(420, width * 0.6)), marginLeft: 46, marginBottom: 42, style,
      x: { label: "y, across (mm) →" }, y: { domain: [0, 1], label: "↑ GI of the start design", grid: true },
      color: { domain: [...marked].filter(Boolean), range: [grey, orange, green], legend: true },
      marks: [
        Plot.line(points.filter((p) => !marked.has(p.name)), { x: "y", y: "gi", z: "name", stroke: "#cbd2d9", strokeWidth: 1.2 }),
        Plot.line(points.filter((p) => marked.has(p.name)), { x: "y", y: "gi", z: "name", stroke: "name", strokeWidth: 2.4 }),
        Plot.dot(points.filter((p) => marked.has(p.name)), { x: "y", y: "gi", fill: "name", r: 3.5 }),
      ],
    });
  }
  const right = (name) => ({ name, right: true });
  function table(head, rows) {
    return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "table of the levels" }, h("table", {},
      h("thead", {}, h("tr", {}, head.map((c) => h("th", { scope: "col", class: c.right ? "r" : null }, c.name ?? c)))),
      h("tbody", {}, rows.map((row) => h("tr", {}, row.map((cell, i) => h("td", { class: head[i].right ? "r" : null, style: i === 1 ? "min-width:15em" : null }, cell ?? "–")))))));
  }

  if (data.status !== "ok") page.append(h("div", { class: "warn", role: "note" }, h("strong", {}, "Interrupted"), " the table is of what was spread until then."));
  page.append(h("div", { class: "grid", id: "figures" },
    ran.length ? figure("w8", "Speed against error", `Grey bars reach up to ${data.noise_allowed} noise floors: a level whose mark lies within its bar cannot be told from the finest with ${data.seeds} beds. Triangles lie above it.`, scatter) : null,
    ran.length ? figure("w4", "Gradation of each level", "Mean GI(y) over the bins that count; the other levels are the pale lines.", profiles) : null,
    h("div", { class: "card w12" }, h("h3", {}, "Every level"), table(["level", "what it is", right("grains"), right("steps"), right("grain-steps"), right("seconds"), right("speed-up"), right("GI rms"), right("noise floor"), right("GI error"), right("packing error"), right("largest overlap / r"), right("deep contacts in a million"), ""],
      data.levels.map((l) => known(l.grains)
        ? [l.name, l.meaning, Math.round(l.grains).toLocaleString("en-GB"), Math.round(l.steps).toLocaleString("en-GB"), l.grain_steps.toExponential(2), fixed(l.seconds, 1), fixed(l.speed_up, 2), fixed(l.gi_rmse, 3), fixed(l.noise_floor, 3), fixed(l.gi_error, 3), known(l.packing_error) ? `${(100 * l.packing_error).toFixed(1)} %` : "–", known(l.max_overlap_ratio) ? `${(100 * l.max_overlap_ratio).toFixed(1)} %` : "–", per_million(l.deep_contact_share), l.status === "ok" ? kind(l) : l.status]
        : [l.name, l.meaning, "–", "–", "–", "–", "–", "–", "–", "–", "–", "–", "–", l.reason ? `${l.status}: ${l.reason}` : l.status]))),
    h("div", { class: "card w12" }, h("h3", {}, "How to read it"), h("p", { class: "note" }, "GI rms: difference between a level's mean GI(y) and the finest level's, over the bins that count. Noise floor: what two such means differ by when only the packings differ; the variance between beds, times the grains, is shared by all levels. GI error: the difference with the floor taken out in squares. Packing: of coarse grains it is no prediction. Deep contacts: those that overlap by more than 3 % of the smaller radius, of all that were seen; one in a thousand is allowed. Seconds: one spread with an empty cache, packing included, on the machine named below."),
      (() => { const best = data.levels.find((l) => l.name === data.recommended); return best ? h("pre", { tabindex: "0" }, best.reductions.set.filter((s) => s !== "run.map_spreads=1").map((s) => `--set '${s}'`).join(" \\\n")) : null; })(),
      h("p", { class: "note" }, `${data.provenance.program} ${data.provenance.version} (${data.provenance.source}), ${data.provenance.host.isa || "unknown"}, ${data.provenance.host.cores} cores, ${data.provenance.host.threads} threads used.`))));
  document.body.append(h("footer", {}, "Figures drawn with Observable Plot 0.6 and D3 7 (ISC licence), contained in this page. Colours after Okabe and Ito."));
  redraw();
  let waiting = 0;
  new ResizeObserver(() => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(redraw); }).observe(page);
})();
