// SPDX-License-Identifier: MIT
// Light or dark, before anything is drawn.
(() => {
  "use strict";
  const wanted = ["auto", "light", "dark"];
  let theme = "auto";
  try { theme = localStorage.getItem("theme") ?? "auto"; } catch { /* no storage: as the system */ }
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const apply = () => {
    const shown = theme === "auto" ? (dark.matches ? "dark" : "light") : theme;
    document.documentElement.dataset.theme = shown;
    const button = document.getElementById("theme");
    if (button) button.textContent = `theme: ${theme}`;
    dispatchEvent(new Event("theme"));
  };
  dark.addEventListener("change", apply);
  addEventListener("DOMContentLoaded", () => {
    apply();
    document.getElementById("theme").addEventListener("click", () => {
      theme = wanted[(wanted.indexOf(theme) + 1) % wanted.length];
      try { localStorage.setItem("theme", theme); } catch { /* for this time only */ }
      apply();
    });
  });
  apply();
})();
