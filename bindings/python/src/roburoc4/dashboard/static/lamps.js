// SPDX-License-Identifier: MIT
// The warning lamps, always in the same places, and the banner: the worst of them in words.
import { by, mark, put, show } from "./text.js";

const lamps = Object.fromEntries([...document.querySelectorAll("#lamps .lamp")].map((lamp) => [lamp.dataset.lamp, lamp]));

function light(name, on, text) {
  const lamp = lamps[name];
  mark(lamp, "lit", on ? "yes" : "no");
  if (text) put(lamp.firstElementChild, text);
}

function banner(level, title, text) {
  const node = by("banner");
  show(node, Boolean(title));
  if (!title) return;
  mark(node, "level", level);
  put(by("banner-title"), title);
  put(by("banner-text"), text);
}

const end = (text) => (text ? text[0].toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".") : "");

const said = ({ say, attempt }) => end(say) + (attempt ? ` Try: ${attempt}.` : "");

/** What is worst, as [level, title, text]. */
function worst(frame, { mine, offered }, about) {
  const { facts, link, state } = frame;
  if (state !== "ready") {
    const lost = state === "lost" || about.everReady;
    return [link.level === "weak" ? "weak" : "bad", lost ? "ROBOT LOST" : "NO ROBOT YET", said(link)];
  }
  if (facts.overridden) {
    return ["bad", "OVERRIDE", "Somebody holds [A] on the robot’s game pad and drives it. Commands from here are ignored."];
  }
  if (facts.other_commander) return ["bad", "ANOTHER PROGRAM COMMANDS THE ROBOT", "Two drivers at once are dangerous: end one of them."];
  if (facts.inhibited) {
    return ["bad", "MOTION INHIBITED", end(frame.why) || "A speed is asked for, but the robot stands still: look at emergency stops, brakes selector and bumpers."];
  }
  if (mine && frame.why) return ["weak", facts.armed ? "STOPPED" : "DISARMED", end(frame.why)];
  if (mine && !facts.armed) return ["weak", "DISARMED", facts.blocked ? `Not ready to arm: ${facts.blocked}.` : "The robot takes no speed. Look around, then arm."];
  if (link.level !== "good") return [link.level, "LINK", said(link)];
  if (facts.battery_low) return ["weak", "BATTERY LOW", "Bring the robot to its charger. Charger and platform off before plugging it in."];
  if (offered && !facts.armed) return ["weak", "DISARMED", frame.driver === null ? "Nobody has control: the robot takes no speed from here." : "The driver has not armed the robot: it takes no speed."];
  return ["", "", ""];
}

export function showLamps(frame, drive, about) {
  const { facts } = frame;
  light("lost", frame.state !== "ready", ["ready", "lost"].includes(frame.state) ? "LOST" : frame.state.toUpperCase());
  light("override", facts.overridden, facts.override_known || frame.state !== "ready" ? "OVERRIDE" : "OVERRIDE ?");
  light("inhibited", facts.inhibited);
  light("disarmed", !facts.armed);
  light("other_commander", facts.other_commander);
  const bumpers = [facts.front_bumper && "FRONT", facts.rear_bumper && "REAR"].filter(Boolean).join(" + ");
  light("bumper", Boolean(bumpers), bumpers ? `${bumpers} BUMPER` : "BUMPER");
  light("battery", facts.battery_low);
  light("driving", facts.armed, facts.driving ? "DRIVING" : "ARMED");
  banner(...worst(frame, drive, about));
}

export function showSilence(why) {
  for (const name of Object.keys(lamps)) light(name, false);
  light("lost", true, "NO DASHBOARD");
  banner("bad", "NO CONNECTION TO THE DASHBOARD", `What you see is old, and nothing can be driven from here. ${why ? `The dashboard says: ${end(why)}` : "Is the program roburoc4 dashboard still running? Is the network up? This page connects again by itself."}`);
}
