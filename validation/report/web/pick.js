// What lies under a finger: the nearest triangle, or the face that a cut opened, and what is known there.

/// Calls visit(triangle, distance, facing) for every triangle of a part that the ray meets.
function forHits(part, from, along, visit) {
  const p = part.points, ids = part.indices;
  for (let t = 0; t < ids.length; t += 3) {
    const a = 3 * ids[t], b = 3 * ids[t + 1], c = 3 * ids[t + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const hx = along[1] * vz - along[2] * vy, hy = along[2] * vx - along[0] * vz, hz = along[0] * vy - along[1] * vx;
    const det = ux * hx + uy * hy + uz * hz;
    if (Math.abs(det) < 1e-12) continue;
    const sx = from[0] - p[a], sy = from[1] - p[a + 1], sz = from[2] - p[a + 2];
    const u = (sx * hx + sy * hy + sz * hz) / det;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const v = (along[0] * qx + along[1] * qy + along[2] * qz) / det;
    if (v < 0 || u + v > 1) continue;
    visit(t / 3, (vx * qx + vy * qy + vz * qz) / det);
  }
}

/// The part whose closed surface has the point inside: crossed an odd number of times.
function partAround(parts, point, along) {
  return parts.find((part) => {
    let crossings = 0;
    if (part.group !== "valves" && !part.glass) forHits(part, point, along, (_, way) => (crossings += way > 0 ? 1 : 0));
    return crossings % 2 === 1;
  });
}

function nearestHit(parts, from, along, isKept) {
  let best = null;
  for (const part of parts) {
    if (part.glass) continue;
    forHits(part, from, along, (triangle, way) => {
      if (best && way >= best.way) return;
      const point = plus(from, scaled(along, way));
      if (isKept(point)) best = { part, triangle, way, point };
    });
  }
  return best;
}

/// `from` lies in front of everything. The answer has no triangle where the cut itself was met.
function pick(view, from, along, cut) {
  const parts = view.parts.filter((part) => part.visible);
  const above = (p) => dot(cut, p) - cut[3];
  const hit = nearestHit(parts, from, along, (p) => above(p) <= 1e-6);
  const speed = dot(cut, along);
  if (cut[3] > 1e8 || Math.abs(speed) < 1e-9) return hit;
  const way = -above(from) / speed, point = plus(from, scaled(along, way));
  if (hit && hit.way < way - 1e-6) return hit;
  const part = partAround(parts, point, unit([0.31, 0.62, 0.72]));
  return part ? { part, triangle: -1, way, point } : hit;
}

/// Of all triangles that are shown, the one of the flattest cell, as a hit.
function flattestHit(parts) {
  let best = null;
  for (const part of parts)
    if (part.visible && part.group !== "valves")
      part.quality.forEach((degrees, triangle) => {
        if (!best || degrees < best.degrees) best = { part, triangle, degrees };
      });
  if (!best) return null;
  const corner = (k) => 3 * best.part.indices[3 * best.triangle + k];
  best.point = [0, 1, 2].map((axis) => (best.part.points[corner(0) + axis] + best.part.points[corner(1) + axis] + best.part.points[corner(2) + axis]) / 3);
  return best;
}

function gridByte(view, field, point) {
  const grid = view.grids;
  if (!grid || !grid.values[field.id]) return 0;
  const at = point.map((v, k) => Math.floor((v - grid.low[k]) / grid.spacing));
  if (at.some((v, k) => v < 0 || v >= grid.count[k])) return 0;
  return grid.values[field.id][(at[2] * grid.count[1] + at[1]) * grid.count[0] + at[0]];
}

/// Name and text of everything that is known of a hit.
function describeHit(view, hit) {
  const { part, triangle, point } = hit, lps = plus(point, view.center);
  const rows = [[part.group === "valves" ? "valve" : "region", part.label], ["mesh", part.mesh]];
  if (triangle >= 0) {
    const surface = view.surfaces.get(part.surface[triangle]);
    rows.push(["surface", surface ? surface.label : "between regions"]);
    if (part.group !== "valves") rows.push(["smallest dihedral", part.quality[triangle] + "°"]);
  } else {
    rows.push(["surface", "none: inside, on the cut"]);
  }
  for (const field of Object.values(view.fields)) {
    if (!part.fields || (field.id === "quality" && triangle >= 0)) continue;
    const byte = triangle >= 0 && part.fields[field.id] ? part.fields[field.id][part.indices[3 * triangle]] : gridByte(view, field, point);
    const text = fieldText(field, byte);
    if (text) rows.push([{ helix: "helix angle", thickness: "wall thickness", source: "fibres from", difference: "against the rule", quality: "smallest dihedral" }[field.id], text]);
  }
  rows.push(["L, P, S", lps.map((v) => v.toFixed(1)).join(", ") + " mm"]);
  return { rows, lps };
}
