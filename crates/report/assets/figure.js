// What the view shows as a PNG for print: white ground, legend, bar of colours, scale of lengths.

class Figure {
  constructor(view) {
    [this.view, this.stage] = [view, view.stage];
    // Pixels per pixel of the page: some 300 to the inch in a column of a paper.
    this.fine = 3;
  }

  // Offers the file to the one who looks.
  save() {
    const link = document.createElement("a");
    link.href = this.draw().toDataURL("image/png");
    link.download = `${document.title.split(" – ")[0]}.png`.replace(/[\\/:*?"<>|]+/g, "_");
    link.click();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.stage.canvas.parentElement;
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [width * this.fine, height * this.fine];
    const context = canvas.getContext("2d");
    context.fillStyle = "#ffffff";
    context.fillRect(0, 0, canvas.width, canvas.height);
    for (const ink of [this.view.body.ink, this.view.arrows?.material]) ink?.color.set("#262b33");
    this.stage.renderer.setPixelRatio(this.fine);
    this.stage.renderer.setSize(width, height, false);
    this.stage.renderer.render(this.stage.scene, this.stage.camera);
    context.drawImage(this.stage.canvas, 0, 0, canvas.width, canvas.height);
    this.view.dress();
    this.stage.resize();
    context.scale(this.fine, this.fine);
    context.fillStyle = context.strokeStyle = "#262b33";
    context.textBaseline = "middle";
    this.legend(context);
    this.bar(context, width);
    this.ruler(context, width, height);
    context.textAlign = "left";
    const arrows = this.view.part("arrow-scale");
    if (!arrows.hidden) context.fillText(arrows.textContent, 14, height - 16);
    return canvas;
  }

  legend(context) {
    context.font = "13.5px sans-serif";
    let x = 14;
    for (const entry of this.view.part("legend").children) {
      const mark = entry.querySelector("i");
      if (mark.className !== "mapped") {
        context.fillStyle = mark.style.background;
        context.fillRect(x, 14, 13, 13);
      } else {
        this.view.bar.swatch.forEach(([r, g, b], k) => {
          context.fillStyle = `rgb(${[r, g, b].join()})`;
          context.fillRect(x + k, 14, 1, 13);
        });
      }
      context.fillStyle = "#262b33";
      context.fillText(entry.textContent, x + 19, 21);
      x += 19 + context.measureText(entry.textContent).width + 16;
    }
  }

  bar(context, width) {
    if (this.view.part("bar").hidden) return;
    context.font = "12.5px sans-serif";
    context.textAlign = "right";
    context.fillText(this.view.part("bar-name").textContent, width - 14, 20);
    context.drawImage(this.view.part("bar-colours"), width - 32, 34, 18, 162);
    context.strokeRect(width - 32, 34, 18, 162);
    const ticks = [...this.view.part("bar-ticks").children];
    ticks.forEach((tick, k) => {
      const share = ticks.length > 1 ? k / (ticks.length - 1) : 0;
      context.fillText(tick.textContent, width - 38, 38 + 154 * share);
    });
  }

  // 1, 2 or 5 times a power of ten, at most a fifth of the width.
  ruler(context, width, height) {
    const camera = this.stage.camera;
    const perLength = (width * camera.zoom) / (camera.right - camera.left);
    const most = (0.2 * width) / perLength;
    const power = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map((factor) => factor * power).find((one) => one <= most);
    if (!length) return;
    const [right, y] = [width - 14, height - 16];
    const left = right - length * perLength;
    context.beginPath();
    for (const [x, from, to] of [[left, y - 4, y + 4], [right, y - 4, y + 4]]) {
      context.moveTo(x, from);
      context.lineTo(x, to);
    }
    context.moveTo(left, y);
    context.lineTo(right, y);
    context.stroke();
    context.textAlign = "center";
    context.fillText(`${short(length)} ${this.view.data.length}`, 0.5 * (left + right), y - 12);
  }
}
