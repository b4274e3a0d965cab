// SPDX-License-Identifier: Apache-2.0
// The time line: how far, and a mark with a letter for each event; a click seeks.
"use strict";

class Timeline {
  /** @param seek called with a time in microseconds */
  constructor(canvas, seek) {
    this.canvas = canvas;
    canvas.onclick = (e) => {
      if (this.span === undefined) return;
      const box = canvas.getBoundingClientRect();
      seek(this.span[0] + (e.clientX - box.left) / box.width * (this.span[1] - this.span[0]));
    };
  }
  /** @param what {begin, end, now (null: live), events, colours} */
  draw({ begin, end, now, events, colours }) {
    const canvas = this.canvas, ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
    this.span = [begin, end];
    canvas.width = w * ratio;
    canvas.height = h * ratio;
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = colours.line;
    g.fillRect(0, h - 10, w, 4);
    const x = (t) => (t - begin) / Math.max(1, end - begin) * w;
    if (now !== null) {
      g.fillStyle = colours.local;
      g.fillRect(0, h - 10, x(now), 4);
      g.fillRect(x(now) - 1.5, 2, 3, h - 4);
    }
    const shown = events.filter((event) => event.t >= begin && event.t <= end);
    for (const event of shown) {
      g.fillStyle = colours[Timeline.mark(event)[0]];
      g.fillRect(x(event.t) - 0.75, 13, 1.5, h - 20);
    }
    // Letters do not overlap; verdicts and warnings come first.
    g.font = "bold 11px system-ui, sans-serif";
    g.textAlign = "center";
    const taken = [], order = ["accused", "withdrawn", "warned", "bridged", "validated"];
    const weight = (event) => order.indexOf(event.kind) + 1 || 9;
    for (const event of shown.slice().sort((a, b) => weight(a) - weight(b))) {
      const [colour, letter] = Timeline.mark(event);
      const at = Math.min(w - 5, Math.max(5, x(event.t)));
      if (taken.some((other) => Math.abs(other - at) < 9)) continue;
      taken.push(at);
      g.fillStyle = colours[colour];
      g.fillText(letter, at, 11);
    }
  }
  /** Colour and letter of a kind of event. */
  static mark(event) {
    return { validated: ["priority", "v"], bridged: ["hidden", "h"], seen_again: ["priority", "s"], ended: ["soft", "e"],
      withdrawn: ["bad", "w"], accused: ["bad", "A"], warned: ["bad", "!"], notice: ["bad", "n"] }[event.kind] || ["soft", "?"];
  }
  /** What a click on an event chooses: a vehicle, a track or a sender; null where it is of none. */
  static subject(event) {
    if (event.vehicle) return { kind: "priority", id: event.vehicle };
    if (event.track) return { kind: "local", id: event.track };
    return event.sender ? { kind: "sender", id: event.sender } : null;
  }
}
