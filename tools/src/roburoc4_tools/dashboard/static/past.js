// SPDX-License-Identifier: MIT
// Back in time: map and plots show one moment of the last ten minutes. Everything else stays live.
import { by, figure, put, show } from "./text.js";

const LEAST_S = 10;
const MOST_S = 600;
const clock = new Intl.DateTimeFormat(undefined, { timeStyle: "medium", hourCycle: "h23" });

export class Past {
  /** onMove: called with a Unix time, or null for the present. oldest: since when something is known. */
  constructor(onMove, oldest) {
    this.onMove = onMove;
    this.oldest = oldest;
    this.time_s = null;
    by("map-past").addEventListener("click", () => this.open(by("past").hidden));
    by("past-end").addEventListener("click", () => this.open(false));
    by("past-at").addEventListener("input", () => this.move());
  }

  open(on) {
    show(by("past"), on);
    by("map-past").setAttribute("aria-pressed", String(on));
    by("past-at").min = -Math.max(LEAST_S, Math.min(MOST_S, Math.ceil(this.now - this.oldest())));
    by("past-at").value = 0;
    this.move();
    if (on) by("past-at").focus();
  }

  move() {
    const ago = -by("past-at").valueAsNumber;
    this.time_s = ago > 0 ? this.now - ago : null;
    this.onMove(this.time_s);
  }

  show(frame) {
    this.now = frame.time_s;
    if (by("past").hidden) return;
    put(by("past-text"), this.time_s === null ? "now" : `${clock.format(this.time_s * 1000)}${by("map").dataset.past === "" ? ": nothing known" : `, ${figure(this.now - this.time_s, 0, "s")} ago`}`);
  }
}
