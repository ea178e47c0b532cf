// SPDX-License-Identifier: MIT
// The page: each part draws itself from the frame that comes in.
import { by, put, show } from "./text.js";
import { showBanner, showSilence } from "./banner.js";
import { Channels } from "./channels.js";
import { Drawer } from "./drawer.js";
import { Drive } from "./drive.js";
import { Events } from "./events.js";
import { Fleet } from "./fleet.js";
import { Link } from "./link.js";
import { Panel } from "./panel.js";
import { Plots } from "./plots.js";
import { Recording } from "./record.js";
import { Past } from "./past.js";
import { Place } from "./place.js";
import { RobotMap } from "./map.js";
import { showCameras } from "./cameras.js";
import { Speed } from "./speeds.js";
import { showBattery, showLink, showNoLink } from "./status.js";

// The token is in the cookie now. It should not stay in the address bar, from where links are copied.
if (location.search) history.replaceState(null, "", location.pathname);

let about = { everReady: false, telemeter: [], name: "" };
const send = (message) => link.send(message);
const speeds = [
  new Speed(by("speed-linear"), { name: "Speed", unit: "m/s", sign: 1, sides: ["back", "forward"] }),
  new Speed(by("speed-angular"), { name: "Turn", unit: "rad/s", sign: -1, sides: ["left +", "right −"] }),
];
const drive = new Drive(send, () => link.lookAgain(), (full) => full.forEach((sides, index) => speeds[index].setFull(sides)));
const panel = new Panel(send);
const place = new Place((what, pose) => (what === "go" ? drive.go(pose) : send({ type: what, ...pose })));
const events = new Events();
const recording = new Recording(send);
const fleet = new Fleet((name) => link.use(name));
const map = new RobotMap(by("map"), send, place, (index, x, y) => panel.moveBox(index, x, y));
const plots = new Plots();
const drawer = new Drawer((name) => name === "plots" && plots.wake());
const channels = new Channels();
const past = new Past((time_s) => {
  map.past = time_s;
  plots.look(time_s);
  if (time_s === null) delete by("map").dataset.past;
}, () => Math.min(...[map.path[0]?.[2], plots.times[0]].filter(Boolean)));

addEventListener("keydown", ({ code, repeat }) => {
  if (code !== "Escape" || repeat) return; // one that is held closes one thing
  const signals = document.querySelector(".signals");
  if (drive.going) drive.letGo();
  else if (place.active) place.begin("");
  else if (!by("past").hidden) past.open(false);
  else if (signals.open) signals.open = false;
  else drawer.close();
});

// After a press, arrow keys drive again instead of moving the slider.
addEventListener("pointerup", () => document.activeElement?.matches("input[type=range]") && document.activeElement.blur());

// ---- the page's name ----

/** What people call this device, until they give it a name. */
function device() {
  const agent = navigator.userAgent;
  const browser = ["Firefox", "Edg", "Chrome", "Safari"].find((name) => agent.includes(name)) ?? "browser";
  const kind = [["phone", /iPhone|Mobile/], ["tablet", /iPad|Android/], ["Windows", /Windows/], ["Mac", /Mac/]].find(([, of]) => of.test(agent));
  return `${browser} on ${kind?.[0] ?? "Linux"}`;
}

const named = by("page-name");
try { named.value = localStorage.getItem("name") ?? ""; } catch { /* as the device */ }
named.placeholder = device();
const nameOfPage = () => named.value.trim() || device();
named.addEventListener("change", () => {
  try { localStorage.setItem("name", named.value.trim()); } catch { /* for this time only */ }
  drive.call(nameOfPage());
});

// ---- messages ----

function hello(message) {
  drive.call(nameOfPage());
  put(by("name"), message.name || message.address);
  put(by("address"), message.address);
  show(by("address"), message.name !== "");
  about.simulated = message.simulated;
  show(by("tab-sim"), message.simulated);
  document.title = `${message.name || "roburoc4"} ${message.simulated ? "simulator" : message.address}`;
  put(by("version"), `roburoc4 ${message.version}`);
  if (message.simulated) panel.build();
  if (message.name !== about.name) about = { ...about, everReady: false, name: message.name };
  drive.begin(message);
  map.begin(message);
  plots.begin(message.speeds, message.battery);
  events.begin(message);
  recording.begin(message);
  fleet.begin(message);
  showCameras(message.cameras);
}

function describe(message) {
  about = { ...message, everReady: about.everReady, name: about.name, simulated: about.simulated };
  put(by("kind"), about.simulated ? "simulator" : message.recorded ? "replayed" : "real");
  show(by("kind"), true);
  plots.describe(message);
  channels.build(message.channels);
  const limits = message.differential;
  speeds[0].setLimits(limits?.min_linear_m_s, limits?.max_linear_m_s, message.full_linear_m_s);
  speeds[1].setLimits(limits?.min_angular_rad_s, limits?.max_angular_rad_s, message.full_angular_rad_s);
  drive.describe(message);
}

// ---- frames ----

function drawFrame(frame) {
  document.body.classList.toggle("stale", frame.state !== "ready");
  about.everReady ||= frame.state === "ready";
  const inputs = drive.show(frame);
  showBanner(frame, drive, about);
  showLink(frame);
  showBattery(frame, about);
  speeds[0].show(frame.speeds?.[1] ?? null, frame.speeds?.[0] ?? null);
  speeds[1].show(frame.speeds?.[3] ?? null, frame.speeds?.[2] ?? null);
  place.show(frame, drive.mine, drive.scale * drive.full[0][1]);
  past.show(frame);
  map.show(frame, about);
  recording.show(frame.recording);
  fleet.show(frame.fleet);
  plots.show(frame, drawer.open === "plots");
  if (drawer.open === "io") channels.show(frame);
  if (frame.sim) panel.show(frame.sim);
  put(by("pages"), `${frame.pages} ${frame.pages === 1 ? "page" : "pages"} open`);
  return inputs;
}

function silent(on, why) {
  document.body.classList.toggle("silent", on);
  drive.silent(on);
  recording.silent(on);
  if (!on) return;
  place.silent();
  showSilence(why, drive.stopping);
  showNoLink();
  // After a failure of the network, TCP may hold back what was sent on the old connection for a minute.
  if (drive.stopping && link.open) link.reconnect();
}

const link = new Link({ hello, about: describe, events: (message) => events.add(message), trail: (message) => map.begin(message), refused: (message) => drive.refused(message), stopped: () => drive.stopped() }, drawFrame, silent);
