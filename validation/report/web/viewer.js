// The 3D view: reads the model, keeps the reader's choices, and turns hands into pictures.

function unpackLines(json, bytes, toPoint) {
  if (!json || !json.vertices) return null;
  return {
    points: toPoint(json.positions, json.vertices),
    helix: new Uint8Array(bytes, json.helix, json.vertices),
    lengths: new Uint16Array(bytes, json.lengths, json.lines),
  };
}

function normalsOf(p, t) {
  const n = new Float32Array(p.length);
  for (let i = 0; i < t.length; i += 3) {
    const a = 3 * t[i], b = 3 * t[i + 1], c = 3 * t[i + 2];
    const u = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const v = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const w = cross(u, v);
    for (const corner of [a, b, c]) for (let k = 0; k < 3; ++k) n[corner + k] += w[k];
  }
  return n;
}

/// The page's data as typed arrays; positions in mm around the centre.
function unpackView({ index, bytes }) {
  const { low, scale, center } = index;
  const toPoint = (offset, count) => {
    const raw = new Uint16Array(bytes, offset, 3 * count);
    return Float32Array.from(raw, (v, i) => low[i % 3] + v * scale - center[i % 3]);
  };
  const byteArrays = (offsets, count) => Object.fromEntries(Object.entries(offsets).map(([id, at]) => [id, new Uint8Array(bytes, at, count)]));
  const parts = index.parts.map((json) => {
    const points = toPoint(json.positions, json.vertices), indices = new Uint32Array(bytes, json.indices, 3 * json.triangles);
    return {
      ...json, points, indices, visible: json.shown, normals: normalsOf(points, indices),
      surface: new Uint16Array(bytes, json.surface, json.triangles),
      quality: new Uint8Array(bytes, json.quality, json.triangles),
      fields: json.fields ? byteArrays(json.fields, json.vertices) : null,
      lines: unpackLines(json.lines, bytes, toPoint), inner: unpackLines(json.inner, bytes, toPoint),
    };
  });
  const fields = Object.fromEntries(index.fields.map((field) => [field.id, { ...field, table: tableOf(field) }]));
  const g = index.grids;
  const grids = g && { ...g, low: minus(g.low, center), values: byteArrays(g.values, g.count[0] * g.count[1] * g.count[2]) };
  const categoriesSeen = (field, i) => parts.some((part) => part.fields && part.fields[field.id] && part.fields[field.id].includes(i + 1));
  return { parts, fields, grids, center, radius: index.radius, reach: index.reach, chambersView: index.chambersView,
    surfaces: new Map(index.surfaces.map((s) => [s.tag, s])), qualityTable: tableOf(qualityField), categoriesSeen };
}

const axisViews = {
  front: [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
  back: [[-1, 0, 0], [0, 0, 1], [0, 1, 0]],
  left: [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
  right: [[0, -1, 0], [0, 0, 1], [-1, 0, 0]],
  above: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  below: [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
};

function makeViewer(root, data) {
  const canvas = root.querySelector("canvas"), stage = root.querySelector(".stage");
  const gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: true, preserveDrawingBuffer: true });
  if (!gl) {
    root.classList.add("no-webgl");
    return null;
  }
  const view = unpackView(data), drawing = makeDrawing(gl, view);
  const views = { ...axisViews, chambers: view.chambersView };
  const state = {
    eye: views.front, target: [0, 0, 0], span: 1.08 * view.radius, // half of what the shorter side shows, mm
    color: "region", highlight: null, fibers: "off", edges: 0,
    cut: "none", cutAt: 0, isFlipped: false, mark: null,
  };

  function matrices() {
    const aspect = canvas.width / canvas.height, k = 1 / state.span;
    const sx = aspect > 1 ? k / aspect : k, sy = aspect > 1 ? k : k * aspect, depthScale = 1 / (view.reach * 2.2);
    const [r, u, t] = state.eye, toClip = new Float32Array(16), toEye = new Float32Array(9);
    for (let c = 0; c < 3; ++c) {
      toClip.set([sx * r[c], sy * u[c], -depthScale * t[c], 0], 4 * c);
      toEye.set([r[c], u[c], t[c]], 3 * c);
    }
    toClip.set([-sx * dot(r, state.target), -sy * dot(u, state.target), depthScale * dot(t, state.target), 1], 12);
    return { toClip, toEye, sx, sy, depthScale };
  }

  /// Along which way the cut looks; its place is the coordinate along `axis`, in LPS mm where that is an axis of the body.
  function cutAxis() {
    return { coronal: [0, 1, 0], sagittal: [1, 0, 0], axial: [0, 0, 1], chambers: view.chambersView[2], screen: state.eye[2] }[state.cut];
  }
  const cutZero = () => (["coronal", "sagittal", "axial"].includes(state.cut) ? dot(cutAxis(), view.center) : 0);
  /// Normal and offset: what lies beyond is taken away.
  function cutPlane() {
    const axis = cutAxis();
    if (!axis) return noCut;
    const sign = (state.cut === "coronal") !== state.isFlipped ? -1 : 1;
    return [...scaled(axis, sign), sign * (state.cutAt - cutZero())];
  }
  /// What the cut's slider spans: the parts that are shown.
  function cutRange() {
    const axis = cutAxis();
    let low = Infinity, high = -Infinity;
    for (const part of shownParts())
      for (let i = 0; i < part.points.length; i += 3) {
        const d = dot(axis, part.points.subarray(i, i + 3));
        low = Math.min(low, d);
        high = Math.max(high, d);
      }
    return low > high ? [-1, 1] : [low + cutZero(), high + cutZero()];
  }
  const shownParts = () => {
    const shown = view.parts.filter((part) => part.visible), solid = shown.filter((part) => !part.glass);
    return solid.length ? solid : shown;
  };

  let isWaiting = false, colorsOf = "";
  function draw() {
    isWaiting = false;
    const ratio = Math.min(2.5, window.devicePixelRatio || 1);
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const colors = state.color + " " + state.highlight;
    if (colors !== colorsOf) drawing.recolor(state);
    colorsOf = colors;
    const m = matrices();
    drawing.draw(m, cutPlane(), state);
    overlay.update(m);
  }
  function redraw() {
    if (!isWaiting) requestAnimationFrame(draw);
    isWaiting = true;
  }

  function turn(dx, dy) {
    const [right, up, toward] = state.eye, angle = Math.hypot(dx, dy);
    if (angle < 1e-6) return;
    const axis = unit(right.map((v, i) => (v * dy + up[i] * dx) / angle)), c = Math.cos(-angle), s = Math.sin(-angle);
    const rotated = (v) => {
      const k = cross(axis, v), d = dot(axis, v) * (1 - c);
      return v.map((x, i) => x * c + k[i] * s + axis[i] * d);
    };
    const newToward = unit(rotated(toward)), leaning = rotated(up);
    const newUp = unit(minus(leaning, scaled(newToward, dot(leaning, newToward))));
    state.eye = [cross(newUp, newToward), newUp, newToward];
    redraw();
  }
  const mmPerPixel = () => (2 * state.span) / Math.min(canvas.clientWidth, canvas.clientHeight);
  function pan(dx, dy) {
    const step = mmPerPixel();
    state.target = plus(state.target, plus(scaled(state.eye[0], -dx * step), scaled(state.eye[1], dy * step)));
    redraw();
  }
  function zoomBy(factor) {
    state.span = clamp(state.span / factor, view.radius / 30, 4 * view.reach);
    redraw();
  }
  /// Centres and fills the picture with the parts that are shown.
  function fit() {
    const parts = shownParts(), low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
    for (const part of parts)
      part.points.forEach((v, i) => {
        low[i % 3] = Math.min(low[i % 3], v);
        high[i % 3] = Math.max(high[i % 3], v);
      });
    if (low[0] > high[0]) return;
    state.target = scaled(plus(low, high), 0.5);
    let radius = 1;
    for (const { points } of parts)
      for (let i = 0; i < points.length; i += 3)
        radius = Math.max(radius, Math.hypot(...minus(points.subarray(i, i + 3), state.target)));
    state.span = 1.06 * radius;
    redraw();
  }

  function pickAt(clientX, clientY) {
    const box = canvas.getBoundingClientRect(), step = mmPerPixel(), [r, u, t] = state.eye;
    const x = (clientX - box.left - box.width / 2) * step, y = -(clientY - box.top - box.height / 2) * step;
    const from = plus(state.target, plus(plus(scaled(r, x), scaled(u, y)), scaled(t, 2 * view.reach)));
    return pick(view, from, scaled(t, -1), cutPlane());
  }
  /// Looks at a place from outside of what is shown.
  function faceTo(point) {
    const out = minus(point, state.target);
    if (Math.hypot(...out) < 1) return;
    const toward = unit(out), right = unit(Math.abs(toward[2]) > 0.95 ? [1, 0, -toward[0] / toward[2]] : cross([0, 0, 1], toward));
    state.eye = [right, cross(toward, right), toward];
    redraw();
  }
  /// A place in LPS mm, or null.
  function markPlace(lps) {
    state.mark = lps && minus(lps, view.center);
    redraw();
  }

  const overlay = makeOverlay(stage, state);
  const viewer = { root, canvas, view, views, state, redraw, turn, pan, zoomBy, fit, faceTo, pickAt, markPlace, cutRange };
  new ResizeObserver(redraw).observe(canvas);
  return viewer;
}

/// Letters of the body's directions at the rim of the view, a scale bar, and a mark at the place last picked.
function makeOverlay(stage, state) {
  const directions = { L: [1, 0, 0], R: [-1, 0, 0], P: [0, 1, 0], A: [0, -1, 0], S: [0, 0, 1], I: [0, 0, -1] };
  const letters = Object.entries(directions).map(([name, direction]) => {
    const letter = element("span", { className: "letter" }, name);
    stage.append(letter);
    return { letter, direction };
  });
  const bar = element("i"), text = element("b"), mark = element("span", { className: "mark", hidden: true });
  stage.append(element("span", { className: "scale" }, bar, text), mark);

  function place(m) {
    mark.hidden = !state.mark;
    if (!state.mark) return;
    const p = minus(state.mark, state.target);
    mark.style.left = 50 + 50 * m.sx * dot(state.eye[0], p) + "%";
    mark.style.top = 50 - 50 * m.sy * dot(state.eye[1], p) + "%";
  }
  function update(m) {
    for (const { letter, direction } of letters) {
      const x = dot(state.eye[0], direction), y = dot(state.eye[1], direction), flat = Math.hypot(x, y);
      const reach = 0.46 / Math.max(Math.abs(x), Math.abs(y), 1e-6);
      letter.style.left = 50 + 100 * x * reach + "%";
      letter.style.top = 50 - 100 * y * reach + "%";
      letter.style.opacity = flat < 0.5 ? 0 : (flat - 0.5) * 2;
    }
    const pixelsPerMm = (m.sx * stage.clientWidth) / 2;
    const length = [100, 50, 20, 10, 5, 2, 1].find((mm) => mm * pixelsPerMm < 130) || 1;
    bar.style.width = length * pixelsPerMm + "px";
    text.textContent = length + " mm";
    place(m);
  }
  return { update };
}
