// A body on the stage: its surface with colours, and the edges of its elements.

class Body {
  // `glass`: translucent in one colour; else opaque, coloured by a field.
  constructor(surface, glass) {
    this.surface = surface;
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setIndex(new THREE.BufferAttribute(surface.triangles(), 1));
    this.position = new THREE.BufferAttribute(new Float32Array(3 * surface.points), 3);
    this.geometry.setAttribute("position", this.position);
    const Material = surface.plane ? THREE.MeshBasicMaterial : THREE.MeshLambertMaterial;
    this.material = new Material({
      side: THREE.DoubleSide,
      // Behind its own edges; glass behind the body where both lie in one surface.
      polygonOffset: true,
      polygonOffsetFactor: glass === undefined ? 1 : 2,
      polygonOffsetUnits: glass === undefined ? 1 : 40,
    });
    if (glass === undefined) {
      this.colour = new THREE.BufferAttribute(new Float32Array(3 * surface.points), 3);
      this.geometry.setAttribute("color", this.colour);
      this.material.vertexColors = true;
    } else {
      this.material.color.set(glass);
      Object.assign(this.material, { transparent: true, opacity: 0.28, depthWrite: false });
    }
    this.mesh = new THREE.Mesh(this.geometry, this.material);
    this.edges = new THREE.BufferGeometry();
    this.edges.setIndex(new THREE.BufferAttribute(surface.lines(), 1));
    this.edges.setAttribute("position", this.position);
    this.ink = new THREE.LineBasicMaterial({ transparent: true, opacity: glass === undefined ? 0.35 : 0.3 });
    if (glass !== undefined) this.ink.color.set(glass);
    this.lines = new THREE.LineSegments(this.edges, this.ink);
    this.group = new THREE.Group();
    this.group.add(this.mesh, this.lines);
    this.mesh.frustumCulled = this.lines.frustumCulled = false;
  }

  // Moves the points with the nodes.
  move(x) {
    this.position.array.set(this.surface.interpolate(x, 3));
    this.position.needsUpdate = true;
    if (!this.surface.plane) this.geometry.computeVertexNormals();
  }

  // Colours by a field on nodes or faces; grey without one.
  paint(field, map) {
    const grey = [0.42, 0.45, 0.5];
    if (!field) {
      for (let i = 0; i < this.surface.points; i++) this.colour.array.set(grey, 3 * i);
    } else {
      const own = values(field);
      const at = field.on === "nodes" ? this.surface.interpolate(own, 1) : this.surface.spread(own);
      let last = NaN;
      let colour = grey;
      for (let i = 0; i < at.length; i++) {
        if (at[i] !== last) colour = map.linear((last = at[i]));
        this.colour.array.set(colour, 3 * i);
      }
    }
    this.colour.needsUpdate = true;
  }

  free() {
    [this.geometry, this.edges, this.material, this.ink].forEach((part) => part.dispose());
  }
}
