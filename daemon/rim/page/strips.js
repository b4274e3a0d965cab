// SPDX-License-Identifier: Apache-2.0
// Strip charts: the last minutes of a few figures, one line each.
"use strict";

class Strips {
  constructor(parent) {
    this.parent = parent;
    this.strips = new Map();
    this.span_s = 120;
  }
  clear() { for (const strip of this.strips.values()) strip.points = []; }
  add(name, unit, t, value) {
    let strip = this.strips.get(name);
    if (!strip) {
      const canvas = document.createElement("canvas");
      this.parent.append(canvas);
      strip = { name, unit, canvas, points: [] };
      this.strips.set(name, strip);
    }
    const points = strip.points;
    if (value === null || value === undefined) return;
    if (points.length && t < points[points.length - 1][0]) strip.points.length = 0;
    points.push([t, value]);
    while (points.length > 600 || (points.length && points[0][0] < t - this.span_s)) points.shift();
  }
  draw() {
    const style = getComputedStyle(document.documentElement);
    for (const { name, unit, canvas, points } of this.strips.values()) {
      const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
      canvas.width = w * ratio;
      canvas.height = h * ratio;
      const g = canvas.getContext("2d");
      g.setTransform(ratio, 0, 0, ratio, 0, 0);
      g.font = "11px system-ui, sans-serif";
      g.fillStyle = style.getPropertyValue("--soft");
      const last = points.length ? points[points.length - 1] : null;
      const most = Math.max(...points.map((p) => p[1]), 1e-9);
      g.textAlign = "left";
      g.fillText(name, 0, 10);
      g.textAlign = "right";
      const text = (v) => Number.isInteger(v) || v >= 100 ? v.toFixed(0) : v.toFixed(1);
      g.fillText(last ? text(last[1]) + " " + unit + "  (most " + text(Math.max(...points.map((p) => p[1]))) + ")" : "none", w, 10);
      g.strokeStyle = style.getPropertyValue("--line");
      g.beginPath(); g.moveTo(0, h - 3); g.lineTo(w, h - 3); g.stroke();
      if (!last) continue;
      g.strokeStyle = style.getPropertyValue("--local");
      g.lineWidth = 1.5;
      g.beginPath();
      points.forEach(([t, v], i) => {
        const x = w - (last[0] - t) / this.span_s * w, y = h - 3 - (v / most) * (h - 20);
        if (i === 0) g.moveTo(x, y); else g.lineTo(x, y);
      });
      g.stroke();
      g.fillStyle = style.getPropertyValue("--local");
      g.beginPath();
      g.arc(w - 2, h - 3 - (last[1] / most) * (h - 20), 2, 0, 2 * Math.PI);
      g.fill();
    }
  }
}
