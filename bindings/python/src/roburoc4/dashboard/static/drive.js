// SPDX-License-Identifier: MIT
// Control of the robot: taking it, arming, stopping, and sending the inputs with each frame.
import { by, figure, put, show } from "./text.js";
import { Inputs } from "./inputs.js";

const REFUSAL_MS = 8000;
const TAKES_SPACE = "input:not([type=range]), select, textarea";

export class Drive {
  constructor(send, onStop) {
    this.send = send;
    this.onStop = onStop;
    this.stopping = false; // STOP was pressed, and the dashboard has not confirmed it
    this.page = null;
    this.mine = false;
    this.tick = 0;
    this.offered = false;
    this.refusal = "";
    this.full = [[0, 0], [0, 0]];
    this.inputs = new Inputs(by("stick"), by("knob"), () => this.letGo());
    this.refusedAt = 0;
    this.going = false;
    for (const what of ["take", "leave", "disarm", "keep"]) by(what).addEventListener("click", () => this.ask({ type: what }));
    by("hand-over").addEventListener("click", () => this.ask({ type: "leave" }));
    by("arm").addEventListener("click", () => this.ask({ type: "arm", tick: this.tick }));
    by("stop").addEventListener("pointerdown", () => this.stop());
    // A press by key is a click without a pointerdown.
    by("stop").addEventListener("click", (event) => event.detail === 0 && this.stop());
    by("scale").addEventListener("input", () => this.showScale());
    addEventListener("keydown", (event) => this.key(event), true);
    addEventListener("keyup", (event) => this.stops(event) && event.preventDefault(), true);
    document.addEventListener("visibilitychange", () => this.hide());
  }

  begin(hello) {
    this.page = hello.page;
    this.offered = hello.enable_drive;
    this.mine = false;
    this.stopping &&= this.offered;
    if (this.stopping) this.send({ type: "stop" });
    show(by("stop"), this.offered);
    document.body.classList.toggle("drivable", this.offered);
    this.showScale();
  }

  describe(about) {
    this.full = [about.full_linear_m_s, about.full_angular_rad_s];
    this.showScale();
  }

  get scale() {
    return Number(by("scale").value) / 100;
  }

  showScale() {
    put(by("scale-text"), `${figure(this.scale * 100, 0, "%")}: ${figure(this.scale * Math.max(...this.full[0]), 2, "m/s")}`);
  }

  ask(message) {
    this.refusal = "";
    this.send(message);
  }

  /** An open connection loses nothing, so STOP is sent once on each until the dashboard has confirmed it. */
  stop() {
    if (!this.offered) return;
    this.stopping = true;
    this.ask({ type: "stop" });
    this.onStop();
  }

  stopped() {
    this.stopping = false;
  }

  /** Whether a key is the space bar, and nothing that has the focus uses it. */
  stops(event) {
    return event.code === "Space" && this.offered && !event.target.closest?.(TAKES_SPACE);
  }

  key(event) {
    if (event.code === "Escape") this.letGo();
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
    this.going = false;
    if (this.mine) this.send({ type: "drawn", tick: this.tick, input: { forward: 0, left: 0, scale: this.scale } });
  }

  /** Let the robot go to a place by itself, until any input of the driver ends that. */
  go({ x_m, y_m }) {
    this.going = true;
    this.ask({ type: "go", tick: this.tick, x_m, y_m, scale: this.scale });
  }

  refused(message) {
    this.refusal = message.text;
    this.refusedAt = performance.now();
  }

  silent(on) {
    for (const what of ["take", "arm", "disarm", "leave"]) by(what).disabled = on;
    if (on) this.mine = false;
  }

  /** Show a frame, and return the inputs if this page drives. */
  show(frame) {
    this.tick = frame.tick;
    this.mine = frame.driver !== null && frame.driver === this.page;
    this.inputs.wanted = this.mine;
    const armed = this.mine && frame.facts.armed;
    this.forgetRefusal(`${frame.driver} ${armed}`);
    put(by("control"), !this.offered ? "Watching only" : `Control: ${this.mine ? "this page" : frame.driver === null ? "nobody" : `page ${frame.driver}`}`);
    this.showButtons({ take: this.offered && !this.mine, arm: this.mine && !armed, disarm: armed, leave: this.mine });
    const asks = frame.asker !== null && frame.asker === this.page;
    put(by("take"), frame.driver === null ? "Take control" : asks ? "Asked" : "Ask for control");
    by("take").disabled = asks;
    by("arm").classList.toggle("go", !frame.facts.blocked);
    this.showAsker(frame.asker);
    document.body.classList.toggle("in-control", this.mine);
    document.body.classList.toggle("armed", armed);
    put(by("drive-why"), this.why(frame, armed));
    put(by("pad-text"), this.offered ? this.inputs.padText() : "");
    if (!this.mine) {
      put(by("asked"), "No speed is commanded.");
      return null;
    }
    const { forward, left, by: source } = this.inputs.look();
    if (forward || left || !armed) this.going = false;
    const scale = this.scale;
    const speed = (share, [low, high]) => share * scale * (share > 0 ? high : low);
    put(by("asked"), `${figure(speed(forward, this.full[0]), 2, "m/s")}, ${figure(speed(left, this.full[1]), 2, "rad/s")}${source ? ` by ${source}` : ""}${source && !armed ? ": not sent" : ""}`);
    return { forward, left, scale, going: this.going };
  }

  showAsker(asker) {
    const asked = this.mine && asker !== null;
    if (asked) put(by("asked-by").firstChild, `Page ${asker} asks for control.`);
    show(by("asked-by"), asked);
    show(by("drive-why"), !asked);
  }

  showButtons(wanted) {
    const focused = document.activeElement;
    for (const [what, on] of Object.entries(wanted)) show(by(what), on);
    // Users who press the buttons by key continue with the one that replaces theirs.
    if (focused?.hidden && focused.id in wanted) Object.keys(wanted).filter((what) => wanted[what]).map(by)[0]?.focus();
  }

  /** Show a refusal until the state changes, or long enough to read it. */
  forgetRefusal(state) {
    if (state !== this.state || performance.now() - this.refusedAt > REFUSAL_MS) this.refusal = "";
    this.state = state;
  }

  why(frame, armed) {
    if (!this.offered) return "Start roburoc4 dashboard with --enable-drive to drive from here.";
    if (this.refusal) return this.refusal;
    if (!this.mine) return frame.driver === null ? "One page at a time can drive: take control, then arm." : frame.asker === this.page ? `Page ${frame.driver} was asked. You get control when it agrees, or when it is gone.` : "Another page drives. STOP works from every page.";
    if (frame.going) return "The robot goes to the place on the map. Any key or deflection, Escape, or leaving this page ends that.";
    if (armed && frame.must_let_go) return "Armed: let go of everything once, then drive.";
    if (armed && this.inputs.unrepeated) return "Ready: the key stopped repeating, so it counts as released. Press it again. If the system does not repeat keys, drive with the game pad or the stick.";
    if (armed) return "Ready: hold [A] on the game pad, drag the stick, or hold a key. Letting go stops.";
    return frame.facts.blocked ? `Not ready to arm: ${frame.facts.blocked}.` : "Is the way clear, is the emergency stop in somebody’s hand? Then arm.";
  }
}
