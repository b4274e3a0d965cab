// SPDX-License-Identifier: Apache-2.0
// A drive inside a report: the frames are in the page (gzip, base64), drawn by the live page's code.
"use strict";

class Clip {
  /** @param data {step: microseconds, frames, map, events}; frames as in docs/reference/view-protocol.md */
  constructor(root, data) {
    this.data = data;
    this.begin = data.frames[0].at;
    this.end = data.frames[data.frames.length - 1].at;
    this.now = this.begin;
    this.isPlaying = false;
    const part = (name) => root.querySelector("." + name);
    this.parts = { stage: part("stage"), late: part("late"), play: part("play"), speed: part("speed"), time: part("time"), details: part("details"), events: part("events") };
    this.view = new SceneView(part("scene"));
    this.view.map = data.map;
    this.view.scale = data.scale || this.view.scale;
    this.hands = new Hands(this.view, { hover: part("hover"), choose: () => this.showDetails(), wheelNeedsFocus: true });
    this.layers = Hands.layers(part("layers"), this.view);
    this.timeline = new Timeline(part("timeline"), (t) => this.seek(t));
    this.parts.play.onclick = () => this.toggle();
    for (const event of data.events) this.addEvent(event);
    root.addEventListener("keydown", (e) => this.key(e));
    new ResizeObserver(() => { this.view.reserve = part("layers").offsetHeight + 12; this.draw(); }).observe(part("stage"));
    this.seek(data.first || this.fullest());
  }
  /** Where nobody has chosen a moment: the first with the most vehicles. An empty picture says nothing. */
  fullest() {
    const count = (frame) => frame.local.length + frame.priority.length;
    return this.data.frames.reduce((best, frame) => count(frame) > count(best) ? frame : best).at;
  }
  addEvent(event) {
    const item = Details.element("li"), button = Details.element("button", ((event.t - this.begin) * 1e-6).toFixed(1) + " s  " + Words.unbroken(event.text), event.kind);
    button.onclick = () => {
      this.view.chosen = Timeline.subject(event) || this.view.chosen;
      this.seek(event.t);
    };
    item.append(button);
    this.parts.events.append(item);
  }
  key(e) {
    if (e.ctrlKey || e.metaKey || e.altKey || e.target.tagName === "SELECT") return;
    if (e.target.tagName === "BUTTON" && (e.key === " " || e.key === "Enter")) return;
    const keys = { ...Hands.keys(this.view), " ": () => this.toggle(), ",": () => this.seek(this.now - 1e6), ".": () => this.seek(this.now + 1e6),
      Escape: () => { this.view.chosen = null; this.view.draw(); this.showDetails(); } };
    const act = keys[e.key] || keys[e.key.toLowerCase()];
    if (act) { e.preventDefault(); act(); }
    const layer = Number(e.key);
    if (layer >= 1 && layer <= this.layers.length) this.layers[layer - 1].click();
  }
  toggle() {
    this.isPlaying = !this.isPlaying;
    if (this.isPlaying && this.now >= this.end) this.now = this.begin;
    this.drawnAt = null;
    if (this.isPlaying) this.tick();
    this.draw();
  }
  seek(t) {
    this.now = Math.min(this.end, Math.max(this.begin, t));
    this.draw();
  }
  tick() {
    requestAnimationFrame((at) => {
      if (!this.isPlaying) return;
      if (this.drawnAt !== null) this.now += (at - this.drawnAt) * 1000 * Number(this.parts.speed.value);
      this.drawnAt = at;
      if (this.now >= this.end) { this.now = this.end; this.isPlaying = false; }
      this.draw();
      this.tick();
    });
  }
  /** The newest frame at the time of now. */
  frame() {
    let low = 0, high = this.data.frames.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.data.frames[middle].at <= this.now) low = middle; else high = middle - 1;
    }
    return this.data.frames[low];
  }
  draw() {
    const frame = this.frame();
    if (frame !== this.shown) {
      this.shown = frame;
      this.view.frame = frame;
      this.showDetails();
    }
    this.view.draw();
    this.hands.showLines();
    const age_s = (this.now - frame.rx) * 1e-6;  // As live: never a picture that only looks new.
    this.parts.stage.classList.toggle("is-late", age_s > 0.45);
    this.parts.late.hidden = age_s <= 0.45;
    this.parts.late.textContent = "lists are " + age_s.toFixed(1) + " s old";
    this.parts.play.textContent = this.isPlaying ? "Pause" : "Play";
    this.parts.time.textContent = ((this.now - this.begin) * 1e-6).toFixed(1) + " / " + ((this.end - this.begin) * 1e-6).toFixed(1) + " s";
    this.timeline.draw({ begin: this.begin, end: Math.max(this.end, this.begin + 1), now: this.now, events: this.data.events, colours: this.view.colours });
    let last = -1;
    this.data.events.forEach((event, i) => { if (event.t <= this.now) last = i; });
    if (last !== this.marked) {
      const items = this.parts.events.children;
      if (items[this.marked]) items[this.marked].classList.remove("is-now");
      if (items[last]) {
        items[last].classList.add("is-now");
        this.parts.events.scrollTop = items[last].offsetTop - this.parts.events.clientHeight / 2;
      }
      this.marked = last;
    }
  }
  showDetails() { Details.fill(this.parts.details, this.view.frame, this.view.chosen); }
}

async function startClip() {
  const root = document.getElementById("clip"), note = root.querySelector(".note");
  try {
    const packed = Uint8Array.from(atob(document.getElementById("clip-data").textContent.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const clip = new Clip(root, JSON.parse(await new Response(stream).text()));
    note.remove();
    root.dataset.ready = "yes";
    if (new URLSearchParams(location.search).has("test")) window.__clip = clip;
  } catch (error) {
    note.textContent = "The scene cannot be played here: " + error.message + " (it needs a browser of 2023 or newer).";
  }
}
startClip();
