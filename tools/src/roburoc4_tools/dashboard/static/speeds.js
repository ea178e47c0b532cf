// SPDX-License-Identifier: MIT
// A speed as a bar from zero in the middle: filled to the current speed, a triangle at the target, a frame
// around what full deflection gives here, the robot's own limits at its ends. The scale is that of square
// roots, so that 0.3 m/s is as easy to read as 2.6.
import { figure, make, put } from "./text.js";

const MARKS = [1, 0.3, 0.1, 2, 3, 5, 10, 20];
const CROWDED = 13; // percent of the bar between two marks

export class Speed {
  /** sign: 1 where positive is to the right; sides: what left and right mean. */
  constructor(place, { name, unit, sign, sides }) {
    this.sign = sign;
    this.unit = unit;
    this.name = name;
    this.value = make("b", "value");
    this.target = make("b");
    this.marks = make("div", "marks");
    this.full = make("i", "full");
    this.fill = make("i", "fill");
    this.bug = make("i", "bug");
    this.bar = make("div", "bar", "", this.full, this.fill, this.bug);
    this.bar.setAttribute("aria-hidden", "true");
    this.marks.setAttribute("aria-hidden", "true");
    place.append(make("div", "line", "", make("span", "name", name), this.value, make("span", "unit", unit), make("span", "target", "", make("span", "", "target "), this.target)),
      this.bar, this.marks, make("div", "sides", "", make("span", "", sides[0]), make("span", "", sides[1])));
    this.setLimits(null, null, [0, 0]);
  }

  /** The position of a value, in percent from the left. */
  at(value) {
    const share = Math.min(1, Math.sqrt(Math.abs(value) / this.reach));
    return 50 + 50 * Math.sign(value) * this.sign * share;
  }

  span(node, from, to) {
    const [left, right] = [this.at(from), this.at(to)].toSorted((a, b) => a - b);
    node.style.left = `${left}%`;
    node.style.width = `${right - left}%`;
  }

  setLimits(low, high, full) {
    const ends = [low, high].filter((limit) => Number.isFinite(limit)).map(Math.abs);
    this.reach = Math.max(...ends, ...full) || 1;
    this.setFull(full);
    const marks = [0, this.reach];
    for (const mark of MARKS) if (marks.every((other) => Math.abs(this.at(mark) - this.at(other)) > CROWDED)) marks.push(mark);
    marks.push(...marks.slice(1).map((mark) => -mark));
    this.marks.replaceChildren(...marks.map((mark) => {
      const node = make("span", "", figure(mark, 1).replace(/\.0$/, ""));
      node.style.left = `${this.at(mark)}%`;
      node.style.transform = `translateX(-${this.at(mark)}%)`; // at the ends, the text stays within the bar
      return node;
    }));
  }

  /** What full deflection gives at this slider. */
  setFull([low, high]) {
    this.span(this.full, -low, high);
  }

  show(current, target) {
    put(this.value, figure(current, 2));
    put(this.target, target === null ? "" : figure(target, 2));
    const key = `${current} ${target} ${this.reach}`;
    if (key === this.key) return;
    this.key = key;
    this.span(this.fill, 0, current ?? 0);
    this.bug.hidden = target === null;
    this.bug.style.left = `${this.at(target ?? 0)}%`;
  }
}
