// SPDX-License-Identifier: MIT
// The robot from above at its pose: X up, Y left.
import { inkOf } from "./fleet.js";
import { by, colour, figure, mark, put, typesIn } from "./text.js";

const LENGTH = 1.31;
const WIDTH = 0.75;
const WHEEL = { x: 0.305, y: 0.34, length: 0.56, width: 0.14 };
const MOST_PLACES = 8000;
const STEP_M = 0.03;
const STEP_RAD = 0.1;
const STEP_S = 0.1; // so that ten minutes of driving fit
const AXES_PX = 360; // on a narrower map they would cover the pose
const NEAR_PX = 14;
const NEAR_M = 0.5;
const RECENT_S = 60;
const JUMP_M = 0.5;
const LONGEST_CONE_M = 2.5; // longer ones are lines, which hide less
const clock = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" });
const COLOURS = ["--grid", "--grid-bold", "--text", "--soft", "--card", "--blue", "--orange", "--red", "--sky", "--body", "--wheel", "--box", "--violet", "--green"];

function legend({ sim, fleet }) {
  const own = sim ? "Solid: odometry, which slips in turns. Dashed: where it really is." : "By odometry, which slips in turns.";
  return fleet.length > 1 ? "Each robot by its own odometry: “place” corrects it." : own;
}

export class RobotMap {
  constructor(canvas, send, chosen, onMoveBox) {
    this.chosen = chosen;
    this.canvas = canvas;
    this.send = send;
    this.pen = canvas.getContext("2d");
    this.tools = by("map-follow").parentNode;
    this.top = 44;
    this.onMoveBox = onMoveBox;
    this.path = [];
    this.truth = [];
    this.scale = 60;
    this.centre = { x: 0, y: 0 };
    this.follow = true;
    this.drag = null;
    this.fingers = new Map();
    this.frame = null;
    this.past = null;
    this.about = null;
    new ResizeObserver(() => this.resize()).observe(canvas);
    addEventListener("theme", () => this.readColours());
    this.readColours();
    this.listen();
  }

  readColours() {
    this.ink = Object.fromEntries(COLOURS.map((name) => [name.slice(2), colour(name)]));
  }

  resize() {
    const dense = devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.canvas.width = Math.round(this.width * dense);
    this.canvas.height = Math.round(this.height * dense);
    this.dense = dense;
    this.larger = Math.max(1, parseFloat(getComputedStyle(document.documentElement).fontSize) / 16);
    if (this.frame) this.paint();
  }

  // ---- from metres to pixels and back ----

  at(x, y) {
    return [this.width / 2 - (y - this.centre.y) * this.scale, this.height / 2 - (x - this.centre.x) * this.scale];
  }

  place(px, py) {
    return { x: this.centre.x - (py - this.height / 2) / this.scale, y: this.centre.y - (px - this.width / 2) / this.scale };
  }

  /** The place under the cursor stays there, unless the robot is followed. */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const before = this.place(px, py);
    this.scale = Math.max(4, Math.min(400, this.scale * factor));
    const after = this.place(px, py);
    if (this.follow) return;
    this.centre.x += before.x - after.x;
    this.centre.y += before.y - after.y;
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || typesIn(event.target)) return;
    if (event.key === "+") this.zoom(1.4);
    else if (event.key === "-") this.zoom(1 / 1.4);
    else if (event.code === "KeyF" && !event.repeat) this.setFollow(!this.follow);
  }

  setFollow(on) {
    this.follow = on;
    by("map-follow").setAttribute("aria-pressed", String(on));
  }

  // ---- mouse and touch ----

  listen() {
    by("map-in").addEventListener("click", () => this.zoom(1.4));
    by("map-out").addEventListener("click", () => this.zoom(1 / 1.4));
    by("map-follow").addEventListener("click", () => this.setFollow(!this.follow));
    by("map-clear").addEventListener("click", () => this.send({ type: "forget_trail" }));
    addEventListener("keydown", (event) => this.key(event));
    const canvas = this.canvas;
    canvas.addEventListener("wheel", (event) => { event.preventDefault(); this.zoom(Math.exp(-event.deltaY / 500), event.offsetX, event.offsetY); }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => { this.fingers.delete(event.pointerId); this.drag = null; });
    canvas.addEventListener("pointerleave", () => { this.pointer = null; });
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    const { x, y } = this.place(event.offsetX, event.offsetY);
    if (this.chosen.active) {
      this.chosen.press({ x, y });
      this.drag = { relocalizes: true };
      return;
    }
    const boxes = this.frame?.sim?.boxes ?? [];
    const index = boxes.findLastIndex(([boxX, boxY, sizeX, sizeY]) => Math.abs(x - boxX) <= sizeX / 2 + 0.05 && Math.abs(y - boxY) <= sizeY / 2 + 0.05);
    this.drag = index >= 0 ? { box: index, dx: boxes[index][0] - x, dy: boxes[index][1] - y } : { x, y };
  }

  move(event) {
    const here = this.place(event.offsetX, event.offsetY);
    this.canvas.style.cursor = this.drag ? "grabbing" : "grab";
    this.pointer = this.drag ? null : [event.offsetX, event.offsetY];
    if (!this.fingers.has(event.pointerId)) return;
    if (this.fingers.size === 2) {
      const apart = () => { const [a, b] = [...this.fingers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
      const before = apart();
      this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
      const [[ax, ay], [bx, by_]] = [...this.fingers.values()];
      this.zoom(apart() / Math.max(before, 1), (ax + bx) / 2, (ay + by_) / 2);
      return;
    }
    if (this.drag?.relocalizes) {
      this.chosen.drag(here);
    } else if (this.drag?.box !== undefined) {
      this.onMoveBox(this.drag.box, here.x + this.drag.dx, here.y + this.drag.dy);
    } else if (this.drag) {
      this.setFollow(false);
      this.centre.x += this.drag.x - here.x;
      this.centre.y += this.drag.y - here.y;
    }
  }

  // ---- path and pose ----

  /** The trail as the dashboard keeps it: places and their times. */
  begin({ path: [xs, ys, times, thetas] }) {
    this.path = xs.map((x, index) => [x, ys[index], times[index], thetas[index]]);
    this.truth = [];
  }

  keep(list, { x_m: x, y_m: y, theta_rad: theta }, time_s) {
    const last = list.at(-1);
    if (last && (Math.abs(time_s - last[2]) < STEP_S || (Math.hypot(x - last[0], y - last[1]) < STEP_M && Math.abs(theta - last[3]) < STEP_RAD))) return;
    list.push([x, y, time_s, theta]);
    if (list.length > MOST_PLACES) list.splice(0, MOST_PLACES / 4);
  }

  show(frame, about) {
    this.frame = frame;
    this.about = about;
    this.top = Math.max(44, this.tools.offsetHeight + 18);
    const pose = frame.pose;
    const known = pose && pose.x_m !== null && pose.y_m !== null && pose.theta_rad !== null;
    if (known && frame.state === "ready") this.keep(this.path, pose, frame.time_s);
    // The pose of what the map shows.
    const then = this.past === null ? pose : this.poseThen();
    const followed = this.past !== null && then ? then : known && pose;
    if (this.follow && followed) this.centre = { x: followed.x_m, y: followed.y_m };
    if (frame.sim) this.keep(this.truth, frame.sim.pose, frame.time_s);
    this.paint();
    put(by("pose"), then ? `x ${figure(then.x_m, 2, "m")}   y ${figure(then.y_m, 2, "m")}   θ ${figure((then.theta_rad * 180) / Math.PI, 0, "°")}` : this.past === null ? "pose not reported" : "pose not known");
    put(by("map-legend"), legend(frame));
  }

  // ---- painting ----

  paint() {
    if (!this.width) return;
    mark(this.canvas, "trail", this.path.length);
    mark(this.canvas, "view", `${this.centre.x} ${this.centre.y} ${this.scale}`);
    const { pen, ink } = this;
    pen.setTransform(this.dense, 0, 0, this.dense, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    this.paintGrid();
    for (const box of this.frame.sim?.boxes ?? []) this.paintBox(box);
    this.paintPath(this.truth, ink.orange, [5, 5]);
    this.paintPath(this.path, ink.blue, []);
    const pose = this.frame.pose;
    if (this.frame.sim) this.outline(this.frame.sim.pose, ink.orange);
    if (this.past !== null) this.paintPast(pose);
    else if (pose && pose.theta_rad !== null && pose.x_m !== null && pose.y_m !== null) {
      this.inFrame(pose, () => this.paintCones());
      this.inFrame(pose, () => this.paintRobot(this.frame.facts));
      this.paintDistances(pose);
    }
    this.names = [];
    for (const robot of this.frame.fleet) if (robot.pose) this.paintFleet(robot, robot.name === this.about.name);
    const { wanted } = this.chosen;
    if (wanted) {
      if (wanted.theta_rad === undefined) this.paintGoal([wanted.x_m, wanted.y_m], "go here?");
      else this.outline(wanted, ink.blue);
    }
    if (this.frame.going) this.paintGoal(this.frame.going);
    this.paintTime();
    this.paintScale();
  }

  /** The pose at the time in the past that is looked at. */
  poseThen() {
    const found = this.path.findLast(([, , time_s]) => time_s <= this.past);
    return found && { x_m: found[0], y_m: found[1], time_s: found[2], theta_rad: found[3] };
  }

  /** The robot where it was; where it is, an outline. */
  paintPast(pose) {
    const then = this.poseThen();
    mark(this.canvas, "past", then ? [then.x_m, then.y_m, then.time_s, then.theta_rad].join(" ") : "");
    if (pose) this.outline(pose, this.ink.soft);
    if (!then) return;
    this.inFrame(then, () => this.paintRobot({}));
    const [px, py] = this.at(then.x_m, then.y_m);
    const text = `here since ${clock.format(then.time_s * 1000)}`;
    this.label(text, ...this.inside(text, px, py - 20), this.ink.text);
  }

  /** The place to which a robot goes by itself, and its way. */
  paintGoal([x, y], text = "goes here", from = this.frame.pose) {
    const { pen, ink } = this;
    const [px, py] = this.at(x, y);
    pen.strokeStyle = ink.orange;
    pen.lineWidth = 2;
    pen.setLineDash([2, 6]);
    pen.beginPath();
    if (from) pen.moveTo(...this.at(from.x_m, from.y_m));
    pen.lineTo(px, py);
    pen.stroke();
    pen.setLineDash([]);
    pen.lineWidth = 3;
    pen.beginPath();
    pen.arc(px, py, 10, 0, 2 * Math.PI);
    pen.moveTo(px - 16, py); pen.lineTo(px + 16, py);
    pen.moveTo(px, py - 16); pen.lineTo(px, py + 16);
    pen.stroke();
    this.label(text, px, py - 20, ink.text);
  }

  /** Each robot's name at its pose, or below another's; for those that are not shown in full, also an outline and the goal. */
  paintFleet({ name, pose, state, going }, chosen) {
    if (pose.x_m === null || pose.y_m === null || pose.theta_rad === null) return;
    const ink = state === "ready" ? this.ink[inkOf(this.frame.fleet, name)] : this.ink.soft;
    if (!chosen) this.outline(pose, ink);
    if (!chosen && going) this.paintGoal(going, `${name} goes here`, pose);
    let [px, py] = this.at(pose.x_m, pose.y_m);
    const high = 16 * this.larger;
    while (this.names.some(([x, y]) => Math.abs(x - px) < 4 * high && Math.abs(y - py) < high)) py += high;
    this.names.push([px, py]);
    this.label(name, px, py + 4, ink);
  }

  /** The time at which the robot passed the point of its trail under the pointer. */
  paintTime() {
    if (!this.pointer) return;
    const { pen, ink } = this;
    const [px, py] = this.pointer;
    let nearest = [NEAR_PX, null];
    for (const [x, y, time_s] of this.path) {
      const [sx, sy] = this.at(x, y);
      const away = Math.hypot(sx - px, sy - py);
      if (away < nearest[0]) nearest = [away, [sx, sy, time_s]];
    }
    if (!nearest[1]) return;
    const [x, y, time_s] = nearest[1];
    pen.fillStyle = ink.blue;
    pen.beginPath();
    pen.arc(x, y, 4, 0, 2 * Math.PI);
    pen.fill();
    this.label(clock.format(time_s * 1000), ...this.inside("00:00:00", x, y - 10), ink.text);
  }

  paintGrid() {
    const { pen, ink } = this;
    const cell = [0.5, 1, 2, 5, 10, 50].find((size) => size * this.scale >= 28) ?? 100;
    const low = this.place(this.width, this.height);
    const high = this.place(0, 0);
    this.cell = cell;
    pen.lineWidth = 1;
    for (const axis of ["x", "y"]) {
      for (let index = Math.ceil(low[axis] / cell); index * cell <= high[axis]; index++) {
        const [px, py] = this.at(index * cell, index * cell);
        pen.strokeStyle = index === 0 ? ink["grid-bold"] : ink.grid;
        pen.beginPath();
        if (axis === "x") { pen.moveTo(0, py); pen.lineTo(this.width, py); } else { pen.moveTo(px, 0); pen.lineTo(px, this.height); }
        pen.stroke();
      }
    }
  }

  paintScale() {
    const { pen, ink } = this;
    const long = this.cell * this.scale;
    const [x, y] = [12, this.height - 12];
    pen.strokeStyle = pen.fillStyle = ink.soft;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(x, y - 5); pen.lineTo(x, y); pen.lineTo(x + long, y); pen.lineTo(x + long, y - 5);
    pen.stroke();
    const text = `${this.cell} m`;
    this.label(text, x + 4, y - 8, ink.soft, "left");
    if (this.width > AXES_PX) this.label("X ↑   Y ←", x + Math.max(long, pen.measureText(text).width + 4) + 14, y, ink.soft, "left");
  }

  label(text, x, y, ink, align = "center") {
    const { pen } = this;
    pen.font = `600 ${12 * this.larger}px system-ui, sans-serif`;
    pen.textAlign = align;
    pen.lineWidth = 6;
    pen.lineJoin = "round";
    pen.strokeStyle = this.ink.card;
    pen.strokeText(text, x, y);
    pen.fillStyle = ink;
    pen.fillText(text, x, y);
  }

  /** The nearest centre at which a text is not cut off. */
  inside(text, x, y) {
    const half = this.pen.measureText(text).width / 2 + 8;
    return [Math.max(half, Math.min(this.width - half, x)), Math.max(16, Math.min(this.height - 42, y))];
  }

  /** The last minute in full colour, older parts paler. */
  paintPath(places, ink, dashes) {
    const recent = places.findIndex(([, , time_s]) => time_s > this.frame.time_s - RECENT_S);
    const from = recent < 0 ? places.length : recent;
    const { pen } = this;
    pen.strokeStyle = ink;
    pen.lineWidth = 2;
    pen.lineJoin = "round";
    pen.setLineDash(dashes);
    for (const [part, alpha] of [[places.slice(0, from + 1), 0.45], [places.slice(from), 1]]) {
      pen.globalAlpha = alpha;
      pen.beginPath();
      let last = null;
      for (const [x, y] of part) {
        // A robot that was relocalized did not drive there.
        if (last && Math.hypot(x - last[0], y - last[1]) > JUMP_M) pen.moveTo(...this.at(x, y));
        pen.lineTo(...this.at(x, y));
        last = [x, y];
      }
      pen.stroke();
    }
    pen.globalAlpha = 1;
    pen.setLineDash([]);
  }

  paintBox([x, y, sizeX, sizeY]) {
    const { pen, ink } = this;
    const [px, py] = this.at(x + sizeX / 2, y + sizeY / 2);
    pen.fillStyle = ink.box;
    pen.strokeStyle = ink.soft;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.roundRect(px, py, sizeY * this.scale, sizeX * this.scale, 3);
    pen.fill();
    pen.stroke();
  }

  /** Draw in the robot's frame: its X to the right, its Y up, in metres. */
  inFrame(pose, paint) {
    const { pen } = this;
    const [px, py] = this.at(pose.x_m, pose.y_m);
    pen.save();
    pen.translate(px, py);
    pen.scale(this.scale, -this.scale);
    pen.rotate(pose.theta_rad + Math.PI / 2);
    paint();
    pen.restore();
  }

  sensors() {
    const distances = this.frame.distances_m ?? [];
    return (this.about?.telemeter ?? []).map((sensor, index) => ({ ...sensor, distance: distances[index] ?? null }))
      .filter((sensor) => [sensor.x_m, sensor.y_m, sensor.theta_rad, sensor.field_of_view_rad, sensor.max_distance_m].every((value) => value !== null));
  }

  paintCones() {
    const { pen, ink } = this;
    for (const { x_m, y_m, theta_rad, field_of_view_rad, max_distance_m, distance } of this.sensors()) {
      if (distance === null) continue;
      const [from, to] = [theta_rad - field_of_view_rad / 2, theta_rad + field_of_view_rad / 2];
      const reach = Math.max(0, Math.min(distance, max_distance_m));
      const radius = Math.max(0.01, Math.min(reach, LONGEST_CONE_M));
      const fade = pen.createRadialGradient(x_m, y_m, 0, x_m, y_m, radius);
      fade.addColorStop(0, `${ink.sky}55`);
      fade.addColorStop(1, `${ink.sky}${reach > LONGEST_CONE_M ? "00" : "33"}`);
      pen.fillStyle = fade;
      pen.beginPath(); pen.moveTo(x_m, y_m); pen.arc(x_m, y_m, radius, from, to); pen.closePath();
      pen.fill();
      if (distance < max_distance_m) {
        pen.lineWidth = 3.5 / this.scale;
        pen.strokeStyle = distance < NEAR_M ? ink.red : ink.sky;
        pen.beginPath();
        pen.arc(x_m, y_m, reach, from, to);
        pen.stroke();
      }
    }
  }

  /** Write each distance beside the obstacle; where that is out of view, nearer to the robot. */
  paintDistances(pose) {
    const [c, s] = [Math.cos(pose.theta_rad), Math.sin(pose.theta_rad)];
    for (const { x_m, y_m, theta_rad, distance, max_distance_m } of this.sensors()) {
      if (distance === null) continue;
      const free = distance >= max_distance_m;
      const text = free ? `free ${figure(max_distance_m, 0, "m")}` : figure(distance, 2, "m");
      const on = (reach) => {
        const [x, y] = [x_m + reach * Math.cos(theta_rad), y_m + reach * Math.sin(theta_rad)];
        return this.at(pose.x_m + c * x - s * y, pose.y_m + s * x + c * y);
      };
      // Before the obstacle, not on it.
      let reach = free ? LONGEST_CONE_M * 0.6 : Math.max(distance - 22 / this.scale, 0.3);
      while (reach > 0.3 && !this.sees(...on(reach))) reach -= 0.1;
      if (this.sees(...on(reach))) this.label(text, on(reach)[0], on(reach)[1] + 4, distance < NEAR_M ? this.ink.red : this.ink.text);
    }
  }

  sees(px, py) {
    return px > 34 && px < this.width - 34 && py > this.top && py < this.height - (this.width > AXES_PX ? 36 : 64);
  }

  paintRobot(facts) {
    const { pen, ink } = this;
    pen.fillStyle = ink.wheel;
    for (const [sx, sy] of [[1, 1], [1, -1], [-1, 1], [-1, -1]]) {
      pen.beginPath();
      pen.roundRect(sx * WHEEL.x - WHEEL.length / 2, sy * WHEEL.y - WHEEL.width / 2, WHEEL.length, WHEEL.width, 0.04);
      pen.fill();
    }
    pen.fillStyle = ink.body;
    pen.strokeStyle = ink.text;
    pen.lineWidth = 1.5 / this.scale;
    pen.beginPath();
    pen.roundRect(-LENGTH / 2 + 0.04, -WIDTH / 2 + 0.11, LENGTH - 0.08, WIDTH - 0.22, 0.08);
    pen.fill();
    pen.stroke();
    pen.fillStyle = ink.blue;
    pen.beginPath();
    pen.moveTo(0.48, 0); pen.lineTo(0.22, 0.14); pen.lineTo(0.22, -0.14);
    pen.fill();
    this.paintBumper(1, facts.front_bumper);
    this.paintBumper(-1, facts.rear_bumper);
  }

  paintBumper(side, pressed) {
    const { pen, ink } = this;
    const thick = pressed ? 0.1 : 0.05;
    pen.fillStyle = pressed ? ink.red : ink.soft;
    pen.beginPath();
    pen.roundRect(side > 0 ? LENGTH / 2 - thick : -LENGTH / 2, -WIDTH / 2, thick, WIDTH, 0.02);
    if (pressed === null) { // not known
      pen.strokeStyle = ink.soft;
      pen.lineWidth = 1 / this.scale;
      pen.stroke();
      return;
    }
    pen.fill();
    if (pressed) {
      pen.strokeStyle = ink.red;
      pen.lineWidth = 2 / this.scale;
      for (const ring of [0.12, 0.2]) {
        pen.beginPath();
        pen.arc((side * LENGTH) / 2, 0, ring + 0.2, side > 0 ? -0.7 : Math.PI - 0.7, side > 0 ? 0.7 : Math.PI + 0.7);
        pen.stroke();
      }
    }
  }

  outline(pose, ink) {
    const { pen } = this;
    this.inFrame(pose, () => {
      pen.strokeStyle = ink;
      pen.lineWidth = 2.5 / this.scale;
      pen.setLineDash([0.1, 0.07]);
      pen.strokeRect(-LENGTH / 2, -WIDTH / 2, LENGTH, WIDTH);
      pen.setLineDash([]);
      pen.beginPath();
      pen.moveTo(LENGTH / 2 - 0.05, 0); pen.lineTo(LENGTH / 2 - 0.25, 0.12); pen.lineTo(LENGTH / 2 - 0.25, -0.12);
      pen.closePath();
      pen.stroke();
    });
  }
}
