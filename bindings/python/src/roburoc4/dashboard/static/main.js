// SPDX-License-Identifier: MIT
// The page: each part draws itself from the frame that comes in.
import { by, figure, make, mark, put, show } from "./text.js";
import { Channels } from "./channels.js";
import { Dial } from "./dial.js";
import { Drive } from "./drive.js";
import { Link } from "./link.js";
import { Panel } from "./panel.js";
import { Plots } from "./plots.js";
import { RobotMap } from "./map.js";
import { showLamps, showSilence } from "./lamps.js";

const MOST_EVENTS = 200;
const SIGNS = { bad: "✕", weak: "!", good: "✓", plain: "·" };
const SERVICES = { iocard: "IO card", telemeter: "telemeters", battery: "battery", localization: "localization", differential: "speeds" };
const STATES = { charging: "charging", charged: "charged, still plugged in", ok: "in use", critical: "CRITICAL" };
const clock = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" });

// The cookie has it now; the address bar, and what is copied from there, should not.
if (location.search) history.replaceState(null, "", location.pathname);

let about = { everReady: false, telemeter: [] };
const send = (message) => link.send(message);
const drive = new Drive(send);
const panel = new Panel(send);
const map = new RobotMap(by("map"), (index, x, y) => panel.moveBox(index, x, y));
const plots = new Plots();
const channels = new Channels();
const dials = [
  new Dial(by("dial-linear"), { name: "linear", unit: "m/s", sign: 1, sides: ["backward", "forward"] }),
  new Dial(by("dial-angular"), { name: "turn", unit: "rad/s", sign: -1, sides: ["left +", "right −"] }),
];

// ---- what comes in ----

function hello(message) {
  put(by("address"), message.address);
  show(by("simulated"), message.simulated);
  show(by("sim-card"), message.simulated);
  document.title = `roburoc4 ${message.simulated ? "simulator" : message.address}`;
  put(by("version"), `roburoc4 ${message.version}, page ${message.page}`);
  if (message.simulated) panel.build();
  drive.begin(message);
  map.begin(message.path);
  plots.begin(message.speeds, message.battery);
  by("events").replaceChildren();
  addEvents(message);
}

function describe(message) {
  about = { ...message, everReady: about.everReady };
  channels.build(message.channels);
  drive.describe(message);
  const limits = message.differential;
  dials[0].setLimits(limits?.min_linear_m_s, limits?.max_linear_m_s, message.full_linear_m_s);
  dials[1].setLimits(limits?.min_angular_rad_s, limits?.max_angular_rad_s, message.full_angular_rad_s);
  put(by("dials-note"), limits ? `robot’s limits ${figure(limits.min_linear_m_s, 1)} to ${figure(limits.max_linear_m_s, 1, "m/s")}, ${figure(limits.min_angular_rad_s, 1)} to ${figure(limits.max_angular_rad_s, 1, "rad/s")}` : "");
}

function addEvents({ events }) {
  const list = by("events");
  for (const { time_s, level, text } of events) {
    const node = make("li", "", "", make("time", "", clock.format(time_s * 1000)), make("i", "", SIGNS[level]), make("span", "", text));
    node.dataset.level = level;
    list.prepend(node);
  }
  while (list.childElementCount > MOST_EVENTS) list.lastElementChild.remove();
}

// ---- what is drawn with each frame ----

const lossText = (share) => figure(share === null ? null : share * 100, 1, "%");

function showQuality(frame) {
  const { level, say, round_trip_ms, loss } = frame.link;
  mark(by("quality"), "level", level);
  put(by("quality-say"), say);
  const newest = Math.min(...Object.values(frame.link.services).map(({ age_ms }) => age_ms ?? Infinity));
  put(by("quality-figures"), frame.state === "ready" ? `${figure(round_trip_ms, 1, "ms")} round trip · ${lossText(loss)} lost · ${figure(newest, 0, "ms")} old` : "");
}

function showLink(frame) {
  const { say, attempt, services, silence_ms, round_trip_ms, loss } = frame.link;
  put(by("link-say"), say);
  put(by("link-try"), attempt ? `Try: ${attempt}.` : "");
  put(by("link-figures"), `${frame.state} · round trip ${figure(round_trip_ms, 1, "ms")} · loss ${lossText(loss)} · silent for ${figure(silence_ms, 0, "ms")}`);
  const rows = by("services");
  if (!rows.childElementCount) {
    rows.append(...Object.keys(services).map((name) => make("tr", "", "", make("th", "", SERVICES[name]), make("td"), make("td"), make("td"), make("td"))));
  }
  Object.values(services).forEach(({ period_ms, age_ms, loss: lost, jitter_ms }, index) => {
    const [, every, age, share, jitter] = rows.children[index].children;
    put(every, figure(period_ms, 0, "ms"));
    put(age, figure(age_ms, 0, "ms"));
    put(share, lossText(lost));
    put(jitter, figure(jitter_ms, 1, "ms"));
  });
}

function showBattery({ battery }) {
  const gauge = by("gauge");
  mark(gauge, "state", battery?.state ?? "unknown");
  if (!battery) {
    put(by("gauge-text"), "not reported");
    return;
  }
  const low = about.battery?.minimum_percent ?? 0;
  mark(gauge, "low", battery.percent <= low || battery.state === "critical" ? "yes" : "no");
  by("gauge-fill").style.width = `${Math.max(0, Math.min(100, battery.percent))}%`;
  by("gauge-least").style.left = `${low}%`;
  put(by("gauge-text"), figure(battery.percent, 0, "%"));
  put(by("battery-state"), STATES[battery.state] ?? battery.state);
  put(by("battery-text"), [battery.volts === null ? "" : figure(battery.volts, 1, "V"), trend(battery, low), low ? `least ${figure(low, 0, "%")}` : ""].filter(Boolean).join(" · "));
}

function trend({ trend_percent_h: slope, percent }, low) {
  if (slope === null) return "trend: known after a minute";
  if (Math.abs(slope) < 0.5) return "→ steady";
  const hours = slope > 0 ? (100 - percent) / slope : (percent - low) / -slope;
  const left = hours > 48 || hours <= 0 ? "" : `, ${hours < 1.5 ? figure(hours * 60, 0, "min") : figure(hours, 1, "h")} to ${slope > 0 ? "full" : "its least"}`;
  return `${slope > 0 ? "↗ +" : "↘ "}${figure(slope, 0, "% per hour")}${left}`;
}

function drawFrame(frame) {
  document.body.classList.toggle("stale", frame.state !== "ready");
  about.everReady ||= frame.state === "ready";
  const inputs = drive.show(frame);
  showLamps(frame, drive, about);
  showQuality(frame);
  showLink(frame);
  showBattery(frame);
  dials[0].show(frame.speeds?.[1] ?? null, frame.speeds?.[0] ?? null);
  dials[1].show(frame.speeds?.[3] ?? null, frame.speeds?.[2] ?? null);
  map.show(frame, about);
  plots.show(frame);
  channels.show(frame);
  if (frame.sim) panel.show(frame.sim);
  put(by("pages"), `${frame.pages} ${frame.pages === 1 ? "page" : "pages"} open`);
  return inputs;
}

function silent(on, why) {
  document.body.classList.toggle("silent", on);
  drive.silent(on);
  if (!on) return;
  showSilence(why);
  mark(by("quality"), "level", "bad");
  put(by("quality-say"), "no connection to the dashboard");
  put(by("quality-figures"), "");
}

const link = new Link({ hello, about: describe, events: addEvents, refused: (message) => drive.refused(message) }, drawFrame, silent);
