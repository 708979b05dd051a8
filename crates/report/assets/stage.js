// The stage: camera, light, drawing on demand.

class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setClearAlpha(0);
    this.renderer.localClippingEnabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -100, 100);
    this.camera.up.set(0, 0, 1);
    // From the camera's side, so that no side of a body is dark.
    const lamp = new THREE.DirectionalLight(0xffffff, 2.2);
    lamp.position.set(0.4, 0.8, 1);
    this.camera.add(lamp);
    this.scene.add(this.camera, new THREE.HemisphereLight(0xffffff, 0xb8bcc4, 1.5));
    this.orbit = new THREE.OrbitControls(this.camera, canvas);
    this.orbit.enableDamping = false;
    this.orbit.addEventListener("change", () => this.draw());
    this.orbit.listenToKeyEvents(canvas);
    this.waiting = false;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  // Looks at a box from a side that suits bodies bending in a vertical plane; plane bodies from above.
  look(box, plane) {
    const centre = box.getCenter(new THREE.Vector3());
    const radius = Math.max(0.5 * box.getSize(new THREE.Vector3()).length(), 1e-12);
    this.home = { box, plane };
    this.orbit.target.copy(centre);
    const size = box.getSize(new THREE.Vector3());
    // Across the thinner of the two horizontal directions.
    const across = size.y <= size.x ? new THREE.Vector3(-0.35, -1, 0.4) : new THREE.Vector3(1, -0.35, 0.4);
    const from = plane ? new THREE.Vector3(0, -1e-4, 1) : across;
    this.orbit.enableRotate = !plane;
    this.camera.position.copy(centre).addScaledVector(from.normalize(), 4 * radius);
    this.camera.near = -20 * radius;
    this.camera.far = 40 * radius;
    this.camera.zoom = 1;
    this.radius = radius;
    this.camera.lookAt(centre);
    this.camera.updateMatrixWorld();
    // Half the sizes that the box takes on the screen.
    const inverse = this.camera.matrixWorldInverse;
    this.half = new THREE.Vector3();
    for (let k = 0; k < 8; k++) {
      const corner = new THREE.Vector3(
        k & 1 ? box.max.x : box.min.x,
        k & 2 ? box.max.y : box.min.y,
        k & 4 ? box.max.z : box.min.z,
      );
      const seen = corner.applyMatrix4(inverse);
      this.half.max(new THREE.Vector3(Math.abs(seen.x), Math.abs(seen.y), 0));
    }
    this.resize();
    this.orbit.update();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height || !this.half) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    // Room for the legend and the bar of colours.
    const scale = Math.max(this.half.x / (0.5 * width * 0.8), this.half.y / (0.5 * height * 0.8));
    Object.assign(this.camera, {
      left: -0.5 * width * scale,
      right: 0.5 * width * scale,
      top: 0.5 * height * scale,
      bottom: -0.5 * height * scale,
    });
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
    });
  }
}
