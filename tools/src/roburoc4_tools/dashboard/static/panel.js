// SPDX-License-Identifier: MIT
// The simulator's panel: everything that a person beside the robot could do, and network faults.
import { by, figure, make, mark, put } from "./text.js";

const SWITCHES = [
  ["powered", "Main power", "power on", "power off"],
  ["estop_local", "Emergency stop, local", "estop local press", "estop local release"],
  ["estop_remote", "Emergency stop, remote", "estop remote press", "estop remote release"],
  ["brakes_released", "Brakes selector: released", "brakes released", "brakes automatic"],
  ["charger", "Charger plugged in", "charger on", "charger off"],
  ["front_bumper", "Front bumper pressed", "front bumper press", "front bumper release"],
  ["rear_bumper", "Rear bumper pressed", "rear bumper press", "rear bumper release"],
  ["overridden", "Game pad: [A] held", "pad a down", "pad a up"],
];
const HOLD_MS = 600;
const FAULTS = [
  ["loss", "Loss", 100, 1, "%"],
  ["duplicate", "Doubled", 100, 1, "%"],
  ["reorder", "Out of order", 100, 1, "%"],
  ["corrupt", "Broken bits", 100, 1, "%"],
  ["delay_ms", "Delay", 500, 5, "ms"],
  ["jitter_ms", "Jitter", 500, 5, "ms"],
];
const PAD = [["rt", "RT forward", 0, 100], ["lt", "LT backward", 0, 100], ["ljx", "LJ turn", -100, 100]];

/** A control that was just moved keeps its value until the simulator has it. */
const hold = (input) => { input.held = performance.now() + HOLD_MS; };
const held = (input) => input.matches(":active") || performance.now() < (input.held ?? 0);

export class Panel {
  constructor(send) {
    this.send = send;
    this.switches = new Map();
    this.sliders = new Map();
    this.pending = new Map();
  }

  line(text) {
    this.send({ type: "panel", line: text });
  }

  /** Send only the latest value, with the next frame: sliders change more often than that. */
  soon(what, message) {
    this.pending.set(what, message);
  }

  build() {
    const switches = make("div", "switches");
    for (const [name, text, on, off] of SWITCHES) {
      const box = make("input");
      box.type = "checkbox";
      box.name = name;
      box.addEventListener("change", () => { hold(box); this.line(box.checked ? on : off); });
      this.switches.set(name, box);
      switches.append(make("label", "switch", "", box, make("span", "", text)));
    }
    by("sim").replaceChildren(switches, this.buttons(), make("div", "switches", "", this.pad(), this.battery()), this.faults());
  }

  button(text, action, className = "") {
    const button = make("button", className, text);
    button.addEventListener("click", () => { action(); });
    return button;
  }

  buttons() {
    this.motor = this.button("Motor power button", () => this.line("motor on"));
    return make("div", "buttons", "", this.motor,
      this.button("Add an obstacle", () => this.addBox()),
      this.button("Clear obstacles", () => this.send({ type: "clear" })),
      this.button("Robot back to the origin", () => this.line("place 0 0 0")));
  }

  addBox() {
    const { x_m: x, y_m: y, theta_rad: theta } = this.pose;
    const far = 2.2;
    this.send({ type: "box", x_m: x + far * Math.cos(theta), y_m: y + far * Math.sin(theta), size_x_m: 0.5, size_y_m: 0.8 });
  }

  slider(text, low, high, step, unit, onInput) {
    const input = make("input");
    Object.assign(input, { type: "range", min: low, max: high, step, value: Math.max(low, Math.min(0, high)) });
    const output = make("output", "", `0 ${unit}`);
    input.addEventListener("input", () => { hold(input); onInput(Number(input.value)); });
    return { input, output, node: make("label", "slider", "", make("span", "", text), input, output) };
  }

  pad() {
    const place = make("div", "group", "", make("h2", "", "The robot’s game pad"));
    for (const [axis, text, low, high] of PAD) {
      const slider = this.slider(text, low, high, 5, "%", (value) => {
        put(slider.output, figure(value, 0, "%"));
        this.soon(axis, { type: "panel", line: `pad ${axis} ${low < 0 ? value / 100 : value / 50 - 1}` });
      });
      place.append(slider.node);
    }
    place.append(this.button("Release the pad", () => {
      this.line("pad release");
      place.querySelectorAll("input").forEach((input) => { input.value = 0; });
      place.querySelectorAll("output").forEach((output) => put(output, figure(0, 0, "%")));
    }));
    return place;
  }

  battery() {
    const slider = this.slider("Battery charge", 0, 100, 1, "%", (value) => this.soon("battery", { type: "panel", line: `battery ${value}` }));
    this.charge = slider;
    return make("div", "group", "", make("h2", "", "Battery"), slider.node);
  }

  faults() {
    const place = make("div", "group", "", make("h2", "", "Network faults"));
    const tell = () => {
      const faults = {};
      for (const [name, , , , unit] of FAULTS) faults[name] = Number(this.sliders.get(name).input.value) / (unit === "%" ? 100 : 1);
      this.soon("faults", { type: "faults", faults });
    };
    for (const [name, text, high, step, unit] of FAULTS) {
      const slider = this.slider(text, 0, high, step, unit, tell);
      slider.input.name = name;
      this.sliders.set(name, slider);
      place.append(slider.node);
    }
    place.append(this.button("Restore the network", () => this.send({ type: "faults", faults: {} })));
    return place;
  }

  moveBox(index, x, y) {
    this.soon("box", { type: "move", index, x_m: x, y_m: y });
  }

  show(sim) {
    for (const message of this.pending.values()) this.send(message);
    this.pending.clear();
    this.pose = sim.pose;
    for (const [name, box] of this.switches) if (!held(box) && box.checked !== sim[name]) box.checked = sim[name];
    mark(this.motor, "on", sim.motors_enabled ? "yes" : "no");
    put(this.motor, sim.motors_enabled ? "Motor power is on" : "Press the motor power button");
    this.follow(this.charge, sim.battery_percent, "%");
    for (const [name, , , , unit] of FAULTS) this.follow(this.sliders.get(name), sim.faults[name] * (unit === "%" ? 100 : 1), unit);
    put(by("sim-state"), `true pose x ${figure(sim.pose.x_m, 2, "m")}   y ${figure(sim.pose.y_m, 2, "m")}   θ ${figure((sim.pose.theta_rad * 180) / Math.PI, 0, "°")}${sim.watchdog_tripped ? "   watchdog: no command" : ""}`);
  }

  /** Show the current value on a slider, unless somebody holds it. */
  follow(slider, value, unit) {
    put(slider.output, figure(value, 0, unit));
    if (!held(slider.input)) {
      const text = String(Math.round(value));
      if (slider.input.value !== text) slider.input.value = text;
    }
  }
}
