// SPDX-License-Identifier: MIT
// Input sources: game pad, stick on the page, keyboard. In doubt an input counts as released, and whatever
// was held when the page was left, or another pad appeared, must be released before it counts again.
//
// The game pad is read as in the manual (4.1): [A] held is the dead-man, RT forward, LT backward,
// LJ left and right to turn. [B] stops, LB and RB make it slower and faster.
//
// Browsers do not always report that a key was released: a menu, a drag or the Command key hide it. So a
// key is held no longer than the keyboard repeats, as in terminal/deadman.py. Only the key that was pressed
// last repeats; it keeps the others held.

import { mark } from "./text.js";

const A = 0;
export const B = 1;
const SLOWER = 4; // LB
export const FASTER = 5; // RB
const LT = 6;
const RT = 7;
const LJ_X = 0;
const DEAD_ZONE = 0.12;
const RISE_MS = 600;
const FIRST_MS = 700; // a keyboard waits up to this long before it repeats a key
const REPEAT_MS = 200; // and then repeats it more often than this
const MOTIONS = {
  KeyW: [1, 0], ArrowUp: [1, 0], KeyS: [-1, 0], ArrowDown: [-1, 0],
  KeyA: [0, 1], ArrowLeft: [0, 1], KeyD: [0, -1], ArrowRight: [0, -1],
};
const NEUTRAL = { forward: 0, left: 0, by: "" };

const beyond = (value) => (Math.abs(value) < DEAD_ZONE ? 0 : (value - Math.sign(value) * DEAD_ZONE) / (1 - DEAD_ZONE));
const within = (value) => Math.max(-1, Math.min(1, value || 0));

const touches = () => matchMedia("(hover: none)").matches;

/** Whether the Command key is involved: while it is down, a Mac does not report that other keys are released. */
const commands = (event) => event.metaKey || /^(Meta|OS)/.test(event.code);

/** Whether a key is meant for what has the focus rather than for the robot. */
function writes({ target, code }) {
  if (target.matches?.("input[type=range], [role=tab]")) return code.startsWith("Arrow");
  return target.matches?.("input:not([type=checkbox]), select, textarea") ?? false;
}

export class Inputs {
  constructor(stick, knob, onLetGo) {
    this.stick = stick;
    this.knob = knob;
    this.onLetGo = onLetGo;
    this.keys = new Set();
    this.heard = 0;
    this.repeats = false;
    this.unrepeated = false;
    this.held = null;
    this.stickAt = null;
    this.risen = 0;
    this.looked = 0;
    this.stuck = true;
    this.padIndex = null;
    this.down = new Set();
    addEventListener("keydown", (event) => this.press(event));
    addEventListener("keyup", (event) => this.lift(event));
    for (const event of ["contextmenu", "dragstart"]) document.addEventListener(event, (begun) => this.refuse(begun));
    addEventListener("blur", () => this.letGo());
    document.addEventListener("visibilitychange", () => this.letGo());
    for (const event of ["gamepadconnected", "gamepaddisconnected"]) addEventListener(event, () => this.letGo());
    stick.addEventListener("pointerdown", (event) => this.grip(event));
    stick.addEventListener("pointermove", (event) => event.pointerId === this.held?.pointer && this.push(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      stick.addEventListener(end, (event) => event.pointerId === this.held?.pointer && this.release());
    }
    addEventListener("resize", () => this.release());
    // A finger that rests on the stick opens a context menu, too.
    stick.addEventListener("contextmenu", (event) => { event.preventDefault(); event.stopPropagation(); });
  }

  press(event) {
    if (commands(event)) this.letGo();
    if (!(event.code in MOTIONS) || event.ctrlKey || event.altKey || event.metaKey || writes(event)) return;
    if (this.wanted) event.preventDefault();
    this.listen();
    // A key that repeats but was not pressed on this page was pressed on another one.
    if (event.repeat && !this.keys.has(event.code)) return;
    this.keys.add(event.code);
    this.hear(event.repeat);
  }

  lift(event) {
    if (commands(event)) this.letGo();
    if (event.code === this.unrepeated) this.unrepeated = "";
    if (!this.keys.delete(event.code)) return;
    this.hear(false);
    this.tellIfFree();
  }

  hear(repeats) {
    this.heard = performance.now();
    this.repeats = repeats;
    this.unrepeated = "";
  }

  /** Count keys that no longer repeat as released. */
  listen() {
    if (!this.keys.size || performance.now() - this.heard <= (this.repeats ? REPEAT_MS : FIRST_MS)) return;
    this.unrepeated = [...this.keys][0];
    this.keys.clear();
  }

  /** A menu or a drag would hide the release of a key. */
  refuse(begun) {
    this.letGo();
    if (this.wanted) begun.preventDefault();
  }

  /** Deflection counts from where the stick was touched, so that a change of the layout does not change a speed. */
  grip(event) {
    if (this.held || event.button > 0) return;
    this.stick.setPointerCapture(event.pointerId);
    this.unrepeated = "";
    this.held = { pointer: event.pointerId, x: event.clientX, y: event.clientY, reach: this.stick.clientWidth / 2 };
    this.push(event);
  }

  push(event) {
    const { reach } = this.held;
    let x = (event.clientX - this.held.x) / reach;
    let y = (event.clientY - this.held.y) / reach;
    const far = Math.max(1, Math.hypot(x, y));
    x /= far;
    y /= far;
    this.stickAt = { forward: beyond(-y), left: beyond(-x) };
    this.point(x, y);
  }

  point(x, y) {
    const reach = (this.stick.clientWidth / 2) * 0.7;
    const moved = x || y ? `translate(${x * reach}px, ${y * reach}px)` : "";
    if (this.knob.style.transform !== moved) this.knob.style.transform = moved;
  }

  /** Show what game pad and keys do on the stick and the keys of the page. */
  follow({ forward, left }) {
    if (!this.held) this.point(-left, -forward);
    for (const key of document.querySelectorAll("kbd")) mark(key, "held", key.dataset.keys.split(" ").some((code) => this.keys.has(code)));
  }

  release() {
    if (!this.held) return;
    this.held = this.stickAt = null;
    this.point(0, 0);
    this.tellIfFree();
  }

  letGo() {
    this.stuck = true;
    this.keys.clear();
    this.unrepeated = "";
    this.release();
    this.onLetGo();
  }

  /** Report a release at once, not with the next frame. */
  tellIfFree() {
    const inputs = this.look();
    if (inputs.forward === 0 && inputs.left === 0) this.onLetGo();
  }

  /** The first game pad whose layout is known. */
  pad() {
    let pads = [];
    try { pads = [...(navigator.getGamepads?.() ?? [])].filter((pad) => pad?.connected); } catch { /* withheld */ }
    return { pad: pads.find((pad) => pad.mapping === "standard") ?? null, strange: pads.length > 0 };
  }

  /** The buttons for STOP and for the speed that were pressed since the last call. */
  pressed() {
    const before = this.down;
    const { pad } = this.pad();
    this.down = new Set(pad ? [B, SLOWER, FASTER].filter((button) => pad.buttons[button]?.pressed) : []);
    return document.visibilityState === "visible" ? [...this.down].filter((button) => !before.has(button)) : [];
  }

  /** How this device drives. */
  hint() {
    return [this.pad().pad && "hold [A]", "drag the stick", touches() || "hold a key"].filter((text) => text && text !== true).join(", or ");
  }

  padText() {
    const { pad, strange } = this.pad();
    if (pad) {
      return pad.buttons[A]?.pressed ? `Game pad: ${this.stuck ? "let [A] go once" : "[A] held"}` : "Game pad: [B] STOP; hold [A]; RT forward, LT back, LJ turn; LB, RB speed";
    }
    if (!isSecureContext || !navigator.getGamepads) {
      return "Game pad withheld: browsers may refuse it to plain HTTP. Start with --tls-cert and --tls-key";
    }
    if (touches() && !strange) return "";
    return strange ? "Game pad not used: the browser does not know its layout" : "No game pad seen: press a button on it";
  }

  fromPad(pad) {
    if (!pad?.buttons[A]?.pressed) return null;
    return { forward: within((pad.buttons[RT]?.value ?? 0) - (pad.buttons[LT]?.value ?? 0)), left: within(-beyond(pad.axes[LJ_X] ?? 0)), by: "game pad" };
  }

  fromKeys(elapsed) {
    const sum = [0, 0];
    for (const code of this.keys) MOTIONS[code].forEach((part, index) => { sum[index] += part; });
    this.risen = sum[0] || sum[1] ? Math.min(1, this.risen + elapsed / RISE_MS) : 0;
    return { forward: within(sum[0]) * this.risen, left: within(sum[1]) * this.risen, by: this.keys.size ? "keys" : "" };
  }

  /** The inputs at this moment. */
  look() {
    this.listen();
    const now = performance.now();
    const elapsed = Math.min(now - this.looked, 50);
    this.looked = now;
    const { pad } = this.pad();
    const held = pad?.buttons[A]?.pressed ?? false;
    const away = document.visibilityState !== "visible" || !document.hasFocus();
    if (away || (pad?.index ?? null) !== this.padIndex) this.stuck = true;
    this.padIndex = pad?.index ?? null;
    if (this.stuck) this.stuck = away || held;
    if (this.stuck) return NEUTRAL;
    return this.fromPad(pad) ?? (this.stickAt ? { ...this.stickAt, by: "stick" } : this.fromKeys(elapsed));
  }
}
