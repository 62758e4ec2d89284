// Vectors, unit quaternions (w, x, y, z) and matrices by columns, as plain arrays.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => times(1 / (Math.hypot(...a) || 1), a);

/** p q */
function product(p, q) {
  const [a, b] = [p.slice(1), q.slice(1)];
  return [p[0] * q[0] - dot(a, b), ...add(add(times(p[0], b), times(q[0], a)), cross(a, b))];
}

/** A vector turned by a quaternion. */
function turned(q, v) {
  const axis = [q[1], q[2], q[3]];
  const twice = times(2, cross(axis, v));
  return add(add(v, times(q[0], twice)), cross(axis, twice));
}

function matrixProduct(a, b) {
  const found = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      for (let k = 0; k < 4; k++) found[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    }
  }
  return found;
}

function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(0.5 * angle);
  const [c, d] = [(near + far) / (near - far), (2 * near * far) / (near - far)];
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, c, -1, 0, 0, d, 0];
}

/** From space to the eye's axes: to the right, up, and backward. */
function lookAt(eye, target, up) {
  const back = unit(minus(eye, target));
  const right = unit(cross(up, back));
  const above = cross(back, right);
  const shift = [right, above, back].map((axis) => -dot(axis, eye));
  return [0, 1, 2].flatMap((i) => [right[i], above[i], back[i], 0]).concat(shift, 1);
}

/** Where a matrix brings a point: x and y from -1 to 1, and the depth along the line of sight. */
function projected(matrix, [x, y, z]) {
  const row = (i) => matrix[i] * x + matrix[4 + i] * y + matrix[8 + i] * z + matrix[12 + i];
  return [row(0) / row(3), row(1) / row(3), row(3)];
}

/** The round number (1, 2 or 5 times a power of ten) next above a value. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5, 10].find((digit) => digit * power >= value * (1 - 1e-9));
}

/** A number as a person writes it. */
function shown(value, digits = 4) {
  if (value === 0 || !Number.isFinite(value)) return value === 0 ? "0" : "–";
  const size = Math.abs(value);
  const text = size < 1e-3 || size >= 1e5 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return text.replace(/\.?0*e\+?/, "e").replace(/-/g, "\u2212");
}
