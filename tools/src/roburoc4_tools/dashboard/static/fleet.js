// SPDX-License-Identifier: MIT
// The robots of this dashboard by name and colour, and which of them the page shows and drives.
import { by, figure, make, mark, put, show } from "./text.js";

const INKS = ["violet", "green", "sky", "text"];
const NAMES = ["red", "blue", "violet", "green"];
const named = ({ name }) => NAMES.find((ink) => ink === name.toLowerCase());
const stateOf = ({ state, alarm, armed, battery }) => (state !== "ready" ? "lost" : alarm ? "alarm" : armed ? "armed" : figure(battery ?? null, 0, "%"));

/** The name of a robot's colour: its own where it is called so, else one that no other is called. */
export function inkOf(robots, name) {
  const free = INKS.filter((ink) => !robots.some((robot) => named(robot) === ink));
  return named({ name }) ?? free[robots.filter((robot) => !named(robot)).findIndex((robot) => robot.name === name) % free.length];
}

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
    const several = robots.length > 1;
    show(by("fleet"), several);
    put(by("stop").firstChild, several ? "STOP ALL" : "STOP");
    mark(document.body, "robot", several ? inkOf(robots, this.chosen) : "");
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
      mark(button, "robot", inkOf(robots, name));
      button.addEventListener("click", () => this.choose(name));
      return [name, button];
    }));
    by("fleet").replaceChildren(...this.buttons.values());
  }
}
