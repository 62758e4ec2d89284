// Obstacles of a scene: skins, in space or carried by bodies, and planes, drawn as far as the room.

const THROUGH = 0.3; // how much is seen of what one sees through
const BELOW = 0.05; // of the size of what moves: a floor that much above its lowest point is still below it

class Obstacles {
  constructor(scene, painter) {
    this.scene = scene;
    this.painter = painter;
    this.meshes = scene.solids.map((solid) =>
      solid.kind === "skin" ? painter.mesh(painter.solid, skinMesh(solid)) : painter.square,
    );
  }

  /** The box around what moves and what is near it, and the coordinate of a floor along the upward axis, or null. */
  room() {
    const { low, high, up, solids } = this.scene;
    const size = Math.max(...minus(high, low)) || Infinity;
    const k = up.findIndex((component) => component !== 0);
    const bottom = Math.min(low[k] * up[k], high[k] * up[k]);
    const heights = solids
      .filter((solid) => solid.kind === "flat" && solid.part === null && dot(solid.normal, up) > 1 - 1e-9)
      .map((solid) => solid.point[k] * up[k])
      .filter((height) => height >= bottom - 2 * size && height <= bottom + BELOW * size);
    const [least, most] = [[...low], [...high]];
    for (const { vertices } of solids.filter((solid) => solid.kind === "skin" && solid.part === null))
      for (let i = 0; i < vertices.length; i++) {
        const value = Math.min(high[i % 3] + size, Math.max(low[i % 3] - size, vertices[i]));
        least[i % 3] = Math.min(least[i % 3], value);
        most[i % 3] = Math.max(most[i % 3], value);
      }
    return { low: least, high: most, floor: heights.length ? Math.max(...heights) * up[k] : null };
  }

  /** Draw skins, and keep what one sees through for later; colors are those of the parts. */
  draw(poses, colors, common, lines, { low, high }) {
    this.later = [];
    this.scene.solids.forEach((solid, i) => {
      const pose = solid.part === null ? null : poses[solid.part];
      const [place, q] = pose ? [pose.place(0), pose.node(0)] : [[0, 0, 0], [1, 0, 0, 0]];
      const own = pose ? colors.get(solid.part) : STONE;
      if (solid.kind === "flat") this.later.push(this.square(solid, place, q, own, low, high, lines));
      else {
        const values = { place, rotation: q, sides: [1, 1, 1], own };
        if (solid.sheer) this.later.push([this.meshes[i], values]);
        else this.painter.drawSolid(this.meshes[i], { ...common, ...values });
      }
    });
  }

  drawSheer(common) {
    for (const [mesh, values] of this.later) this.painter.drawSolid(mesh, { ...common, ...values, alpha: THROUGH });
  }

  /** The square of a plane, and its border among the lines. */
  square(solid, place, q, own, low, high, lines) {
    const point = add(place, turned(q, solid.point));
    const rotation = product(q, uprightTo(solid.normal));
    const [right, up] = [turned(rotation, [1, 0, 0]), turned(rotation, [0, 1, 0])];
    const gap = minus(times(0.5, add(low, high)), point);
    const foot = add(point, add(times(dot(gap, right), right), times(dot(gap, up), up)));
    const half = times(0.5, minus(high, low));
    const sides = [right, up].map((along) => along.reduce((sum, value, k) => sum + Math.abs(value) * half[k], 0));
    const corners = [
      [-1, -1],
      [1, -1],
      [1, 1],
      [-1, 1],
    ].map(([u, v]) => add(foot, add(times(u * sides[0], right), times(v * sides[1], up))));
    corners.forEach((corner, k) => lines.push(...segment(corner, corners[(k + 1) % 4], PALE)));
    return [this.painter.square, { place: foot, rotation, sides: [...sides, 1], own }];
  }
}

/** The smallest rotation that brings the third axis onto a unit vector, as a quaternion. */
function uprightTo([x, y, z]) {
  const length = Math.hypot(1 + z, x, y);
  return length > 1e-9 ? [(1 + z) / length, -y / length, x / length, 0] : [0, 1, 0, 0];
}
