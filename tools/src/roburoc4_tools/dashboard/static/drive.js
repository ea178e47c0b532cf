// SPDX-License-Identifier: MIT
// Control of the robot: taking it, arming, stopping, and sending the inputs with each frame.
import { by, figure, mark, put, show } from "./text.js";
import { B, FASTER, Inputs } from "./inputs.js";
import { RECORDED } from "./states.js";

const REFUSAL_MS = 8000;
const TAKES_SPACE = "input:not([type=range]), select, textarea";

/** Disarmed, armed or driving: in a place of its own, which no alarm takes. */
function showMode(mode) {
  put(by("mode"), mode.toUpperCase());
  mark(by("mode"), "mode", mode);
}

export class Drive {
  /** onScale: called with the speeds that full deflection gives. */
  constructor(send, onStop, onScale) {
    this.send = send;
    this.onStop = onStop;
    this.onScale = onScale;
    this.urgent = true; // a robot may have to be stopped
    this.relieves = false;
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
    for (const what of ["disarm", "keep"]) by(what).addEventListener("click", () => this.ask({ type: what }));
    by("take").addEventListener("click", () => this.ask({ type: this.relieves ? "relieve" : "take" }));
    // It stands where "Take control" was: the second click of a double click means nothing.
    by("leave").addEventListener("click", (event) => event.detail < 2 && this.ask({ type: "leave" }));
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
    this.name = hello.name;
    this.offered = hello.enable_drive;
    this.mine = false;
    this.stopping &&= this.offered;
    if (this.stopping) this.send({ type: "stop" });
    show(by("stop"), this.offered);
    document.body.classList.toggle("drivable", this.offered);
    this.showScale();
  }

  /** Tell the dashboard how this page is called. */
  call(name) {
    if (name) this.send({ type: "name", name });
  }

  describe(about) {
    this.full = [about.full_linear_m_s, about.full_angular_rad_s];
    this.recorded = about.recorded;
    this.showScale();
  }

  get scale() {
    return Number(by("scale").value) / 100;
  }

  showScale() {
    put(by("scale-text"), `${figure(this.scale * 100, 0, "%")}: ${figure(this.scale * Math.max(...this.full[0]), 2, "m/s")}`);
    this.onScale(this.full.map((sides) => sides.map((side) => side * this.scale)));
  }

  /** By the game pad: a step up or down. */
  step(way) {
    by("scale").value = Number(by("scale").value) + way * Number(by("scale").step);
    this.showScale();
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

  /** Whether a key is the space bar: it stops from every field while there may be something to stop. */
  stops(event) {
    return event.code === "Space" && this.offered && (this.urgent || !event.target.closest?.(TAKES_SPACE));
  }

  key(event) {
    // A key that is still held does not press the button that takes the place of the first.
    if (event.code === "Enter" && event.repeat && event.target.matches?.("button")) event.preventDefault();
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
  go({ x_m, y_m, clearance_m }) {
    this.going = true;
    this.ask({ type: "go", tick: this.tick, x_m, y_m, clearance_m, scale: this.scale });
  }

  refused(message) {
    this.refusal = message.text;
    this.refusedAt = performance.now();
  }

  silent(on) {
    for (const what of ["take", "arm", "disarm", "leave"]) by(what).disabled = on;
    if (!on) return;
    this.mine = false;
    this.urgent = true;
    this.showAsker({ asker: null });
    showMode("unknown");
    put(by("control").lastChild, "not known");
    put(by("drive-why"), "Nothing can be driven from here: there is no connection to the dashboard.");
    put(by("asked"), "");
    put(by("pad-text"), "");
    this.inputs.letGo();
    this.inputs.follow({ forward: 0, left: 0 });
  }

  /** Show a frame, and return the inputs if this page drives. */
  show(frame) {
    this.tick = frame.tick;
    this.mine = frame.driver !== null && frame.driver === this.page;
    this.inputs.wanted = this.mine;
    this.urgent = frame.facts.armed || frame.facts.at_rest !== true || frame.fleet.some((robot) => robot.armed);
    this.relieves = !this.mine && frame.relievable;
    for (const button of this.inputs.pressed()) {
      if (button === B) this.stop();
      else this.step(button === FASTER ? 1 : -1);
    }
    const armed = this.mine && frame.facts.armed;
    this.forgetRefusal(`${frame.driver} ${armed} ${frame.facts.blocked}`);
    put(by("control").lastChild, !this.offered ? "watching only" : this.mine ? "this page" : frame.driver_name ?? "nobody");
    showMode(frame.state !== "ready" ? "lost" : frame.facts.driving ? "driving" : frame.facts.armed ? "armed" : "disarmed");
    this.showButtons({ take: this.offered && !this.mine, arm: this.mine && !armed, disarm: armed, leave: this.mine });
    const asks = frame.asker !== null && frame.asker === this.page;
    put(by("take"), frame.driver === null ? "Take control" : this.relieves ? "Relieve" : asks ? "Asked" : "Ask for control");
    by("take").disabled = asks && !this.relieves;
    put(by("arm"), frame.fleet.length > 1 ? `Arm ${this.name}` : "Arm");
    by("arm").classList.toggle("go", !frame.facts.blocked && !this.recorded);
    by("arm").disabled = this.recorded;
    this.showAsker(frame);
    document.body.classList.toggle("in-control", this.mine);
    document.body.classList.toggle("armed", armed);
    put(by("drive-why"), this.why(frame, armed));
    put(by("pad-text"), this.offered ? this.inputs.padText() : "");
    if (!this.mine) {
      put(by("asked"), "This page commands no speed.");
      this.inputs.follow({ forward: 0, left: 0 });
      return null;
    }
    const { forward, left, by: source } = this.inputs.look();
    this.inputs.follow({ forward, left });
    if (forward || left || !armed) this.going = false;
    const scale = this.scale;
    const speed = (share, [low, high]) => share * scale * (share > 0 ? high : low);
    const sent = armed && frame.facts.driving && !frame.must_let_go;
    put(by("asked"), !source ? "No input." : !sent ? `${source}: not sent` : `${figure(speed(forward, this.full[0]), 2, "m/s")}, ${figure(speed(left, this.full[1]), 2, "rad/s")} by ${source}`);
    return { forward, left, scale, going: this.going };
  }

  showAsker({ asker, asker_name }) {
    const asked = this.mine && asker !== null;
    if (asked) put(by("asked-by").firstChild, `Page “${asker_name}” wants to drive. Hand over stops and disarms.`);
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
    if (frame.state !== "ready") return "Nothing can be driven: the robot does not answer.";
    if (this.recorded) return RECORDED;
    if (!this.mine) return frame.driver === null ? "One page at a time can drive: take control, then arm." : frame.asker === this.page ? `Page “${frame.driver_name}” was asked. You get control when it agrees, or when it is gone.` : `“${frame.driver_name}” has control${this.relieves ? " and drives nothing." : ". STOP works from every page."}`;
    if (frame.going) return "Any key, any deflection, or leaving this page ends the drive.";
    if (armed && frame.must_let_go) return "Armed: let go of everything once, then drive.";
    if (armed && this.inputs.unrepeated) return "Ready: the key stopped repeating, so it counts as released. Press it again, or drive with the game pad or the stick.";
    if (armed) return `Ready: ${this.inputs.hint()}. Letting go stops.`;
    if (frame.facts.blocked) return `Not ready to arm: ${frame.facts.blocked}.`;
    return frame.facts.charger ? "The charger is plugged in: switch charger and platform off and unplug it, then arm." : "Is the way clear, an emergency stop in hand? Then arm.";
  }
}
