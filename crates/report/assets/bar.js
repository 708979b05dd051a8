// The bar of colours: name, unit, ticks.

class Bar {
  constructor(view) {
    this.view = view;
  }

  show(name, map, told) {
    this.view.part("bar").hidden = !map;
    // The colours of the body in the legend of a figure.
    this.swatch = Array.from({ length: 13 }, (_, k) => (map ? map.bytes(map.low + ((map.high - map.low) * k) / 12) : [107, 115, 128]));
    if (!map) return;
    const unit = this.view.fields[name]?.unit;
    const missing = told ? "" : " (not kept for this frame)";
    this.view.part("bar-name").textContent = this.view.label(name) + (unit ? ` [${unit}]` : "") + missing;
    const canvas = this.view.part("bar-colours");
    const context = canvas.getContext("2d");
    for (let y = 0; y < canvas.height; y++) {
      const value = map.high + ((map.low - map.high) * y) / (canvas.height - 1);
      context.fillStyle = `rgb(${map.bytes(value).join()})`;
      context.fillRect(0, y, canvas.width, 1);
    }
    const ticks = [0, 0.25, 0.5, 0.75, 1].map((share) => {
      const item = document.createElement("li");
      item.textContent = short(map.high + (map.low - map.high) * share);
      return item;
    });
    this.view.part("bar-ticks").replaceChildren(...(map.low === map.high ? ticks.slice(0, 1) : ticks));
  }
}
