// The dispenser, the land and the platform in 3-D, with every kept instant of the spread: three.js draws the grains as spheres, one
// quadrilateral each. Without WebGL, and on paper, the same instants stand as parallel projections.
"use strict";
const SpreadScene = (() => {
  // The 8 bytes of a grain go to the graphics card as they are: u16 x, y, z, and radius + 256 powder.
  const vertex = `
    in vec2 corner; in vec4 grain;
    uniform vec3 low, extent; uniform float radius_max, cut;
    out vec2 at; out vec3 centre; out float radius; flat out float powder_a;
    void main() {
      vec3 place = low + grain.xyz / 65535.0 * extent;
      powder_a = step(255.5, grain.w);
      radius = (grain.w - 256.0 * powder_a) / 255.0 * radius_max;
      vec4 seen = modelViewMatrix * vec4(place, 1.0);
      centre = seen.xyz;
      at = corner;
      gl_Position = place.y < cut ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * (seen + vec4(corner * radius, 0.0, 0.0));
    }`;
  const fragment = `
    in vec2 at; in vec3 centre; in float radius; flat in float powder_a;
    uniform mat4 projectionMatrix;
    out vec4 colour;
    void main() {
      float from_axis = dot(at, at);
      if (from_axis > 1.0) discard;
      vec3 normal = vec3(at, sqrt(1.0 - from_axis));
      vec4 place = projectionMatrix * vec4(centre + radius * normal, 1.0);
      gl_FragDepth = 0.5 * place.z / place.w + 0.5;
      float light = 0.45 + 0.6 * max(0.0, dot(normal, normalize(vec3(-0.3, 0.6, 0.75))));
      colour = vec4(mix(vec3(0.902, 0.624, 0.0), vec3(0.0, 0.447, 0.698), powder_a) * light, 1.0);
    }`;

  function bytes_of(picture) {
    return Uint8Array.from(atob(picture.data), (c) => c.charCodeAt(0));
  }

  // Solid bodies in mm: the floors that carry powder, and how thick they are drawn.
  function bodies(plan) {
    const mm = (v) => v * 1e3, L = mm(plan.dispenser_length_m), W = mm(plan.width_m), land = mm(plan.land_m), P = mm(plan.platform_length_m);
    const depth = mm(plan.bed_depth_m), gap = mm(plan.gap_m), thick = Math.max(0.1 * W, 1.2 * depth), behind = Math.min(mm(plan.second_land_m ?? 0), 0.3 * P + land);
    const solids = [
      { name: "dispenser floor", x: [0, L], z: [-depth - 0.4 * thick, -depth], colour: 0x9aa3ad },
      { name: "land", x: [L, L + land], z: [-thick, 0], colour: 0xc3cad2 },
      { name: "platform", x: [L + land, L + land + P], z: [-gap - thick, -gap], colour: 0xaab2bb },
      { name: "second land", x: [L + land + P, L + land + P + behind], z: [-thick, 0], colour: 0xc3cad2 },
    ];
    return { solids: solids.filter((s) => s.x[1] > s.x[0]), L, W, end: L + land + P + behind, depth, dose: mm(plan.dose_height_m), thick: mm(plan.blade_thickness_m ?? 1e-4), platform: [L + land, L + land + P] };
  }
  const curves = (plan) => [plan.curve, plan.curve2 ?? []].map((c) => c.map((p) => [p[0] * 1e3, p[1] * 1e3])).filter((c) => c.length > 1);

  // What an instant shows, in words that the JSON proves.
  function names_of(pictures, plan) {
    const L = plan.dispenser_length_m, x0 = L + plan.land_m, P = plan.platform_length_m;
    const place = (x) => (x < L ? "over the dispenser" : x < x0 ? "on the land" : x < x0 + P ? "over the platform" : "behind the platform");
    return pictures.map((p, i) => (i === 0 ? "before" : i === pictures.length - 1 ? "after" : `during: blade ${place(p.blade_x)}, x = ${(p.blade_x * 1e3).toFixed(2)} mm`));
  }
  const blade_stands = (i, pictures) => i > 0 && i < pictures.length - 1;

  // ---- without WebGL, and on paper: a parallel projection, far grains first ---------------------------------------------
  function still(picture, plan, width, with_partition, with_blade, label) {
    const b = bodies(plan), lean = 0.45, x_end = b.end, high = Math.max(4 * b.dose, 0.25 * b.W);
    const scale = width / (x_end + lean * b.W), low = -Math.max(...b.solids.map((s) => -s.z[0]));
    const height = Math.ceil((high - low + lean * b.W) * scale), ratio = 2;
    const canvas = document.createElement("canvas");
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", label);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const X = (x, y) => (x + lean * y) * scale, Y = (y, z) => height - (z - low + lean * y) * scale;
    const face = (points, fill, stroke) => {
      pen.beginPath();
      points.forEach(([x, y, z], i) => (i ? pen.lineTo(X(x, y), Y(y, z)) : pen.moveTo(X(x, y), Y(y, z))));
      pen.closePath();
      if (fill) { pen.fillStyle = fill; pen.fill(); }
      if (stroke) { pen.strokeStyle = stroke; pen.lineWidth = 1; pen.stroke(); }
    };
    const grey = (n, f) => "#" + [16, 8, 0].map((s) => Math.round(((n >> s) & 255) * f).toString(16).padStart(2, "0")).join("");
    for (const s of b.solids) {
      face([[s.x[0], 0, s.z[1]], [s.x[1], 0, s.z[1]], [s.x[1], b.W, s.z[1]], [s.x[0], b.W, s.z[1]]], grey(s.colour, 1), "#6b7280");
      face([[s.x[0], 0, s.z[0]], [s.x[1], 0, s.z[0]], [s.x[1], 0, s.z[1]], [s.x[0], 0, s.z[1]]], grey(s.colour, 0.82), "#6b7280");
    }
    const grains = Grains.unpack(picture), order = d3.range(grains.n).sort((i, j) => grains.y[j] - grains.y[i] || grains.z[i] - grains.z[j]);
    const blade = picture.blade_x * 1e3;
    const draw = (i) => {
      const x = grains.x[i] * 1e3, y = grains.y[i] * 1e3, z = grains.z[i] * 1e3;
      pen.beginPath();
      pen.arc(X(x, y), Y(y, z), Math.max(0.5, grains.r[i] * 1e3 * scale), 0, 7);
      const f = 0.75 + 0.35 * Math.min(1, Math.max(0, (z + b.depth) / (b.depth + b.dose)));
      pen.fillStyle = grains.a[i] ? `rgb(0,${Math.round(114 * f)},${Math.round(178 * f)})` : `rgb(${Math.round(230 * Math.min(1, f))},${Math.round(159 * f)},0)`;
      pen.fill();
    };
    order.filter((i) => !with_blade || grains.x[i] * 1e3 < blade).forEach(draw);
    if (with_blade) face([[blade, 0, 0], [blade, b.W, 0], [blade, b.W, high * 0.8], [blade, 0, high * 0.8]], "rgba(40,48,56,.45)", "#111");
    order.filter((i) => with_blade && grains.x[i] * 1e3 >= blade).forEach(draw);
    if (with_partition)
      for (const curve of curves(plan)) {
        for (let k = 0; k + 1 < curve.length; ++k) face([[...curve[k], b.dose], [...curve[k + 1], b.dose], [...curve[k + 1], 2.2 * b.dose], [...curve[k], 2.2 * b.dose]], "rgba(20,20,20,.65)", "#111");
      }
    return canvas;
  }

  // ---- with WebGL ------------------------------------------------------------------------------------------------------
  function live(pictures, plan, canvas, context) {
    const b = bodies(plan), renderer = new THREE.WebGLRenderer({ canvas, context, antialias: true, preserveDrawingBuffer: true });
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setClearColor(0xf3f5f7);
    const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(28, 2, 0.01, 1000);
    camera.up.set(0, 0, 1);
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.enableDamping = false;
    controls.enableZoom = false; // by wheel only once the view has the focus: the page must scroll past it
    canvas.style.touchAction = "pan-y";

    const box = (x, y, z, material) => {
      const mesh = new THREE.Mesh(new THREE.BoxGeometry(x[1] - x[0], y[1] - y[0], z[1] - z[0]), material);
      mesh.position.set((x[0] + x[1]) / 2, (y[0] + y[1]) / 2, (z[0] + z[1]) / 2);
      mesh.add(new THREE.LineSegments(new THREE.EdgesGeometry(mesh.geometry), new THREE.LineBasicMaterial({ color: 0x4b5563 })));
      scene.add(mesh);
      return mesh;
    };
    for (const s of b.solids) box(s.x, [0, b.W], s.z, new THREE.MeshBasicMaterial({ color: s.colour }));
    const glass = (color, opacity) => new THREE.MeshBasicMaterial({ color, opacity, transparent: true, side: THREE.DoubleSide, depthWrite: false });
    const blade_height = Math.max(0.5 * b.W, 5 * b.dose), blade = box([0, Math.min(b.thick, 0.12 * b.L)], [0, b.W], [0, blade_height], glass(0x1f2937, 0.35));
    const blade_half = Math.min(b.thick, 0.12 * b.L) / 2;

    const partition = new THREE.Group();
    for (const curve of curves(plan)) {
      const corners = [], edge = [], top = b.dose + Math.max(2 * b.dose, 0.12 * b.W);
      for (let k = 0; k + 1 < curve.length; ++k) {
        const [p, q] = [curve[k], curve[k + 1]];
        corners.push(...p, -b.depth, ...q, -b.depth, ...q, top, ...p, -b.depth, ...q, top, ...p, top);
        edge.push(...p, top, ...q, top, ...p, b.dose, ...p, top, ...q, b.dose, ...q, top);
      }
      const lay = (values) => new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(values), 3));
      partition.add(new THREE.Mesh(lay(corners), glass(0x111111, 0.55)), new THREE.LineSegments(lay(edge), new THREE.LineBasicMaterial({ color: 0x111111 })));
    }
    scene.add(partition);

    const quad = new THREE.BufferAttribute(new Float32Array([-1, -1, 1, -1, 1, 1, -1, 1]), 2);
    const clouds = pictures.map((picture) => {
      const geometry = new THREE.InstancedBufferGeometry(), bytes = bytes_of(picture);
      geometry.setIndex([0, 1, 2, 0, 2, 3]);
      geometry.setAttribute("corner", quad);
      const records = new THREE.InstancedInterleavedBuffer(new Uint16Array(bytes.buffer, 0, 4 * picture.shown), 4);
      geometry.setAttribute("grain", new THREE.InterleavedBufferAttribute(records, 4, 0, false));
      geometry.instanceCount = picture.shown;
      const v = (a) => ({ value: new THREE.Vector3(...a.map((m) => m * 1e3)) });
      const material = new THREE.ShaderMaterial({ vertexShader: vertex, fragmentShader: fragment, glslVersion: THREE.GLSL3, uniforms: { low: v(picture.origin), extent: v(picture.extent), radius_max: { value: picture.radius_max * 1e3 }, cut: { value: -1e9 } } });
      const mesh = new THREE.Mesh(geometry, material);
      mesh.frustumCulled = false;
      scene.add(mesh);
      return mesh;
    });

    let shown = 0, waiting = 0, drawn = 0;
    const paint = () => { waiting = 0; renderer.render(scene, camera); canvas.dataset.drawn = ++drawn; };
    const ask = () => { waiting ||= requestAnimationFrame(paint); };
    controls.addEventListener("change", ask);
    const centre = [b.end / 2, b.W / 2, 0];
    // Far enough that the box from `from` to `to` fills the picture, seen along `direction`.
    function look(direction, from, to) {
      const middle = new THREE.Vector3((from + to) / 2, centre[1], centre[2]), aspect = camera.aspect, half = Math.tan((camera.fov * Math.PI) / 360);
      const side = new THREE.Vector3(...direction).normalize(), tall = b.W * Math.abs(side.z) + 4 * b.dose;
      const far = Math.max((0.53 * (to - from)) / (half * aspect), (0.6 * tall) / half) + 0.5 * b.W;
      controls.target.copy(middle);
      camera.position.copy(middle).addScaledVector(side, far);
      controls.update();
      ask();
    }
    const views = {
      oblique: () => look([-0.35, -1, 0.75], 0, b.end),
      above: () => look([0, -1e-3, 1], 0, b.end),
      side: () => look([0, -1, 0.02], 0, b.end),
      part: () => look([0.25, -0.8, 0.9], ...b.platform),
    };
    function turn(dx, dy) {
      const way = camera.position.clone().sub(controls.target).applyAxisAngle(new THREE.Vector3(0, 0, 1), dx);
      const flat = Math.hypot(way.x, way.y), steep = Math.min(1.55, Math.max(-1.5, Math.atan2(way.z, flat) + dy)), far = way.length();
      const heading = Math.atan2(way.y, way.x);
      camera.position.copy(controls.target).add(new THREE.Vector3(Math.cos(heading) * Math.cos(steep), Math.sin(heading) * Math.cos(steep), Math.sin(steep)).multiplyScalar(far));
      controls.update();
      ask();
    }
    function zoom(factor) {
      camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
      controls.update();
      ask();
    }
    const keys = { ArrowLeft: () => turn(0.12, 0), ArrowRight: () => turn(-0.12, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1), "+": () => zoom(0.85), "=": () => zoom(0.85), "-": () => zoom(1 / 0.85), 0: () => views.oblique() };
    canvas.addEventListener("keydown", (event) => {
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
    });
    canvas.addEventListener("focus", () => { controls.enableZoom = true; });
    canvas.addEventListener("blur", () => { controls.enableZoom = false; });
    canvas.addEventListener("pointerdown", () => canvas.focus({ preventScroll: true }));

    let begun = false;
    return {
      zoom, turn, views,
      show(index) {
        shown = index;
        clouds.forEach((cloud, i) => { cloud.visible = i === index; });
        partition.visible = index === 0;
        blade.visible = blade_stands(index, pictures);
        blade.position.x = pictures[index].blade_x * 1e3 - blade_half;
        ask();
      },
      cut(open) {
        for (const cloud of clouds) cloud.material.uniforms.cut.value = open ? b.W / 2 : -1e9;
        ask();
      },
      resize(width) {
        const height = Math.round(Math.max(260, Math.min(520, width * 0.5)));
        renderer.setSize(width, height);
        camera.aspect = width / height;
        camera.updateProjectionMatrix();
        if (!begun) views.oblique();
        begun = true;
        ask();
      },
      shown: () => shown,
    };
  }

  // The figure: picture, instants, views. `h` makes elements; returns the nodes and what to call with a new width.
  function build(pictures, plan, h) {
    const names = names_of(pictures, plan), canvas = h("canvas", { tabindex: "0", class: "live", role: "application", "aria-label": "dispenser, land and platform with the grains in 3-D; arrow keys turn, plus and minus zoom, 0 resets" });
    // Asked first: a renderer that gets no context would complain on the console.
    const context = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    const stills = h("div", { class: context ? "stills paper" : "stills" }), said = h("p", { class: "note", "aria-live": "polite", style: "margin:.4rem 0" });
    const state = { view: null, at: 0, stills_width: 0 };
    const say = () => {
      const p = pictures[state.at];
      said.textContent = `${names[state.at]}; t = ${(p.time * 1e3).toFixed(1)} ms; ${p.shown === p.grains ? "all" : p.shown.toLocaleString("en-GB") + " of"} ${p.grains.toLocaleString("en-GB")} grains drawn${p.shown < p.grains ? " (left out: inside the bed, or fallen into the overflow)" : ""}`;
    };
    const group = "instant";
    const radios = pictures.map((_, i) => h("label", {}, h("input", { type: "radio", name: group, value: String(i), ...(i === 0 ? { checked: "" } : {}) }), i === 0 ? "before" : i === pictures.length - 1 ? "after" : pictures.length === 3 ? "during" : `during ${i}`));
    const choose = h("fieldset", { class: "choice" }, h("legend", {}, "Instant"), radios);
    const draw_stills = (width, which) => stills.replaceChildren(...which.map((i) => h("div", {}, h("p", { class: "note" }, names[i]), still(pictures[i], plan, width, i === 0, blade_stands(i, pictures), `grains in a parallel projection, ${names[i]}`))));
    const redraw = (width) => {
      if (context) state.view.resize(width);
      else draw_stills((state.stills_width = width), [state.at]);
    };
    choose.addEventListener("change", (event) => {
      state.at = Number(event.target.value);
      if (context) state.view.show(state.at);
      else draw_stills(state.stills_width, [state.at]);
      say();
    });
    say();
    if (!context) return { nodes: [stills, choose, said], redraw, note: "This browser has no WebGL: the picture stands still." };

    state.view = live(pictures, plan, canvas, context);
    state.view.show(0);
    const button = (text, label, act) => { const node = h("button", { type: "button", "aria-label": label }, text); node.addEventListener("click", act); return node; };
    const look = h("div", { class: "choice", role: "group", "aria-label": "view" },
      button("oblique", "view obliquely", () => state.view.views.oblique()), button("above", "view from above", () => state.view.views.above()), button("side", "view from the side", () => state.view.views.side()), button("layer", "view of the platform", () => state.view.views.part()),
      button("↺", "turn left", () => state.view.turn(-0.2, 0)), button("↻", "turn right", () => state.view.turn(0.2, 0)), button("+", "closer", () => state.view.zoom(0.8)), button("−", "farther", () => state.view.zoom(1.25)));
    const open = h("input", { type: "checkbox" });
    open.addEventListener("change", () => state.view.cut(open.checked));
    const opening = h("label", { class: "choice" }, open, "cut open at half the width");
    window.addEventListener("beforeprint", () => { if (!stills.childNodes.length) draw_stills(1000, d3.range(pictures.length)); });
    return { nodes: [canvas, h("div", { class: "controls" }, choose, look, opening), said, stills], redraw, note: "Drag to turn, two fingers or the wheel (after a click into the picture) to zoom; arrow keys, + and − do the same." };
  }

  return { build, names_of };
})();
