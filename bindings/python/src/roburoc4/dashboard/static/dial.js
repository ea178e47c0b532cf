// SPDX-License-Identifier: MIT
// A speed dial: zero on top, needle for the current speed, triangle for the target.
import { draw, figure, put } from "./text.js";

const SWEEP = 130;
const RADIUS = 82;

function point(angle, radius) {
  const turned = ((angle - 90) * Math.PI) / 180;
  return [radius * Math.cos(turned), radius * Math.sin(turned)];
}

function arc(from, to, radius) {
  const [x1, y1] = point(from, radius);
  const [x2, y2] = point(to, radius);
  return `M${x1.toFixed(2)} ${y1.toFixed(2)}A${radius} ${radius} 0 ${Math.abs(to - from) > 180 ? 1 : 0} ${to > from ? 1 : 0} ${x2.toFixed(2)} ${y2.toFixed(2)}`;
}

/** A step of 1, 2 or 5 that gives a handful of ticks. */
function step(span) {
  const power = 10 ** Math.floor(Math.log10(span));
  return [0.2, 0.25, 0.5, 1, 2].map((share) => share * power).find((size) => span / size <= 4) ?? power;
}

export class Dial {
  /** sign: which way positive turns the needle; sides: what left and right mean. */
  constructor(place, { name, unit, sign, sides }) {
    this.unit = unit;
    this.sign = sign;
    const picture = draw("svg", { viewBox: "-100 -103 200 178", role: "img", "aria-label": name });
    this.scale = picture.appendChild(draw("g"));
    this.swing = picture.appendChild(draw("path", { class: "swing" }));
    this.bug = picture.appendChild(draw("path", { class: "bug", d: "M0 -84l8 -14h-16z" }));
    this.needle = picture.appendChild(draw("g", { class: "needle" }));
    this.needle.append(draw("path", { d: "M-3 -30L-1.2 -76H1.2L3 -30z" }));
    picture.append(draw("text", { class: "name", y: -14 }, name));
    this.value = picture.appendChild(draw("text", { class: "value", y: 16 }));
    picture.append(draw("text", { class: "unit", y: 32 }, unit));
    this.target = picture.appendChild(draw("text", { class: "target", y: 50 }));
    picture.append(draw("text", { class: "side", x: -70, y: 71 }, sides[0]), draw("text", { class: "side", x: 70, y: 71 }, sides[1]));
    place.append(picture);
    this.setLimits(null, null, [0, 0]);
  }

  angle(value) {
    const share = Math.max(-1.04, Math.min(1.04, value / this.reach));
    return this.sign * share * SWEEP;
  }

  setLimits(low, high, full) {
    const key = `${low} ${high} ${full}`;
    if (key === this.key) return;
    this.key = key;
    const known = Number.isFinite(low) && Number.isFinite(high) && low !== null && high !== null;
    this.reach = known ? Math.max(-low, high, 0.01) : 1;
    this.scale.replaceChildren(draw("path", { class: "track", d: arc(-SWEEP, SWEEP, RADIUS) }));
    const [one, other] = [this.angle(-full[0]), this.angle(full[1])];
    if (one !== other) this.scale.append(draw("path", { class: "full", d: arc(one, other, RADIUS) }));
    const size = step(this.reach);
    for (let value = 0; value <= this.reach + 1e-6; value += size) {
      for (const signed of value ? [-value, value] : [0]) this.tick(signed, "tick", figure(signed, size < 1 ? 1 : 0));
    }
    if (known) for (const limit of [low, high]) this.tick(limit, "limit", "");
  }

  tick(value, kind, text) {
    const angle = this.angle(value);
    const [x1, y1] = point(angle, RADIUS - (kind === "limit" ? 9 : 5));
    const [x2, y2] = point(angle, RADIUS + (kind === "limit" ? 9 : 5));
    this.scale.append(draw("line", { class: kind, x1, y1, x2, y2 }));
    if (text) {
      const [x, y] = point(angle, RADIUS - 16);
      this.scale.append(draw("text", { class: "number", x, y: y + 3.5 }, text));
    }
  }

  show(current, target) {
    const angle = current === null ? 0 : this.angle(current);
    this.needle.setAttribute("transform", `rotate(${angle.toFixed(1)})`);
    this.bug.setAttribute("transform", `rotate(${(target === null ? 0 : this.angle(target)).toFixed(1)})`);
    this.swing.setAttribute("d", Math.abs(angle) > 0.5 ? arc(0, angle, RADIUS) : "");
    put(this.value, figure(current, 2));
    put(this.target, `target ${figure(target, 2)}`);
  }
}
