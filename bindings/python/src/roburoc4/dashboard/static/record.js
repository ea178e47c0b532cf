// SPDX-License-Identifier: MIT
// The record button: the dashboard records, so it goes on when this page is closed.
import { by, figure, put, show } from "./text.js";

export class Recording {
  constructor(send) {
    this.on = false;
    const toggle = () => send({ type: this.on ? "record_end" : "record" });
    by("record").addEventListener("click", toggle);
    addEventListener("keydown", (event) => {
      if (event.code === "KeyR" && !event.repeat && !event.ctrlKey && !event.metaKey && !event.altKey && !event.target.matches?.("input:not([type=checkbox]), select")) toggle();
    });
  }

  begin({ name }) {
    by("record-download").href = `/recording.csv?robot=${encodeURIComponent(name)}`;
  }

  show(recording) {
    this.on = recording?.on ?? false;
    put(by("record"), this.on ? "End recording" : "Record");
    by("record").setAttribute("aria-pressed", String(this.on));
    show(by("recording"), this.on);
    put(by("record-text"), recording === null
      ? "Every status of the robot as a row of a table, until you end it. Closing this page does not."
      : `${figure(recording.seconds, 0, "s")}, ${recording.rows} rows${recording.lost ? `, ${recording.lost} statuses lost` : ""}${recording.why ? `; ended: ${recording.why}` : ""}`);
    show(by("record-download"), recording !== null);
  }
}
