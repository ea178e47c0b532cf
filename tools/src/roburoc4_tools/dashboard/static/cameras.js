// SPDX-License-Identifier: MIT
// Pictures of the operator's own camera servers, beside the map. The dashboard passes them on, so that their
// age is known: a picture that is old says so, and a camera that shows nothing gives its room back.
import { by, figure, make, mark, put, show } from "./text.js";

const OLD_MS = 1000;
const DEAD_MS = 10000;
const PAUSE_MS = 500;

let feeds = [];

class Feed {
  constructor({ name }, index) {
    this.name = name;
    this.path = `/camera/${index}`;
    this.number = 0;
    this.at = performance.now();
    this.picture = make("img");
    this.picture.alt = `camera ${name}`;
    this.caption = make("figcaption", "", name);
    this.large = make("button", "quiet", "large");
    this.large.setAttribute("aria-label", `camera ${name} large, map small`);
    const toggle = () => this.large.setAttribute("aria-pressed", String(by("stage").classList.toggle("camera-first")));
    this.node = make("figure", "", "", this.picture, this.caption, this.large);
    this.node.addEventListener("click", toggle);
    this.look();
  }

  async look() {
    let shown = false;
    try {
      const answer = await fetch(`${this.path}?after=${this.number}`);
      if (answer.status === 200) {
        this.number = answer.headers.get("X-Picture");
        const url = URL.createObjectURL(await answer.blob());
        this.picture.src = url;
        await this.picture.decode();
        URL.revokeObjectURL(url);
        this.at = performance.now();
        shown = true;
      }
    } catch { /* no connection, or no picture */ }
    if (this.ended) return;
    setTimeout(() => this.look(), shown && document.visibilityState === "visible" ? 0 : PAUSE_MS);
  }

  showAge() {
    const age = performance.now() - this.at;
    const state = age > DEAD_MS ? "dead" : age > OLD_MS ? "old" : "live";
    mark(this.node, "state", state);
    put(this.caption, state === "live" ? this.name : `${this.name}: no new picture for ${figure(age / 1000, 0, "s")}`);
  }
}

export function showCameras(cameras) {
  const key = JSON.stringify(cameras);
  if (by("cameras").dataset.key === key) return;
  by("cameras").dataset.key = key;
  for (const feed of feeds) feed.ended = true;
  feeds = cameras.map((camera, index) => new Feed(camera, index));
  show(by("cameras"), cameras.length > 0);
  by("cameras").replaceChildren(...feeds.map(({ node }) => node));
}

setInterval(() => {
  for (const feed of feeds) feed.showAge();
  mark(by("cameras"), "state", feeds.every(({ node }) => node.dataset.state === "dead") ? "dead" : "live");
}, 250);
