// Plots of a run: columns over trials.

const CURVES = ["--curve-1", "--curve-2", "--curve-3", "--curve-4", "--curve-5", "--curve-6", "--curve-7"];

class Plots {
  constructor(plots) {
    this.places = plots.map((plot, k) => ({ plot, place: document.getElementById(`plot-${k}`), drawn: null }));
    this.draw();
    let width = window.innerWidth;
    window.addEventListener("resize", () => {
      if (window.innerWidth === width) return;
      width = window.innerWidth;
      this.places.forEach(({ place, drawn }) => drawn.setSize({ width: place.clientWidth, height: 230 }));
    });
  }

  // Draws all plots, again when the colours have changed.
  draw() {
    for (const one of this.places) {
      one.drawn?.destroy();
      one.place.replaceChildren();
      one.drawn = this.one(one.plot, one.place);
    }
  }

  one(plot, place) {
    const heading = document.createElement("figcaption");
    heading.textContent = plot.title;
    place.append(heading);
    const [ink, grid] = [colourOf("--muted"), colourOf("--grid")];
    const axis = (label, size) => ({
      label, size, stroke: ink, labelSize: 18, labelFont: "12px system-ui", font: "12px system-ui",
      grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1, size: 5 }, labelGap: 0,
    });
    const decades = (self, ticks) => ticks.map((tick) => (isPower(tick) ? short(tick) : ""));
    const numbers = (self, ticks) => ticks.map(short);
    const series = plot.labels.map((label, k) => ({
      label,
      stroke: colourOf(CURVES[k % CURVES.length]),
      width: 1.8,
      // Rejected trials have no distance.
      spanGaps: true,
      points: plot.points ? { show: true, size: 7 } : { show: plot.columns[0].length < 60, size: 4 },
      paths: plot.points ? () => null : undefined,
      value: (self, value) => (value === null ? "–" : short(value)),
    }));
    const wide = this.spansDecades(plot);
    const options = {
      width: place.clientWidth,
      height: 230,
      scales: { x: { time: false }, y: { distr: plot.log ? 3 : 1, log: 10 } },
      axes: [
        axis(plot.x, 42),
        { ...axis(plot.y, 62), values: plot.log && wide ? decades : numbers },
      ],
      series: [{ label: plot.x }, ...series],
      cursor: { drag: { x: true, y: false } },
    };
    return new uPlot(options, plot.columns, place);
  }

  spansDecades(plot) {
    const all = plot.columns.slice(1).flat().filter((y) => y > 0);
    return Math.max(...all) > 30 * Math.min(...all);
  }
}

const isPower = (x) => x > 0 && Math.abs(Math.log10(x) - Math.round(Math.log10(x))) < 1e-9;
