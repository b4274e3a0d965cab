// SPDX-License-Identifier: Apache-2.0
// Draws one frame of the bird's-eye view. Knows a canvas and a frame (docs/reference/view-protocol.md),
// nothing of where frames come from: the page and a report use the same code.
"use strict";

class SceneView {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.map = { lanes: [], buildings: [] };
    this.frame = null;
    this.scale = 6;           // Pixels per metre.
    this.centre = null;       // Of the view, odometry frame; null: follows the ego.
    this.headingUp = true;
    this.chosen = null;       // {kind, id}
    this.hovered = null;
    this.reserve = 0;         // Pixels at the bottom that something else covers.
    this.labels = [];
    this.layers = { fields: true, local: true, priority: true, senders: true, radar: true, camera: true,
      truth: true, map: true };
    this.restyle();
  }

  restyle() {
    const style = getComputedStyle(document.documentElement);
    this.colours = {};
    for (const name of ["paper", "ink", "soft", "local", "priority", "hidden", "bad", "sender", "radar",
      "truth", "road", "building", "watched", "degraded", "blind", "line"]) {
      this.colours[name] = style.getPropertyValue("--" + name).trim();
    }
  }

  draw(frame) {
    if (frame) this.frame = frame;
    const ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (this.canvas.width !== Math.round(width * ratio)) this.canvas.width = Math.round(width * ratio);
    if (this.canvas.height !== Math.round(height * ratio)) this.canvas.height = Math.round(height * ratio);
    const g = this.g = this.canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = this.colours.paper;
    g.fillRect(0, 0, width, height);
    this.labels = [];
    this.rings = [];
    if (!this.frame || !this.frame.ego) return;
    this.aim(width, height);
    if (this.layers.map) this.drawMap();
    if (this.layers.fields) this.drawFields();
    this.drawGrid(width, height);
    this.drawTrail();
    if (this.layers.truth) this.drawTruth();
    if (this.layers.camera) this.drawCameras();
    if (this.layers.radar) this.drawRadar();
    this.drawEgo();
    if (this.layers.local) for (const track of this.frame.local) this.drawLocal(track);
    if (this.layers.senders) for (const sender of this.frame.senders) this.drawSender(sender);
    if (this.layers.priority) for (const track of this.frame.priority) this.drawPriority(track);
    this.drawWarnings();
    this.drawHovered();
    this.placeLabels(width, height - this.reserve);
  }

  // --- where things lie on the canvas
  aim(width, height) {
    const ego = this.frame.ego;
    const turn = this.headingUp ? Math.PI / 2 - ego.yaw : 0;
    this.c = Math.cos(turn); this.s = Math.sin(turn);
    this.ex = ego.x; this.ey = ego.y;
    const ahead = this.headingUp && !this.centre ? 0.68 : 0.5;
    this.ox = width / 2; this.oy = height * ahead;
    this.mx = this.centre ? this.centre.x : ego.x;
    this.my = this.centre ? this.centre.y : ego.y;
    this.turn = turn;
  }
  at(x, y) {
    const dx = x - this.mx, dy = y - this.my;
    return [this.ox + this.scale * (this.c * dx - this.s * dy), this.oy - this.scale * (this.s * dx + this.c * dy)];
  }
  /** The point of the odometry frame under a pixel. */
  under(px, py) {
    const u = (px - this.ox) / this.scale, v = -(py - this.oy) / this.scale;
    return { x: this.mx + this.c * u + this.s * v, y: this.my - this.s * u + this.c * v };
  }
  pan(dx, dy) {
    const a = this.under(0, 0), b = this.under(dx, dy);
    const from = this.centre || { x: this.mx, y: this.my };
    if (!this.centre) {  // The picture does not jump when it lets go of the car.
      const middle = this.under(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2);
      from.x = middle.x; from.y = middle.y;
    }
    this.centre = { x: from.x - (b.x - a.x), y: from.y - (b.y - a.y) };
    this.draw();
  }
  zoom(factor, px, py) {
    const before = this.centre && px !== undefined ? this.under(px, py) : null;
    this.scale = Math.min(60, Math.max(0.8, this.scale * factor));
    if (before) {
      const after = this.under(px, py);
      this.centre = { x: this.centre.x + before.x - after.x, y: this.centre.y + before.y - after.y };
    }
    this.draw();
  }

  // --- shapes
  path(points, close) {
    const g = this.g;
    g.beginPath();
    for (let i = 0; i + 1 < points.length; i += 2) {
      const [x, y] = this.at(points[i], points[i + 1]);
      if (i === 0) g.moveTo(x, y); else g.lineTo(x, y);
    }
    if (close) g.closePath();
  }
  box(o, grow) {
    const l = (o.len || 4.2) / 2 + (grow || 0), w = (o.wid || 1.8) / 2 + (grow || 0);
    const c = Math.cos(o.yaw), s = Math.sin(o.yaw), points = [];
    for (const [a, b] of [[l, w], [l, -w], [-l, -w], [-l, w]]) points.push(o.x + a * c - b * s, o.y + a * s + b * c);
    this.path(points, true);
  }
  /** A bar at the front: which way it points. */
  front(o) {
    const l = (o.len || 4.2) / 2, w = (o.wid || 1.8) / 2, c = Math.cos(o.yaw), s = Math.sin(o.yaw), f = l * 0.6;
    this.path([o.x + f * c - w * s, o.y + f * s + w * c, o.x + f * c + w * s, o.y + f * s - w * c]);
    this.g.stroke();
  }
  ellipse(o) {
    if (!o.cov || o.cov.some((v) => v === null)) return false;
    const [xx, xy, yy] = o.cov, mean = (xx + yy) / 2, root = Math.hypot((xx - yy) / 2, xy);
    const a = Math.sqrt(5.991 * Math.max(mean + root, 0)), b = Math.sqrt(5.991 * Math.max(mean - root, 0));  // 95 %.
    const [px, py] = this.at(o.x, o.y);
    const angle = Math.atan2(2 * xy, xx - yy) / 2 + this.turn;
    this.g.beginPath();
    this.g.ellipse(px, py, Math.min(a * this.scale, 4000), Math.min(b * this.scale, 4000), -angle, 0, 2 * Math.PI);
    return true;
  }
  /** Words beside a vehicle; all are put in place at the end.
   * @param weight 3: shown in any case @param clear pixels round the vehicle to stay out of */
  label(o, lines, colour, weight, clear) { this.labels.push({ o, lines, colour, weight, clear }); }
  /** No label covers another; those that find no free place are left out, the least first. */
  placeLabels(width, height) {
    const g = this.g, row = 14, taken = [], vehicles = [];
    const overlap = (a, b) => Math.max(0, Math.min(a[2], b[2]) - Math.max(a[0], b[0])) * Math.max(0, Math.min(a[3], b[3]) - Math.max(a[1], b[1]));
    for (const list of [this.frame.local, this.frame.priority]) {
      for (const o of list) {
        const [x, y] = this.at(o.x, o.y), r = this.scale * (o.wid || 1.8) * 0.6;
        vehicles.push([x - r, y - r, x + r, y + r]);
      }
    }
    g.font = "12px system-ui, sans-serif";
    g.textAlign = "left";
    g.lineWidth = 3;
    g.strokeStyle = this.colours.paper;
    for (const { o, lines, colour, weight, clear } of this.labels.sort((a, b) => b.weight - a.weight)) {
      const [x, y] = this.at(o.x, o.y);
      const off = clear || Math.max(14, this.scale * (o.wid || 1.8) * 0.5 + 8), up = clear || Math.max(off, this.scale * (o.len || 4.2) * 0.5 + 6);
      const w = Math.max(...lines.map((line) => g.measureText(line).width)), h = row * lines.length;
      if (x < -w || y < -h || x > width + w || y > height + h) continue;
      let best = null, least = Infinity;
      for (const [left, top] of [[x + off, y - h / 2], [x - off - w, y - h / 2], [x - w / 2, y - up - h], [x - w / 2, y + up]]) {
        const area = [left, top, left + w, top + h];
        const covered = 4 * taken.reduce((sum, other) => sum + overlap(area, other), 0) +
          vehicles.reduce((sum, other) => sum + overlap(area, other), 0) +
          (w * h - overlap(area, [0, 0, width, height]));
        if (covered < least - 1) { least = covered; best = area; }
      }
      if (weight < 3 && taken.some((other) => overlap(best, other) > 0)) continue;
      taken.push(best);
      g.fillStyle = colour;
      lines.forEach((line, i) => {
        g.strokeText(line, best[0], best[1] + 11 + row * i);
        g.fillText(line, best[0], best[1] + 11 + row * i);
      });
    }
    g.fillStyle = this.colours.soft;
    for (const [text, left, top] of this.rings) {
      const area = [left, top, left + g.measureText(text).width, top + row];
      if (taken.some((other) => overlap(area, other) > 0)) continue;
      taken.push(area);
      g.fillText(text, left, top + 11);
    }
    this.placed = taken;
  }

  // --- layers
  drawMap() {
    const world = this.frame.world, g = this.g;
    if (!world) return;
    const c = Math.cos(world[2]), s = Math.sin(world[2]);
    const moved = (line) => {
      const out = [];
      for (let i = 0; i + 1 < line.length; i += 2) {
        out.push(world[0] + c * line[i] - s * line[i + 1], world[1] + s * line[i] + c * line[i + 1]);
      }
      return out;
    };
    g.lineJoin = g.lineCap = "round";
    g.strokeStyle = this.colours.road;
    g.lineWidth = 3.5 * this.scale;
    for (const lane of this.map.lanes) { this.path(moved(lane)); g.stroke(); }
    g.fillStyle = this.colours.building;
    for (const outline of this.map.buildings) { this.path(moved(outline), true); g.fill(); }
  }
  drawFields() {
    const ego = this.frame.ego, g = this.g, [x, y] = this.at(ego.x, ego.y);
    for (const [from, to, range, state] of this.frame.sectors) {
      if (from === null || to === null) continue;
      const r = Math.max(2, state === 2 && !(range > 0) ? 30 : range || 0) * this.scale;
      const a = -(ego.yaw + from + this.turn);
      let sweep = (to - from) % (2 * Math.PI);
      if (sweep <= 0) sweep += 2 * Math.PI;
      g.beginPath();
      g.moveTo(x, y);
      g.arc(x, y, Math.min(r, 20000), a, a - sweep, true);
      g.closePath();
      g.fillStyle = [this.colours.watched, this.colours.degraded, this.colours.blind][state];
      g.fill();
      if (state > 0) {  // Not by colour alone.
        g.setLineDash(state === 1 ? [6, 4] : [2, 5]);
        g.strokeStyle = this.colours.soft;
        g.lineWidth = 1;
        g.stroke();
        g.setLineDash([]);
      }
    }
  }
  drawGrid(width, height) {
    const g = this.g, ego = this.frame.ego, [x, y] = this.at(ego.x, ego.y);
    g.strokeStyle = this.colours.line;
    g.lineWidth = 1;
    const step = [5, 10, 20, 50, 100].find((s) => s * this.scale > 70) || 200;
    for (let r = step; r * this.scale < Math.hypot(width, height); r += step) {
      g.beginPath();
      g.arc(x, y, r * this.scale, 0, 2 * Math.PI);
      g.stroke();
      if (y - r * this.scale > 16) this.rings.push([r + " m", x + 3, y - r * this.scale - 14]);
    }
  }
  drawTrail() {
    const g = this.g;
    if (this.frame.trail.length < 4) return;
    this.path(this.frame.trail);
    g.strokeStyle = this.colours.soft;
    g.lineWidth = 2;
    g.setLineDash([1, 5]);
    g.lineCap = "round";
    g.stroke();
    g.setLineDash([]);
  }
  drawEgo() {
    const g = this.g, ego = this.frame.ego;
    const o = { x: ego.x + ego.cx * Math.cos(ego.yaw), y: ego.y + ego.cx * Math.sin(ego.yaw), yaw: ego.yaw,
      len: ego.len, wid: ego.wid };
    this.box(o);
    g.fillStyle = this.colours.ink;
    g.fill();
    g.strokeStyle = this.colours.paper;
    g.lineWidth = 1.5;
    this.front(o);
  }
  drawTruth() {
    const g = this.g;
    g.lineWidth = 1;
    for (const o of this.frame.truth || []) {
      this.box(o);
      g.strokeStyle = this.colours.truth;
      g.setLineDash(o.hidden ? [3, 3] : []);
      g.stroke();
    }
    g.setLineDash([]);
  }
  drawRadar() {
    const g = this.g, points = this.frame.radar, size = Math.max(1.5, Math.min(3, this.scale / 3));
    const ego = this.frame.ego;
    g.fillStyle = g.strokeStyle = this.colours.radar;
    g.lineWidth = 1;
    for (let i = 0; i + 2 < points.length; i += 3) {
      const [x, y] = this.at(points[i], points[i + 1]), rate = points[i + 2];
      g.globalAlpha = rate !== null && Math.abs(rate) > 0.7 ? 1 : 0.6;  // Stationary returns pale.
      g.fillRect(x - size / 2, y - size / 2, size, size);
      if (rate === null || Math.abs(rate) < 0.7) continue;
      // The tick: where the point will be in 0.3 s, along the beam.
      const dx = points[i] - ego.x, dy = points[i + 1] - ego.y, d = Math.hypot(dx, dy) || 1;
      const [tx, ty] = this.at(points[i] + dx / d * rate * 0.3, points[i + 1] + dy / d * rate * 0.3);
      g.beginPath(); g.moveTo(x, y); g.lineTo(tx, ty); g.stroke();
    }
    g.globalAlpha = 1;
    for (const [x, y, yaw, len, wid] of this.frame.objects) {
      this.box({ x, y, yaw, len, wid });
      g.stroke();
    }
  }
  drawCameras() {
    const g = this.g;
    for (const camera of this.frame.cameras) {
      if (camera.x === undefined) continue;
      const [x, y] = this.at(camera.x, camera.y);
      for (const box of camera.boxes || []) {
        const range = Math.min(camera.range || 60, 60);
        g.beginPath();
        g.moveTo(x, y);
        for (const angle of [box[6], box[7]]) {
          g.lineTo(...this.at(camera.x + range * Math.cos(angle), camera.y + range * Math.sin(angle)));
        }
        g.closePath();
        g.fillStyle = this.colours.radar;
        g.globalAlpha = 0.09;
        g.fill();
        g.globalAlpha = 0.3;
        g.strokeStyle = this.colours.radar;
        g.lineWidth = 1;
        g.stroke();
        g.globalAlpha = 1;
      }
    }
  }
  isChosen(kind, id) { return this.chosen && this.chosen.kind === kind && this.chosen.id === id; }
  drawLocal(track) {
    const g = this.g;
    this.box(track);
    g.globalAlpha = 0.25;
    g.fillStyle = this.colours.local;
    g.fill();
    g.globalAlpha = 1;
    g.strokeStyle = this.colours.local;
    g.lineWidth = this.isChosen("local", track.id) ? 4 : 2;
    g.setLineDash(track.vis === 0 ? [] : [6, 4]);
    g.stroke();
    g.setLineDash([]);
    g.lineWidth = 2;
    this.front(track);
    const reach = 0.5;  // Speed as a line: where it is in half a second.
    this.path([track.x, track.y, track.x + Math.cos(track.yaw) * ((track.len || 4) / 2 + track.v * reach),
      track.y + Math.sin(track.yaw) * ((track.len || 4) / 2 + track.v * reach)]);
    g.lineWidth = 1;
    g.stroke();
    if (this.isChosen("local", track.id) && this.ellipse(track)) g.stroke();
  }
  drawPriority(track) {
    const g = this.g, hidden = track.local === "", colour = hidden ? this.colours.hidden : this.colours.priority;
    const [x, y] = this.at(track.x, track.y);
    const r = Math.max(12, this.scale * Math.hypot(track.len || 4.2, track.wid || 1.8) / 2 + 5);
    g.strokeStyle = colour;
    g.lineWidth = this.isChosen("priority", track.id) ? 4.5 : 2.5;
    g.beginPath();
    g.arc(x, y, r, 0, 2 * Math.PI);
    g.setLineDash(hidden ? [7, 5] : []);
    g.stroke();
    if (hidden) {
      this.box(track);
      g.lineWidth = 2;
      g.stroke();
      if (this.ellipse(track)) { g.lineWidth = 1; g.stroke(); }
    }
    g.setLineDash([]);
    if (hidden && track.budget !== null) {  // The budget as a clock that runs down.
      g.beginPath();
      g.arc(x, y, r + 5, -Math.PI / 2, -Math.PI / 2 + 2 * Math.PI * Math.min(1, track.budget / 10));
      g.lineWidth = 4;
      g.stroke();
    }
    const lines = [Words.short(track.id)];
    if (hidden) lines.push("hidden, " + Words.number(track.budget, 1, "s left"));
    this.label(track, lines, colour, this.isChosen("priority", track.id) ? 3 : hidden ? 2 : 1, r + (hidden ? 11 : 5));
  }
  colourOfTrust(trust) {
    return [this.colours.sender, this.colours.sender, this.colours.sender, this.colours.priority,
      this.colours.hidden, this.colours.bad, this.colours.bad][trust] || this.colours.sender;
  }
  drawSender(sender) {
    if (sender.x === null || sender.y === null || sender.yaw === null) return;
    const g = this.g, colour = this.colourOfTrust(sender.trust);
    const target = sender.vehicle ? this.frame.priority.find((t) => t.id === sender.vehicle)
      : this.frame.local.find((t) => t.id === sender.track);
    g.strokeStyle = colour;
    if (target) {
      this.path([sender.x, sender.y, target.x, target.y]);
      g.lineWidth = 1;
      g.stroke();
    }
    const size = Math.max(2.2, 11 / this.scale), c = Math.cos(sender.yaw), s = Math.sin(sender.yaw), points = [];
    for (const [a, b] of [[1, 0], [-0.7, 0.65], [-0.35, 0], [-0.7, -0.65]]) {
      points.push(sender.x + size * (a * c - b * s), sender.y + size * (a * s + b * c));
    }
    this.path(points, true);
    g.lineWidth = this.isChosen("sender", sender.id) ? 4 : 1.8;
    g.setLineDash(sender.trust < 3 ? [3, 2] : []);
    g.stroke();
    g.setLineDash([]);
    if (sender.trust >= 5) {  // A cross: not by colour alone.
      const [x, y] = this.at(sender.x, sender.y);
      g.beginPath();
      g.moveTo(x - 9, y - 9); g.lineTo(x + 9, y + 9); g.moveTo(x + 9, y - 9); g.lineTo(x - 9, y + 9);
      g.stroke();
    }
    const words = [];
    if (sender.liar) words.push("liar");
    if (sender.trust >= 5) words.push(Words.trust[sender.trust]);
    if (words.length) this.label(sender, [words.join(": ")], this.colours.bad, 1.5);
  }

  /** A triangle at each vehicle warned of, where a contact is foreseen a cross and a line to it. */
  drawWarnings() {
    const g = this.g;
    for (const warning of this.frame.warnings || []) {
      if (warning.x === null || warning.y === null) continue;
      const strong = warning.level === 2 || warning.level === 3;
      const colour = strong ? this.colours.bad : this.colours.hidden;
      g.strokeStyle = g.fillStyle = colour;
      if (warning.cx !== null && warning.cy !== null) {
        this.path([warning.x, warning.y, warning.cx, warning.cy]);
        g.lineWidth = 1.5;
        g.setLineDash([2, 3]);
        g.stroke();
        g.setLineDash([]);
        const [x, y] = this.at(warning.cx, warning.cy);
        g.beginPath();
        g.moveTo(x - 5, y); g.lineTo(x + 5, y); g.moveTo(x, y - 5); g.lineTo(x, y + 5);
        g.lineWidth = 2.5;
        g.stroke();
      }
      const [x, y] = this.at(warning.x, warning.y);
      g.beginPath();
      g.moveTo(x, y - 9); g.lineTo(x + 9, y + 7); g.lineTo(x - 9, y + 7);
      g.closePath();
      g.fill();
      g.fillStyle = this.colours.paper;
      g.fillRect(x - 1, y - 4, 2, 6);
      g.fillRect(x - 1, y + 3.5, 2, 2);
      this.label(warning, [Words.warning(warning)], colour, strong ? 3 : 1.8);
    }
  }
  drawHovered() {
    if (!this.hovered) return;
    const { kind, id } = this.hovered;
    const list = { local: this.frame.local, priority: this.frame.priority, sender: this.frame.senders }[kind];
    const o = list.find((item) => item.id === id);
    if (!o) return;
    const [x, y] = this.at(o.x, o.y), g = this.g;
    g.beginPath();
    g.arc(x, y, Math.max(12, this.scale * (o.len || 4.2) / 2 + 3), 0, 2 * Math.PI);
    g.strokeStyle = this.colours.ink;
    g.lineWidth = 1;
    g.stroke();
  }

  /** What lies under a pixel: {kind, id}, or null. Small things first. */
  pick(px, py) {
    if (!this.frame || !this.frame.ego) return null;
    const point = this.under(px, py);
    let best = null, nearest = Math.max(2.5, 14 / this.scale);
    const consider = (kind, list, bonus) => {
      for (const o of list) {
        const d = Math.hypot(o.x - point.x, o.y - point.y) - bonus;
        if (d < nearest) { nearest = d; best = { kind, id: o.id }; }
      }
    };
    if (this.layers.local) consider("local", this.frame.local, 0);
    if (this.layers.priority) consider("priority", this.frame.priority, 0.3);
    if (this.layers.senders) consider("sender", this.frame.senders, 0);
    return best;
  }
}
