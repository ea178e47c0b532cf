// SPDX-License-Identifier: MIT
// The WebSocket. Each frame that was drawn is answered with its tick; the driver's inputs
// are sent with it. A page that is hidden or frozen draws nothing, so it answers nothing.

const RETRY_MS = 1000;
const CONNECT_MS = 3000; // a browser alone may wait half a minute after an outage
const SILENCE_MS = 1000;
const SAYS_WHY = [1008, 1013]; // refused what the page sent; too many pages
const REFUSED = 403;

export class Link {
  /** handlers: by type of message; frame: draws, returns the inputs or null; silent: called with true or false, and why. */
  constructor(handlers, frame, silent) {
    this.handlers = handlers;
    this.frame = frame;
    this.silent = silent;
    this.heard = -Infinity;
    this.latest = null;
    this.wasSilent = null;
    this.why = "";
    this.robot = decodeURIComponent(location.hash.slice(1));
    this.connect();
    setInterval(() => {
      this.look();
      if (this.connecting && performance.now() - this.begun > CONNECT_MS) this.reconnect();
    }, 200);
    addEventListener("pagehide", () => this.socket?.close());
    addEventListener("pageshow", (event) => event.persisted && this.connect());
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/socket?robot=${encodeURIComponent(this.robot)}`);
    this.socket = socket;
    this.begun = performance.now();
    socket.addEventListener("message", (event) => socket === this.socket && this.hear(event.data));
    socket.addEventListener("close", (closed) => {
      if (socket !== this.socket) return;
      this.socket = null;
      this.latest = null;
      this.heard = -Infinity;
      this.look();
      setTimeout(() => this.socket ?? this.connect(), RETRY_MS);
      this.askWhy(closed);
    });
  }

  /** Show another robot. The new connection ends the control of the one before. */
  use(robot) {
    if (robot === this.robot) return;
    this.robot = robot;
    location.hash = encodeURIComponent(robot);
    this.reconnect();
  }

  reconnect() {
    this.latest = null;
    this.socket?.close();
    this.connect();
  }

  get open() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  get connecting() {
    return this.socket?.readyState === WebSocket.CONNECTING;
  }

  /** A refused WebSocket gives a page no reason; a refused request does. */
  async askWhy({ code, reason }) {
    let why = SAYS_WHY.includes(code) ? reason : "";
    if (!why) {
      const answer = await fetch("/", { cache: "no-store" }).catch(() => null);
      if (answer?.status === REFUSED) why = await answer.text().catch(() => "");
    }
    if (why === this.why) return;
    this.why = why;
    this.lookAgain();
  }

  hear(text) {
    const message = JSON.parse(text);
    if (message.type !== "frame") {
      this.handlers[message.type]?.(message);
      return;
    }
    this.heard = performance.now();
    this.why = "";
    const asked = this.latest !== null;
    this.latest = message;
    if (!asked) requestAnimationFrame(() => this.drawLatest());
  }

  drawLatest() {
    const frame = this.latest;
    this.latest = null;
    if (frame === null) return;
    this.look();
    const input = this.frame(frame);
    this.send(input ? { type: "drawn", tick: frame.tick, input } : { type: "drawn", tick: frame.tick });
  }

  /** Send it now or not at all: later it would be out of date. */
  send(message) {
    if (this.open) this.socket.send(JSON.stringify(message));
  }

  lookAgain() {
    this.wasSilent = null;
    this.look();
  }

  look() {
    const silent = performance.now() - this.heard > SILENCE_MS;
    if (silent !== this.wasSilent && document.visibilityState === "visible") {
      this.wasSilent = silent;
      this.silent(silent, this.why.trim());
    }
  }
}
