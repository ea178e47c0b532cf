// SPDX-License-Identifier: MIT
// Sound and vibration when a new alarm begins, for whoever wants them.
import { by, put } from "./text.js";

let wanted = false;
let before = [];
let sound = null;

try { wanted = localStorage.getItem("sound") === "on"; } catch { /* off */ }

function show() {
  by("sound").setAttribute("aria-pressed", String(wanted));
  put(by("sound"), wanted && navigator.userActivation?.hasBeenActive === false ? "alarm sound: press any key first" : "alarm sound");
}

function beep() {
  navigator.vibrate?.([200, 100, 200]);
  sound ??= new AudioContext();
  sound.resume(); // one that was made before the page was first touched is suspended
  const tone = sound.createOscillator();
  const volume = sound.createGain();
  volume.gain.value = 0.2;
  tone.frequency.value = 880;
  tone.connect(volume).connect(sound.destination);
  tone.start();
  tone.stop(sound.currentTime + 0.4);
}

by("sound").addEventListener("click", () => {
  wanted = !wanted;
  try { localStorage.setItem("sound", wanted ? "on" : "off"); } catch { /* for this time only */ }
  show();
  if (wanted) beep(); // browsers allow sound only after a press
});
show();
// Browsers keep a page silent until it is pressed.
for (const press of ["pointerup", "keydown"]) addEventListener(press, () => { sound?.resume(); show(); });

/** alarms: the names of those that hold. */
export function alarm(alarms) {
  if (wanted && alarms.some((name) => !before.includes(name))) beep();
  before = alarms;
}
