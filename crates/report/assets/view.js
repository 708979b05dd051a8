// The three-dimensional view: what is chosen in its controls is what is shown.

class View {
  constructor(data, fields) {
    [this.data, this.fields] = [data, fields];
    this.surfaces = data.surfaces.map((surface) => new Surface(surface));
    this.part = (id) => document.getElementById(id);
    this.stage = new Stage(this.part("canvas"));
    this.bar = new Bar(this);
    this.cut = new Cut(this);
    this.figure = new Figure(this);
    this.listen();
    this.part("member").replaceChildren(...data.views.map((view, k) => option(k, view.name || "the body")));
    this.part("member-label").hidden = data.views.length < 2;
    this.choose(0);
  }

  listen() {
    this.part("member").addEventListener("change", (event) => this.choose(Number(event.target.value)));
    this.part("field").addEventListener("change", () => this.show());
    this.part("arrows").addEventListener("change", () => this.show());
    for (const id of ["show-start", "show-target", "show-lines"]) {
      this.part(id).addEventListener("change", () => this.show());
    }
    this.part("slider").addEventListener("input", () => {
      this.stop();
      this.show();
    });
    this.part("play").addEventListener("click", () => (this.timer ? this.stop() : this.play()));
    this.part("home").addEventListener("click", () => this.stage.look(this.stage.home.box, this.stage.home.plane));
    this.part("save").addEventListener("click", () => this.figure.save());
    // The slider's keys work on the drawing too; the arrow keys with shift turn the body.
    this.part("canvas").addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1, PageDown: 5, PageUp: -5, Home: -1e9, End: 1e9 }[event.key];
      if (step === undefined || event.shiftKey) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      this.go(Number(this.part("slider").value) + step);
    }, true);
  }

  // Shows another state's frames, the last first.
  choose(index) {
    this.stop();
    const view = (this.view = this.data.views[index]);
    for (const old of [this.body, this.start, this.moved, ...(this.targets || [])].filter(Boolean)) {
      this.stage.scene.remove(old.group);
      old.free();
    }
    this.body = new Body(this.surfaces[view.surface]);
    this.body.ink.color.set(colourOf("--edge"));
    this.start = new Body(this.surfaces[view.surface], START_COLOUR);
    this.start.move(values(view.frames[0].x));
    this.targets = view.targets.map((target) => {
      const body = new Body(this.surfaces[target.surface], colourOfTarget(target));
      body.move(values(target.x));
      return body;
    });
    // Obstacles that move have a place in every frame.
    const { obstacles } = view.frames.find((frame) => frame.obstacles) || {};
    this.moved = obstacles ? new Body(this.surfaces[obstacles.surface], OBSTACLE_COLOUR) : null;
    for (const body of [this.body, this.start, this.moved, ...this.targets].filter(Boolean)) this.stage.scene.add(body.group);
    const last = view.frames.length - 1;
    const slider = this.part("slider");
    [slider.max, slider.value] = [last, this.opening(view.frames)];
    this.part("slider-row").hidden = last < 1;
    this.part("show-start").parentElement.hidden = last < 1;
    this.part("first-name").textContent = view.frames[0].label;
    const isThere = (label) => (label === "obstacle" && this.moved) || view.targets.some((target) => target.label === label);
    this.behind = ["target", "obstacle"].filter(isThere);
    this.part("target-name").textContent = this.behind.join(", ");
    this.part("target-label").hidden = this.behind.length === 0;
    this.offerFields();
    const box = new THREE.Box3();
    // A wall may be far larger than the body.
    for (const { x } of [...view.frames, ...view.targets.filter((target) => target.label !== "obstacle")]) {
      box.expandByPoint(new THREE.Vector3(...x.low)).expandByPoint(new THREE.Vector3(...x.high));
    }
    this.cut.offer(box, this.surfaces[view.surface].plane);
    this.stage.look(box, this.surfaces[view.surface].plane);
    this.show();
  }

  // The frame to begin with. The last: the optimum, the end of a path; of a state with its modes the state; of a motion its most deformed instant.
  opening(frames) {
    if (frames.some((frame) => frame.fields.mode)) return 0;
    const last = frames.length - 1;
    const isInstant = ({ label }) => label.startsWith("t = ");
    if (!isInstant(frames[last])) return last;
    // Kept iterations stand before the instants.
    const rest = values(frames.find(isInstant).x);
    const distance = ({ x }) => values(x).reduce((most, at, k) => Math.max(most, Math.abs(at - rest[k])), 0);
    const farthest = frames.map((frame) => (isInstant(frame) ? distance(frame) : -1));
    // An end that is as far is as good.
    return farthest.lastIndexOf(farthest.reduce((most, one) => Math.max(most, one), 0));
  }

  offerFields() {
    const all = (group) => [...new Set(this.view.frames.flatMap((frame) => Object.keys(frame[group])))];
    const names = (group) => all(group).filter((name) => name !== "mode");
    const rank = (name) => (this.fields[name]?.control ? 0 : name === "deviation_norm" ? 1
      : name === "|u|" ? 2 : this.fields[name] ? 3 : 4);
    const offer = (select, list, none) => {
      const kept = select.value;
      list.sort((a, b) => rank(a) - rank(b));
      const options = list.map((name) => option(name, this.label(name)));
      select.replaceChildren(...(none ? [option("", none), ...options] : [...options, option("", "none")]));
      if (list.includes(kept)) select.value = kept;
    };
    const vectors = names("vectors");
    offer(this.part("field"), names("fields"));
    offer(this.part("arrows"), vectors, "none");
    this.part("arrows-label").hidden = vectors.length === 0;
    // A control that is a field of vectors is what the case is about.
    const control = vectors.find((name) => this.fields[name]?.control) || vectors.find((name) => name === "B_r");
    if (control && !this.part("arrows").value) this.part("arrows").value = control;
  }

  label(name) {
    const known = this.fields[name];
    if (known) return known.label;
    if (name.startsWith("gradient_")) return `gradient of ${name.slice(9)}`;
    if (name.startsWith("direction_")) return `direction of ${name.slice(10)}`;
    return name.replaceAll("_", " ");
  }

  range(name) {
    const arrays = this.view.frames.map((frame) => frame.fields[name]).filter(Boolean);
    return [Math.min(...arrays.map((a) => a.low[0])), Math.max(...arrays.map((a) => a.high[0]))];
  }

  // Draws what is chosen.
  show() {
    const slider = this.part("slider");
    const frame = this.view.frames[Number(slider.value)];
    this.part("frame").textContent = frame.label;
    slider.setAttribute("aria-valuetext", frame.label);
    const x = values(frame.x);
    this.body.move(x);
    // A frame with one field of its own, a mode, is coloured by that.
    const own = Object.keys(frame.fields);
    const chosen = this.part("field").value;
    const name = chosen && !frame.fields[chosen] && own.length === 1 ? own[0] : chosen;
    const map = name ? new ColourMap(...this.range(name)) : null;
    const field = name ? frame.fields[name] : undefined;
    this.body.paint(field, map);
    this.bar.show(name, map, field !== undefined);
    this.showArrows(frame, x);
    const planes = this.cut.planes();
    for (const part of [this.body.material, this.body.ink, this.arrows?.material]) {
      if (part) part.clippingPlanes = planes;
    }
    this.start.group.visible = this.part("show-start").checked && Number(slider.value) > 0;
    const targets = this.part("show-target").checked;
    this.targets.forEach((target) => (target.group.visible = targets));
    if (this.moved) {
      this.moved.group.visible = targets && frame.obstacles !== undefined;
      if (frame.obstacles) this.moved.move(values(frame.obstacles.x));
    }
    const lines = this.part("show-lines").checked;
    [this.body, this.start, this.moved, ...this.targets].filter(Boolean).forEach((body) => (body.lines.visible = lines));
    this.showLegend(frame, targets);
    this.stage.draw();
  }

  showArrows(frame, x) {
    if (this.arrows) {
      this.stage.scene.remove(this.arrows.group);
      this.arrows.free();
      this.arrows = null;
    }
    const name = this.part("arrows").value;
    const vectors = name ? frame.vectors[name] : undefined;
    const scale = this.part("arrow-scale");
    scale.hidden = !name;
    if (!name) return;
    const unit = this.fields[name]?.unit || "";
    if (!vectors) {
      scale.textContent = `${this.label(name)}: not kept for this frame`;
      return;
    }
    const own = values(vectors);
    let most = 0;
    for (let k = 0; k < own.length; k += 3) most = Math.max(most, Math.hypot(own[k], own[k + 1], own[k + 2]));
    const surface = this.surfaces[this.view.surface];
    const length = Math.min(0.22, 1.5 / Math.sqrt(surface.arrows.length)) * this.stage.radius;
    this.arrows = new Arrows(surface, length, most);
    this.arrows.material.color.set(colourOf("--arrow"));
    this.arrows.show(x, own);
    this.stage.scene.add(this.arrows.group);
    scale.textContent = `${this.label(name)}: longest arrow ${short(most)} ${unit}`.trim();
  }

  showLegend(frame, targets) {
    const entries = [["body", frame.label]];
    if (this.start.group.visible) entries.push([START_COLOUR, this.view.frames[0].label]);
    for (const label of targets ? this.behind : []) {
      entries.push([colourOfTarget({ label }), label === "obstacle" ? this.view.obstacles : label]);
    }
    this.part("legend").replaceChildren(...entries.map(([colour, label]) => {
      const entry = document.createElement("span");
      const mark = document.createElement("i");
      if (colour === "body") mark.className = "mapped";
      else mark.style.background = colour;
      entry.append(mark, label);
      return entry;
    }));
  }

  go(index) {
    const slider = this.part("slider");
    slider.value = Math.min(Number(slider.max), Math.max(0, index));
    this.stop();
    this.show();
  }

  play() {
    const slider = this.part("slider");
    if (Number(slider.value) === Number(slider.max)) slider.value = 0;
    this.timer = setInterval(() => {
      slider.value = Number(slider.value) + 1;
      this.show();
      if (Number(slider.value) >= Number(slider.max)) this.stop();
    }, Math.max(60, Math.min(400, 4000 / Number(slider.max))));
    this.part("play").textContent = "Pause";
    this.part("play").setAttribute("aria-label", "Pause");
    this.show();
  }

  stop() {
    clearInterval(this.timer);
    this.timer = null;
    this.part("play").textContent = "Play";
    this.part("play").setAttribute("aria-label", "Play");
  }

  // Colours of the page have changed.
  dress() {
    this.body.ink.color.set(colourOf("--edge"));
    this.show();
  }
}

function option(value, text) {
  const out = document.createElement("option");
  [out.value, out.textContent] = [value, text];
  return out;
}

const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
