// WebGL 2: the surfaces of rods from a texture with the state of their nodes; boxes, balls and skins; lines; marks.

const ROW = 512; // texels in a row of the state: two for each node, place and value, then rotation

const TURN = `vec3 turn(vec4 q, vec3 v) { vec3 t = 2.0 * cross(q.yzw, v); return v + q.x * t + cross(q.yzw, t); }`;

const LIGHT = `
uniform vec3 light;
vec3 lit(vec3 color, vec3 normal) {
  float facing = abs(dot(normalize(normal), light));
  return color * (0.42 + 0.58 * facing) + 0.10 * pow(facing, 24.0);
}`;

// A rod is never drawn thinner than a few pixels; flat is its shadow on the floor.
const TUBE = [
  `#version 300 es
in float node; in vec2 point; in vec3 normal;
uniform sampler2D state; uniform mat4 camera; uniform vec3 eye, up;
uniform float thickness, pixel, radius, floorHeight; uniform bool flatten;
out vec3 vNormal; out float vValue;
${TURN}
vec4 at(int i) { return texelFetch(state, ivec2(i % ${ROW}, i / ${ROW}), 0); }
void main() {
  vec4 place = at(2 * int(node)), q = at(2 * int(node) + 1);
  float grown = max(thickness, pixel * distance(eye, place.xyz) / radius);
  vec3 p = place.xyz + turn(q, vec3(grown * point, 0.0));
  if (flatten) p += (floorHeight - dot(p, up)) * up;
  vNormal = turn(q, normal);
  vValue = place.w;
  gl_Position = camera * vec4(p, 1.0);
}`,
  `#version 300 es
precision highp float;
in vec3 vNormal; in float vValue;
uniform sampler2D map; uniform vec2 range; uniform vec4 plain; uniform bool flatten;
out vec4 color;
${LIGHT}
void main() {
  if (flatten) { color = vec4(0.80, 0.80, 0.79, 1.0); return; }
  float place = clamp((vValue - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 own = plain.a > 0.5 ? plain.rgb : texture(map, vec2(0.5 / 256.0 + place * 255.0 / 256.0, 0.5)).rgb;
  color = vec4(lit(own, vNormal), 1.0);
}`,
];

const SOLID = [
  `#version 300 es
in vec3 point, normal;
uniform mat4 camera; uniform vec3 place, sides; uniform vec4 rotation;
out vec3 vNormal;
${TURN}
void main() {
  vNormal = turn(rotation, normal);
  gl_Position = camera * vec4(place + turn(rotation, sides * point), 1.0);
}`,
  `#version 300 es
precision highp float;
in vec3 vNormal;
uniform vec3 own; uniform float alpha;
out vec4 color;
${LIGHT}
void main() { color = vec4(lit(own, vNormal), alpha); }`,
];

const LINE = [
  `#version 300 es
in vec3 point; in vec4 own;
uniform mat4 camera; uniform float size, nearer;
out vec4 vColor;
void main() {
  gl_Position = camera * vec4(point, 1.0);
  gl_Position.z -= nearer * gl_Position.w;
  gl_PointSize = size;
  vColor = own;
}`,
  `#version 300 es
precision highp float;
in vec4 vColor;
uniform int shape; uniform float size;
out vec4 color;
void main() {
  color = vColor;
  if (shape == 0) return;
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  float r = shape == 1 ? length(p) : abs(p.x) + abs(p.y);
  if (r > 1.0) discard;
  if (r > 1.0 - 4.0 / size) color = vec4(0.1, 0.1, 0.1, 1.0);
}`,
];

class Painter {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("this browser has no WebGL 2, so the animation can't be shown");
    this.gl = gl;
    gl.enable(gl.DEPTH_TEST);
    this.tube = this.program(TUBE);
    this.solid = this.program(SOLID);
    this.line = this.program(LINE);
    this.box = this.mesh(this.solid, boxMesh());
    this.ball = this.mesh(this.solid, ballMesh());
    this.square = this.mesh(this.solid, squareMesh());
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.polygonOffset(1, 1);
    this.loose = gl.createVertexArray();
    gl.bindVertexArray(this.loose);
    this.looseBuffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.looseBuffer);
    this.attribute(this.line, "point", 3, 28, 0);
    this.attribute(this.line, "own", 4, 28, 12);
  }

  program([vertex, fragment]) {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, text] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const places = {};
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
      const { name } = gl.getActiveUniform(program, k);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  attribute({ program }, name, size, stride, offset) {
    const place = this.gl.getAttribLocation(program, name);
    this.gl.enableVertexAttribArray(place);
    this.gl.vertexAttribPointer(place, size, this.gl.FLOAT, false, stride, offset);
  }

  mesh(program, { layout, vertices, indices }) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(vertices), gl.STATIC_DRAW);
    const stride = 4 * layout.reduce((sum, [, size]) => sum + size, 0);
    let offset = 0;
    for (const [name, size] of layout) {
      this.attribute(program, name, size, stride, offset);
      offset += 4 * size;
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(indices), gl.STATIC_DRAW);
    return { array, count: indices.length };
  }

  texture(filter) {
    const gl = this.gl;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, filter);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /** A color map: 256 colors of three bytes. */
  colorMap(bytes) {
    const gl = this.gl;
    const texture = this.texture(gl.LINEAR);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, bytes);
    return texture;
  }

  /** A rod, ready to be drawn: its mesh, and the texture and array for the state of its nodes. */
  strand(part) {
    const rows = Math.ceil((2 * part.nodes) / ROW);
    const radius = Math.max(...part.outlines.flat().map((point) => Math.hypot(...point)));
    const state = new Float32Array(4 * ROW * rows);
    return { ...this.mesh(this.tube, tubeMesh(part)), rows, radius, state, texture: this.texture(this.gl.NEAREST) };
  }

  use({ program, places }, values) {
    const gl = this.gl;
    gl.useProgram(program);
    for (const [name, value] of Object.entries(values)) {
      if (!(name in places)) continue;
      if (typeof value === "number") gl.uniform1f(places[name], value);
      else if (typeof value === "boolean") gl.uniform1i(places[name], value);
      else
        gl[{ 2: "uniform2fv", 3: "uniform3fv", 4: "uniform4fv" }[value.length] || "uniformMatrix4fv"](
          places[name],
          ...(value.length > 4 ? [false] : []),
          value,
        );
    }
    return places;
  }

  drawStrand(rod, map, values) {
    const gl = this.gl;
    const places = this.use(this.tube, { ...values, radius: rod.radius });
    gl.uniform1i(places.state, 0);
    gl.uniform1i(places.map, 1);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, map);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, rod.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, ROW, rod.rows, 0, gl.RGBA, gl.FLOAT, rod.state);
    this.drawMesh(rod);
  }

  drawSolid(mesh, values) {
    this.use(this.solid, { alpha: 1, ...values });
    this.drawMesh(mesh);
  }

  /** Draw what one sees through: after all else, behind what lies in it, and hiding nothing. */
  sheer(draw) {
    const gl = this.gl;
    for (const what of [gl.BLEND, gl.POLYGON_OFFSET_FILL]) gl.enable(what);
    gl.depthMask(false);
    draw();
    gl.depthMask(true);
    for (const what of [gl.BLEND, gl.POLYGON_OFFSET_FILL]) gl.disable(what);
  }

  drawMesh({ array, count }) {
    this.gl.bindVertexArray(array);
    this.gl.drawElements(this.gl.TRIANGLES, count, this.gl.UNSIGNED_INT, 0);
  }

  /** Lines (shape 0), disks (1) or diamonds (2): rows of a place and a color, seven numbers each. */
  drawLoose(rows, shape, camera, { size = 1, nearer = 0 } = {}) {
    if (!rows.length) return;
    const gl = this.gl;
    const places = this.use(this.line, { camera, size, nearer });
    gl.uniform1i(places.shape, shape);
    gl.bindVertexArray(this.loose);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.looseBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(rows.flat()), gl.DYNAMIC_DRAW);
    gl.drawArrays(shape ? gl.POINTS : gl.LINES, 0, rows.length);
  }
}
