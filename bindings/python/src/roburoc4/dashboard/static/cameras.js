// SPDX-License-Identifier: MIT
// Pictures of the operator's own camera servers, beside the map.
import { by, make, show } from "./text.js";

export function showCameras(cameras) {
  const key = JSON.stringify(cameras);
  if (by("cameras").dataset.key === key) return;
  by("cameras").dataset.key = key;
  show(by("cameras"), cameras.length > 0);
  by("cameras").replaceChildren(...cameras.map(({ name, url }) => {
    const picture = make("img");
    picture.alt = `camera ${name}`;
    picture.src = url;
    const caption = make("figcaption", "", name);
    const first = make("button", "quiet", "large");
    first.setAttribute("aria-label", `camera ${name} large, map small`);
    first.addEventListener("click", () => first.setAttribute("aria-pressed", String(by("stage").classList.toggle("camera-first"))));
    picture.addEventListener("error", () => {
      picture.style.visibility = "hidden";
      caption.textContent = `${name}: no picture from ${url}`;
      setTimeout(() => { picture.src = url; }, 5000);
    });
    picture.addEventListener("load", () => { picture.style.visibility = ""; caption.textContent = name; });
    return make("figure", "", "", picture, caption, first);
  }));
}
