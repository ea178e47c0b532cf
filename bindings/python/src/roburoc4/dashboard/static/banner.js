// SPDX-License-Identifier: MIT
// The most urgent condition in words, with what to try, and the others beside it by name. The place never
// changes its size: nothing moves when a condition comes or goes.
import { by, make, mark, put } from "./text.js";

const end = (text) => (text ? text[0].toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".") : "");
const advice = ({ say, attempt }) => end(say) + (attempt ? ` Try: ${attempt}.` : "");

const STILL = 0.02; // m/s, rad/s
const atRest = (speeds) => speeds !== null && speeds.every((speed) => speed !== null && Math.abs(speed) < STILL);

/** All conditions that hold, most urgent first: [level, title, text]. */
function conditions(frame, { mine, offered }, about) {
  const { facts, link, state, battery, why } = frame;
  const found = [];
  const add = (on, level, title, text) => on && found.push([level, title, text]);
  if (state !== "ready") {
    return [[link.level === "weak" ? "weak" : "bad", state === "lost" || about.everReady ? "ROBOT LOST" : "NO ROBOT YET", advice(link)]];
  }
  const bumpers = [facts.front_bumper && "FRONT", facts.rear_bumper && "REAR"].filter(Boolean).join(" AND ");
  add(facts.other_commander, "bad", "ANOTHER COMMANDER", "Another program commands the robot, too. Two drivers at once are dangerous: end one of them.");
  add(bumpers, "bad", `${bumpers} BUMPER`, "The robot touches something there: check what it is, then drive away from it.");
  add(facts.inhibited, "bad", "MOTION INHIBITED", `${end(why) || "The robot does not follow its commands."} Check emergency stops, brakes selector and bumpers.`);
  add(facts.overridden, "bad", "OVERRIDE", "Somebody holds [A] on the robot’s game pad and drives it. Commands from here are ignored.");
  add(facts.stop_unconfirmed && !facts.armed && !atRest(frame.speeds), "bad", "STOP NOT CONFIRMED", "The robot was sent zeros, but did not confirm them: watch it, and press its emergency stop if it moves.");
  add(battery?.state === "critical", "bad", "BATTERY CRITICAL", "Stop work and bring the robot to its charger now.");
  add(link.level === "bad", "bad", "LINK BAD", advice(link));
  add(facts.battery_low && battery?.state !== "critical", "weak", "BATTERY LOW", "Bring the robot to its charger. Charger and platform off before plugging it in.");
  add(link.level === "weak", "weak", "LINK WEAK", advice(link));
  add(mine && facts.armed && why, "weak", "STOPPED", end(why));
  if (facts.armed) add(true, "go", facts.driving ? "DRIVING" : "ARMED", frame.going ? "The robot goes by itself to the place on the map." : mine ? "Letting go stops the robot." : "The robot accepts speeds from another page.");
  else add(true, "calm", "DISARMED", end(mine ? why || facts.blocked : "") || (offered ? "The robot accepts no speed from here." : "This page only watches."));
  return found;
}

let announced = "";

function showConditions([first, ...others]) {
  const [level, title, text] = first;
  mark(by("banner"), "level", level);
  put(by("banner-title"), title);
  put(by("banner-text"), text);
  const more = others.filter(([of]) => of === "bad" || of === "weak");
  const names = more.map(([of, name]) => `${of}:${name}`).join();
  if (by("banner-more").dataset.names !== names) {
    by("banner-more").dataset.names = names;
    by("banner-more").replaceChildren(...more.map(([of, name]) => {
      const node = make("li", "", name);
      node.dataset.level = of;
      return node;
    }));
  }
  announce(level, title, text);
}

/** Let a screen reader speak when the condition changes, not when a number in its text does. */
function announce(level, title, text) {
  if (title === announced) return;
  const calm = announced === "" && level === "calm";
  announced = title;
  put(by("spoken"), calm || title === "DRIVING" ? "" : `${title}. ${text}`);
}

export const showBanner = (frame, drive, about) => showConditions(conditions(frame, drive, about));

export function showSilence(why, stopping) {
  const [title, text, next] = stopping
    ? ["STOP NOT CONFIRMED", "There is no connection to the dashboard: press the robot’s emergency stop.", "This page sends STOP again when it is connected."]
    : ["NO CONNECTION TO THE DASHBOARD", "What you see is old, and nothing can be driven from here.", "Is the program roburoc4 dashboard still running? Is the network up? This page connects again by itself."];
  showConditions([["bad", title, `${text} ${why ? `The dashboard says: ${end(why)}` : next}`]]);
}
