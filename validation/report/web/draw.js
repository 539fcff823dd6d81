// One picture of the view from its state: `view` is what the page holds, `state` what the reader chose.

const noCut = [0, 0, 0, 1e9];

function makeDrawing(gl, view) {
  const surfaces = makeProgram(gl, meshVertex, meshFragment);
  const ribbons = makeProgram(gl, lineVertex, lineFragment);
  const caps = makeProgram(gl, capVertex, capFragment);
  const tables = {}, values = {};
  for (const field of Object.values(view.fields)) tables[field.id] = makeTable(gl, field.table);
  for (const part of view.parts) {
    part.surfaceBuffers = makeSurface(gl, part);
    if (part.lines) part.lineBuffers = makeRibbons(gl, part.lines);
    if (part.inner) part.innerBuffers = makeRibbons(gl, part.inner);
  }
  const capVao = gl.createVertexArray();
  gl.bindVertexArray(capVao);
  const capBuffer = setAttribute(gl, 0, new Float32Array(18), 3, gl.FLOAT, false);

  function valuesOf(field) {
    values[field.id] = values[field.id] || makeValues(gl, view.grids.values[field.id], view.grids.count, !field.categories.length);
    return values[field.id];
  }

  function recolor(state) {
    for (const part of view.parts) {
      gl.bindBuffer(gl.ARRAY_BUFFER, part.surfaceBuffers.colors);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, cornerColors(part, state, view));
    }
  }

  function camera(program, m, cut) {
    gl.useProgram(program.program);
    gl.uniformMatrix4fv(program.uniforms.toClip, false, m.toClip);
    if (program.uniforms.toEye) gl.uniformMatrix3fv(program.uniforms.toEye, false, m.toEye);
    if (program.uniforms.cut) gl.uniform4fv(program.uniforms.cut, cut);
  }

  function drawPart(part, m, cut, edges) {
    camera(surfaces, m, cut);
    gl.uniform1i(surfaces.uniforms.glass, part.glass ? 1 : 0);
    gl.uniform1i(surfaces.uniforms.edges, edges);
    gl.bindVertexArray(part.surfaceBuffers.vao);
    gl.drawArrays(gl.TRIANGLES, 0, part.surfaceBuffers.count);
  }

  /// Marks where the cut runs inside a closed surface: there back faces and front faces do not cancel.
  function markInside(part, m, cut) {
    gl.enable(gl.STENCIL_TEST);
    gl.clearStencil(0);
    gl.clear(gl.STENCIL_BUFFER_BIT);
    gl.colorMask(false, false, false, false);
    gl.depthMask(false);
    gl.disable(gl.DEPTH_TEST);
    gl.stencilFunc(gl.ALWAYS, 0, 255);
    gl.stencilOpSeparate(gl.FRONT, gl.KEEP, gl.KEEP, gl.DECR_WRAP);
    gl.stencilOpSeparate(gl.BACK, gl.KEEP, gl.KEEP, gl.INCR_WRAP);
    drawPart(part, m, cut, 0);
    gl.colorMask(true, true, true, true);
    gl.depthMask(true);
    gl.enable(gl.DEPTH_TEST);
    gl.stencilFunc(gl.NOTEQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP);
  }

  function cutSquare(cut) {
    const n = cut.slice(0, 3), a = unit(cross(n, Math.abs(n[2]) < 0.8 ? [0, 0, 1] : [1, 0, 0])), b = cross(n, a);
    const far = 3 * view.reach, corner = (i, j) => n.map((v, k) => v * cut[3] + far * (i * a[k] + j * b[k]));
    return new Float32Array([corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, -1), corner(1, 1), corner(-1, 1)].flat());
  }

  function drawCap(part, m, cut, state) {
    markInside(part, m, cut);
    camera(caps, m, cut);
    const u = caps.uniforms, field = view.fields[state.color];
    const byField = Boolean(field && part.fields && view.grids && view.grids.values[field.id]);
    const own = state.color === "region" || byField ? part.color : paleColor(part.color);
    gl.uniform3fv(u.color, own.map((c) => c / 255));
    gl.uniform3fv(u.unknown, unknownColor(part.color).map((c) => c / 255));
    gl.uniform1i(u.byField, byField ? 1 : 0);
    gl.uniform1i(u.values, 0);
    gl.uniform1i(u.table, 1);
    if (byField) {
      gl.activeTexture(gl.TEXTURE1);
      gl.bindTexture(gl.TEXTURE_2D, tables[field.id]);
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_3D, valuesOf(field));
      gl.uniform3fv(u.valuesLow, view.grids.low);
      gl.uniform3fv(u.valuesSize, view.grids.count.map((n) => n * view.grids.spacing));
    }
    gl.bindVertexArray(capVao);
    gl.bindBuffer(gl.ARRAY_BUFFER, capBuffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, cutSquare(cut));
    gl.drawArrays(gl.TRIANGLES, 0, 6);
    gl.disable(gl.STENCIL_TEST);
  }

  function drawLines(buffers, m, cut, { width, slab, mode, plain }) {
    camera(ribbons, m, cut);
    const u = ribbons.uniforms;
    gl.uniform2f(u.halfWidth, width * m.sx, width * m.sy);
    gl.uniform1f(u.lift, 0.7 * m.depthScale);
    gl.uniform1f(u.slab, slab);
    gl.uniform1i(u.mode, mode);
    gl.uniform3fv(u.plain, plain);
    gl.uniform1i(u.table, 1);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, tables.helix || null);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindVertexArray(buffers.vao);
    gl.drawElements(gl.TRIANGLES, buffers.count, gl.UNSIGNED_INT, 0);
  }

  function drawAllLines(parts, m, cut, state) {
    const mode = { plain: 0, helix: 1, direction: 2 }[state.fibers];
    const style = { width: 0.36, slab: 1e9, mode, plain: [0.99, 0.93, 0.76] };
    for (const part of parts) {
      if (part.group === "valves") {
        const color = part.color.map((c) => c / 255);
        if (part.lineBuffers) drawLines(part.lineBuffers, m, cut, { width: 0.7, slab: 1e9, mode: 0, plain: color });
      } else if (mode !== undefined) {
        if (part.lineBuffers) drawLines(part.lineBuffers, m, cut, style);
        if (part.innerBuffers && cut[3] < 1e8) drawLines(part.innerBuffers, m, cut, { ...style, slab: 1.2 });
      }
    }
  }

  function draw(m, cut, state) {
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const shown = view.parts.filter((part) => part.visible), solid = shown.filter((part) => !part.glass);
    for (const part of solid) drawPart(part, m, cut, state.edges);
    const isFilled = (part) => part.group !== "valves" && state.edges !== 2;
    if (cut[3] < 1e8) for (const part of solid) if (isFilled(part)) drawCap(part, m, cut, state);
    drawAllLines(solid, m, cut, state);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    for (const part of shown) if (part.glass) drawPart(part, m, noCut, 0);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  return { draw, recolor };
}
