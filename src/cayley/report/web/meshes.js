// Meshes: the surface of a rod, a box, a ball, a square and the skin of an obstacle.

/** The surface of a rod, vertices by node and face around the section, and the two caps. */
function tubeMesh({ nodes, outlines, points, normals, caps }) {
  const vertices = [];
  const indices = [];
  const own = (list, node) => list[list.length > 1 ? node : 0];
  for (let node = 0; node < nodes; node++) {
    const [outline, normal] = [own(outlines, node), own(normals, node)];
    points.forEach((pair, face) =>
      pair.forEach((k, side) => vertices.push(node, ...outline[k], ...normal[face][side], 0)),
    );
  }
  const around = 2 * points.length;
  for (let node = 0; node + 1 < nodes; node++) {
    for (let face = 0; face < points.length; face++) {
      const a = node * around + 2 * face;
      const b = a + around;
      indices.push(a, a + 1, b + 1, a, b + 1, b);
    }
  }
  for (const [node, sense] of [
    [0, -1],
    [nodes - 1, 1],
  ]) {
    const first = vertices.length / 6;
    for (const point of own(outlines, node)) vertices.push(node, ...point, 0, 0, sense);
    for (const corners of caps) indices.push(...corners.map((k) => first + k));
  }
  return {
    layout: [
      ["node", 1],
      ["point", 2],
      ["normal", 3],
    ],
    vertices,
    indices,
  };
}

const SOLID_LAYOUT = [
  ["point", 3],
  ["normal", 3],
];

/** A box with sides of length 1. */
function boxMesh() {
  const vertices = [];
  const indices = [];
  for (let axis = 0; axis < 3; axis++) {
    for (const sense of [-0.5, 0.5]) {
      const first = vertices.length / 6;
      for (const [u, v] of [
        [-0.5, -0.5],
        [0.5, -0.5],
        [0.5, 0.5],
        [-0.5, 0.5],
      ]) {
        const point = [0, 0, 0];
        const normal = [0, 0, 0];
        [point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]] = [sense, u, v];
        normal[axis] = 2 * sense;
        vertices.push(...point, ...normal);
      }
      indices.push(first, first + 1, first + 2, first, first + 2, first + 3);
    }
  }
  return { layout: SOLID_LAYOUT, vertices, indices };
}

/** A ball with diameter 1. */
function ballMesh() {
  const [rings, around] = [12, 24];
  const vertices = [];
  const indices = [];
  for (let i = 0; i <= rings; i++) {
    const polar = (Math.PI * i) / rings;
    for (let k = 0; k <= around; k++) {
      const angle = (2 * Math.PI * k) / around;
      const normal = [Math.sin(polar) * Math.cos(angle), Math.sin(polar) * Math.sin(angle), Math.cos(polar)];
      vertices.push(...times(0.5, normal), ...normal);
      if (i < rings && k < around) {
        const a = i * (around + 1) + k;
        const b = a + around + 1;
        indices.push(a, b, b + 1, a, b + 1, a + 1);
      }
    }
  }
  return { layout: SOLID_LAYOUT, vertices, indices };
}

/** A square with corners at -1 and 1, and its normal along the third axis. */
function squareMesh() {
  const corners = [-1, 1].flatMap((x) => [-1, 1].map((y) => [x, y, 0]));
  return {
    layout: SOLID_LAYOUT,
    vertices: corners.flatMap((corner) => [...corner, 0, 0, 1]),
    indices: [0, 2, 3, 0, 3, 1],
  };
}

/** The skin of an obstacle: normals are smooth where triangles meet at less than forty degrees, else edges are sharp. */
function skinMesh({ vertices, triangles }) {
  const corner = (k) => vertices.slice(3 * k, 3 * k + 3);
  const normals = [];
  const around = new Map(); // numbers of the triangles at each vertex
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = triangles.slice(k, k + 3).map(corner);
    normals.push(unit(cross(minus(b, a), minus(c, a))));
    for (const own of triangles.slice(k, k + 3)) around.set(own, [...(around.get(own) || []), k / 3]);
  }
  const sharp = Math.cos((40 * Math.PI) / 180);
  const found = triangles.flatMap((own, k) => {
    const normal = normals[Math.floor(k / 3)];
    const near = around.get(own).filter((other) => dot(normals[other], normal) > sharp);
    return [...corner(own), ...unit(near.reduce((sum, other) => add(sum, normals[other]), [0, 0, 0]))];
  });
  return { layout: SOLID_LAYOUT, vertices: found, indices: triangles.map((_, k) => k) };
}
