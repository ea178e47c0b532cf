// SPDX-License-Identifier: MIT
// All channels of the IO card, with their names: lamps for digital ones, bars for analog ones.
import { by, figure, make, mark, put } from "./text.js";

const AXIS = /game ?pad|joystick|trigger/i;
const VOLTS = 30;

export class Channels {
  constructor() {
    this.digital = [];
    this.analog = [];
  }

  build(channels) {
    this.digital = channels.digital_inputs.map((name, index) => this.lamp(index, name));
    by("digital-inputs").replaceChildren(...this.digital);
    this.analog = channels.analog_inputs.map((name, index) => this.bar(index, name));
    by("analog-inputs").replaceChildren(...this.analog.map(({ node }) => node));
    const outputs = [...channels.digital_outputs.map((name, index) => [`DO ${index}`, name]), ...channels.analog_outputs.map((name, index) => [`AO ${index}`, name])];
    by("outputs").replaceChildren(...outputs.map(([number, name]) => {
      const node = make("li", "", "", make("i"), make("small", "", number), make("span", "", name || "no name"));
      node.dataset.on = "unknown";
      return node;
    }));
  }

  lamp(index, name) {
    const node = make("li", "", "", make("i"), make("small", "", `DI ${index}`), make("span", "", name || "no name"));
    node.dataset.on = "unknown";
    node.dataset.input = index;
    return node;
  }

  bar(index, name) {
    const axis = AXIS.test(name);
    const value = make("b");
    const level = make("i");
    const node = make("li", "", "", make("small", "", `AI ${index}`), make("span", "", name || "no name"), value, make("div", axis ? "level axis" : "level", "", level));
    node.dataset.input = index;
    return { node, value, level, axis };
  }

  show(frame) {
    this.digital.forEach((node, index) => mark(node, "on", frame.digital === null ? "unknown" : frame.digital[index] === "1" ? "yes" : "no"));
    this.analog.forEach(({ value, level, axis }, index) => {
      const number = frame.analog?.[index] ?? null;
      put(value, figure(number, 2, axis ? "" : "V"));
      const share = number === null ? 0 : Math.max(-1, Math.min(1, axis ? number : number / VOLTS));
      const style = axis ? `${share < 0 ? 50 + share * 50 : 50}% ${Math.abs(share) * 50}%` : `0% ${Math.max(0, share) * 100}%`;
      if (level.dataset.style !== style) {
        level.dataset.style = style;
        [level.style.left, level.style.width] = style.split(" ");
      }
    });
  }
}
