// SPDX-License-Identifier: MIT
// The robots of this dashboard by name, and which of them the page shows and drives.
import { by, figure, make, mark, put, show } from "./text.js";

const stateOf = ({ state, alarm, armed, battery }) => (state !== "ready" ? "lost" : alarm ? "alarm" : armed ? "armed" : figure(battery ?? null, 0, "%"));

export class Fleet {
  constructor(choose) {
    this.choose = choose;
    this.chosen = "";
    this.buttons = new Map();
  }

  begin({ name }) {
    this.chosen = name;
  }

  show(robots) {
    show(by("fleet"), robots.length > 1);
    put(by("stop").firstChild, robots.length > 1 ? "STOP ALL" : "STOP");
    if (robots.map(({ name }) => name).join() !== [...this.buttons.keys()].join()) this.build(robots);
    for (const robot of robots) {
      const button = this.buttons.get(robot.name);
      mark(button, "level", robot.state !== "ready" || robot.alarm ? "bad" : "calm");
      put(button.lastChild, stateOf(robot));
      button.setAttribute("aria-pressed", String(robot.name === this.chosen));
    }
  }

  build(robots) {
    this.buttons = new Map(robots.map(({ name }) => {
      const button = make("button", "chip", "", make("b", "", name), make("span", "figures"));
      button.addEventListener("click", () => this.choose(name));
      return [name, button];
    }));
    by("fleet").replaceChildren(...this.buttons.values());
  }
}
