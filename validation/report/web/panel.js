// The controls beside the 3D view.

function choice(label, name, options) {
  const select = element("select", { name }, ...options.map(([value, text]) => element("option", { value }, text)));
  return [element("label", {}, label, select), select];
}

function button(text, action, properties = {}) {
  const made = element("button", { type: "button", ...properties }, text);
  made.addEventListener("click", action);
  return made;
}

function colorOptions(view) {
  const names = { helix: "helix angle", thickness: "wall thickness", source: "fibre source", difference: "difference of methods" };
  const fields = Object.keys(view.fields).filter((id) => names[id]).map((id) => [id, names[id]]);
  return [["region", "region"], ...fields, ["quality", "element quality"], ["surface", "surface label"]];
}

function fiberOptions(view) {
  const helix = view.fields.helix ? [["helix", "by helix angle"]] : [];
  return [["off", "hidden"], ["plain", "plain"], ...helix, ["direction", "by direction"]];
}

/// Rows of parts by group, with "only"; returns what shows their boxes as they are.
function addParts(viewer, place, onChange) {
  const boxes = [];
  const setShown = (test) => {
    for (const part of viewer.view.parts) part.visible = test(part);
    onChange();
  };
  const parts = viewer.view.parts;
  place.append(element("div", { className: "buttons" }, button("all", () => setShown(() => true)), button("none", () => setShown(() => false)),
    button("walls", () => setShown((part) => part.group === "muscle")), button("blood", () => setShown((part) => part.group === "blood"))));
  for (const part of parts) {
    const box = element("input", { type: "checkbox", name: "part-" + part.name }), dye = element("i");
    dye.style.background = rgb(part.color);
    box.addEventListener("input", () => {
      part.visible = box.checked;
      onChange();
    });
    boxes.push([box, part]);
    const only = button("only", () => setShown((other) => other === part), { className: "only", title: "show only " + part.label });
    place.append(element("div", { className: "part" }, element("label", {}, box, dye, part.label), only));
  }
  return () => boxes.forEach(([box, part]) => (box.checked = part.visible));
}

function addPanel(viewer, panel) {
  const { state, view } = viewer;
  const [colorLabel, color] = choice("Colour by", "color", colorOptions(view));
  const [fiberLabel, fibers] = choice("Fibres", "fibers", fiberOptions(view));
  const [edgeLabel, edges] = choice("Surface", "edges", [["0", "smooth"], ["1", "with mesh edges"], ["2", "wireframe"]]);
  const [cutLabel, cut] = choice("Cut", "cut", [["none", "none"], ["chambers", "four chambers"], ["coronal", "coronal"],
    ["sagittal", "sagittal"], ["axial", "axial"], ["screen", "facing you"]]);
  const slider = element("input", { type: "range", name: "cutAt", step: "0.5" });
  slider.setAttribute("aria-label", "place of the cut");
  const place = element("output"), legend = element("div", { className: "legend3d" }), facts = element("div", { className: "facts", hidden: true });
  const flip = button("flip", () => {
    state.isFlipped = !state.isFlipped;
    viewer.redraw();
  });
  const sliderRow = element("div", { className: "cut", hidden: true }, slider, element("div", {}, place, flip));
  const views = element("div", { className: "views" }, ...Object.keys(viewer.views).map((name) => button(name, () => show(name), { name: "view-" + name })),
    button("fit to shown", viewer.fit, { name: "fit", className: "wide" }));
  const partsBox = element("details", { className: "parts", open: isWide() }, element("summary", {}, "Parts shown"));
  const more = element("details", { className: "more", open: isWide() }, element("summary", {}, "Cut, edges, directions"), cutLabel, sliderRow, edgeLabel, views);
  const hint = element("p", { className: "hint" }, "Drag to turn; two fingers or shift-drag to move; click for the values of a place, then the wheel zooms.");
  panel.append(colorLabel, ...(view.parts.some((part) => part.lines && part.muscle) ? [fiberLabel] : []), legend, facts, more, partsBox, hint);

  function show(name) {
    state.eye = viewer.views[name];
    viewer.redraw();
  }
  function placeText() {
    const axis = { coronal: "y", sagittal: "x", axial: "z" }[state.cut];
    place.textContent = axis ? `${axis} = ${state.cutAt.toFixed(1)} mm` : `${state.cutAt.toFixed(1)} mm from the middle`;
  }
  function setRange() {
    sliderRow.hidden = state.cut === "none";
    if (sliderRow.hidden) return;
    const [low, high] = viewer.cutRange();
    Object.assign(slider, { min: low.toFixed(1), max: high.toFixed(1) });
    state.cutAt = clamp(state.cutAt, low, high);
    slider.value = state.cutAt;
    placeText();
  }
  function refresh() {
    Object.assign(color, { value: state.color });
    Object.assign(fibers, { value: state.fibers });
    Object.assign(cut, { value: state.cut });
    edges.value = String(state.edges);
    refreshParts();
    legend.replaceChildren(legendOf(state, view), fiberLegend());
    setRange();
    viewer.redraw();
  }
  function fiberLegend() {
    if (state.fibers === "helix" && state.color !== "helix") return rampLegend(view.fields.helix);
    if (state.fibers !== "direction") return "";
    return element("div", {}, element("b", {}, "fibres run"), swatches([[[240, 40, 40], "left to right"], [[40, 240, 40], "front to back"], [[40, 40, 240], "up and down"]]));
  }
  const refreshParts = addParts(viewer, partsBox, refresh);

  color.addEventListener("input", () => {
    Object.assign(state, { color: color.value, highlight: null });
    refresh();
  });
  fibers.addEventListener("input", () => {
    state.fibers = fibers.value;
    refresh();
  });
  edges.addEventListener("input", () => {
    state.edges = Number(edges.value);
    viewer.redraw();
  });
  cut.addEventListener("input", () => {
    state.cut = cut.value;
    if (state.cut !== "none") {
      const [low, high] = viewer.cutRange();
      state.cutAt = (low + high) / 2;
    }
    const facing = { chambers: "chambers", coronal: "front", sagittal: "left", axial: "above" }[state.cut];
    if (facing) show(facing);
    refresh();
  });
  slider.addEventListener("input", () => {
    state.cutAt = Number(slider.value);
    placeText();
    viewer.redraw();
  });

  function showFacts(hit) {
    facts.hidden = !hit;
    if (!hit) return viewer.markPlace(null);
    const { rows, lps } = describeHit(view, hit);
    facts.replaceChildren(...rows.map(([name, text]) => element("div", {}, element("span", {}, name), element("b", {}, text))));
    viewer.markPlace(lps);
    return lps;
  }
  /// e.g. report.html#view=chambers&cut=chambers&color=helix&fibers=plain
  function readAddress() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    for (const control of [color, fibers, edges, cut]) {
      if (![...control.options].some((option) => option.value === wanted.get(control.name))) continue;
      control.value = wanted.get(control.name);
      control.dispatchEvent(new Event("input"));
    }
    if (viewer.views[wanted.get("view")]) show(wanted.get("view"));
  }
  refresh();
  readAddress();
  return { refresh, showFacts };
}
