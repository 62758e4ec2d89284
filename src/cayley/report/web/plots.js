// Plots by uPlot: over the time, linked to each other and to the animation, and along a rod.

const LINE_COLORS = ["#0072B2", "#D55E00", "#009E73"];
const WHOLE = /^(total|defect|‖·‖)$/; // lines that sum up the others are black
const PLOT_HEIGHT = 190;

/** A plot in an element of its own, which it fills. */
class Plot {
  /**
   * @param {Element} holder
   * @param {{title: string, across: string, unit: string, names: string[], shade?: number[], linked?: boolean}} about
   * @param {(value: number) => void} clicked with the place on the horizontal axis
   */
  constructor(holder, about, data, clicked) {
    this.element = holder.appendChild(document.createElement("div"));
    this.element.className = "plot";
    this.about = about;
    this.data = data;
    this.clicked = clicked;
    this.marker = document.createElement("div");
    this.marker.className = "now";
    this.plot = new uPlot(this.options(), data, this.element);
    this.watch = new ResizeObserver(() => this.fit());
    this.watch.observe(this.element);
  }

  options() {
    const { title, across, unit, names, shade, linked, range } = this.about;
    const axis = {
      font: "11px system-ui, sans-serif",
      labelFont: "11px system-ui, sans-serif",
      labelSize: 18,
      stroke: "#5f5f5f",
      grid: { stroke: "#e9e9e9", width: 1 },
      ticks: { stroke: "#cccccc", size: 4 },
      labelGap: 0,
    };
    const number = (digits) => (plot, value) => (value === null || value === undefined ? "–" : shown(value, digits));
    return {
      title,
      width: this.element.clientWidth || 400,
      height: PLOT_HEIGHT,
      scales: { x: { time: false }, y: { range: range || padded } },
      legend: { live: true },
      cursor: { points: { size: 6 }, drag: { x: true, y: false }, ...(linked ? { sync: { key: "time" } } : {}) },
      axes: [
        { ...axis, size: 30, label: across, values: (plot, ticks) => ticks.map((value) => shown(value, 8)) },
        { ...axis, size: 58, label: unit === "1" ? "" : `[${unit}]`, values: ticksWithStep },
      ],
      series: [
        { label: across.startsWith("time") ? "t" : "s", value: number(6) },
        ...names.map((name, k) => ({
          label: name,
          stroke: WHOLE.test(name) ? "#1a1a1a" : LINE_COLORS[k],
          width: 1.4,
          value: number(6),
          points: { show: false },
        })),
      ],
      hooks: {
        drawClear: [(plot) => shade && fillBetween(plot, shade)],
        ready: [(plot) => this.listen(plot)],
        setSize: [() => this.mark(this.at)],
        setScale: [() => this.mark(this.at)],
      },
    };
  }

  listen(plot) {
    let pressed = 0;
    plot.over.append(this.marker);
    plot.over.addEventListener("mousedown", (event) => (pressed = event.clientX));
    plot.over.addEventListener("click", (event) => {
      const x = event.clientX - plot.over.getBoundingClientRect().left;
      if (Math.abs(event.clientX - pressed) < 4) this.clicked(plot.posToVal(x, "x"));
    });
  }

  /** Stand the marker at a place on the horizontal axis. */
  mark(at) {
    this.at = at;
    if (!this.plot || at === undefined) return;
    const x = this.plot.valToPos(at, "x");
    this.marker.hidden = !(x >= -0.5 && x <= this.plot.over.clientWidth + 0.5);
    this.marker.style.transform = `translateX(${x}px)`;
  }

  set(data, keepZoom = false) {
    this.data = data;
    const ready = this.plot.scales.x.min !== null && this.plot.scales.x.min !== undefined;
    this.plot.setData(data, !(keepZoom && ready));
    if (keepZoom && ready) this.plot.redraw();
    this.mark(this.at);
  }

  fit() {
    const width = this.element.clientWidth;
    if (width && width !== this.plot.width) this.plot.setSize({ width, height: PLOT_HEIGHT });
  }

  remove() {
    this.watch.disconnect();
    this.plot.destroy();
    this.element.remove();
  }
}

/** Vertical range with a margin; values that differ by less than rounding are shown in a range of their own size. */
function padded(plot, low, high) {
  if (low === null || high === null) return [-1, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  const width = high - low;
  const margin = width > 1e-13 * size ? 0.08 * width : 0.5 * size || 1;
  return [low - margin, high + margin];
}

/** Numbers at ticks with as many digits as their distance needs. */
function ticksWithStep(plot, ticks, axis, space, step) {
  const size = Math.max(...ticks.map(Math.abs));
  const digits = Math.min(12, Math.max(2, Math.ceil(Math.log10(size / step || 1)) + 2));
  return ticks.map((value) => shown(Math.abs(value) < 1e-9 * step ? 0 : value, digits));
}

function fillBetween(plot, [from, to]) {
  const x = Math.max(plot.valToPos(from, "x", true), plot.bbox.left);
  const width = Math.min(plot.valToPos(to, "x", true), plot.bbox.left + plot.bbox.width) - x;
  plot.ctx.fillStyle = "#f2f0eb";
  if (width > 0) plot.ctx.fillRect(x, plot.bbox.top, width, plot.bbox.height);
}
