// A field of vectors as arrows on the surface.

class Arrows {
  // `length`: of the longest arrow, whose vector has the length `most`.
  constructor(surface, length, most) {
    this.surface = surface;
    [this.length, this.most] = [length, most];
    const count = surface.arrows.length;
    const shaft = new THREE.CylinderGeometry(0.035, 0.035, 0.7, 6).translate(0, -0.15, 0);
    const head = new THREE.ConeGeometry(0.12, 0.32, 8).translate(0, 0.34, 0);
    this.material = new THREE.MeshBasicMaterial();
    this.parts = [shaft, head].map((geometry) => new THREE.InstancedMesh(geometry, this.material, count));
    this.parts.forEach((part) => (part.frustumCulled = false));
    this.group = new THREE.Group();
    this.group.add(...this.parts);
  }

  // Puts the arrows in front of the faces of a body at these nodes.
  show(x, vectors) {
    const up = new THREE.Vector3(0, 1, 0);
    const v = new THREE.Vector3();
    this.surface.arrows.forEach((face, k) => {
      const { centre, normal } = this.surface.middle(face, x);
      v.set(vectors[3 * k], vectors[3 * k + 1], vectors[3 * k + 2]);
      const share = this.most > 0 ? v.length() / this.most : 0;
      const size = Number.isFinite(share) && share > 1e-6 ? share * this.length : 0;
      const turn = new THREE.Quaternion().setFromUnitVectors(up, size > 0 ? v.clone().normalize() : up);
      const lift = this.surface.plane ? 0.02 : 0.12;
      const at = centre.addScaledVector(normal, lift * this.length);
      // Arrows that point into the body begin at its surface.
      const into = size > 0 ? Math.abs(v.normalize().dot(normal)) : 0;
      at.addScaledVector(normal, this.surface.plane ? 0 : 0.5 * into * size);
      const matrix = new THREE.Matrix4().compose(at, turn, new THREE.Vector3(size, size, size));
      this.parts.forEach((part) => part.setMatrixAt(k, matrix));
    });
    this.parts.forEach((part) => (part.instanceMatrix.needsUpdate = true));
  }

  free() {
    this.parts.forEach((part) => part.geometry.dispose());
    this.parts.forEach((part) => part.dispose());
    this.material.dispose();
  }
}
