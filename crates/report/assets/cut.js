// A plane that cuts the body open, across an axis.

class Cut {
  constructor(view) {
    this.view = view;
    // What three.js asks of a plane: what lies at n . x + constant < 0 is not drawn.
    this.plane = { normal: new THREE.Vector3(1, 0, 0), constant: 0 };
    for (const id of ["cut", "cut-at"]) view.part(id).addEventListener("input", () => view.show());
  }

  // Begins with a body in this box.
  offer(box, plane) {
    this.box = box;
    this.view.part("cut-label").hidden = plane;
    if (plane) this.view.part("cut").value = "";
  }

  // The planes to cut by: none or one.
  planes() {
    const chosen = this.view.part("cut").value;
    const slider = this.view.part("cut-at");
    slider.hidden = !chosen;
    if (!chosen) return [];
    const [axis, sign] = [chosen[0], chosen[1] === "<" ? -1 : 1];
    const at = this.box.min[axis] + Number(slider.value) * (this.box.max[axis] - this.box.min[axis]);
    this.plane.normal.set(0, 0, 0);
    this.plane.normal[axis] = sign;
    this.plane.constant = -sign * at;
    slider.setAttribute("aria-valuetext", `${chosen} ${short(at)} ${this.view.data.length}`);
    slider.title = slider.getAttribute("aria-valuetext");
    return [this.plane];
  }
}
