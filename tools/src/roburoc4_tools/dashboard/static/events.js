// SPDX-License-Identifier: MIT
// What happened, newest first: filtered by severity and by words, and downloaded as CSV.
import { by, make, put, save, show } from "./text.js";

const MOST = 200;
const SIGNS = { bad: "✕", weak: "!", good: "✓", plain: "·" };
const clock = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" });

export class Events {
  constructor() {
    this.events = [];
    by("events-level").addEventListener("change", () => this.filter());
    by("events-text").addEventListener("input", () => this.filter());
    by("events-export").addEventListener("click", () => this.export());
  }

  begin(message) {
    this.events = [];
    by("events").replaceChildren();
    this.add(message);
  }

  add({ events }) {
    for (const event of events) {
      const { time_s, level, text } = event;
      const time = make("time", "", clock.format(time_s * 1000));
      time.dateTime = new Date(time_s * 1000).toISOString();
      const sign = make("i", "", SIGNS[level]);
      sign.setAttribute("aria-hidden", "true");
      const node = make("li", "", "", time, sign, make("span", "", text));
      node.dataset.level = level;
      by("events").prepend(node);
      this.events.unshift({ ...event, node });
    }
    for (const { node } of this.events.splice(MOST)) node.remove();
    this.filter();
  }

  get shown() {
    const [level, text] = [by("events-level").value, by("events-text").value.trim().toLowerCase()];
    return this.events.filter((event) => (level === "all" || event.level === "bad" || event.level === level) && event.text.toLowerCase().includes(text));
  }

  filter() {
    const shown = new Set(this.shown);
    for (const event of this.events) show(event.node, shown.has(event));
    show(by("events-none"), !shown.size);
    put(by("events-none"), this.events.length ? "No event fits the filter." : "What happens to the robot and its link is listed here with its time: warnings, arming, stops, who takes control.");
    by("events-export").disabled = !shown.size;
  }

  export() {
    const lines = this.shown.map(({ time_s, level, text }) => [new Date(time_s * 1000).toISOString(), level, `"${text.replaceAll('"', '""')}"`].join());
    save("roburoc4-events.csv", ["time,level,text", ...lines].join("\n") + "\n");
  }
}
