// SPDX-License-Identifier: MIT
// The most urgent state in words, with what to try, and the others beside it by name. The place never
// changes its size: nothing moves when a state comes or goes.
import { by, make, mark, put } from "./text.js";
import { silence, statesOf } from "./states.js";
import { alarm } from "./alarm.js";

const [matter, remedy] = by("banner-text").children;
const words = by("banner-text").parentNode;

/** Where not all of it has room, what to do counts more than what is the matter. */
function fit() {
  by("banner").classList.remove("brief");
  by("banner").classList.toggle("brief", [words, by("banner")].some((node) => node.scrollHeight > node.clientHeight + 1) && remedy.textContent !== "");
}

new ResizeObserver(fit).observe(by("banner"));

// Where the names of the others have no room beside the title, a press shows them whole.
by("banner").addEventListener("click", () => by("banner").classList.toggle("names"));

function showStates([first, ...others]) {
  const [level, title, text, attempt] = first;
  const before = by("banner").textContent;
  mark(by("banner"), "level", level);
  put(by("banner-title"), title);
  put(matter, text);
  put(remedy, attempt);
  const more = others.filter(([of]) => of === "bad" || of === "weak");
  const names = more.map(([of, name]) => `${of}:${name}`).join();
  if (by("banner-more").dataset.names !== names) {
    by("banner-more").dataset.names = names;
    by("banner").classList.remove("names");
    by("banner-more").replaceChildren(...more.map(([of, name]) => {
      const node = make("li", "", name);
      node.dataset.level = of;
      return node;
    }));
  }
  if (by("banner").textContent !== before) fit();
  announce(level, title, `${text} ${attempt}`);
  alarm([first, ...others].filter(([of]) => of === "bad").map(([, name]) => name));
}

let announced = "";

/** Let a screen reader speak when the state changes, not when a number in its text does. */
function announce(level, title, text) {
  if (title === announced) return;
  const calm = announced === "" && level === "calm";
  announced = title;
  put(by("spoken"), calm || title === "DRIVING" || title === "MOVING" ? "" : `${title}. ${text}`);
}

export const showBanner = (frame, { mine, offered }, { everReady, recorded }) => showStates(statesOf({ ...frame, mine, offered, everReady, recorded }));

export const showSilence = (why, stopping) => showStates(silence(why, stopping));
