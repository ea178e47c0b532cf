// SPDX-License-Identifier: MIT
// The record button: the dashboard records, so it continues when this page is closed.
import { by, figure, put, show, typesIn } from "./text.js";

const FORMS = ["csv", "mcap", "pcapng"];

export class Recording {
  constructor(send) {
    this.on = false;
    by("record").addEventListener("click", () => send({ type: this.on ? "record_end" : "record" }));
    addEventListener("keydown", (event) => {
      if (event.code === "KeyR" && !event.repeat && !event.ctrlKey && !event.metaKey && !event.altKey && !typesIn(event.target) && !this.on) send({ type: "record" });
    });
  }

  begin({ name, captured }) {
    for (const form of FORMS) by(`record-${form}`).href = `/recording.${form}?robot=${encodeURIComponent(name)}`;
    show(by("record-pcapng"), captured);
  }

  /** The dashboard may have ended, and its recording with it. */
  silent(on) {
    by("record").disabled = on;
    if (!on) return;
    show(by("recording"), false);
    put(by("record-text"), "not known");
  }

  show(recording) {
    this.on = recording?.on ?? false;
    put(by("record"), this.on ? "End recording" : "Record");
    by("record").setAttribute("aria-pressed", String(this.on));
    show(by("recording"), this.on);
    put(by("record-text"), recording === null
      ? "Every status of the robot, until you stop it. Closing this page does not stop it."
      : `${figure(recording.seconds, 0, "s")}, ${recording.statuses} statuses${recording.lost ? `, ${recording.lost} statuses lost` : ""}${recording.why ? `; ended: ${recording.why}` : ""}`);
    for (const form of ["csv", "mcap"]) show(by(`record-${form}`), recording?.forms.includes(form) ?? false);
  }
}
