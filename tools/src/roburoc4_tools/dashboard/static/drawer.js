// SPDX-License-Identifier: MIT
// The tabs below the map: one open or none, by click or by key.
import { by, show, typesIn } from "./text.js";

const KEYS = { KeyP: "plots", KeyE: "events", KeyI: "io", KeyL: "link", KeyM: "sim" };
const ROOMY = "(min-width: 1000px) and (min-height: 820px)";

export class Drawer {
  /** onOpen: called with the name of the tab that was opened. */
  constructor(onOpen) {
    this.onOpen = onOpen;
    this.open = "";
    this.tabs = [...document.querySelectorAll("[role=tab]")];
    for (const button of document.querySelectorAll("[data-tab]")) button.addEventListener("click", () => this.toggle(button.dataset.tab));
    addEventListener("keydown", (event) => this.key(event));
    const roomy = matchMedia(ROOMY);
    this.select(roomy.matches ? "plots" : "");
    // A page that is zoomed, or made small, keeps its map.
    roomy.addEventListener("change", () => roomy.matches || this.select(""));
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
    const at = this.tabs.indexOf(document.activeElement);
    if (at >= 0 && ["ArrowLeft", "ArrowRight"].includes(event.code)) this.focus(at, event.code === "ArrowRight" ? 1 : -1);
    else if (event.code in KEYS && !typesIn(event.target) && !by(`tab-${KEYS[event.code]}`).hidden) this.enter(KEYS[event.code]);
  }

  focus(at, way) {
    const shown = this.tabs.filter((tab) => !tab.hidden);
    const next = shown[(shown.indexOf(this.tabs[at]) + way + shown.length) % shown.length];
    this.select(next.dataset.tab);
    next.focus();
  }

  /** By key: an opened panel gets the focus, so that Tab moves within it; a closed one gives it to its tab. */
  enter(name) {
    const within = by("drawer").contains(document.activeElement);
    this.toggle(name);
    if (this.open) by(`panel-${name}`).focus();
    else if (within) by(`tab-${name}`).focus();
  }

  close() {
    if (this.open) this.enter(this.open);
  }

  toggle(name) {
    this.select(name === this.open ? "" : name);
  }

  select(name) {
    this.open = name;
    for (const [index, tab] of this.tabs.entries()) {
      const on = tab.dataset.tab === name;
      tab.setAttribute("aria-selected", String(on));
      tab.tabIndex = on || (!name && index === 0) ? 0 : -1;
      show(by(`panel-${tab.dataset.tab}`), on);
    }
    by("drawer").classList.toggle("open", name !== "");
    if (name) this.onOpen(name);
  }
}
