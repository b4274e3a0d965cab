// SPDX-License-Identifier: Apache-2.0
// Numbers of the messages in plain words.
"use strict";
const Words = {
  classes: ["unknown", "car", "van", "truck", "bus", "motorcycle", "pedestrian", "cyclist"],
  visibility: ["in view", "hidden", "out of view"],
  trust: ["no sender", "unknown", "candidate", "validated", "bridged", "suspect", "revoked"],
  why: [
    "",
    "heard; nothing the sensors see agrees with it yet",
    "agrees with what the sensors see, not for long enough yet",
    "the sensors see its vehicle where it says it is",
    "hidden now; it was validated before, so V2V carries it within its budget",
    "not believed: it left what the sensors see, or contradicts itself",
    "accused: not believed, reported as misbehaviour",
  ],
  sources: ["radar", "camera", "objects", "V2V"],
  warnings: ["", "collision ahead", "hard braking ahead", "crossing traffic", "oncoming while turning left", "beside", "lane change"],
  levels: ["note", "caution", "WARNING", "URGENT", "vehicle lost"],
  warning(w) {
    const time = Number.isFinite(w.ttc) && w.level < 4 ? ", " + w.ttc.toFixed(1) + " s" : "";
    return (this.levels[w.level] || "") + ": " + (this.warnings[w.kind] || "kind " + w.kind) + time;
  },
  sector: ["watched", "degraded", "blind"],
  number(value, decimals, unit) {
    if (value === null || value === undefined) return "none";
    const text = value.toFixed(decimals);  // Never -0.0.
    return (/^-[0.]+$/.test(text) ? text.slice(1) : text) + (unit ? " " + unit : "");
  },
  /** No line ends between a figure and its unit. */
  unbroken(text) { return text.replace(/(\d) (m|s|m\/s)(?![a-z])/g, "$1\u00a0$2"); },
  /** The last digits of an id: enough to tell vehicles apart. */
  short(id) { return id.length > 5 ? id.slice(-5) : id; },
};
