// SPDX-License-Identifier: MIT
// All states of the robot, most urgent first. Whatever is said of motion is computed from the speeds that
// were measured for this frame; what is past is no state, only a reason for the present one.
import { figure, trip } from "./text.js";

const end = (text) => (text ? text[0].toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".") : "");

export const RECORDED = "A recording is replayed: nothing can be driven.";

/** What is measured now, as a sentence. */
export function motion({ speeds, facts }) {
  if (facts.at_rest === null || !speeds) return "It is not known whether the robot moves.";
  if (facts.at_rest) return "The robot stands.";
  return `The robot moves: ${figure(speeds[1], 2, "m/s")}, ${figure(speeds[3], 2, "rad/s")}.`;
}

const lost = (s) => s.state !== "ready";
const bumpers = ({ facts }) => [facts.front_bumper && "FRONT", facts.rear_bumper && "REAR"].filter(Boolean).join(" AND ");
const brakes = ({ speeds }) => speeds?.[0] === 0 && speeds[2] === 0;
const critical = (s) => s.battery?.state === "critical";

// Level, title, whether it holds, what is the matter, what to do. `s` is the frame, with what the page knows.
const STATES = [
  ["bad", "STOP NOT CONFIRMED", ({ facts }) => facts.stop_unconfirmed && !facts.armed && !facts.overridden && facts.at_rest !== true, (s) => `The robot was sent zeros, and did not confirm them. ${motion(s)}`, () => "press the robot’s emergency stop"],
  ["bad", (s) => (s.everReady || s.state === "lost" ? "ROBOT LOST" : "NO ROBOT YET"), lost, (s) => end(s.link.say), (s) => s.link.attempt],
  ["bad", "ANOTHER COMMANDER", ({ facts }) => facts.other_commander, (s) => `Another program commands the robot. ${motion(s)}`, () => "end that program; STOP here cannot stop it, the robot’s emergency stop can"],
  ["bad", (s) => `${bumpers(s)} BUMPER`, bumpers, () => "The robot touches something there.", () => "look what it is, then drive away from it"],
  ["bad", "OVERRIDE", ({ facts }) => facts.overridden, (s) => `Somebody holds [A] on the robot’s game pad: commands from here are ignored. ${motion(s)}`, () => "release [A] to drive from here"],
  ["bad", "MOTION INHIBITED", ({ facts }) => facts.inhibited, (s) => `The robot does not follow its commands. ${motion(s)}`, () => "check emergency stops, brakes selector and bumpers"],
  ["bad", "CHARGER PLUGGED IN", ({ facts }) => facts.charger && (facts.armed || facts.at_rest === false), (s) => `The robot would tear its cable. ${motion(s)}`, () => "stop, switch charger and platform off, unplug"],
  ["bad", "BATTERY CRITICAL", critical, () => "The battery is nearly empty.", () => "stop work and bring the robot to its charger now"],
  ["bad", "LINK BAD", (s) => s.link.level === "bad", (s) => end(s.link.say), (s) => s.link.attempt],
  ["weak", "POSE WRONG", ({ facts }) => facts.pose_error, () => "The localization reports an error: the map is not to be trusted.", () => "drive by sight; set the pose with “place”"],
  ["weak", "BATTERY LOW", (s) => s.facts.battery_low && !critical(s), () => "The battery is below the robot’s minimum.", () => "bring the robot to its charger; charger and platform off before plugging it in"],
  ["weak", "LINK WEAK", (s) => s.link.level === "weak", (s) => end(s.link.say), (s) => s.link.attempt],
  ["weak", "LET GO", (s) => s.mine && s.facts.armed && s.why && s.must_let_go, (s) => `${end(s.why)} ${motion(s)}`, () => "let go of everything, then drive"],
  ["go", "DRIVING", ({ facts }) => facts.armed && facts.driving, (s) => (s.going ? `By itself: ${trip(s, s.going, s.going_m_s)}.` : `${s.mine ? "Letting go stops the robot." : `By “${s.driver_name}”.`}${s.facts.at_rest ? " The robot stands." : ""}`)],
  ["armed", "ARMED", ({ facts }) => facts.armed, (s) => (s.mine ? end(s.why) || "Letting go stops the robot." : `The robot accepts speeds from “${s.driver_name}”.`)],
  ["weak", "MOVING", ({ facts }) => facts.at_rest === false && !facts.armed && !facts.overridden && !facts.other_commander && !facts.stop_unconfirmed, (s) => `${brakes(s) ? "Its target is zero: it brakes, or something pushes it." : "Nothing is commanded from here."} ${motion(s)}`, (s) => (brakes(s) ? "wait until it stands" : "look who moves it; keep away from it")],
  ["calm", "DISARMED", () => true, (s) => (s.recorded ? RECORDED : end(s.mine ? s.facts.blocked || s.why : "") || (s.offered ? "The robot accepts no speed from here." : "This page only watches."))],
];

/** All states that hold, most urgent first: level, title, what is the matter, what to try. */
export function statesOf(s) {
  const found = [];
  for (const [level, title, on, text, remedy] of STATES) {
    if (!on(s)) continue;
    const attempt = s.recorded ? "" : remedy?.(s);
    found.push([level, typeof title === "string" ? title : title(s), text(s), attempt ? `Try: ${attempt}.` : ""]);
    if (on === lost) break; // of a robot that is silent, nothing else is known
  }
  return found;
}

export const silence = (why, stopping) => {
  const says = why && `The dashboard says: ${end(why)}`;
  return [stopping
    ? ["bad", "STOP NOT CONFIRMED", `There is no connection to the dashboard. ${says || "This page sends STOP again when it is connected."}`, "Try: press the robot’s emergency stop."]
    : ["bad", "NO CONNECTION TO THE DASHBOARD", "What you see is old. This page connects again by itself.", says || "Try: look whether roburoc4 dashboard runs, and the network."]];
};
