// SPDX-License-Identifier: MIT
// A place on the map, chosen by press and drag or typed in, then confirmed: where the robot is, or where it goes.
import { by, figure, put, show, trip } from "./text.js";

const FIELDS = ["x", "y", "theta"];
const DEGREES = 180 / Math.PI;
const FARTHEST_M = 1000;
const FAR_M = 10; // from here on, it asks again
const MOST_CLEARANCE_M = 5;
const TEXTS = {
  relocalize: "Press where the robot is and drag in its direction, or type it.",
  go: "Press where the robot should go, or type it. It only sees with its telemeters.",
};

/** What is wrong with a field; empty if nothing is. */
function complaint(name, unit, most, low = -most) {
  const field = by(`relocalize-${name}`);
  const text = name === "theta" ? "θ" : name;
  if (field.value === "" && !field.validity.badInput && field.placeholder) return ""; // the default
  if (!Number.isFinite(field.valueAsNumber)) return `${text} is empty: type a number. `;
  return field.valueAsNumber < low || field.valueAsNumber > most ? `${text} is ${figure(low, 0)} to ${figure(most, 0, unit)}. ` : "";
}

export class Place {
  /** onChosen: called with the purpose ("relocalize" or "go") and the pose. */
  constructor(onChosen) {
    this.onChosen = onChosen;
    this.what = "";
    this.from = null;
    for (const what of ["relocalize", "go"]) by(`map-${what}`).addEventListener("click", () => this.begin(this.what === what ? "" : what));
    by("relocalize-cancel").addEventListener("click", () => this.begin(""));
    by("relocalize-set").addEventListener("click", () => this.confirm());
    by("relocalize").addEventListener("input", () => this.change());
  }

  get active() {
    return this.what !== "";
  }

  begin(what) {
    this.what = what;
    for (const one of ["relocalize", "go"]) by(`map-${one}`).setAttribute("aria-pressed", String(one === what));
    show(by("relocalize"), this.active);
    show(by("relocalize-turn"), what === "relocalize");
    show(by("relocalize-clear"), what === "go");
    this.change();
    if (!what) return;
    if (this.pose) this.fill(this.pose.x_m, this.pose.y_m, this.pose.theta_rad);
    // On a phone, the keyboard would cover the map.
    if (matchMedia("(hover: hover)").matches) by("relocalize-x").focus();
  }

  /** Another place: what was wrong with the last, and what was asked about it, is over. */
  change() {
    this.wrong = "";
    this.sure = false;
    put(by("relocalize-set"), this.what === "go" ? "Go" : "Set");
  }

  confirm() {
    const checks = [["x", "m", FARTHEST_M], ["y", "m", FARTHEST_M], this.what === "go" ? ["clearance", "m", MOST_CLEARANCE_M, 0] : ["theta", "°", 360]];
    for (const check of checks) {
      this.wrong = complaint(...check);
      if (!this.wrong) continue;
      by(`relocalize-${check[0]}`).focus();
      return;
    }
    const { x_m, y_m, theta_rad } = this.wanted;
    const away = this.what === "go" && this.pose ? Math.hypot(x_m - this.pose.x_m, y_m - this.pose.y_m) : 0;
    if (away > FAR_M && !this.sure) {
      this.sure = true;
      this.wrong = "That is far. Is the whole way clear, and in sight? ";
      put(by("relocalize-set"), `Go ${figure(away, 0, "m")}`);
      return;
    }
    const clearance = by("relocalize-clearance").valueAsNumber;
    this.onChosen(this.what, this.what === "go" ? { x_m, y_m, clearance_m: Number.isFinite(clearance) ? clearance : null } : { x_m, y_m, theta_rad });
    this.begin("");
  }

  fill(...pose) {
    FIELDS.forEach((name, index) => { by(`relocalize-${name}`).value = (name === "theta" ? pose[index] * DEGREES : pose[index]).toFixed(name === "theta" ? 0 : 2); });
    this.change();
  }

  press({ x, y }) {
    this.from = { x, y };
    this.fill(x, y, this.wanted.theta_rad || 0);
  }

  drag({ x, y }) {
    if (this.what === "go" || Math.hypot(x - this.from.x, y - this.from.y) < 0.1) return;
    this.fill(this.from.x, this.from.y, Math.atan2(y - this.from.y, x - this.from.x));
  }

  /** The place that is not confirmed yet, for the map; the heading only where it is asked for. */
  get wanted() {
    if (!this.active) return null;
    const [x_m, y_m, degrees] = FIELDS.map((name) => by(`relocalize-${name}`).valueAsNumber);
    return this.what === "go" ? { x_m, y_m } : { x_m, y_m, theta_rad: degrees / DEGREES };
  }

  /** Without a connection, nothing can be set. */
  silent() {
    this.begin("");
    for (const what of ["relocalize", "go"]) show(by(`map-${what}`), false);
  }

  show(frame, mine, speed) {
    this.pose = frame.pose;
    const { armed } = frame.facts;
    show(by("map-relocalize"), mine);
    show(by("map-go"), mine && armed);
    if (!this.active) return;
    if (!mine || (this.what === "go" && !armed)) {
      this.begin("");
      return;
    }
    const { x_m, y_m } = this.wanted;
    put(by("relocalize-warning"), this.wrong || (!armed ? "" : this.what === "go" ? "The robot will move by itself. " : "The robot is armed and stays armed, at another place on the map. "));
    put(by("relocalize-hint"), TEXTS[this.what]);
    put(by("relocalize-text"), this.what === "go" && Math.max(Math.abs(x_m), Math.abs(y_m)) <= FARTHEST_M ? `${trip(frame, [x_m, y_m], speed)}.` : "");
  }
}
