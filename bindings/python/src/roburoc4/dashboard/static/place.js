// SPDX-License-Identifier: MIT
// A place on the map, chosen by press and drag or typed in, then confirmed: where the robot is, or where it goes.
import { by, put, show } from "./text.js";

const FIELDS = ["x", "y", "theta"];
const DEGREES = 180 / Math.PI;
const TEXTS = {
  relocalize: "Press where the robot is and drag in its direction, or type it.",
  go: "Press where the robot should go, or type it. It only sees with its telemeters.",
};

export class Place {
  /** onChosen: called with the purpose ("relocalize" or "go") and the pose. */
  constructor(onChosen) {
    this.what = "";
    this.from = null;
    for (const what of ["relocalize", "go"]) by(`map-${what}`).addEventListener("click", () => this.begin(this.what === what ? "" : what));
    by("relocalize-cancel").addEventListener("click", () => this.begin(""));
    by("relocalize-set").addEventListener("click", () => {
      const { x_m, y_m, theta_rad } = this.wanted;
      const wrong = [x_m, y_m, theta_rad].findIndex((value) => !Number.isFinite(value));
      if (wrong >= 0) {
        by(`relocalize-${FIELDS[wrong]}`).focus(); // still to be filled in
        return;
      }
      onChosen(this.what, { x_m, y_m, theta_rad });
      this.begin("");
    });
  }

  get active() {
    return this.what !== "";
  }

  begin(what) {
    this.what = what;
    for (const one of ["relocalize", "go"]) by(`map-${one}`).setAttribute("aria-pressed", String(one === what));
    show(by("relocalize"), this.active);
    show(by("relocalize-turn"), what === "relocalize");
    put(by("relocalize-set"), what === "go" ? "Go" : "Set");
    if (!what) return;
    put(by("relocalize-text"), TEXTS[what]);
    if (this.pose) this.fill(this.pose.x_m, this.pose.y_m, this.pose.theta_rad);
    // On a phone, the keyboard would cover the map.
    if (matchMedia("(hover: hover)").matches) by("relocalize-x").focus();
  }

  fill(...pose) {
    FIELDS.forEach((name, index) => { by(`relocalize-${name}`).value = (name === "theta" ? pose[index] * DEGREES : pose[index]).toFixed(name === "theta" ? 0 : 2); });
  }

  press({ x, y }) {
    this.from = { x, y };
    this.fill(x, y, this.wanted.theta_rad || 0);
  }

  drag({ x, y }) {
    if (this.what === "go" || Math.hypot(x - this.from.x, y - this.from.y) < 0.1) return;
    this.fill(this.from.x, this.from.y, Math.atan2(y - this.from.y, x - this.from.x));
  }

  /** The place that is not confirmed yet, for the map. */
  get wanted() {
    if (!this.active) return null;
    const [x_m, y_m, degrees] = FIELDS.map((name) => by(`relocalize-${name}`).valueAsNumber);
    return { x_m, y_m, theta_rad: degrees / DEGREES };
  }

  show(frame, mine) {
    this.pose = frame.pose;
    const { armed } = frame.facts;
    show(by("map-relocalize"), mine);
    show(by("map-go"), mine && armed);
    if (!mine || (this.what === "go" && !armed)) if (this.active) this.begin("");
    put(by("relocalize-warning"), !armed ? "" : this.what === "go" ? "The robot will move by itself. " : "The robot is armed and stays armed, at another place on the map. ");
  }
}
