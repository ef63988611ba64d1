// Pictures of the bed: grains packed as 8-byte records (see grain_picture.h) drawn on canvases, to scale.
"use strict";
const Grains = (() => {
  const colours = { A: [0, 114, 178], B: [230, 159, 0] };

  function unpack(picture) {
    const bytes = Uint8Array.from(atob(picture.data), (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    const n = picture.shown;
    const grains = { n, x: new Float64Array(n), y: new Float64Array(n), z: new Float64Array(n), r: new Float64Array(n), a: new Uint8Array(n) };
    const place = (axis, q) => picture.origin[axis] + (q / 65535) * picture.extent[axis];
    for (let i = 0; i < n; ++i) {
      grains.x[i] = place(0, view.getUint16(8 * i, true));
      grains.y[i] = place(1, view.getUint16(8 * i + 2, true));
      grains.z[i] = place(2, view.getUint16(8 * i + 4, true));
      grains.r[i] = (bytes[8 * i + 6] / 255) * picture.radius_max;
      grains.a[i] = bytes[8 * i + 7] & 1;
    }
    return grains;
  }

  function sheet(width, height, label) {
    const canvas = document.createElement("canvas");
    const ratio = Math.max(2, window.devicePixelRatio || 1); // crisp on paper too
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.width = width + "px"; // the height follows: paper is narrower than the screen it was drawn for
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", label);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    return { canvas, pen };
  }

  const shade = (rgb, f) => `rgb(${rgb.map((c) => Math.round(f < 1 ? c * f : c + (255 - c) * (f - 1))).join(",")})`;

  // A round length near a fifth of the picture.
  function scale_bar(pen, width, height, scale) {
    const wanted = (width / scale) * 0.2 * 1e3;
    const step = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].reduce((a, b) => (Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a));
    const length = step * 1e-3 * scale, x = width - length - 10, y = height - 8;
    pen.font = "600 11px system-ui, sans-serif";
    pen.textAlign = "center";
    const words = `${step} mm`;
    pen.fillStyle = "rgba(255,255,255,.82)";
    pen.fillRect(x - 5, y - 19, length + 10, 24);
    pen.fillStyle = "#111";
    pen.fillRect(x, y - 2.5, length, 2.5);
    pen.fillText(words, x + length / 2, y - 6);
  }

  // Grains seen from above, x to the right, y up; the higher the lighter.
  function plan(grains, width, window_m, background, label) {
    const [x0, x1, y0, y1] = window_m;
    const scale = width / (x1 - x0), height = Math.round(scale * (y1 - y0));
    const { canvas, pen } = sheet(width, height, label);
    pen.fillStyle = background;
    pen.fillRect(0, 0, width, height);
    let low = Infinity, high = -Infinity;
    const inside = (i) => grains.x[i] > x0 - grains.r[i] && grains.x[i] < x1 + grains.r[i];
    for (let i = 0; i < grains.n; ++i) if (inside(i)) { low = Math.min(low, grains.z[i]); high = Math.max(high, grains.z[i]); }
    for (let i = 0; i < grains.n; ++i) { // sorted by z: painter's order
      if (!inside(i)) continue;
      const r = grains.r[i] * scale, f = 0.62 + 0.5 * (high > low ? (grains.z[i] - low) / (high - low) : 1);
      pen.beginPath();
      pen.arc((grains.x[i] - x0) * scale, height - (grains.y[i] - y0) * scale, Math.max(r, 0.4), 0, 7);
      pen.fillStyle = shade(grains.a[i] ? colours.A : colours.B, f);
      pen.fill();
      if (r > 2) { pen.strokeStyle = "rgba(0,0,0,.28)"; pen.lineWidth = 0.5; pen.stroke(); }
    }
    scale_bar(pen, width, height, scale);
    return canvas;
  }

  // The cut y = middle, x to the right, z up: circles are the grains' true sections. `solids`: [[x0, x1, z_top], ...] drawn grey.
  function slice(grains, width, window_m, middle, solids, label) {
    const [x0, x1, z0, z1] = window_m;
    const scale = width / (x1 - x0), height = Math.round(scale * (z1 - z0));
    const { canvas, pen } = sheet(width, height, label);
    const top = (z) => height - (z - z0) * scale;
    pen.fillStyle = "#fff";
    pen.fillRect(0, 0, width, height);
    pen.fillStyle = "#aab2bb";
    for (const [a, b, z] of solids) pen.fillRect((a - x0) * scale, top(z), (b - a) * scale, height);
    pen.setLineDash([5, 4]);
    pen.strokeStyle = "#555";
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(0, top(0));
    pen.lineTo(width, top(0));
    pen.stroke();
    pen.setLineDash([]);
    for (let i = 0; i < grains.n; ++i) {
      const away = grains.y[i] - middle, section = grains.r[i] ** 2 - away ** 2;
      if (section <= 0 || grains.x[i] < x0 - grains.r[i] || grains.x[i] > x1 + grains.r[i]) continue;
      pen.beginPath();
      pen.arc((grains.x[i] - x0) * scale, top(grains.z[i]), Math.max(Math.sqrt(section) * scale, 0.4), 0, 7);
      pen.fillStyle = shade(grains.a[i] ? colours.A : colours.B, 1);
      pen.fill();
      if (scale * grains.r[i] > 2) { pen.strokeStyle = "rgba(0,0,0,.4)"; pen.lineWidth = 0.6; pen.stroke(); }
    }
    return canvas;
  }

  return { unpack, plan, slice };
})();
