// SPDX-License-Identifier: MIT
// Signals over time: those that the user chose, one plot for each unit, on one time axis. uPlot draws; this
// feeds it, scrolls, pauses, zooms, and exports what is shown.
import { by, colour, figure, make, mark, put, save } from "./text.js";

const MOST = 12000;
const EVERY_S = 0.1;
const GAP_S = 2;
const REDRAW_S = 0.1;
const TIME_STEPS_S = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200];
const LEAST_HEIGHT = 128;
const BESIDES = 32; // height of a plot's legend, in pixels
const SPANS = [10, 30, 60, 120, 300, 600, 3600, 43200];
const INKS = ["--blue", "--orange", "--green", "--violet", "--red", "--sky", "--text", "--soft"];
const DASHES = [[], [7, 4], [2, 3]];
// At least this much is shown: the noise of a robot at rest does not fill the plot.
const RANGES = {
  "m/s": (low, high) => [Math.min(-0.2, low * 1.1), Math.max(0.2, high * 1.1)],
  "rad/s": (low, high) => [Math.min(-0.2, low * 1.1), Math.max(0.2, high * 1.1)],
  "%": () => [0, 100],
  "% lost": (_, high) => [0, Math.max(5, high * 1.1)],
  on: () => [-0.1, 1.1],
  V: (low, high) => [Math.floor(low - 0.5), Math.ceil(high + 0.5)],
  m: (_, high) => [0, Math.max(1, high * 1.1)],
  ms: (_, high) => [0, Math.max(10, high * 1.1)],
};
const FIRST = ["speed", "target"];
const clock = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" });

// What was not received lately is a gap.
const fresh = (frame, service) => frame.state === "ready" && !frame.stale.includes(service);
const speed = (index) => (frame) => (fresh(frame, "differential") ? frame.speeds?.[index] ?? null : null);
const battery = (name) => (frame) => (fresh(frame, "battery") ? frame.battery?.[name] ?? null : null);
const FIXED = [
  ["speed", "speed", "m/s", 2, speed(1)], ["target", "speed, target", "m/s", 2, speed(0)],
  ["turn", "turn", "rad/s", 2, speed(3)], ["turn_target", "turn, target", "rad/s", 2, speed(2)],
  ["battery", "battery", "%", 0, battery("percent")], ["voltage", "battery voltage", "V", 2, battery("volts")],
  ["round_trip", "round trip", "ms", 1, (frame) => frame.link.round_trip_ms],
  ["loss", "loss", "% lost", 1, (frame) => (frame.link.loss === null ? null : frame.link.loss * 100)],
].map(([id, label, unit, digits, of]) => ({ id, label, unit, digits, of }));

/** All signals of a robot. */
function signalsOf(about) {
  const distances = about.telemeter.map((_, index) => ({ id: `distance_${index}`, label: `distance ${index}`, unit: "m", digits: 2, of: (frame) => (fresh(frame, "telemeter") ? frame.distances_m?.[index] ?? null : null) }));
  const analog = about.channels.analog_inputs.map((name, index) => ({ id: `analog_${index}`, label: `AI ${index} ${name}`, unit: "analog", digits: 2, of: (frame) => (fresh(frame, "iocard") ? frame.analog?.[index] ?? null : null) }));
  const digital = about.channels.digital_inputs.map((name, index) => ({ id: `digital_${index}`, label: `DI ${index} ${name}`, unit: "on", digits: 0, of: (frame) => (fresh(frame, "iocard") && frame.digital ? Number(frame.digital[index]) : null) }));
  return [...FIXED, ...distances, ...analog, ...digital];
}

function chosenBefore() {
  try { return JSON.parse(localStorage.getItem("signals")) ?? FIRST; } catch { return FIRST; }
}

export class Plots {
  constructor() {
    this.signals = FIXED;
    this.chosen = new Set(chosenBefore());
    this.times = [];
    this.values = new Map();
    this.span = 30;
    this.paused = false;
    this.range = null;
    this.drawn = 0;
    this.now = 0;
    this.plots = [];
    by("plot-pause").addEventListener("click", () => this.pause(!this.paused));
    by("plot-less").addEventListener("click", () => this.zoom(-1));
    by("plot-more").addEventListener("click", () => this.zoom(1));
    by("plot-export").addEventListener("click", () => this.export());
    addEventListener("theme", () => this.build());
    new ResizeObserver(() => this.resize()).observe(by("panel-plots"));
    this.describe(null);
  }

  // ---- which signals ----

  describe(about) {
    if (about) this.signals = signalsOf(about);
    by("plot-signals").replaceChildren(...this.signals.map((signal) => {
      const box = make("input");
      Object.assign(box, { type: "checkbox", name: signal.id, checked: this.chosen.has(signal.id) });
      box.addEventListener("change", () => this.choose(signal.id, box.checked));
      return make("label", "switch", "", box, make("span", "", signal.label));
    }));
    this.build();
  }

  choose(id, on) {
    if (on) this.chosen.add(id); else this.chosen.delete(id);
    try { localStorage.setItem("signals", JSON.stringify([...this.chosen])); } catch { /* for this time only */ }
    this.build();
  }

  // ---- values ----

  /** Begin with what the dashboard has kept: speeds and battery, which were measured at different times. */
  begin(speeds, charge) {
    const rows = [];
    speeds[0].forEach((time, row) => rows.push([time, { target: speeds[1][row], speed: speeds[2][row], turn_target: speeds[3][row], turn: speeds[4][row] }]));
    charge[0].forEach((time, row) => rows.push([time, { battery: charge[1][row], voltage: charge[2][row] }]));
    this.times = [];
    this.values.clear();
    for (const [time, row] of rows.toSorted((a, b) => a[0] - b[0])) this.push(time, row);
    // Between two rows of the battery it is not measured: a gap lasts until the next value.
    for (const id of ["battery", "voltage"]) {
      const column = this.column(id);
      for (let row = 1; row < this.times.length; row++) if (column[row] === undefined && column[row - 1] === null) column[row] = null;
    }
    this.redraw();
  }

  column(id) {
    if (!this.values.has(id)) this.values.set(id, []);
    return this.values.get(id);
  }

  /** undefined: not measured at that time; null: a gap. */
  add(time, row) {
    if (this.times.length && time < this.times.at(-1)) {
      this.times.length = 0;
      this.values.clear();
    }
    // A page that was hidden or not connected received nothing meanwhile.
    if (time - this.times.at(-1) > GAP_S) this.push(this.times.at(-1) + EVERY_S, Object.fromEntries([...this.values.keys()].map((id) => [id, null])));
    this.push(time, row);
  }

  push(time, row) {
    const index = this.times.push(time) - 1;
    for (const [id, value] of Object.entries(row)) this.column(id)[index] = value;
    if (index < MOST) return;
    this.times.splice(0, MOST / 4);
    for (const column of this.values.values()) column.splice(0, MOST / 4);
  }

  show(frame, seen) {
    this.now = frame.time_s;
    const last = this.times.at(-1) ?? -Infinity;
    if (this.now - last >= EVERY_S || this.now < last) this.add(this.now, Object.fromEntries(this.signals.map(({ id, of }) => [id, of(frame)])));
    if (seen && !this.paused && (this.now - this.drawn > REDRAW_S || this.now < this.drawn)) this.redraw();
  }

  // ---- time ----

  pause(on, range = null) {
    this.paused = on;
    this.range = on ? range ?? [this.now - this.span, this.now] : null;
    by("plot-pause").setAttribute("aria-pressed", String(on));
    put(by("plot-pause"), on ? "continue" : "pause");
    this.redraw();
  }

  zoom(way) {
    if (this.range) {
      const [low, high] = this.range;
      const half = ((high - low) / 2) * (way < 0 ? 0.5 : 2);
      this.range = [(low + high) / 2 - half, (low + high) / 2 + half];
    } else {
      this.span = SPANS[Math.max(0, Math.min(SPANS.length - 1, SPANS.indexOf(this.span) + way))];
    }
    this.redraw();
  }

  /** Show the time around a moment, or the present again. */
  look(time_s) {
    this.moment = time_s;
    this.pause(time_s !== null, [time_s - this.span / 2, time_s + this.span / 2]);
  }

  get shown() {
    return this.range ?? [this.now - this.span, this.now];
  }

  // ---- plots ----

  build() {
    this.plots.forEach((plot) => plot.destroy());
    const chosen = this.signals.filter(({ id }) => this.chosen.has(id));
    const units = [...new Set(chosen.map(({ unit }) => unit))];
    by("plots").replaceChildren();
    this.plots = units.map((unit) => this.plot(unit, chosen.filter((signal) => signal.unit === unit)));
    if (!units.length) by("plots").append(make("p", "legend", "Choose signals above."));
    this.resize();
    this.redraw();
  }

  plot(unit, signals) {
    const grid = { stroke: colour("--grid"), width: 1 };
    const style = { stroke: colour("--soft"), grid, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    const range = RANGES[unit];
    const options = {
      width: this.width, height: LEAST_HEIGHT,
      series: [{ label: "time", value: (_, time) => (time === null ? "–" : clock.format(time * 1000)) }, ...signals.map(({ label, digits }, index) => ({
        label, width: 2, stroke: colour(INKS[index % INKS.length]), dash: DASHES[Math.floor(index / INKS.length) % DASHES.length], points: { show: false }, value: (_, value) => figure(value, digits),
      }))],
      axes: [{ ...style, space: 70, size: 24, incrs: TIME_STEPS_S, values: (_, times) => times.map((time) => clock.format(time * 1000)) },
        { ...style, size: 52, space: 26, label: unit, labelSize: 18, labelFont: "11px system-ui" }],
      scales: { x: { time: false }, ...(range && { y: { range: (_, low, high) => range(low ?? 0, high ?? 0) } }) },
      cursor: { sync: { key: "time" }, drag: { x: true, y: false, setScale: false }, bind: { dblclick: () => () => { this.pause(false); return null; } } },
      hooks: { setSelect: [(plot) => this.select(plot)] },
    };
    const plot = new globalThis.uPlot(options, [[]], by("plots"));
    plot.signals = signals;
    return plot;
  }

  /** Zoom all plots to the time that was dragged across. */
  select(plot) {
    const { left, width } = plot.select;
    if (width <= 2) return;
    const range = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.pause(true, range);
  }

  get width() {
    return Math.max(by("plots").clientWidth, 150);
  }

  resize() {
    const room = by("panel-plots").clientHeight - by("plots").offsetTop - BESIDES / 2;
    const height = Math.max(LEAST_HEIGHT, Math.floor(room / this.plots.length) - BESIDES);
    this.plots.forEach((plot) => plot.setSize({ width: this.width, height }));
  }

  /** Redraw when the tab is opened. */
  wake() {
    this.resize();
    this.redraw();
  }

  redraw() {
    this.drawn = this.now;
    const [min, max] = this.shown;
    const length = max - min;
    put(by("plot-span"), length < 60 ? `${figure(length, length < 10 ? 1 : 0)} s` : length < 3600 ? `${figure(length / 60, 0)} min` : `${figure(length / 3600, 0)} h`);
    for (const plot of this.plots) {
      const data = [this.times, ...plot.signals.map(({ id }) => { const column = this.column(id); column.length = this.times.length; return column; })];
      plot.batch(() => {
        plot.setData(data, false);
        plot.setScale("x", { min, max });
      });
      if (this.moment && this.paused) plot.setCursor({ left: plot.valToPos(this.moment, "x"), top: 5 });
      // The legend shows the newest values, unless the pointer is on the plot.
      else if (plot.cursor.left < 0) plot.setLegend({ idx: this.times.length ? this.times.length - 1 : null });
    }
    mark(by("plots"), "until", max);
  }

  // ---- export ----

  /** The signals and the time that are shown, as CSV. */
  export() {
    const chosen = this.signals.filter(({ id }) => this.chosen.has(id));
    const [low, high] = this.shown;
    const lines = [["time_s", ...chosen.map(({ id }) => id)].join()];
    this.times.forEach((time, row) => {
      if (time < low || time > high) return;
      const values = chosen.map(({ id }) => this.values.get(id)?.[row] ?? "");
      if (values.some((value) => value !== "")) lines.push([time.toFixed(3), ...values].join());
    });
    save("roburoc4-plot.csv", lines.join("\n") + "\n");
  }
}
