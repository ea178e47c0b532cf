// SPDX-License-Identifier: MIT
// What happened over time. uPlot draws; this feeds it, and lets it scroll, stand and zoom.
import { by, colour, figure, mark, put } from "./text.js";

const MOST = 12000;
const EVERY_S = 0.06;
const BATTERY_EVERY_S = 5;
const REDRAW_S = 0.1;
const TIME_STEPS_S = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200];
const LEAST_SPEED = 0.2;
const HEIGHT = 132;
const SPANS = [10, 30, 60, 120, 300, 600];

const clock = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" });

const reading = (digits, unit) => (_, number) => figure(number, digits, unit);

const speedScale = { y: { range: (_, low, high) => [Math.min(-LEAST_SPEED, (low ?? 0) * 1.1), Math.max(LEAST_SPEED, (high ?? 0) * 1.1)] } };

const batteryScales = { y: { range: [0, 100] }, volts: { range: (_, low, high) => [Math.floor((low ?? 20) - 0.5), Math.ceil((high ?? 28) + 0.5)] } };

const side = (label) => ({ label, labelSize: 18, labelFont: "11px system-ui" });
const voltSide = { scale: "volts", side: 1, grid: { show: false }, values: (_, volts) => volts.map((value) => `${value} V`), size: 44 };

const line = (label, ink, value, rest) => ({ label, stroke: colour(ink), width: 2, points: { show: false }, value, ...rest });
const speedLines = (unit) => [line("target", "--orange", reading(2, unit), { dash: [6, 4] }), line("current", "--blue", reading(2, unit))];
const batteryLines = () => [line("charge", "--blue", reading(0, "%")), line("voltage", "--orange", reading(2, "V"), { scale: "volts", dash: [2, 3] })];

class Columns {
  constructor(count, every) {
    this.data = Array.from({ length: count }, () => []);
    this.every = every;
  }

  begin(columns) {
    this.data = columns.map((column) => [...column]);
  }

  add(row) {
    const times = this.data[0];
    if (times.length && row[0] - times.at(-1) < this.every && row[0] >= times.at(-1)) return;
    if (times.length && row[0] < times.at(-1)) this.data.forEach((column) => column.splice(0));
    this.data.forEach((column, index) => column.push(row[index]));
    if (times.length > MOST) this.data.forEach((column) => column.splice(0, MOST / 4));
  }
}

export class Plots {
  constructor() {
    this.speeds = new Columns(5, EVERY_S);
    this.battery = new Columns(3, BATTERY_EVERY_S);
    this.span = 30;
    this.paused = false;
    this.drawn = 0;
    this.now = 0;
    this.plots = [];
    by("plot-pause").addEventListener("click", () => this.pause(!this.paused));
    by("plot-less").addEventListener("click", () => this.zoom(-1));
    by("plot-more").addEventListener("click", () => this.zoom(1));
    addEventListener("theme", () => this.build());
    this.build();
    new ResizeObserver(() => this.resize()).observe(by("plot-linear"));
  }

  pause(on) {
    this.paused = on;
    const button = by("plot-pause");
    button.setAttribute("aria-pressed", String(on));
    put(button, on ? "go on" : "pause");
    if (!on) this.redraw();
  }

  zoom(way) {
    this.span = SPANS[Math.max(0, Math.min(SPANS.length - 1, SPANS.indexOf(this.span) + way))];
    put(by("plot-span"), this.span < 60 ? `${this.span} s` : `${this.span / 60} min`);
    this.redraw();
  }

  options(place, series, axes, scales) {
    const soft = colour("--soft");
    const grid = { stroke: colour("--grid"), width: 1 };
    const style = { stroke: soft, grid, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    return {
      width: Math.max(place.clientWidth, 200),
      height: HEIGHT,
      series: [{ label: "time", value: (_, time) => (time === null ? "–" : clock.format(time * 1000)) }, ...series],
      axes: [{ ...style, space: 70, size: 26, incrs: TIME_STEPS_S, values: (_, times) => times.map((time) => clock.format(time * 1000)) }, ...axes.map((axis) => ({ ...style, size: 52, space: 26, ...axis }))],
      scales: { x: { time: false }, ...scales },
      cursor: { drag: { x: true, y: false }, bind: { dblclick: () => () => { this.pause(false); return null; } } },
      legend: { live: true },
      hooks: { setSelect: [(plot) => plot.select.width > 0 && this.pause(true)] },
    };
  }

  plot(id, series, axes, scales, data) {
    return new globalThis.uPlot(this.options(by(id), series, axes, scales), data, by(id));
  }

  build() {
    this.plots.forEach((plot) => plot.destroy());
    this.plots = [
      this.plot("plot-linear", speedLines("m/s"), [side("linear, m/s")], speedScale, this.view(0)),
      this.plot("plot-angular", speedLines("rad/s"), [side("turn, rad/s")], speedScale, this.view(1)),
      this.plot("plot-battery", batteryLines(), [side("charge, %"), voltSide], batteryScales, this.view(2)),
    ];
    this.zoom(0);
  }

  view(index) {
    const [times, targetLinear, linear, targetAngular, angular] = this.speeds.data;
    return [[times, targetLinear, linear], [times, targetAngular, angular], this.battery.data][index];
  }

  resize() {
    this.plots.forEach((plot) => plot.setSize({ width: Math.max(plot.root.parentElement.clientWidth, 200), height: plot.height }));
  }

  begin(speeds, battery) {
    this.speeds.begin(speeds);
    this.battery.begin(battery);
    this.redraw();
  }

  show(frame) {
    this.now = frame.time_s;
    // The last values of a lost robot are not continued: a gap.
    const fresh = frame.state === "ready";
    if (frame.speeds) this.speeds.add([frame.time_s, ...(fresh ? frame.speeds : [null, null, null, null])]);
    if (frame.battery) this.battery.add([frame.time_s, ...(fresh ? [frame.battery.percent, frame.battery.volts] : [null, null])]);
    if (!this.paused && (this.now - this.drawn > REDRAW_S || this.now < this.drawn)) this.redraw();
  }

  redraw() {
    if (this.paused) return;
    this.drawn = this.now;
    this.plots.forEach((plot, index) => {
      // The battery changes in minutes: its plot shows all that there is.
      const first = this.battery.data[0][0] ?? this.now;
      const span = index === 2 ? Math.max(this.span, this.now - first) : this.span;
      plot.setData(this.view(index), false);
      plot.setScale("x", { min: this.now - span, max: this.now });
      // The legend shows the newest values, unless the pointer is on others.
      if (plot.cursor.left < 0) plot.setLegend({ idx: plot.data[0].length ? plot.data[0].length - 1 : null });
    });
    mark(by("plot-linear"), "until", this.now);
  }
}
