// What a colour means: ramps, the bytes of fields, legends.

const ramps = {
  helix: [[0, [38, 84, 178]], [15 / 180, [38, 84, 178]], [0.5, [246, 244, 240]], [165 / 180, [186, 32, 46]], [1, [186, 32, 46]]],
  thickness: [[0, [68, 1, 84]], [0.25, [59, 82, 139]], [0.5, [33, 145, 140]], [0.75, [94, 201, 98]], [1, [253, 231, 37]]],
  difference: [[0, [247, 246, 240]], [0.5, [240, 150, 110]], [1, [150, 20, 40]]],
  quality: [[0, [165, 15, 21]], [0.25, [239, 120, 80]], [0.45, [250, 225, 190]], [0.65, [190, 220, 235]], [1, [40, 110, 170]]],
};
const categoryColors = [[150, 150, 150], [66, 120, 190], [240, 170, 70], [110, 180, 110], [176, 58, 104]];
const unknownColor = (own) => own.map((c) => 0.2 * c + 0.8 * 188);
const paleColor = (own) => own.map((c) => 0.12 * c + 0.88 * 214);

function rampAt(ramp, share) {
  for (let i = 1; i < ramp.length; ++i) {
    if (share > ramp[i][0]) continue;
    const [s0, c0] = ramp[i - 1], [s1, c1] = ramp[i], t = (share - s0) / (s1 - s0);
    return c0.map((c, k) => c + t * (c1[k] - c));
  }
  return ramp[ramp.length - 1][1];
}

/// 256 RGB colours: 0 is not used, 1 .. 255 span the field, or name its categories.
function tableOf(field) {
  const table = new Uint8Array(256 * 3);
  for (let b = 1; b < 256; ++b) {
    const color = field.categories.length ? categoryColors[(b - 1) % categoryColors.length] : rampAt(ramps[field.id], (b - 1) / 254);
    table.set(color.map(Math.round), 3 * b);
  }
  return table;
}

/// The value that a byte stands for, as text; null for an unknown one.
function fieldText(field, byte) {
  if (!byte) return null;
  if (field.categories.length) return field.categories[byte - 1];
  const value = field.low + ((byte - 1) / 254) * (field.high - field.low);
  const beyond = field.id !== "helix" && byte === 255 ? "≥ " : "";
  return beyond + value.toFixed(field.unit === "mm" ? 1 : 0) + (field.unit === "°" ? "°" : " " + field.unit);
}

/// RGBA per corner of a part's triangles (four bytes each; alpha is not used).
function cornerColors(part, state, view) {
  const corners = new Uint8Array(part.triangles * 12);
  const paint = (corner, c, offset = 0) => {
    for (let k = 0; k < 3; ++k) corners[4 * corner + k] = c[offset + k];
  };
  const field = view.fields[state.color], own = part.color, bytes = part.fields && part.fields[state.color];
  const unknown = unknownColor(own), pale = paleColor(own);
  for (let i = 0; i < part.triangles * 3; ++i) {
    const triangle = (i / 3) | 0;
    if (part.group === "valves" && state.color !== "surface") {
      paint(i, own);
    } else if (state.color === "surface") {
      const surface = view.surfaces.get(part.surface[triangle]);
      const hidden = state.highlight && (!surface || surface.name !== state.highlight);
      paint(i, !surface || hidden ? pale : surface.color);
    } else if (state.color === "quality") {
      paint(i, view.qualityTable, 3 * qualityByte(part.quality[triangle]));
    } else if (bytes) {
      const byte = bytes[part.indices[i]];
      if (byte) paint(i, field.table, 3 * byte);
      else paint(i, unknown);
    } else {
      paint(i, field ? unknown : own);
    }
  }
  return corners;
}

const qualityField = { id: "quality", title: "smallest dihedral angle of a cell", unit: "°", low: 0, high: 70, categories: [] };
const qualityByte = (degrees) => 1 + Math.round((clamp(degrees, 0, 70) / 70) * 254);

function swatches(entries) {
  return element("div", { className: "swatches" }, ...entries.map(([color, text]) => {
    const dye = element("i");
    dye.style.background = rgb(color);
    return element("span", {}, dye, text);
  }));
}

function rampLegend(field) {
  const bar = element("div", { className: "bar" });
  const stops = ramps[field.id].map(([share, color]) => `${rgb(color)} ${(100 * share).toFixed(1)}%`);
  bar.style.background = `linear-gradient(90deg, ${stops.join(",")})`;
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((share) => {
    const value = field.low + share * (field.high - field.low);
    return element("span", {}, String(Math.round(value * 10) / 10));
  });
  const unitText = field.unit === "°" ? " (degrees)" : field.unit ? ` (${field.unit})` : "";
  return element("div", {}, element("b", {}, field.title + unitText), bar, element("div", { className: "ticks" }, ...ticks));
}

/// What the colours of the view mean now.
function legendOf(state, view) {
  if (state.color === "region") return element("div");
  if (state.color === "surface") {
    const seen = new Set();
    for (const part of view.parts) if (part.visible) part.surface.forEach((tag) => seen.add(tag));
    const shown = [...view.surfaces.values()].filter((s) => seen.has(s.tag) && (!state.highlight || s.name === state.highlight));
    return swatches(shown.map((s) => [s.color, s.label]));
  }
  const field = state.color === "quality" ? qualityField : view.fields[state.color];
  if (!field.categories.length) return rampLegend(field);
  const entries = field.categories.map((name, i) => [categoryColors[i], name]).filter((_, i) => view.categoriesSeen(field, i));
  return element("div", {}, element("b", {}, field.title), swatches(entries));
}
