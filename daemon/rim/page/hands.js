// SPDX-License-Identifier: Apache-2.0
// Pointer, wheel, fingers and keys on a SceneView: move, zoom, choose, see what lies under the pointer.
"use strict";

class Hands {
  /** @param panels {hover: element of the lines under the pointer, choose: called after a click} */
  constructor(view, panels) {
    this.view = view;
    this.panels = panels;
    this.pointers = new Map();
    this.moved = 0;
    this.pinch = 0;
    const canvas = view.canvas;
    canvas.onpointerdown = (e) => {
      this.pointers.set(e.pointerId, e);
      canvas.setPointerCapture(e.pointerId);
      this.moved = 0;
      this.leave();
    };
    canvas.onpointermove = (e) => this.move(e);
    canvas.onpointerup = canvas.onpointercancel = (e) => this.release(e);
    canvas.onpointerleave = () => this.leave();
    canvas.addEventListener("wheel", (e) => {
      if (panels.wheelNeedsFocus && document.activeElement !== canvas) return;  // The page itself scrolls.
      e.preventDefault();
      const [x, y] = this.place(e);
      view.zoom(Math.exp(-e.deltaY * 0.0015), x, y);
    }, { passive: false });
  }
  place(e) {
    const box = this.view.canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }
  move(e) {
    const before = this.pointers.get(e.pointerId);
    if (!before) {
      if (e.pointerType === "mouse") this.hover(...this.place(e));
      return;
    }
    const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
    this.pointers.set(e.pointerId, e);
    this.moved += Math.abs(dx) + Math.abs(dy);
    if (this.pointers.size === 2) {
      const [a, b] = [...this.pointers.values()];
      const distance = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (this.pinch > 0) this.view.zoom(distance / this.pinch);
      this.pinch = distance;
    } else if (this.moved > 4 && this.view.frame) {
      this.view.pan(dx, dy);
    }
  }
  release(e) {
    if (this.moved <= 4 && e.type === "pointerup") {
      this.view.chosen = this.view.pick(...this.place(e));
      this.view.draw();
      this.panels.choose();
    }
    this.pointers.delete(e.pointerId);
    this.pinch = 0;
  }
  hover(x, y) {
    this.at = [x, y];
    const under = this.view.pick(x, y), before = this.view.hovered;
    this.view.hovered = under;
    if ((under && under.id) !== (before && before.id) || (under && under.kind) !== (before && before.kind)) this.view.draw();
    this.showLines();
  }
  /** Again after each new frame: figures change under a pointer at rest. */
  showLines() {
    const { hover } = this.panels, { hovered, frame } = this.view;
    const lines = hovered && frame ? Details.lines(frame, hovered) : [];
    hover.hidden = lines.length === 0;
    if (hover.hidden) return;
    hover.replaceChildren(...lines.map((line, i) => Details.element(i ? "div" : "b", line)));
    const canvas = this.view.canvas, [x, y] = this.at;
    hover.style.left = Math.max(0, Math.min(x + 14, canvas.clientWidth - hover.offsetWidth - 4)) + "px";
    hover.style.top = Math.max(0, Math.min(y + 14, canvas.clientHeight - hover.offsetHeight - 4)) + "px";
  }
  leave() {
    if (!this.view.hovered) return;
    this.view.hovered = null;
    this.panels.hover.hidden = true;
    this.view.draw();
  }

  /** Buttons that show and hide layers; returns them. */
  static layers(parent, view) {
    const names = [["fields", "fields"], ["local", "LOCAL"], ["priority", "PRIORITY"], ["senders", "V2V"], ["radar", "radar"],
      ["camera", "camera"], ["truth", "truth"], ["map", "roads"]];
    return names.map(([key, name]) => {
      const button = Details.element("button", name);
      button.setAttribute("aria-pressed", "true");
      button.onclick = () => {
        view.layers[key] = !view.layers[key];
        button.setAttribute("aria-pressed", String(view.layers[key]));
        view.draw();
      };
      parent.append(button);
      return button;
    });
  }
  /** What keys do to the view. */
  static keys(view) {
    const step = 40;
    return {
      ArrowLeft: () => view.pan(step, 0), ArrowRight: () => view.pan(-step, 0),
      ArrowUp: () => view.pan(0, step), ArrowDown: () => view.pan(0, -step),
      "+": () => view.zoom(1.25), "=": () => view.zoom(1.25), "-": () => view.zoom(0.8),
      f: () => { view.centre = null; view.draw(); },
      n: () => { view.headingUp = !view.headingUp; view.draw(); },
    };
  }
}
