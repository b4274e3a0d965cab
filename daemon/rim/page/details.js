// SPDX-License-Identifier: Apache-2.0
// What there is to say of a vehicle or a sender, as a table and as the few lines under the pointer.
// Texts of others are text nodes, never markup.
"use strict";

const Details = {
  element(tag, text, className) {
    const e = document.createElement(tag);
    if (text !== undefined) e.textContent = text;
    if (className) e.className = className;
    return e;
  },
  rows(table, list) {
    for (const [name, value, className] of list) {
      const row = this.element("tr");
      row.append(this.element("th", name), this.element("td", value, className));
      table.append(row);
    }
  },
  find(frame, chosen) {
    const list = { local: frame.local, priority: frame.priority, sender: frame.senders }[chosen.kind];
    return list.find((item) => item.id === chosen.id);
  },
  title(chosen) {
    const kind = { local: "LOCAL vehicle ", priority: "PRIORITY vehicle ", sender: "Sender " }[chosen.kind];
    return kind + (chosen.kind === "sender" ? chosen.id : Words.short(chosen.id));
  },
  warningsOf(frame, chosen, o) {
    return (frame.warnings || []).filter((w) => (chosen.kind === "local" && w.local === o.id) ||
      (chosen.kind === "priority" && (w.vehicle === o.id || (o.local && w.local === o.local))));
  },
  distance(frame, o) { return frame.ego ? Math.hypot(o.x - frame.ego.x, o.y - frame.ego.y) : null; },

  /** Fills the panel of what is chosen ({kind, id} or null). */
  fill(panel, frame, chosen) {
    panel.replaceChildren();
    if (!chosen || !frame) {
      panel.append(this.element("h2", "Nothing chosen"), this.element("div", "Click a vehicle or a sender's arrow.", "soft"));
      return;
    }
    const o = this.find(frame, chosen);
    panel.append(this.element("h2", this.title(chosen)));
    if (!o) { panel.append(this.element("div", "no longer in the list", "bad")); return; }
    const table = this.element("table");
    this.rows(table, this.warningsOf(frame, chosen, o).map((w) => ["warned of", Words.warning(w), "bad"]));
    this.rows(table, [["distance", Words.number(this.distance(frame, o), 1, "m")], ["speed", Words.number(o.v, 1, "m/s")],
      ["size", Words.number(o.len, 1) + " x " + Words.number(o.wid, 1, "m")]]);
    if (chosen.kind !== "sender") this.rows(table, this.trackRows(o));
    if (chosen.kind === "priority") {
      this.rows(table, [["sender", o.sender], ["LOCAL track", o.local ? Words.short(o.local) : "none: hidden", o.local ? "" : "bad"],
        ["budget", Words.number(o.budget, 1, "s")]]);
    }
    if (chosen.kind !== "local") {
      this.rows(table, [["trust", Words.trust[o.trust] + (Words.why[o.trust] ? ": " + Words.why[o.trust] : ""), o.trust >= 5 ? "bad" : ""],
        ["bias", o.bias[0] === null ? "none" : o.bias[0].toFixed(2) + " m east, " + o.bias[1].toFixed(2) + " m north"]]);
    }
    if (chosen.kind === "sender") {
      this.rows(table, [["heard", Words.number(o.age, 2, "s ago")], ["taken for", this.takenFor(o)]]);
      if (o.liar) this.rows(table, [["truth", "an attacker's (the simulator says so)", "bad"]]);
    }
    panel.append(table);
    const sender = chosen.kind === "priority" ? frame.senders.find((s) => s.id === o.sender) : o;
    if (chosen.kind !== "local" && sender && sender.said && sender.said.length) {
      panel.append(this.element("h2", "Last verdicts"));
      const said = this.element("ol");
      for (const [seconds, text, times] of sender.said.slice().reverse()) {
        said.append(this.element("li", Words.number(Math.max(0, seconds), 1, "s ago") + ": " + text + (times > 1 ? " (" + times + " times)" : "")));
      }
      panel.append(said);
    }
  },
  trackRows(o) {
    const [xx, xy, yy] = o.cov, root = (value) => Math.sqrt(Math.max(value, 0)).toFixed(2);
    const list = [["class", Words.classes[o.cls] || "unknown"], ["existence", Words.number(o.ex, 3)],
      ["visibility", Words.visibility[o.vis] || ""], ["known for", Words.number(o.since, 1, "s")],
      ["position sigma", xx === null ? "none" : root(xx) + ", " + root(yy) + " m (covariance " + Words.number(xy, 3) + ")"],
      ["speed sigma", Words.number(o.vs, 2, "m/s")]];
    for (const [kind, name, seconds] of o.src) {
      list.push([Words.sources[kind] + (name ? " " + name : ""), Words.number(seconds, 2, "s ago")]);
    }
    return list;
  },
  takenFor(sender) {
    return sender.vehicle ? "PRIORITY " + Words.short(sender.vehicle)
      : sender.track ? "LOCAL " + Words.short(sender.track) : "nothing the sensors see";
  },

  /** The same in a few lines. */
  lines(frame, chosen) {
    const o = this.find(frame, chosen);
    if (!o) return [];
    const lines = [this.title(chosen), Words.number(this.distance(frame, o), 0, "m") + " away, " + Words.number(o.v, 1, "m/s")];
    if (chosen.kind !== "sender") {
      const ages = o.src.map(([kind, name, seconds]) => Words.sources[kind] + " " + Words.number(seconds, 1, "s"));
      lines.push((Words.classes[o.cls] || "unknown") + ", " + (Words.visibility[o.vis] || "") + ", existence " + Words.number(o.ex, 2),
        ages.length ? "measured by " + ages.join(", ") + " ago" : "measured by none");
    }
    if (chosen.kind === "priority") {
      lines.push("sender " + o.sender + (o.local ? "" : "; hidden, budget " + Words.number(o.budget, 1, "s")));
    }
    if (chosen.kind === "sender") {
      lines.push(Words.trust[o.trust] + (Words.why[o.trust] ? ": " + Words.why[o.trust] : ""), "taken for " + this.takenFor(o));
      if (o.said && o.said.length) lines.push(o.said[o.said.length - 1][1]);
      if (o.liar) lines.push("an attacker's (the simulator says so)");
    }
    return lines.concat(this.warningsOf(frame, chosen, o).map((w) => Words.warning(w)));
  },
};
