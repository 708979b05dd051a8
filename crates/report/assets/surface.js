// A surface: points that move with the nodes of its faces.

class Surface {
  constructor(data) {
    this.nodes = data.nodes;
    this.plane = data.plane;
    this.arrows = indicesOf(data.arrows);
    this.blocks = data.blocks.map((block) => ({
      ...block,
      faces: indicesOf(block.faces),
      edges: indicesOf(block.edges),
      weights: Float32Array.from(block.weights),
      rows: block.weights.length / block.nodes,
    }));
    this.faces = 0;
    this.points = 0;
    for (const block of this.blocks) {
      block.firstFace = this.faces;
      block.firstPoint = this.points;
      block.count = block.faces.length / block.nodes;
      this.faces += block.count;
      this.points += block.count * block.rows;
    }
  }

  // Corners of all triangles, as numbers of points.
  triangles() {
    const out = [];
    for (const block of this.blocks) {
      for (let face = 0; face < block.count; face++) {
        const first = block.firstPoint + face * block.rows;
        for (const corner of block.triangles) out.push(first + corner);
      }
    }
    return new Uint32Array(out);
  }

  // Ends of the pieces of all element edges, as numbers of points.
  lines() {
    const out = [];
    for (const block of this.blocks) {
      for (const code of block.edges) {
        const first = block.firstPoint + Math.floor(code / 4) * block.rows;
        const side = block.sides[code % 4];
        for (let k = 1; k < side.length; k++) out.push(first + side[k - 1], first + side[k]);
      }
    }
    return new Uint32Array(out);
  }

  // Values at the points from values at the nodes, `n` for each.
  interpolate(atNodes, n) {
    const out = new Float32Array(this.points * n);
    let at = 0;
    for (const block of this.blocks) {
      for (let face = 0; face < block.count; face++) {
        for (let row = 0; row < block.rows; row++) {
          for (let a = 0; a < block.nodes; a++) {
            const weight = block.weights[row * block.nodes + a];
            if (weight === 0) continue;
            const node = block.faces[face * block.nodes + a] * n;
            for (let k = 0; k < n; k++) out[at + k] += weight * atNodes[node + k];
          }
          at += n;
        }
      }
    }
    return out;
  }

  // Values at the points from one value for each face.
  spread(byFace) {
    const out = new Float32Array(this.points);
    for (const block of this.blocks) {
      for (let face = 0; face < block.count; face++) {
        const first = block.firstPoint + face * block.rows;
        out.fill(byFace[block.firstFace + face], first, first + block.rows);
      }
    }
    return out;
  }

  // Centre and unit normal of a face.
  middle(face, x) {
    const block = this.blocks.find((one) => face < one.firstFace + one.count);
    const corners = [];
    for (let a = 0; a < block.corners; a++) {
      const node = block.faces[(face - block.firstFace) * block.nodes + a];
      corners.push(new THREE.Vector3(x[3 * node], x[3 * node + 1], x[3 * node + 2]));
    }
    const centre = corners.reduce((sum, corner) => sum.add(corner), new THREE.Vector3()).divideScalar(corners.length);
    const last = corners[corners.length - 1];
    const normal = new THREE.Vector3().crossVectors(
      corners[1].clone().sub(corners[0]),
      last.clone().sub(corners[0]),
    );
    return { centre, normal: normal.normalize() };
  }
}
