// Drawing with WebGL 2: surfaces, the faces that a cut opens, lines. Positions are in mm around the model's centre.

const meshVertex = `#version 300 es
  layout(location = 0) in vec3 position;
  layout(location = 1) in vec3 normal;
  layout(location = 2) in vec3 color;
  uniform mat4 toClip;
  uniform mat3 toEye;
  out vec3 eyeNormal;
  out vec3 place;
  out vec3 base;
  out vec3 corner;
  void main() {
    eyeNormal = toEye * normal;
    place = position;
    base = color;
    int k = gl_VertexID % 3;
    corner = vec3(k == 0, k == 1, k == 2);
    gl_Position = toClip * vec4(position, 1.0);
  }`;

const meshFragment = `#version 300 es
  precision highp float;
  in vec3 eyeNormal;
  in vec3 place;
  in vec3 base;
  in vec3 corner;
  uniform vec4 cut;
  uniform bool glass;
  uniform int edges; // 0 none, 1 on the surface, 2 alone
  out vec4 result;
  void main() {
    if (dot(cut.xyz, place) > cut.w) discard;
    vec3 n = normalize(eyeNormal);
    if (!gl_FrontFacing) n = -n;
    if (n.z < 0.0) n.z = -n.z;
    float key = max(0.0, dot(n, normalize(vec3(-0.35, 0.55, 0.9))));
    float shine = pow(max(0.0, dot(n, normalize(vec3(-0.35, 0.55, 1.9)))), 28.0) * 0.14;
    vec3 lit = base * (0.38 + 0.46 * key + 0.22 * n.z) + shine;
    vec3 width = fwidth(corner);
    vec3 near = smoothstep(width * 0.4, width * 1.3, corner);
    float edge = 1.0 - min(near.x, min(near.y, near.z));
    if (edges == 2 && edge < 0.25) discard;
    if (edges == 1) lit = mix(lit, lit * 0.35, 0.8 * edge);
    if (edges == 2) lit = base * 0.75;
    if (glass) {
      float alpha = 0.06 + 0.5 * (1.0 - n.z) * (1.0 - n.z);
      result = vec4(lit * alpha, alpha);
    } else {
      result = vec4(lit, 1.0);
    }
  }`;

const lineVertex = `#version 300 es
  layout(location = 0) in vec3 position;
  layout(location = 1) in vec3 along;
  layout(location = 2) in float value;
  layout(location = 3) in float side;
  uniform mat4 toClip;
  uniform mat3 toEye;
  uniform vec2 halfWidth;
  uniform float lift;
  out vec3 place;
  out vec3 axis;
  out vec3 eyeAcross;
  out float byte;
  out float s;
  void main() {
    vec4 p = toClip * vec4(position, 1.0);
    vec2 t = (toEye * along).xy;
    float len = length(t);
    t = len > 1e-4 ? t / len : vec2(1.0, 0.0);
    eyeAcross = vec3(-t.y, t.x, 0.0);
    p.xy += eyeAcross.xy * side * halfWidth;
    p.z -= lift;
    place = position;
    axis = along;
    byte = value;
    s = side;
    gl_Position = p;
  }`;

const lineFragment = `#version 300 es
  precision highp float;
  in vec3 place;
  in vec3 axis;
  in vec3 eyeAcross;
  in float byte;
  in float s;
  uniform vec4 cut;
  uniform float slab; // only this far below the cut, mm
  uniform int mode;   // 0 plain, 1 by value, 2 by direction
  uniform vec3 plain;
  uniform sampler2D table;
  out vec4 result;
  void main() {
    float above = dot(cut.xyz, place) - cut.w;
    if (above > 0.0 || above < -slab) discard;
    vec3 base = plain;
    if (mode == 1 && byte > 0.5 / 255.0) base = texture(table, vec2(byte * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
    if (mode == 2) base = abs(normalize(axis)) * 0.85 + 0.12;
    vec3 n = eyeAcross * s + vec3(0.0, 0.0, sqrt(max(0.0, 1.0 - s * s)));
    float key = max(0.0, dot(n, normalize(vec3(-0.35, 0.55, 0.9))));
    vec3 lit = base * (0.45 + 0.6 * key) + 0.18 * pow(key, 20.0);
    result = vec4(mix(lit, base * 0.12, smoothstep(0.62, 0.8, abs(s))), 1.0);
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
  uniform vec3 unknown;
  uniform bool byField;
  uniform sampler3D values; // a byte, and whether it is known: their quotient does not suffer from unknown neighbours
  uniform sampler2D table;
  uniform vec3 valuesLow;
  uniform vec3 valuesSize;
  out vec4 result;
  void main() {
    vec3 base = color;
    if (byField) {
      vec2 h = texture(values, (place - valuesLow) / valuesSize).rg;
      base = h.y > 0.02 ? texture(table, vec2(h.x / h.y * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb : unknown;
    }
    result = vec4(base * 0.94, 1.0);
  }`;

function makeProgram(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  const uniforms = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
    const { name } = gl.getActiveUniform(program, i);
    uniforms[name] = gl.getUniformLocation(program, name);
  }
  return { program, uniforms };
}

function setAttribute(gl, location, data, size, type, normalized) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
  gl.enableVertexAttribArray(location);
  gl.vertexAttribPointer(location, size, type, normalized, 0, 0);
  return buffer;
}

/// Every triangle with corners of its own, so that what is per triangle can be drawn.
function makeSurface(gl, part) {
  const position = new Float32Array(part.triangles * 9), normal = new Float32Array(part.triangles * 9);
  part.indices.forEach((id, i) => {
    for (let k = 0; k < 3; ++k) {
      position[3 * i + k] = part.points[3 * id + k];
      normal[3 * i + k] = part.normals[3 * id + k];
    }
  });
  const vao = gl.createVertexArray();
  gl.bindVertexArray(vao);
  setAttribute(gl, 0, position, 3, gl.FLOAT, false);
  setAttribute(gl, 1, normal, 3, gl.FLOAT, false);
  const colors = setAttribute(gl, 2, new Uint8Array(part.triangles * 12), 4, gl.UNSIGNED_BYTE, true);
  gl.bindVertexArray(null);
  return { vao, colors, count: part.triangles * 3 };
}

/// Ribbons that face the viewer, two vertices for every point.
function makeRibbons(gl, { points, helix, lengths }) {
  const count = points.length / 3;
  const position = new Float32Array(6 * count), along = new Float32Array(6 * count), side = new Float32Array(2 * count);
  const value = new Uint8Array(2 * count), triangles = [];
  let first = 0;
  for (const length of lengths) {
    for (let i = 0; i < length; ++i) {
      const here = first + i, a = first + Math.max(0, i - 1), b = first + Math.min(length - 1, i + 1);
      for (const end of [0, 1]) {
        const v = 2 * here + end;
        for (let k = 0; k < 3; ++k) {
          position[3 * v + k] = points[3 * here + k];
          along[3 * v + k] = points[3 * b + k] - points[3 * a + k];
        }
        side[v] = 2 * end - 1;
        value[v] = helix[here];
      }
      const v = 2 * here;
      if (i + 1 < length) triangles.push(v, v + 1, v + 2, v + 1, v + 3, v + 2);
    }
    first += length;
  }
  const vao = gl.createVertexArray();
  gl.bindVertexArray(vao);
  setAttribute(gl, 0, position, 3, gl.FLOAT, false);
  setAttribute(gl, 1, along, 3, gl.FLOAT, false);
  setAttribute(gl, 2, value, 1, gl.UNSIGNED_BYTE, true);
  setAttribute(gl, 3, side, 1, gl.FLOAT, false);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(triangles), gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { vao, count: triangles.length };
}

function makeTable(gl, table) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, table);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  return texture;
}

function makeValues(gl, bytes, [nx, ny, nz], isSmooth) {
  const pairs = new Uint8Array(2 * bytes.length);
  bytes.forEach((v, i) => {
    pairs[2 * i] = v;
    pairs[2 * i + 1] = v ? 255 : 0;
  });
  const texture = gl.createTexture(), filter = isSmooth ? gl.LINEAR : gl.NEAREST;
  gl.bindTexture(gl.TEXTURE_3D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.RG8, nx, ny, nz, 0, gl.RG, gl.UNSIGNED_BYTE, pairs);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, name, gl.CLAMP_TO_EDGE);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, name, filter);
  return texture;
}
