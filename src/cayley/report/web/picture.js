// The picture of a scene at one frame: shadows, rods, bodies, springs, marks, the floor and its labels.

const INK = [0.1, 0.1, 0.1, 1];
const GRAY = [0.42, 0.42, 0.42, 1];
const PALE = [0.87, 0.87, 0.86, 1];
const STEEL = [0.66, 0.71, 0.76];
const STONE = [0.82, 0.79, 0.73];
const AXIS_COLORS = [
  [0.84, 0.37, 0, 1],
  [0, 0.62, 0.45, 1],
  [0, 0.45, 0.7, 1],
];
const AXIS_NAMES = ["x", "y", "z"];

class Picture {
  constructor(canvas, overlay, maps) {
    this.canvas = canvas;
    this.overlay = overlay;
    this.painter = new Painter(canvas);
    this.maps = Object.fromEntries(Object.entries(maps).map(([name, bytes]) => [name, this.painter.colorMap(bytes)]));
  }

  show(scene) {
    this.scene = scene;
    if (!this.camera || this.camera.up.join() !== scene.up.join()) this.camera = new Camera(scene.up);
    this.rods = scene.rods ||= scene.parts.map((part) => (part.kind === "strand" ? this.painter.strand(part) : null));
    this.obstacles = scene.obstacles ||= new Obstacles(scene, this.painter);
    this.fit();
  }

  /** See all of it. */
  fit() {
    this.widen();
    this.camera.fit(this.low, this.high, this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight));
  }

  /** Make the room as large as all frames need, and choose the distance of its ticks. */
  widen() {
    const { low, high, floor } = this.obstacles.room();
    const longest = Math.max(...minus(high, low), 1e-9);
    const middle = times(0.5, add(low, high));
    const half = minus(high, low).map((side) => 0.5 * Math.max(side, 0.15 * longest) + 0.03 * longest);
    [this.low, this.high] = [minus(middle, half), add(middle, half)];
    if (floor !== null) {
      const k = this.directions()[2];
      (this.scene.up[k] > 0 ? this.low : this.high)[k] = floor;
    }
    this.step = roundUp(longest / 6);
  }

  /** Match the size of the canvases to that of their place on the page. */
  resize() {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    for (const canvas of [this.canvas, this.overlay]) {
      const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.round(ratio * side));
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    }
    this.ratio = ratio;
  }

  /** Places and rotations of a part's nodes at a frame with fraction. */
  pose(part, frame) {
    const k = Math.min(Math.floor(frame), this.scene.frames - 1);
    const next = Math.min(k + 1, this.scene.frames - 1);
    const w = frame - k;
    const [x, y] = [part.position.row(k), part.position.row(next)];
    const [p, q] = [part.rotation.row(k), part.rotation.row(next)];
    const node = (i) => {
      const own = p.subarray(4 * i, 4 * i + 4);
      const other = q.subarray(4 * i, 4 * i + 4);
      const sign = own[0] * other[0] + own[1] * other[1] + own[2] * other[2] + own[3] * other[3] < 0 ? -1 : 1;
      const sum = [0, 1, 2, 3].map((c) => (1 - w) * own[c] + sign * w * other[c]);
      return times4(1 / Math.hypot(...sum), sum);
    };
    const place = (i) => [0, 1, 2].map((c) => (1 - w) * x[3 * i + c] + w * y[3 * i + c]);
    return { node, place, k, next, w };
  }

  /** Where a Place is at the frame of the poses. */
  locate(place, poses) {
    if (place.part === null) return place.shift;
    const pose = poses[place.part];
    return add(pose.place(place.node), turned(pose.node(place.node), place.shift));
  }

  draw({ frame, color, range, thickness, frames, ports, selected }) {
    this.resize();
    const { painter, scene, camera } = this;
    const gl = painter.gl;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const matrix = (this.matrix = camera.matrix(this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight)));
    const eye = camera.eye;
    const light = unit(add(camera.backward, times(0.5, scene.up)));
    const poses = scene.parts.map((part) => this.pose(part, frame));
    const pixel = (2 * 1.6 * Math.tan(0.5 * ANGLE)) / Math.max(1, this.canvas.clientHeight);
    const floorHeight = this.floor() + 1e-3 * camera.size;
    const common = { camera: matrix, eye, up: scene.up, light, thickness, pixel, floorHeight };
    const lines = this.grid();
    const rigid = [];
    scene.parts.forEach((part, i) => {
      const values = this.values(part, poses[i], color);
      if (part.kind === "strand") {
        this.fill(this.rods[i], part, poses[i], values);
        const own = { ...common, plain: values ? [0, 0, 0, 0] : [...STEEL, 1], range };
        painter.drawStrand(this.rods[i], this.maps[color.map], { ...own, flatten: true });
        painter.drawStrand(this.rods[i], this.maps[color.map], { ...own, flatten: false });
      } else rigid.push([part, poses[i], values]);
      if (frames) lines.push(...this.triads(part, poses[i]));
    });
    const colors = new Map();
    for (const [part, pose, values] of rigid) {
      const own = (values && this.rgb(values[0], range, color.map)) || STEEL;
      colors.set(scene.parts.indexOf(part), own);
      this.drawBlock(part, pose, own, common, lines);
    }
    this.obstacles.draw(poses, colors, common, lines, this);
    for (const link of scene.links)
      lines.push(...segment(this.locate(link.first, poses), this.locate(link.second, poses), GRAY));
    painter.drawLoose(lines, 0, matrix);
    painter.sheer(() => this.obstacles.drawSheer(common));
    this.drawMarks(poses, ports, matrix, selected);
    this.labels();
  }

  /** The values that color a part, between two frames; null if it has none. */
  values(part, { k, next, w }, color) {
    const one = part.quantities.find((other) => other.key === color.key);
    if (!one) return null;
    const [a, b] = [k, next].map((frame) => colored(one, one.channel.row(frame), color.component));
    return Float32Array.from(a, (value, i) => (1 - w) * value + w * b[i]);
  }

  fill(rod, part, pose, values) {
    for (let i = 0; i < part.nodes; i++) {
      rod.state.set(pose.place(i), 8 * i);
      rod.state[8 * i + 3] = values ? values[i] : 0;
      rod.state.set(pose.node(i), 8 * i + 4);
    }
  }

  rgb(value, [low, high], map) {
    const bytes = MAPS[map];
    const k = Math.round(255 * Math.min(1, Math.max(0, (value - low) / (high - low))));
    return [0, 1, 2].map((c) => bytes[3 * k + c] / 255);
  }

  drawBlock(part, pose, rgb, common, lines) {
    const [place, q] = [pose.place(0), pose.node(0)];
    const own = { ...common, place, own: rgb };
    if (part.sides && !part.shaped)
      this.painter.drawSolid(this.painter.box, { ...own, rotation: product(q, part.turn), sides: part.sides });
    else if (!part.shaped) {
      const size = 0.04 * this.camera.size;
      this.painter.drawSolid(this.painter.ball, { ...own, rotation: q, sides: [size, size, size] });
    }
    for (const shift of Object.values(part.ports || {}))
      lines.push(...segment(place, add(place, turned(q, shift)), GRAY));
  }

  /** The three axes of cross-sections, at up to forty nodes of a rod. */
  triads(part, pose) {
    const found = [];
    const every = Math.max(1, Math.ceil(part.nodes / 40));
    const length = 0.07 * this.camera.size;
    for (let i = 0; i < part.nodes; i += every) {
      const [place, q] = [pose.place(i), pose.node(i)];
      for (let axis = 0; axis < 3; axis++) {
        const along = [0, 0, 0];
        along[axis] = length;
        found.push(...segment(place, add(place, turned(q, along)), AXIS_COLORS[axis]));
      }
    }
    return found;
  }

  drawMarks(poses, ports, matrix, selected) {
    const { painter, scene } = this;
    const at = (kind) =>
      scene.marks.filter((mark) => mark.kind === kind).map((mark) => [...this.locate(mark.place, poses), 1, 1, 1, 1]);
    const size = this.ratio;
    painter.drawLoose(at("support"), 1, matrix, { size: 11 * size, nearer: 2e-3 });
    painter.drawLoose(at("joint"), 2, matrix, { size: 12 * size, nearer: 2e-3 });
    if (ports) {
      const places = scene.parts.flatMap((part, i) =>
        this.ports(part).map(([, node, shift]) => this.locate({ part: i, node, shift }, poses)),
      );
      painter.drawLoose(
        places.map((place) => [...place, 0.35, 0.7, 0.95, 1]),
        1,
        matrix,
        { size: 8 * size, nearer: 3e-3 },
      );
    }
    if (selected) {
      const place = this.locate({ ...selected, shift: [0, 0, 0] }, poses);
      painter.drawLoose([[...place, 0.95, 0.75, 0.1, 1]], 1, matrix, { size: 10 * size, nearer: 4e-3 });
    }
    this.poses = poses;
    this.portsShown = ports;
  }

  /** Name, node and shift of the ports of a part: those of a body, the ends of a rod. */
  ports(part) {
    if (part.kind === "block") return Object.entries(part.ports).map(([name, shift]) => [name, 0, shift]);
    return [
      ["start", 0, [0, 0, 0]],
      ["end", part.nodes - 1, [0, 0, 0]],
    ];
  }

  floor() {
    const { up } = this.scene;
    return Math.min(dot(this.low, up), dot(this.high, up));
  }

  /** Numbers of the three directions of the room: two along the floor, and up. */
  directions() {
    const height = this.scene.up.findIndex((component) => component !== 0);
    return [(height + 1) % 3, (height + 2) % 3, height];
  }

  ticks(axis) {
    const found = [];
    for (
      let k = Math.ceil(this.low[axis] / this.step - 1e-9);
      k * this.step <= this.high[axis] * (1 + 1e-9) + 1e-12;
      k++
    )
      found.push(k * this.step);
    return found;
  }

  /** A point of the room, by its coordinates along the two directions of the floor and upward. */
  point(u, v, height) {
    const [a, b, c] = this.directions();
    const found = [0, 0, 0];
    [found[a], found[b], found[c]] = [u, v, height];
    return found;
  }

  grid() {
    const [a, b, c] = this.directions();
    const floor = this.floor() * this.scene.up[c];
    const found = [];
    for (const u of [this.low[a], ...this.ticks(a), this.high[a]])
      found.push(...segment(this.point(u, this.low[b], floor), this.point(u, this.high[b], floor), PALE));
    for (const v of [this.low[b], ...this.ticks(b), this.high[b]])
      found.push(...segment(this.point(this.low[a], v, floor), this.point(this.high[a], v, floor), PALE));
    const [u, v] = this.corner();
    found.push(...segment(this.point(u, v, this.low[c]), this.point(u, v, this.high[c]), PALE));
    return found;
  }

  /** The corner of the floor that is farthest to the left in the picture. */
  corner() {
    const [a, b] = this.directions();
    const floor = this.floor() * this.scene.up[this.directions()[2]];
    const corners = [this.low[a], this.high[a]].flatMap((u) => [this.low[b], this.high[b]].map((v) => [u, v]));
    const across = ([u, v]) => projected(this.matrix, this.point(u, v, floor))[0];
    return corners.reduce((best, corner) => (across(corner) < across(best) ? corner : best));
  }

  /** Numbers along two edges of the floor and upward, and what marks mean. */
  labels() {
    const pen = this.overlay.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.overlay.width, this.overlay.height);
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = "#5f5f5f";
    pen.textBaseline = "middle";
    const [a, b, c] = this.directions();
    const floor = this.floor() * this.scene.up[c];
    const eye = this.camera.eye;
    const middle = times(0.5, add(this.low, this.high));
    const near = (axis) => (eye[axis] > middle[axis] ? this.high[axis] : this.low[axis]);
    this.write(pen, a, (u) => this.point(u, near(b), floor));
    this.write(pen, b, (v) => this.point(near(a), v, floor));
    const [u, v] = this.corner();
    this.write(pen, c, (height) => this.point(u, v, height));
    if (this.portsShown) this.namePorts(pen);
  }

  /** Names at the ports, below each other where several are at one place. */
  namePorts(pen) {
    const taken = [];
    pen.fillStyle = "#1a1a1a";
    pen.textAlign = "left";
    this.scene.parts.forEach((part, i) => {
      for (const [name, node, shift] of this.ports(part)) {
        let [x, y] = this.onScreen(this.locate({ part: i, node, shift }, this.poses));
        while (taken.some(([u, v]) => Math.abs(u - x) < 60 && Math.abs(v - y) < 12)) y += 12;
        taken.push([x, y]);
        pen.fillText(`${part.name}.${name}`, x + 8, y - 8);
      }
    });
  }

  write(pen, axis, at) {
    const center = this.onScreen(times(0.5, add(this.low, this.high)));
    const ticks = this.ticks(axis);
    const ends = [this.low[axis], this.high[axis]].map((value) => this.onScreen(at(value)));
    const length = Math.hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
    const every = Math.max(1, Math.ceil((34 * ticks.length) / Math.max(1, length)));
    if (length < 12) return;
    const put = (value, text, away) => {
      const [x, y] = this.onScreen(at(value));
      const out = outward(ends, center, away);
      pen.textAlign = out[0] > 3 ? "left" : out[0] < -3 ? "right" : "center";
      pen.fillText(text, x + out[0], y + out[1]);
    };
    ticks.forEach((value, k) => {
      if (k % every === 0) put(value, shown(value, 6), 9);
    });
    put(0.5 * (this.low[axis] + this.high[axis]), `${AXIS_NAMES[axis]} [m]`, 34);
  }

  onScreen(point) {
    const [x, y] = projected(this.matrix, point);
    return [0.5 * (1 + x) * this.canvas.clientWidth, 0.5 * (1 - y) * this.canvas.clientHeight];
  }

  /** The node of a rod nearest to a place on the canvas, if one is near. */
  pick(x, y) {
    let best = { away: 18 };
    this.scene.parts.forEach((part, i) => {
      for (let node = 0; part.kind === "strand" && node < part.nodes; node++) {
        const [u, v] = this.onScreen(this.poses[i].place(node));
        const away = Math.hypot(u - x, v - y);
        if (away < best.away) best = { away, part: i, node };
      }
    });
    return best.part === undefined ? null : { part: best.part, node: best.node };
  }
}

const times4 = (s, q) => [s * q[0], s * q[1], s * q[2], s * q[3]];
const segment = (a, b, color) => [
  [...a, ...color],
  [...b, ...color],
];

/** A step of some pixels from a line on the screen, away from a point. */
function outward([a, b], center, away) {
  const along = [b[0] - a[0], b[1] - a[1]];
  const normal = times(away / (Math.hypot(...along) || 1), [along[1], -along[0], 0]);
  const sense =
    normal[0] * (0.5 * (a[0] + b[0]) - center[0]) + normal[1] * (0.5 * (a[1] + b[1]) - center[1]) < 0 ? -1 : 1;
  return [sense * normal[0], sense * normal[1]];
}
