// The report's 3D view: surfaces of the model and lines along its fibres, to turn, zoom and cut. WebGL 2, no library.
// The page holds two elements: #model-index (JSON) and #model-data (base64 of little-endian arrays, see viewer_data.cpp).
(function () {
  "use strict";
  const root = document.getElementById("viewer");
  if (!root) return;
  const canvas = root.querySelector("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: true, preserveDrawingBuffer: true });
  if (!gl) {
    root.classList.add("no-webgl");
    return;
  }

  // ---- data -------------------------------------------------------------------------------------------------------
  const index = JSON.parse(document.getElementById("model-index").textContent);
  const bytes = Uint8Array.from(atob(document.getElementById("model-data").textContent.trim()), (c) => c.charCodeAt(0));
  const low = index.low, scale = index.scale;
  const center = index.center;

  function positionsOf(part) {
    const raw = new Uint16Array(bytes.buffer, part.positions, part.vertices * 3);
    const out = new Float32Array(raw.length);
    for (let i = 0; i < raw.length; ++i) out[i] = low[i % 3] + raw[i] * scale - center[i % 3];
    return out;
  }

  function normalsOf(p, t) {
    const n = new Float32Array(p.length);
    for (let i = 0; i < t.length; i += 3) {
      const a = 3 * t[i], b = 3 * t[i + 1], c = 3 * t[i + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      for (const k of [a, b, c]) {
        n[k] += x;
        n[k + 1] += y;
        n[k + 2] += z;
      }
    }
    return n;
  }

  // ---- shaders ----------------------------------------------------------------------------------------------------
  const ramp = `
    vec3 helixColor(float h) {
      float t = clamp(((h * 255.0 - 1.0) / 254.0 * 180.0 - 90.0) / 75.0, -1.0, 1.0);
      vec3 end = t < 0.0 ? vec3(38., 84., 178.) : vec3(186., 32., 46.);
      return mix(vec3(246., 244., 240.), end, abs(t)) / 255.0;
    }`;
  const meshVertex = `#version 300 es
    layout(location = 0) in vec3 position;
    layout(location = 1) in vec3 normal;
    layout(location = 2) in float helix;
    uniform mat4 toClip;
    uniform mat3 toEye;
    out vec3 eyeNormal;
    out vec3 place;
    out vec2 h; // angle where it is known, and 1 there: their quotient does not suffer from unknown neighbours
    void main() {
      eyeNormal = toEye * normal;
      place = position;
      h = helix > 0.5 / 255.0 ? vec2(helix, 1.0) : vec2(0.0);
      gl_Position = toClip * vec4(position, 1.0);
    }`;
  const meshFragment = `#version 300 es
    precision highp float;
    in vec3 eyeNormal;
    in vec3 place;
    in vec2 h;
    uniform vec4 cut;
    uniform vec3 color;
    uniform bool byHelix;
    uniform bool glass;
    out vec4 result;
    ${ramp}
    void main() {
      if (dot(cut.xyz, place) > cut.w) discard;
      vec3 n = normalize(eyeNormal);
      if (!gl_FrontFacing) n = -n;
      if (n.z < 0.0) n.z = -n.z;
      vec3 base = !byHelix ? color : h.y > 0.5 ? helixColor(h.x / h.y) : mix(vec3(0.74), color, 0.2);
      float key = max(0.0, dot(n, normalize(vec3(-0.35, 0.55, 0.9))));
      vec3 halfway = normalize(vec3(-0.35, 0.55, 1.9));
      float shine = pow(max(0.0, dot(n, halfway)), 28.0) * 0.16;
      vec3 lit = base * (0.36 + 0.46 * key + 0.22 * n.z) + shine;
      if (glass) {
        float edge = 1.0 - n.z;
        float alpha = 0.08 + 0.55 * edge * edge;
        result = vec4(lit * alpha, alpha);
      } else {
        result = vec4(lit, 1.0);
      }
    }`;
  const lineVertex = `#version 300 es
    layout(location = 0) in vec3 position;
    layout(location = 1) in vec3 along;
    layout(location = 2) in float helix;
    layout(location = 3) in float side;
    uniform mat4 toClip;
    uniform mat3 toEye;
    uniform vec2 halfWidth;
    uniform float lift;
    out vec3 place;
    out float h;
    out float s;
    void main() {
      vec4 p = toClip * vec4(position, 1.0);
      vec2 t = (toEye * along).xy;
      float len = length(t);
      t = len > 1e-4 ? t / len : vec2(1.0, 0.0);
      p.xy += vec2(-t.y, t.x) * side * halfWidth;
      p.z -= lift;
      place = position;
      h = helix;
      s = side;
      gl_Position = p;
    }`;
  const lineFragment = `#version 300 es
    precision highp float;
    in vec3 place;
    in float h;
    in float s;
    uniform vec4 cut;
    out vec4 result;
    ${ramp}
    void main() {
      if (dot(cut.xyz, place) > cut.w) discard;
      result = vec4(helixColor(h) * (1.0 - 0.5 * s * s), 1.0);
    }`;
  const capVertex = `#version 300 es
    layout(location = 0) in vec3 position;
    uniform mat4 toClip;
    out vec3 place;
    void main() {
      place = position;
      gl_Position = toClip * vec4(position, 1.0);
    }`;
  const capFragment = `#version 300 es
    precision highp float;
    precision highp sampler3D;
    in vec3 place;
    uniform vec3 color;
    uniform bool byHelix;
    uniform sampler3D angles; // as h above
    uniform vec3 anglesLow;
    uniform vec3 anglesSize;
    out vec4 result;
    ${ramp}
    void main() {
      vec3 base = color;
      if (byHelix) {
        vec2 h = texture(angles, (place - anglesLow) / anglesSize).rg;
        base = h.y > 0.02 ? helixColor(h.x / h.y) : mix(vec3(0.74), color, 0.2);
      }
      result = vec4(base * 0.93, 1.0);
    }`;

  function program(vertex, fragment) {
    const p = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(p, shader);
    }
    gl.linkProgram(p);
    const uniforms = {};
    const count = gl.getProgramParameter(p, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < count; ++i) {
      const name = gl.getActiveUniform(p, i).name;
      uniforms[name] = gl.getUniformLocation(p, name);
    }
    return { p, uniforms };
  }
  const meshProgram = program(meshVertex, meshFragment);
  const lineProgram = program(lineVertex, lineFragment);
  const capProgram = program(capVertex, capFragment);

  function attribute(location, data, size, type, normalized) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, normalized, 0, 0);
  }

  const parts = index.parts.map((part) => {
    const triangles = new Uint32Array(bytes.buffer, part.indices, part.triangles * 3);
    const p = positionsOf(part);
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    attribute(0, p, 3, gl.FLOAT, false);
    attribute(1, normalsOf(p, triangles), 3, gl.FLOAT, false);
    attribute(2, new Uint8Array(bytes.buffer, part.helix, part.vertices), 1, gl.UNSIGNED_BYTE, true);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { ...part, vao, count: triangles.length, visible: part.shown };
  });

  /// Each piece of a line becomes a ribbon that faces the viewer.
  function makeLines(lines) {
    if (!lines || !lines.vertices) return null;
    const p = positionsOf(lines);
    const helix = new Uint8Array(bytes.buffer, lines.helix, lines.vertices);
    const lengths = new Uint16Array(bytes.buffer, lines.lengths, lines.lines);
    const position = [], along = [], h = [], side = [], triangles = [];
    let first = 0;
    for (const length of lengths) {
      for (let i = 0; i < length; ++i) {
        const here = first + i, a = first + Math.max(0, i - 1), b = first + Math.min(length - 1, i + 1);
        for (const s of [-1, 1]) {
          for (let k = 0; k < 3; ++k) {
            position.push(p[3 * here + k]);
            along.push(p[3 * b + k] - p[3 * a + k]);
          }
          h.push(helix[here]);
          side.push(s);
        }
        if (i + 1 < length) {
          const v = 2 * here;
          triangles.push(v, v + 1, v + 2, v + 1, v + 3, v + 2);
        }
      }
      first += length;
    }
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    attribute(0, new Float32Array(position), 3, gl.FLOAT, false);
    attribute(1, new Float32Array(along), 3, gl.FLOAT, false);
    attribute(2, new Uint8Array(h), 1, gl.UNSIGNED_BYTE, true);
    attribute(3, new Float32Array(side), 1, gl.FLOAT, false);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(triangles), gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { vao, count: triangles.length };
  }
  const lines = makeLines(index.lines);

  /// Helix angles on a grid, for the faces that a cut opens.
  function makeAngles(grid) {
    if (!grid) return null;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_3D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const [nx, ny, nz] = grid.count, values = new Uint8Array(bytes.buffer, grid.values, nx * ny * nz);
    const pairs = new Uint8Array(2 * values.length);
    values.forEach((v, i) => {
      pairs[2 * i] = v;
      pairs[2 * i + 1] = v ? 255 : 0;
    });
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RG8, nx, ny, nz, 0, gl.RG, gl.UNSIGNED_BYTE, pairs);
    for (const axis of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R])
      gl.texParameteri(gl.TEXTURE_3D, axis, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    return { texture, low: grid.low.map((v, i) => v - center[i]), size: grid.count.map((n) => n * grid.spacing) };
  }
  const angles = makeAngles(index.angles);

  // ---- state ------------------------------------------------------------------------------------------------------
  const views = {
    front: [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    back: [[-1, 0, 0], [0, 0, 1], [0, 1, 0]],
    left: [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
    below: [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    chambers: index.chambersView,
  };
  const state = {
    eye: views.front.map((row) => row.slice()), // rows: right, up, toward the viewer
    zoom: 1,
    pan: [0, 0],
    helix: false,
    fibers: false,
    cut: "none",
    share: 0.5,
  };
  const radius = index.radius;

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((v) => v / Math.hypot(a[0], a[1], a[2]));

  /// Normal and offset: what lies beyond is taken away. The heart's own radius bounds the slider.
  function cutPlane() {
    const normals = {
      coronal: [0, -1, 0],
      sagittal: [1, 0, 0],
      axial: [0, 0, 1],
      chambers: index.chambersView[2],
      screen: state.eye[2],
    };
    const n = normals[state.cut];
    if (!n) return [0, 0, 0, 1e9];
    return [n[0], n[1], n[2], (1 - 2 * state.share) * radius];
  }

  function turn(dx, dy) {
    const [right, up, toward] = state.eye;
    const angle = Math.hypot(dx, dy);
    if (angle < 1e-6) return;
    const axis = unit(right.map((v, i) => (v * dy + up[i] * dx) / angle));
    const c = Math.cos(-angle), s = Math.sin(-angle);
    const rotated = (v) => {
      const k = cross(axis, v), d = dot(axis, v) * (1 - c);
      return v.map((x, i) => x * c + k[i] * s + axis[i] * d);
    };
    const newToward = unit(rotated(toward));
    let newUp = rotated(up);
    newUp = unit(newUp.map((v, i) => v - dot(newUp, newToward) * newToward[i]));
    state.eye = [cross(newUp, newToward), newUp, newToward];
  }

  // ---- drawing ----------------------------------------------------------------------------------------------------
  function matrices() {
    const aspect = canvas.width / canvas.height;
    const k = state.zoom / (1.08 * radius);
    const sx = aspect > 1 ? k / aspect : k, sy = aspect > 1 ? k : k * aspect;
    const sz = -1 / (index.reach * 2.2);
    const [r, u, t] = state.eye;
    const m = [];
    for (let column = 0; column < 3; ++column) m.push(sx * r[column], sy * u[column], sz * t[column], 0);
    m.push(state.pan[0] * sx, state.pan[1] * sy, 0, 1);
    const eye = [];
    for (let column = 0; column < 3; ++column) eye.push(r[column], u[column], t[column]);
    return { toClip: new Float32Array(m), toEye: new Float32Array(eye), sx, sy, depthScale: -sz };
  }

  function drawPart(part, m, cut, glass) {
    gl.useProgram(meshProgram.p);
    const u = meshProgram.uniforms;
    gl.uniformMatrix4fv(u.toClip, false, m.toClip);
    gl.uniformMatrix3fv(u.toEye, false, m.toEye);
    gl.uniform4fv(u.cut, cut);
    gl.uniform3fv(u.color, part.color.map((c) => c / 255));
    gl.uniform1i(u.byHelix, state.helix && part.muscle ? 1 : 0);
    gl.uniform1i(u.glass, glass ? 1 : 0);
    gl.bindVertexArray(part.vao);
    gl.drawElements(gl.TRIANGLES, part.count, gl.UNSIGNED_INT, 0);
  }

  const capVao = gl.createVertexArray();
  gl.bindVertexArray(capVao);
  const capBuffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, capBuffer);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);

  /// The cut through one closed surface, filled: inside is where back faces and front faces do not cancel.
  function drawCap(part, m, cut) {
    gl.enable(gl.STENCIL_TEST);
    gl.clearStencil(0);
    gl.clear(gl.STENCIL_BUFFER_BIT);
    gl.colorMask(false, false, false, false);
    gl.depthMask(false);
    gl.disable(gl.DEPTH_TEST);
    gl.stencilFunc(gl.ALWAYS, 0, 255);
    gl.stencilOpSeparate(gl.FRONT, gl.KEEP, gl.KEEP, gl.DECR_WRAP);
    gl.stencilOpSeparate(gl.BACK, gl.KEEP, gl.KEEP, gl.INCR_WRAP);
    drawPart(part, m, cut, false);
    gl.colorMask(true, true, true, true);
    gl.depthMask(true);
    gl.enable(gl.DEPTH_TEST);
    gl.stencilFunc(gl.NOTEQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP);
    const n = cut.slice(0, 3), a = unit(cross(n, Math.abs(n[2]) < 0.8 ? [0, 0, 1] : [1, 0, 0])), b = cross(n, a);
    const far = 3 * index.reach, corner = (i, j) => n.map((v, k) => v * cut[3] + far * (i * a[k] + j * b[k]));
    const square = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, -1), corner(1, 1), corner(-1, 1)].flat();
    gl.useProgram(capProgram.p);
    gl.uniformMatrix4fv(capProgram.uniforms.toClip, false, m.toClip);
    gl.uniform3fv(capProgram.uniforms.color, part.color.map((c) => c / 255));
    gl.uniform1i(capProgram.uniforms.byHelix, state.helix && part.muscle && angles ? 1 : 0);
    if (angles) {
      gl.bindTexture(gl.TEXTURE_3D, angles.texture);
      gl.uniform3fv(capProgram.uniforms.anglesLow, angles.low);
      gl.uniform3fv(capProgram.uniforms.anglesSize, angles.size);
    }
    gl.bindVertexArray(capVao);
    gl.bindBuffer(gl.ARRAY_BUFFER, capBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(square), gl.DYNAMIC_DRAW);
    gl.drawArrays(gl.TRIANGLES, 0, 6);
    gl.disable(gl.STENCIL_TEST);
  }

  function drawLines(m, cut) {
    if (!lines || !state.fibers) return;
    gl.useProgram(lineProgram.p);
    const u = lineProgram.uniforms;
    gl.uniformMatrix4fv(u.toClip, false, m.toClip);
    gl.uniformMatrix3fv(u.toEye, false, m.toEye);
    gl.uniform4fv(u.cut, cut);
    gl.uniform2f(u.halfWidth, 0.42 * m.sx, 0.42 * m.sy);
    gl.uniform1f(u.lift, 0.9 * m.depthScale);
    gl.bindVertexArray(lines.vao);
    gl.drawElements(gl.TRIANGLES, lines.count, gl.UNSIGNED_INT, 0);
  }

  function draw() {
    waiting = false;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const m = matrices(), cut = cutPlane(), cutting = cut[3] < 1e8;
    for (const part of parts) if (part.visible && !part.glass) drawPart(part, m, cut, false);
    if (cutting) for (const part of parts) if (part.visible && !part.glass) drawCap(part, m, cut);
    drawLines(m, cut);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    for (const part of parts) if (part.visible && part.glass) drawPart(part, m, [0, 0, 0, 1e9], true);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    drawLetters();
  }
  let waiting = false;
  function redraw() {
    if (!waiting) {
      waiting = true;
      requestAnimationFrame(draw);
    }
  }

  /// The body's directions at the rim of the view; a letter fades as its direction turns to the viewer.
  const letters = [["L", [1, 0, 0]], ["R", [-1, 0, 0]], ["P", [0, 1, 0]], ["A", [0, -1, 0]], ["S", [0, 0, 1]], ["I", [0, 0, -1]]]
    .map(([name, direction]) => {
      const element = document.createElement("span");
      element.className = "letter";
      element.textContent = name;
      root.querySelector(".stage").appendChild(element);
      return { element, direction };
    });
  function drawLetters() {
    for (const { element, direction } of letters) {
      const x = dot(state.eye[0], direction), y = dot(state.eye[1], direction), flat = Math.hypot(x, y);
      const reach = 0.46 / Math.max(Math.abs(x), Math.abs(y), 1e-6);
      element.style.left = 50 + 100 * x * reach + "%";
      element.style.top = 50 - 100 * y * reach + "%";
      element.style.opacity = flat < 0.5 ? 0 : (flat - 0.5) * 2;
    }
  }

  // ---- hands ------------------------------------------------------------------------------------------------------
  const pointers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY], dx = now[0] - before[0], dy = now[1] - before[1];
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      const span = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
      zoomBy(span(now) / Math.max(1, span(before)));
    } else if (event.shiftKey || event.buttons === 4 || event.buttons === 2) {
      const mmPerPixel = (2.16 * radius) / (state.zoom * Math.min(canvas.clientWidth, canvas.clientHeight));
      state.pan[0] += dx * mmPerPixel;
      state.pan[1] -= dy * mmPerPixel;
    } else {
      turn(dx * 0.008, dy * 0.008);
    }
    pointers.set(event.pointerId, now);
    redraw();
  });
  for (const kind of ["pointerup", "pointercancel"])
    canvas.addEventListener(kind, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  function zoomBy(factor) {
    state.zoom = Math.min(12, Math.max(0.15, state.zoom * factor));
    redraw();
  }
  // The page must stay scrollable: the wheel zooms once the view was clicked.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    zoomBy(Math.exp(-event.deltaY * 0.0012));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    if (steps[event.key]) turn(...steps[event.key]);
    else if (event.key === "+") zoomBy(1.15);
    else if (event.key === "-") zoomBy(1 / 1.15);
    else return;
    event.preventDefault();
    redraw();
  });

  function show(view) {
    state.eye = views[view].map((row) => row.slice());
    state.pan = [0, 0];
    state.zoom = 1;
    redraw();
  }
  for (const button of root.querySelectorAll("[data-view]"))
    button.addEventListener("click", () => show(button.dataset.view));
  const colors = root.querySelector("[name=color]"), cutChoice = root.querySelector("[name=cut]");
  const slider = root.querySelector("[name=share]"), fibers = root.querySelector("[name=fibers]");
  function readControls() {
    state.helix = colors.value === "helix";
    state.cut = cutChoice.value;
    state.share = Number(slider.value) / 1000;
    state.fibers = Boolean(fibers && fibers.checked);
    slider.disabled = state.cut === "none";
    root.querySelector(".ramp").hidden = !(state.helix || state.fibers);
    redraw();
  }
  for (const control of [colors, cutChoice, slider, fibers])
    if (control) control.addEventListener("input", readControls);
  cutChoice.addEventListener("change", () => {
    if (state.cut === "chambers") show("chambers");
  });

  const list = root.querySelector(".parts");
  for (const part of parts) {
    const label = document.createElement("label"), box = document.createElement("input"), dye = document.createElement("i");
    box.type = "checkbox";
    box.checked = part.visible;
    box.addEventListener("input", () => {
      part.visible = box.checked;
      redraw();
    });
    dye.style.background = `rgb(${part.color.join(",")})`;
    label.append(box, dye, part.label);
    list.append(label);
  }

  new ResizeObserver(redraw).observe(canvas);
  const wanted = new URLSearchParams(location.hash.slice(1)); // e.g. report.html#view=chambers&cut=chambers&color=helix
  if (wanted.has("color")) colors.value = wanted.get("color");
  if (wanted.has("cut")) cutChoice.value = wanted.get("cut");
  if (wanted.has("share")) slider.value = wanted.get("share");
  if (fibers && wanted.has("fibers")) fibers.checked = wanted.get("fibers") === "1";
  if (views[wanted.get("view")]) show(wanted.get("view"));
  readControls();
})();
