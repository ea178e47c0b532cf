// SPDX-License-Identifier: MIT
// Link and battery: a word and a number at the top, all numbers in their tab.
import { by, figure, make, mark, put } from "./text.js";

const SERVICES = { iocard: "IO card", telemeter: "telemeters", battery: "battery", localization: "localization", differential: "speeds" };
const STATES = { charging: "Charging", charged: "Charged, still plugged in", ok: "In use", critical: "CRITICAL" };

const LINKS = { lost: "Lost", idle: "Off", connecting: "Connecting", discovering: "Connecting", subscribing: "Connecting" };

const lossText = (share) => figure(share === null ? null : share * 100, 1, "%");

export function showLink(frame) {
  const { level, say, attempt, services, silence_ms, round_trip_ms, loss } = frame.link;
  mark(by("quality"), "level", level);
  const silent = frame.state === "lost" ? ` ${silence_ms < 100000 ? figure(silence_ms / 1000, 0, "s") : figure(silence_ms / 60000, 0, "min")}` : "";
  put(by("quality-say"), (LINKS[frame.state] ?? `Link ${level}`) + silent);
  put(by("link-say"), say);
  put(by("quality-figures"), frame.state === "ready" ? figure(round_trip_ms, 0, "ms") : "");
  put(by("link-try"), attempt ? `Try: ${attempt}.` : "");
  put(by("link-figures"), `${frame.state} · round trip ${figure(round_trip_ms, 1, "ms")} · loss ${lossText(loss)} · silent for ${figure(silence_ms, 0, "ms")}`);
  const rows = by("services");
  if (!rows.childElementCount) {
    rows.append(...Object.keys(services).map((name) => {
      const row = make("tr", "", "", make("th", "", SERVICES[name]), make("td"), make("td"), make("td"), make("td"));
      row.firstChild.scope = "row";
      return row;
    }));
  }
  Object.entries(services).forEach(([name, { period_ms, age_ms, loss: lost, jitter_ms }], index) => {
    const [, every, age, share, jitter] = rows.children[index].children;
    put(every, frame.facts.missing.includes(name) ? "not sent" : figure(period_ms, 0, "ms"));
    put(age, figure(age_ms, 0, "ms"));
    put(share, lossText(lost));
    put(jitter, figure(jitter_ms, 1, "ms"));
  });
}

export function showNoLink() {
  mark(by("quality"), "level", "bad");
  put(by("quality-say"), "No dashboard");
  put(by("quality-figures"), "");
  put(by("link-say"), "not known: there is no connection to the dashboard, and the values below are old");
  for (const what of ["link-try", "link-figures"]) put(by(what), "");
}

export function showBattery({ battery }, about) {
  const low = about.battery?.minimum_percent ?? 0;
  const critical = battery?.state === "critical";
  mark(by("battery"), "level", critical ? "bad" : battery && battery.percent <= low ? "weak" : "calm");
  put(by("gauge-text"), battery ? `${figure(battery.percent, 0, "%")}${/charg/.test(battery.state) ? " ⚡" : ""}` : "–");
  by("gauge-fill").style.width = `${Math.max(0, Math.min(100, battery?.percent ?? 0))}%`;
  put(by("battery-state"), battery ? STATES[battery.state] ?? battery.state : "Not reported");
  put(by("battery-text"), battery ? [battery.volts === null ? "" : figure(battery.volts, 1, "V"), trend(battery, low), low ? `minimum ${figure(low, 0, "%")}` : ""].filter(Boolean).join(" · ") : "");
}

function trend({ trend_percent_h: slope, percent }, low) {
  if (slope === null) return "trend: known after a minute";
  if (Math.abs(slope) < 0.5) return "→ steady";
  const hours = slope > 0 ? (100 - percent) / slope : (percent - low) / -slope;
  const left = hours > 48 || hours <= 0 ? "" : `, ${hours < 1.5 ? figure(hours * 60, 0, "min") : figure(hours, 1, "h")} to ${slope > 0 ? "full" : "the minimum"}`;
  return `${slope > 0 ? "↗ +" : "↘ "}${figure(slope, 0, "% per hour")}${left}`;
}
