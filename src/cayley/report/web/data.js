// Scenes: what does not change, from JSON, and channels of frames, from compressed chunks (see report/pack.py).

const SIZES = { i2: 2, f4: 4, f8: 8 };

/** Numbers of every frame, one row each; it grows as chunks arrive. */
class Channel {
  constructor(kind, width) {
    this.width = width;
    this.frames = 0;
    this.array = kind === "f8" ? Float64Array : Float32Array;
    this.data = new this.array(0);
  }

  append(values, frames) {
    const needed = (this.frames + frames) * this.width;
    if (needed > this.data.length) {
      const larger = new this.array(Math.max(needed, this.frames ? 2 * this.data.length : 0));
      larger.set(this.data.subarray(0, this.frames * this.width));
      this.data = larger;
    }
    this.data.set(values, this.frames * this.width);
    this.frames += frames;
  }

  row(k) {
    return this.data.subarray(k * this.width, (k + 1) * this.width);
  }

  column(i) {
    const found = new Float64Array(this.frames);
    for (let k = 0; k < this.frames; k++) found[k] = this.data[k * this.width + i];
    return found;
  }
}

class Scene {
  constructor(about) {
    Object.assign(this, about);
    this.time = new Channel("f8", 1);
    for (const part of this.parts) {
      part.position = new Channel("f4", 3 * part.nodes);
      part.rotation = new Channel("i2", 4 * part.nodes);
      for (const one of part.quantities) one.channel = new Channel("i2", part.nodes * (one.axes ? 3 : 1));
    }
    this.parts.forEach((part, i) => (part.reach = part.kind === "block" ? this.reach(part, i) : 0));
    for (const graph of this.graphs) graph.channel = new Channel("f8", graph.names.length);
    this.low = [Infinity, Infinity, Infinity];
    this.high = [-Infinity, -Infinity, -Infinity];
    this.ranges = new Map(); // largest absolute value of each color that was asked for, and up to which frame
  }

  /** How far a body reaches from its mass center. */
  reach(part, i) {
    if (!part.shaped) return 0.5 * Math.hypot(...(part.sides || [0]));
    let found = 0;
    for (const { vertices } of this.solids.filter((solid) => solid.kind === "skin" && solid.part === i))
      for (let k = 0; k < vertices.length; k += 3)
        found = Math.max(found, Math.hypot(vertices[k], vertices[k + 1], vertices[k + 2]));
    return found;
  }

  get frames() {
    return this.time.frames;
  }

  /** All channels, in the order of report/pack.py. */
  channels() {
    const parts = this.parts.map((part) => [
      part.position,
      part.rotation,
      ...part.quantities.map((one) => one.channel),
    ]);
    return [this.time, ...parts.flat(), ...this.graphs.map((graph) => graph.channel)];
  }

  /** Take the frames of a chunk. */
  append(bytes) {
    const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
    const first = this.frames;
    let at = 4 + length;
    for (const [k, channel] of this.channels().entries()) {
      const [kind, scale] = header.channels[k];
      const count = header.frames * channel.width;
      channel.append(decoded(bytes.subarray(at, at + count * SIZES[kind]), kind, scale, channel.width), header.frames);
      at += Math.ceil((count * SIZES[kind]) / 8) * 8;
    }
    this.widen(first);
  }

  /** Make the box around everything large enough for the frames from `first`. */
  widen(first) {
    for (const part of this.parts) {
      const margin = part.reach;
      const data = part.position.data.subarray(first * part.position.width, this.frames * part.position.width);
      for (let i = 0; i < data.length; i++) {
        const axis = i % 3;
        if (data[i] - margin < this.low[axis]) this.low[axis] = data[i] - margin;
        if (data[i] + margin > this.high[axis]) this.high[axis] = data[i] + margin;
      }
    }
  }

  /** Largest absolute value of a color over all frames of all parts, or of one of them. */
  largest(color, only = null) {
    const key = `${color.key}/${color.component}/${only ? this.parts.indexOf(only) : ""}`;
    const [known, from] = this.ranges.get(key) || [0, 0];
    let found = known;
    for (const part of only ? [only] : this.parts) {
      const one = part.quantities.find((other) => other.key === color.key);
      if (!one) continue;
      for (let k = from; k < this.frames; k++) {
        for (const value of colored(one, one.channel.row(k), color.component)) found = Math.max(found, Math.abs(value));
      }
    }
    this.ranges.set(key, [found, this.frames]);
    return found;
  }

  /** Frame, with fraction, of a time. */
  frameAt(time) {
    const times = this.time.data;
    let [low, high] = [0, this.frames - 1];
    if (high <= 0 || time <= times[0]) return 0;
    if (time >= times[high]) return high;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle;
    }
    return low + (time - times[low]) / (times[high] - times[low]);
  }
}

/** Values that color the nodes: numbers themselves, a component of vectors, or their length (component -1). */
function colored(quantity, row, component) {
  if (!quantity.axes) return row;
  const found = new Float32Array(row.length / 3);
  for (let k = 0; k < found.length; k++) {
    found[k] = component < 0 ? Math.hypot(row[3 * k], row[3 * k + 1], row[3 * k + 2]) : row[3 * k + component];
  }
  return found;
}

/** Numbers of a channel from their bytes. */
function decoded(bytes, kind, scale, width) {
  const size = SIZES[kind];
  const count = bytes.length / size;
  const joined = new Uint8Array(bytes.length);
  for (let plane = 0; plane < size; plane++) {
    for (let i = 0; i < count; i++) joined[i * size + plane] = bytes[plane * count + i];
  }
  if (kind === "f8") return new Float64Array(joined.buffer);
  if (kind === "f4") return new Float32Array(joined.buffer);
  const whole = new Int16Array(joined.buffer); // an overflow wraps around, as it did when the differences were taken
  for (let i = width; i < count; i++) whole[i] += whole[i - width];
  return Float32Array.from(whole, (value) => scale * value);
}

async function unzipped(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Bytes of a text in base64. */
function fromBase64(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}
