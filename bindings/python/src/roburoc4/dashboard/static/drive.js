// SPDX-License-Identifier: MIT
// Control of the robot: taking it, arming, stopping, and sending the inputs with each frame.
import { by, figure, put, show } from "./text.js";
import { Inputs } from "./inputs.js";

const TAKES_SPACE = "input:not([type=range]), select, textarea";

export class Drive {
  constructor(send) {
    this.send = send;
    this.page = null;
    this.mine = false;
    this.tick = 0;
    this.offered = false;
    this.refusal = "";
    this.full = [[0, 0], [0, 0]];
    this.inputs = new Inputs(by("stick"), by("knob"), () => this.letGo());
    for (const what of ["take", "leave", "disarm"]) by(what).addEventListener("click", () => this.ask({ type: what }));
    by("arm").addEventListener("click", () => this.ask({ type: "arm", tick: this.tick }));
    by("stop").addEventListener("pointerdown", () => this.stop());
    // A click by key has no pointer before it.
    by("stop").addEventListener("click", (event) => event.detail === 0 && this.stop());
    by("scale").addEventListener("input", () => this.showScale());
    by("scale").addEventListener("change", () => by("scale").blur());
    addEventListener("keydown", (event) => this.key(event), true);
    addEventListener("keyup", (event) => this.stops(event) && event.preventDefault(), true);
    document.addEventListener("visibilitychange", () => this.hide());
  }

  begin(hello) {
    this.page = hello.page;
    this.offered = hello.allow_drive;
    this.mine = false;
    show(by("stop"), this.offered);
    document.body.classList.toggle("drivable", this.offered);
  }

  describe(about) {
    this.full = [about.full_linear_m_s, about.full_angular_rad_s];
    this.showScale();
  }

  get scale() {
    return Number(by("scale").value) / 100;
  }

  showScale() {
    put(by("scale-text"), `${figure(this.scale * 100, 0, "%")}: ${figure(this.scale * Math.max(...this.full[0]), 2, "m/s")}, ${figure(this.scale * Math.max(...this.full[1]), 2, "rad/s")}`);
  }

  ask(message) {
    this.refusal = "";
    document.activeElement?.blur();
    this.send(message);
  }

  stop() {
    if (this.offered) this.ask({ type: "stop" });
  }

  /** Whether a key is the space bar, and not meant for what it switches or writes in. */
  stops(event) {
    return event.code === "Space" && this.offered && !event.target.closest?.(TAKES_SPACE);
  }

  key(event) {
    if (!this.stops(event)) return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) this.stop();
  }

  hide() {
    if (this.mine && document.visibilityState !== "visible") {
      this.send({ type: "disarm", why: "the driver’s page was hidden" });
    }
  }

  letGo() {
    if (this.mine) this.send({ type: "drawn", tick: this.tick, input: { forward: 0, left: 0, scale: this.scale } });
  }

  refused(message) {
    this.refusal = message.text;
  }

  silent(on) {
    for (const what of ["take", "arm", "disarm", "leave"]) by(what).disabled = on;
    if (on) this.mine = false;
  }

  /** Show how it is, and return what the inputs want, if this page drives. */
  show(frame) {
    this.tick = frame.tick;
    this.mine = frame.driver !== null && frame.driver === this.page;
    this.inputs.wanted = this.mine;
    const armed = this.mine && frame.facts.armed;
    put(by("control"), !this.offered ? "watching only" : this.mine ? "you have control" : frame.driver === null ? "nobody has control" : `page ${frame.driver} drives`);
    show(by("take"), this.offered && !this.mine);
    by("take").disabled = frame.driver !== null;
    show(by("leave"), this.mine);
    show(by("arm"), this.mine && !armed);
    show(by("disarm"), armed);
    show(by("inputs"), this.mine);
    by("inputs").classList.toggle("armed", armed);
    document.body.classList.toggle("in-control", this.mine);
    put(by("drive-why"), this.why(frame, armed));
    if (!this.mine) return null;
    put(by("pad-text"), this.inputs.padText());
    const { forward, left, by: source } = this.inputs.look();
    const scale = this.scale;
    const speed = (share, [low, high]) => share * scale * (share > 0 ? high : low);
    put(by("asked"), `${figure(speed(forward, this.full[0]), 2, "m/s")}, ${figure(speed(left, this.full[1]), 2, "rad/s")}${source ? ` by ${source}` : ""}`);
    return { forward, left, scale };
  }

  why(frame, armed) {
    if (!this.offered) return "This page only watches. Start roburoc4 dashboard with --allow-drive to drive from it.";
    if (this.refusal) return this.refusal;
    if (!this.mine) return frame.driver === null ? "One page at a time can drive: take control, then arm." : "Somebody else drives. STOP works from every page.";
    if (frame.why) return frame.why;
    if (armed && frame.must_let_go) return "Armed: let go of everything once, then drive.";
    if (armed && this.inputs.unrepeated) return "Ready: the key no longer repeated, so it counts as let go. Press it anew. Where the system repeats no keys, drive with the game pad or the stick.";
    if (armed) return "Ready: hold [A] on the game pad, drag the stick, or hold a key. Letting go stops.";
    return frame.facts.blocked || "Is the way clear, is the emergency stop in somebody’s hand? Then arm.";
  }
}
