// SPDX-License-Identifier: MIT
// Where the robot is: pressed and dragged on the map, or written; sent when somebody confirms it.
import { by, put, show } from "./text.js";

const FIELDS = ["x", "y", "theta"];
const DEGREES = 180 / Math.PI;

export class Relocalize {
  constructor(send) {
    this.active = false;
    this.from = null;
    by("map-relocalize").addEventListener("click", () => this.begin(!this.active));
    by("relocalize-cancel").addEventListener("click", () => this.begin(false));
    by("relocalize-set").addEventListener("click", () => {
      const [x_m, y_m, degrees] = FIELDS.map((name) => by(`relocalize-${name}`).valueAsNumber);
      if (![x_m, y_m, degrees].every(Number.isFinite)) return;
      send({ type: "relocalize", x_m, y_m, theta_rad: degrees / DEGREES });
      this.begin(false);
    });
  }

  begin(on) {
    this.active = on;
    by("map-relocalize").setAttribute("aria-pressed", String(on));
    show(by("relocalize"), on);
    if (on && this.pose) this.fill(this.pose.x_m, this.pose.y_m, this.pose.theta_rad);
    if (on) by("relocalize-x").focus();
  }

  fill(...pose) {
    FIELDS.forEach((name, index) => { by(`relocalize-${name}`).value = (name === "theta" ? pose[index] * DEGREES : pose[index]).toFixed(name === "theta" ? 0 : 2); });
  }

  press({ x, y }) {
    this.from = { x, y };
    this.fill(x, y, by("relocalize-theta").valueAsNumber / DEGREES || 0);
  }

  drag({ x, y }) {
    if (Math.hypot(x - this.from.x, y - this.from.y) < 0.1) return;
    this.fill(this.from.x, this.from.y, Math.atan2(y - this.from.y, x - this.from.x));
  }

  /** What is asked for, to be drawn. */
  get wanted() {
    if (!this.active) return null;
    const [x_m, y_m, degrees] = FIELDS.map((name) => by(`relocalize-${name}`).valueAsNumber);
    return { x_m, y_m, theta_rad: degrees / DEGREES };
  }

  show(frame, mine) {
    this.pose = frame.pose;
    show(by("map-relocalize"), mine);
    if (!mine && this.active) this.begin(false);
    put(by("relocalize-warning"), frame.facts.armed ? "The robot is armed: it stays so, at another place of the map. " : "");
  }
}
