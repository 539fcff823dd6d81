// Three slices through the image with the label map's contours: to scroll, to set their window, to click.

function unpackImage({ index, bytes }) {
  const [nx, ny, nz] = index.size, count = nx * ny * nz;
  const labels = new Uint8Array(bytes, index.labels, count);
  let grey = null;
  if (index.grey !== undefined) {
    grey = new Uint8Array(bytes, index.grey, count).slice();
    for (let v = 0; v < count; ++v) if (v % nx) grey[v] += grey[v - 1];
  }
  return { ...index, labels, grey, colors: new Map(index.regions.map((r) => [r.tag, r.color])), names: new Map(index.regions.map((r) => [r.tag, r.label])) };
}

/// The plane across the body's axis `across` (0 sagittal, 1 coronal, 2 axial): which axes of the grid run through it, to
/// the right and down the screen, and which of them backwards. The patient's left is on the right, the head above.
function planeOf(image, across) {
  const along = (body) => [0, 1, 2].reduce((best, a) => (Math.abs(image.direction[body][a]) > Math.abs(image.direction[body][best]) ? a : best), 0);
  const grid = along(across);
  const [right, down] = { 0: [[1, 1], [2, -1]], 1: [[0, 1], [2, -1]], 2: [[0, 1], [1, 1]] }[across];
  const used = [grid];
  const axis = ([body, sign]) => {
    const best = [0, 1, 2].filter((a) => !used.includes(a)).reduce((x, a) => (Math.abs(image.direction[body][a]) > Math.abs(image.direction[body][x]) ? a : x));
    used.push(best);
    return { grid: best, isReversed: image.direction[body][best] * sign < 0, size: image.size[best], spacing: image.spacing[best] };
  };
  return { across, grid, right: axis(right), down: axis(down), count: image.size[grid] };
}

const planeNames = ["sagittal", "coronal", "axial"];
const planeSides = [["A", "P", "S", "I"], ["R", "L", "S", "I"], ["R", "L", "A", "P"]];

/// Calls visit(pixel, voxel) over a slice, row by row.
function forPixels(image, plane, index, visit) {
  const stride = [1, image.size[0], image.size[0] * image.size[1]];
  const { right, down } = plane;
  for (let y = 0, pixel = 0; y < down.size; ++y) {
    const row = index * stride[plane.grid] + (down.isReversed ? down.size - 1 - y : y) * stride[down.grid];
    for (let x = 0; x < right.size; ++x, ++pixel) visit(pixel, row + (right.isReversed ? right.size - 1 - x : x) * stride[right.grid]);
  }
}

/// Segments between x, y pairs (in pixels) where the smoothed indicator of a label passes one half.
function contourOf(labels, width, height, tag) {
  const raw = new Float32Array(width * height), soft = new Float32Array(width * height);
  let any = false;
  for (let i = 0; i < raw.length; ++i) if (labels[i] === tag) any = raw[i] = 1;
  if (!any) return [];
  const at = (x, y) => raw[clamp(y, 0, height - 1) * width + clamp(x, 0, width - 1)];
  const weights = [1, 2, 1];
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      let sum = 0;
      for (let j = -1; j <= 1; ++j) for (let i = -1; i <= 1; ++i) sum += weights[i + 1] * weights[j + 1] * at(x + i, y + j);
      soft[y * width + x] = sum / 16 - 0.5;
    }
  const segments = [];
  for (let y = 0; y + 1 < height; ++y)
    for (let x = 0; x + 1 < width; ++x) {
      const i = y * width + x, corners = [[x, y, soft[i]], [x + 1, y, soft[i + 1]], [x + 1, y + 1, soft[i + width + 1]], [x, y + 1, soft[i + width]]];
      const points = [];
      for (let k = 0; k < 4; ++k) {
        const [ax, ay, a] = corners[k], [bx, by, b] = corners[(k + 1) % 4];
        if (a > 0 !== b > 0) points.push([ax + ((bx - ax) * a) / (a - b), ay + ((by - ay) * a) / (a - b)]);
      }
      for (let k = 0; k + 1 < points.length; k += 2) segments.push([...points[k], ...points[k + 1]]);
    }
  return segments;
}

function makeSlices(root, data, onPick) {
  const image = unpackImage(data);
  const state = { contours: true, fill: !image.grey, level: image.window ? image.window.level : 0, width: image.window ? image.window.width : 1 };
  const at = image.size.map((n) => Math.floor(n / 2)); // the voxel that all three planes go through
  const facts = element("div", { className: "facts", hidden: true });
  let isWaiting = false;
  const redraw = () => {
    if (!isWaiting) requestAnimationFrame(() => {
      isWaiting = false;
      panes.forEach((pane) => pane.draw());
    });
    isWaiting = true;
  };
  const lpsOf = (voxel) => [0, 1, 2].map((body) => image.origin[body] + voxel.reduce((sum, v, a) => sum + image.direction[body][a] * image.spacing[a] * v, 0));
  const voxelOf = (lps) => [0, 1, 2].map((a) => clamp(Math.round([0, 1, 2].reduce((sum, body) => sum + image.direction[body][a] * (lps[body] - image.origin[body]), 0) / image.spacing[a]), 0, image.size[a] - 1));
  function goTo(lps) {
    voxelOf(lps).forEach((v, a) => (at[a] = v));
    panes.forEach((pane) => pane.refresh());
    showFacts();
    redraw();
  }
  function showFacts() {
    const v = (at[2] * image.size[1] + at[1]) * image.size[0] + at[0], tag = image.labels[v], [low, high] = image.hu || [0, 0];
    const rows = [["region", image.names.get(tag) || "none"], ["L, P, S", lpsOf(at).map((x) => x.toFixed(1)).join(", ") + " mm"]];
    if (image.grey) rows.push(["image", Math.round(low + (image.grey[v] / 255) * (high - low)) + " HU"]);
    facts.hidden = false;
    facts.replaceChildren(...rows.map(([name, text]) => element("div", {}, element("span", {}, name), element("b", {}, text))));
  }
  const pickVoxel = () => {
    panes.forEach((pane) => pane.refresh());
    showFacts();
    redraw();
    onPick(lpsOf(at));
  };
  const panes = [2, 1, 0].map((across) => makePane(image, state, at, planeOf(image, across), lpsOf, pickVoxel, redraw));
  root.append(...planeTabs(panes), element("div", { className: "panes" }, ...panes.map((pane) => pane.box)), sliceControls(image, state, redraw), facts);
  panes.forEach((pane) => pane.refresh());
  redraw();
  return { goTo };
}

/// On a narrow screen one plane shows at a time.
function planeTabs(panes) {
  const tabs = panes.map((pane) => button(pane.name, () => choose(pane), { name: "plane-" + pane.name }));
  function choose(chosen) {
    panes.forEach((pane, i) => {
      pane.box.classList.toggle("chosen", pane === chosen);
      tabs[i].classList.toggle("chosen", pane === chosen);
    });
  }
  choose(panes[0]);
  return [element("div", { className: "tabs" }, ...tabs)];
}

function checkbox(text, name, isChecked, action) {
  const box = element("input", { type: "checkbox", name, checked: isChecked });
  box.addEventListener("input", () => action(box.checked));
  return element("label", { className: "check" }, box, text);
}

function sliceControls(image, state, redraw) {
  const controls = element("div", { className: "controls" });
  const set = (name) => (value) => {
    state[name] = value;
    redraw();
  };
  controls.append(checkbox("contours", "contours", state.contours, set("contours")), checkbox("regions filled", "fill", state.fill, set("fill")));
  if (image.grey) {
    const [low, high] = image.hu;
    const range = (text, name, min, max) => {
      const slider = element("input", { type: "range", name, min, max, value: state[name] }), output = element("output", {}, state[name] + " HU");
      slider.addEventListener("input", () => {
        output.textContent = slider.value + " HU";
        set(name)(Number(slider.value));
      });
      return element("label", { className: "range" }, text, slider, output);
    };
    controls.append(range("level", "level", low, high), range("width", "width", 50, high - low));
  }
  return element("details", { className: "more", open: isWide() }, element("summary", {}, "Contours and window"), controls);
}

function makePane(image, state, at, plane, lpsOf, pickVoxel, redraw) {
  const { right, down } = plane, name = planeNames[plane.across];
  const canvas = element("canvas", { tabIndex: 0 }), slider = element("input", { type: "range", name: "slice-" + name, min: 0, max: plane.count - 1, step: 1 });
  canvas.setAttribute("aria-label", name + " slice");
  slider.setAttribute("aria-label", "place of the " + name + " slice");
  const place = element("output"), sides = planeSides[plane.across].map((side, i) => element("span", { className: "side s" + i }, side));
  const stage = element("div", { className: "slice" }, canvas, ...sides);
  const box = element("div", { className: "pane" }, stage, element("div", { className: "place" }, place), slider);
  stage.style.setProperty("--ratio", (right.size * right.spacing) / (down.size * down.spacing));
  const buffer = element("canvas", { width: right.size, height: down.size }), labels = new Uint8Array(right.size * down.size);
  const contours = { at: -1, lines: [] };

  function refresh() {
    slider.value = at[plane.grid];
    place.textContent = `${name}, ${"xyz"[plane.across]} = ${lpsOf(at)[plane.across].toFixed(1)} mm`;
  }
  function paintVoxels() {
    const context = buffer.getContext("2d"), pixels = context.createImageData(right.size, down.size), out = pixels.data;
    const [low, high] = image.hu || [0, 1], black = state.level - state.width / 2;
    forPixels(image, plane, at[plane.grid], (pixel, voxel) => {
      const tag = (labels[pixel] = image.labels[voxel]), color = image.colors.get(tag);
      const hu = image.grey ? low + (image.grey[voxel] / 255) * (high - low) : 0;
      const grey = image.grey ? clamp(((hu - black) / state.width) * 255, 0, 255) : 18, share = state.fill && color ? (image.grey ? 0.35 : 0.85) : 0;
      for (let k = 0; k < 3; ++k) out[4 * pixel + k] = share ? grey * (1 - share) + color[k] * share : grey;
      out[4 * pixel + 3] = 255;
    });
    context.putImageData(pixels, 0, 0);
  }
  function strokeContours(context, sx, sy) {
    if (contours.at !== at[plane.grid])
      Object.assign(contours, { at: at[plane.grid], lines: [...image.colors].map(([tag, color]) => [color, contourOf(labels, right.size, down.size, tag)]) });
    context.lineWidth = 1.6 * Math.max(1, window.devicePixelRatio || 1);
    for (const [color, segments] of contours.lines) {
      context.strokeStyle = rgb(color);
      context.beginPath();
      for (const [ax, ay, bx, by] of segments) {
        context.moveTo((ax + 0.5) * sx, (ay + 0.5) * sy);
        context.lineTo((bx + 0.5) * sx, (by + 0.5) * sy);
      }
      context.stroke();
    }
  }
  const pixelOf = (axis) => (axis.isReversed ? axis.size - 1 - at[axis.grid] : at[axis.grid]) + 0.5;
  function strokeCross(context, sx, sy) {
    const x = pixelOf(right) * sx, y = pixelOf(down) * sy;
    context.strokeStyle = "rgba(255,255,255,.42)";
    context.lineWidth = Math.max(1, window.devicePixelRatio || 1);
    context.beginPath();
    context.moveTo(0, y);
    context.lineTo(canvas.width, y);
    context.moveTo(x, 0);
    context.lineTo(x, canvas.height);
    context.stroke();
  }
  function draw() {
    const ratio = Math.min(2, window.devicePixelRatio || 1), width = Math.round(stage.clientWidth * ratio), height = Math.round(stage.clientHeight * ratio);
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    paintVoxels();
    const context = canvas.getContext("2d"), sx = width / right.size, sy = height / down.size;
    context.imageSmoothingEnabled = Boolean(image.grey);
    context.drawImage(buffer, 0, 0, width, height);
    if (state.contours) strokeContours(context, sx, sy);
    strokeCross(context, sx, sy);
  }
  function scrollTo(index) {
    at[plane.grid] = clamp(index, 0, plane.count - 1);
    refresh();
    redraw();
  }
  slider.addEventListener("input", () => scrollTo(Number(slider.value)));
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    scrollTo(at[plane.grid] + Math.sign(event.deltaY));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowUp: 1, ArrowDown: -1, PageUp: 5, PageDown: -5 }[event.key];
    if (!step) return;
    event.preventDefault();
    scrollTo(at[plane.grid] + step);
  });
  canvas.addEventListener("click", (event) => {
    const shares = [event.offsetX / canvas.clientWidth, event.offsetY / canvas.clientHeight];
    [right, down].forEach((axis, i) => {
      const pixel = clamp(Math.floor(shares[i] * axis.size), 0, axis.size - 1);
      at[axis.grid] = axis.isReversed ? axis.size - 1 - pixel : pixel;
    });
    pickVoxel();
  });
  new ResizeObserver(redraw).observe(stage);
  return { box, name, draw, refresh };
}
