// SPDX-License-Identifier: MIT
// Numbers for people to read, and helpers for the document.

export const by = (id) => document.getElementById(id);

/** A number with its unit; a dash where there is none. */
export function figure(value, digits, unit = "") {
  if (value === null || value === undefined || !Number.isFinite(value)) return unit ? `– ${unit}` : "–";
  let text = value.toFixed(digits);
  if (Number(text) === 0) text = (0).toFixed(digits);
  return text.replace("-", "−") + (unit ? `\u202f${unit}` : "");
}

/** How far a place is, and how long the way takes at least. */
export function trip({ pose }, [x, y], speed) {
  const away = pose ? Math.hypot(x - pose.x_m, y - pose.y_m) : NaN;
  return `${figure(away, 1, "m")}, ${figure(Math.ceil(away / speed), 0, "s")} or more at ${figure(speed, 2, "m/s")}`;
}

/** Whether letters that are pressed there are typed into a field. */
export const typesIn = (node) => node.matches?.("input:not([type=range], [type=checkbox]), select, textarea") ?? false;

/** Set a text if it differs, so that the browser does not lay out the page again. */
export function put(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

export function show(node, visible) {
  if (node.hidden === visible) node.hidden = !visible;
}

export function mark(node, name, value) {
  if (node.dataset[name] !== String(value)) node.dataset[name] = value;
}

/** An element with a class, a text, and children. */
export function make(tag, className = "", text = "", ...children) {
  const node = document.createElement(tag);
  if (className) node.className = className;
  if (text) node.textContent = text;
  node.append(...children);
  return node;
}

/** Download a text as a file. */
export function save(name, text) {
  const link = make("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** A colour of the theme, for a canvas. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
