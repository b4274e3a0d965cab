// SPDX-License-Identifier: Apache-2.0
// The page: joins connection, scene, panels, keys.
"use strict";
const $ = (id) => document.getElementById(id);
const view = new SceneView($("scene"));
const strips = new Strips($("strips"));
const state = { frame: null, clock: null, status: null, events: [], linked: false, arrived: 0, heard: 0, rx: 0,
  seeks: 0, pictures: new Map(), drawWanted: false, asked: null };
if (new URLSearchParams(location.search).has("test")) window.__state = state;
const LATE_S = 0.4;  // Looked at every 50 ms: grey half a second after the last list.

function element(tag, text, className) {
  const e = document.createElement(tag);
  if (text !== undefined) e.textContent = text;
  if (className) e.className = className;
  return e;
}

// --- what comes
const client = new ViewClient({
  link(on) {
    state.linked = on;
    if (on) client.pictures(true);
    if (on) { state.events = []; $("events").replaceChildren(); }
    showState();
  },
  clock(clock) {
    state.clock = clock;
    // A clock that left before our command arrived does not undo it.
    if (state.asked && performance.now() - state.asked.at < 400) clock.status = state.asked.status;
    state.heard = performance.now();
    if (clock.seeks !== undefined && clock.seeks !== state.seeks) {
      state.seeks = clock.seeks;
      strips.clear();
    }
    showTransport();
    showState();
  },
  map(map) { view.map = map; wantDraw(); },
  status(status) {
    state.status = status;
    const t = status.t * 1e-6;
    if (status.t !== undefined) {
      const whole = status.latency.find((l) => l.stage === "total") || status.latency[status.latency.length - 1];
      if (whole) strips.add("latency p99, " + whole.stage, "us", t, whole.p99);
      strips.add("tracks, LOCAL", "", t, status.local);
      strips.add("tracks, PRIORITY", "", t, status.priority);
      strips.add("messages in", "/s", t, status.inputs.reduce((sum, i) => sum + (i.hz || 0), 0));
      strips.add("drops", "", t, status.drops_own + status.drops_bsm + Math.max(0, status.drops_kernel));
    }
    showInputs();
    strips.draw();
  },
  events(message) {
    for (const event of message.events) {
      if (state.events.length && event.n <= state.events[state.events.length - 1].n) continue;
      state.events.push(event);
      addEvent(event);
    }
    while (state.events.length > 2000) state.events.shift();
    showTransport();
  },
  scene(frame) {
    state.frame = frame;
    if (frame.rx !== state.rx) { state.rx = frame.rx; state.arrived = performance.now(); }
    document.body.dataset.ready = "yes";
    wantDraw();
  },
  picture(head, jpeg) {
    createImageBitmap(new Blob([jpeg], { type: "image/jpeg" })).then((bitmap) => {
      const old = state.pictures.get(head.camera);
      if (old) old.bitmap.close();
      state.pictures.set(head.camera, { head, bitmap });
      drawPictures();
    }).catch(() => {});
  },
});

// --- drawing: on data, at most once per displayed frame
function wantDraw() {
  if (state.drawWanted) return;
  state.drawWanted = true;
  const paint = () => {
    if (!state.drawWanted) return;
    state.drawWanted = false;
    view.draw(state.frame);
    showDetails();
    showState();
    drawPictures();
    client.drawn();
  };
  requestAnimationFrame(paint);
  setTimeout(paint, 200);  // A page in the background gets no animation frames.
}

/** Age of the lists in seconds: in a log by its clock, live by arrival here. */
function age() {
  const clock = state.clock;
  if (!clock || !state.frame) return Infinity;
  const silence = (performance.now() - state.heard) / 1000;
  if (clock.live) return (performance.now() - state.arrived) / 1000;
  // The program itself may have stopped.
  return Math.max((clock.now - clock.rx) * 1e-6, clock.status === 0 && silence > LATE_S ? silence : 0);
}

function showState() {
  const clock = state.clock, seconds = age();
  let words = "", late = true;
  if (!state.linked) words = "no connection to v2vouch-view";
  else if (clock && !clock.open) words = "LCM bus not open";
  else if (!state.frame) words = "no list yet";
  else if (seconds > LATE_S) words = "lists are " + seconds.toFixed(1) + " s old";
  else late = false;
  document.body.classList.toggle("is-late", late);
  $("late").hidden = !late;
  $("late").textContent = words;
  let now = "late";
  if (!late) now = clock.live ? "live" : ["playing", "paused", "reading", "ended"][clock.status];
  if (!late && state.frame.stale) now += ", predicted: no sensor for 0.1 s";
  if (!late && state.frame.suspect) now += ", own GNSS suspect";
  $("state").textContent = now;
  $("state").className = late || (state.frame && (state.frame.stale || state.frame.suspect)) ? "bad" : "";
  if (state.frame) {
    const f = state.frame;
    $("counts").textContent = f.local.length + " LOCAL, " + f.priority.length + " PRIORITY, " + f.heard + " senders, " +
      Words.number(f.ego ? f.ego.v : null, 1, "m/s");
  }
}
setInterval(showState, 50);

// --- panels
function rows(table, list) {
  for (const [name, value, className] of list) {
    const row = element("tr");
    row.append(element("th", name), element("td", value, className));
    table.append(row);
  }
}
function showDetails() {
  const panel = $("details"), chosen = view.chosen;
  panel.replaceChildren();
  if (!chosen || !state.frame) {
    panel.append(element("h2", "Nothing chosen"), element("div", "Click a vehicle or a sender's arrow.", "soft"));
    return;
  }
  const list = { local: state.frame.local, priority: state.frame.priority, sender: state.frame.senders }[chosen.kind];
  const o = list.find((item) => item.id === chosen.id);
  const title = { local: "LOCAL vehicle ", priority: "PRIORITY vehicle ", sender: "Sender " }[chosen.kind];
  panel.append(element("h2", title + (chosen.kind === "sender" ? chosen.id : Words.short(chosen.id))));
  if (!o) { panel.append(element("div", "no longer in the list", "bad")); return; }
  const table = element("table"), ego = state.frame.ego;
  if (ego) rows(table, [["distance", Math.hypot(o.x - ego.x, o.y - ego.y).toFixed(1) + " m"]]);
  rows(table, [["speed", Words.number(o.v, 1, "m/s")], ["size", Words.number(o.len, 1) + " x " + Words.number(o.wid, 1, "m")]]);
  if (chosen.kind !== "sender") {
    const [xx, xy, yy] = o.cov;
    rows(table, [["class", Words.classes[o.cls] || "unknown"], ["existence", Words.number(o.ex, 3)],
      ["visibility", Words.visibility[o.vis] || ""], ["known for", Words.number(o.since, 1, "s")],
      ["position sigma", xx === null ? "none" : Math.sqrt(Math.max(xx, 0)).toFixed(2) + ", " + Math.sqrt(Math.max(yy, 0)).toFixed(2) + " m (covariance " + Words.number(xy, 3) + ")"],
      ["speed sigma", Words.number(o.vs, 2, "m/s")]]);
    for (const [kind, name, seconds] of o.src) {
      rows(table, [[Words.sources[kind] + (name ? " " + name : ""), Words.number(seconds, 2, "s ago")]]);
    }
  }
  if (chosen.kind === "priority") {
    rows(table, [["sender", o.sender], ["LOCAL track", o.local ? Words.short(o.local) : "none: hidden", o.local ? "" : "bad"],
      ["budget", Words.number(o.budget, 1, "s")]]);
  }
  if (chosen.kind !== "local") {
    rows(table, [["trust", Words.trust[o.trust] + ": " + Words.why[o.trust], o.trust >= 5 ? "bad" : ""],
      ["bias", o.bias[0] === null ? "none" : o.bias[0].toFixed(2) + " m east, " + o.bias[1].toFixed(2) + " m north"]]);
  }
  if (chosen.kind === "sender") {
    rows(table, [["heard", Words.number(o.age, 2, "s ago")],
      ["taken for", o.vehicle ? "PRIORITY " + Words.short(o.vehicle) : o.track ? "LOCAL " + Words.short(o.track) : "nothing the sensors see"]]);
    if (o.liar) rows(table, [["truth", "an attacker's (the simulator says so)", "bad"]]);
  }
  panel.append(table);
  const sender = chosen.kind === "priority" ? state.frame.senders.find((s) => s.id === o.sender) : o;
  if (chosen.kind !== "local" && sender && sender.said && sender.said.length) {
    panel.append(element("h2", "Last verdicts"));
    const said = element("ol");
    for (const [seconds, text, times] of sender.said.slice().reverse()) {
      said.append(element("li", Words.number(seconds, 1, "s ago") + ": " + text + (times > 1 ? " (" + times + " times)" : "")));
    }
    panel.append(said);
  }
}
function showInputs() {
  const panel = $("inputs");
  panel.replaceChildren();
  if (!state.status || !state.status.inputs) return;
  const table = element("table");
  for (const input of state.status.inputs) {
    rows(table, [[input.name, Words.number(input.hz, 0, "Hz") + ", age " + Words.number(input.age, 2, "s") +
      (input.gaps ? ", " + input.gaps + " lost" : "") + (input.silent ? ", silent" : ""), input.silent ? "bad" : ""]]);
  }
  for (const [name, count] of state.status.refusals) rows(table, [["refused: " + name, String(count), "bad"]]);
  panel.append(table);
}
function addEvent(event) {
  const item = element("li"), button = element("button", undefined, event.kind);
  button.append(element("b", ""), document.createTextNode(event.text));
  button.dataset.t = event.t;
  button.onclick = () => {
    if (event.vehicle) view.chosen = { kind: "priority", id: event.vehicle };
    else if (event.sender) view.chosen = { kind: "sender", id: event.sender };
    seek(event.t - 500000);  // A moment before.
    wantDraw();
  };
  item.append(button);
  const list = $("events");
  list.prepend(item);
  while (list.childElementCount > 300) list.lastElementChild.remove();
  timeEvents();
}
function timeEvents() {
  const begin = state.clock && state.clock.begin;
  for (const button of $("events").querySelectorAll("button")) {
    const label = button.firstElementChild;
    if (label.textContent) continue;
    if (begin !== undefined && begin !== null) label.textContent = ((button.dataset.t - begin) * 1e-6).toFixed(1) + " s";
    else label.textContent = new Date(button.dataset.t / 1000).toISOString().slice(11, 19);
  }
}
function drawPictures() {
  const parent = $("cameras");
  for (const [name, { head, bitmap }] of state.pictures) {
    let canvas = parent.querySelector("canvas[data-camera='" + CSS.escape(name) + "']");
    if (!canvas) {
      canvas = element("canvas");
      canvas.dataset.camera = name;
      parent.append(element("h2", "Camera " + name), canvas);
    }
    if (canvas.width !== bitmap.width) { canvas.width = bitmap.width; canvas.height = bitmap.height; }
    const g = canvas.getContext("2d");
    g.drawImage(bitmap, 0, 0);
    const camera = state.frame && state.frame.cameras.find((c) => c.name === name);
    if (!camera || !camera.boxes) continue;
    const k = bitmap.width / (camera.w || head.w || bitmap.width);
    g.lineWidth = Math.max(2, bitmap.width / 400);
    g.strokeStyle = g.fillStyle = "#56b4e9";
    g.font = Math.max(12, bitmap.width / 40) + "px system-ui, sans-serif";
    for (const [left, top, width, height, kind, score] of camera.boxes) {
      g.strokeRect(left * k, top * k, width * k, height * k);
      g.fillText(kind + (score ? " " + score.toFixed(2) : ""), left * k, top * k - 4);
    }
  }
}

// --- time
function playing() { return state.clock && state.clock.status === 0; }
function seek(t) {
  if (!state.clock || state.clock.live) return;
  client.control(playing(), Number($("speed").value), t);
}
function togglePlay() {
  if (!state.clock || state.clock.live) return;
  client.control(!playing(), Number($("speed").value), null);
  state.asked = { status: playing() ? 1 : 0, at: performance.now() };
  state.clock.status = state.asked.status;
}
function showTransport() {
  const clock = state.clock;
  if (!clock) return;
  $("play").hidden = $("speed").hidden = clock.live;
  $("play").textContent = clock.status === 0 ? "Pause" : "Play";
  if (!clock.live && document.activeElement !== $("speed")) $("speed").value = String(clock.speed);
  $("source").textContent = clock.source;
  $("source").title = clock.source;
  const begin = clock.live ? clock.now - 120e6 : clock.begin, end = clock.live ? clock.now : clock.end;
  $("time").textContent = clock.live ? "last 2 min" :
    ((clock.now - begin) * 1e-6).toFixed(1) + " / " + ((end - begin) * 1e-6).toFixed(1) + " s";
  timeEvents();
  const canvas = $("timeline"), ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  canvas.width = w * ratio;
  canvas.height = h * ratio;
  const g = canvas.getContext("2d"), colours = view.colours;
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.fillStyle = colours.line;
  g.fillRect(0, h - 10, w, 4);
  const x = (t) => (t - begin) / Math.max(1, end - begin) * w;
  if (!clock.live) {
    g.fillStyle = colours.local;
    g.fillRect(0, h - 10, x(clock.now), 4);
    g.fillRect(x(clock.now) - 1.5, 2, 3, h - 4);
  }
  const marks = { validated: ["priority", "v"], bridged: ["hidden", "h"], seen_again: ["priority", "s"], ended: ["soft", "e"],
    withdrawn: ["bad", "w"], accused: ["bad", "A"], notice: ["bad", "n"] };
  g.font = "bold 11px system-ui, sans-serif";
  g.textAlign = "center";
  const shown = state.events.filter((event) => event.t >= begin && event.t <= end);
  for (const event of shown) {
    g.fillStyle = colours[(marks[event.kind] || ["soft"])[0]];
    g.fillRect(x(event.t) - 0.75, 13, 1.5, h - 20);
  }
  // Letters do not overlap; verdicts come first.
  const taken = [], weight = (event) => ["accused", "withdrawn", "bridged", "validated"].indexOf(event.kind) + 1 || 9;
  for (const event of shown.slice().sort((a, b) => weight(a) - weight(b))) {
    const [colour, letter] = marks[event.kind] || ["soft", "?"];
    const at = Math.min(w - 5, Math.max(5, x(event.t)));
    if (taken.some((other) => Math.abs(other - at) < 9)) continue;
    taken.push(at);
    g.fillStyle = colours[colour];
    g.fillText(letter, at, 11);
  }
}

// --- hands
const layerNames = [["fields", "fields"], ["local", "LOCAL"], ["priority", "PRIORITY"], ["senders", "V2V"], ["radar", "radar"],
  ["camera", "camera"], ["truth", "truth"], ["map", "roads"]];
for (const [key, name] of layerNames) {
  const button = element("button", name);
  button.setAttribute("aria-pressed", "true");
  button.onclick = () => {
    view.layers[key] = !view.layers[key];
    button.setAttribute("aria-pressed", String(view.layers[key]));
    view.draw();
  };
  $("layers").append(button);
}
const pointers = new Map();
let moved = 0, pinch = 0;
$("scene").onpointerdown = (e) => {
  pointers.set(e.pointerId, e);
  $("scene").setPointerCapture(e.pointerId);
  moved = 0;
};
$("scene").onpointermove = (e) => {
  const before = pointers.get(e.pointerId);
  if (!before) return;
  const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
  pointers.set(e.pointerId, e);
  moved += Math.abs(dx) + Math.abs(dy);
  if (pointers.size === 2) {
    const [a, b] = [...pointers.values()];
    const distance = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    if (pinch > 0) view.zoom(distance / pinch);
    pinch = distance;
  } else if (moved > 4 && state.frame) {
    view.pan(dx, dy);
  }
};
$("scene").onpointerup = $("scene").onpointercancel = (e) => {
  if (moved <= 4 && e.type === "pointerup") {
    const box = $("scene").getBoundingClientRect();
    view.chosen = view.pick(e.clientX - box.left, e.clientY - box.top);
    view.draw();
    showDetails();
  }
  pointers.delete(e.pointerId);
  pinch = 0;
};
$("scene").addEventListener("wheel", (e) => {
  e.preventDefault();
  const box = $("scene").getBoundingClientRect();
  view.zoom(Math.exp(-e.deltaY * 0.0015), e.clientX - box.left, e.clientY - box.top);
}, { passive: false });
$("timeline").onclick = (e) => {
  const clock = state.clock;
  if (!clock || clock.live) return;
  const box = $("timeline").getBoundingClientRect();
  seek(clock.begin + (e.clientX - box.left) / box.width * (clock.end - clock.begin));
};
$("play").onclick = togglePlay;
$("speed").onchange = () => client.control(playing(), Number($("speed").value), null);
$("help-button").onclick = () => $("help").showModal();
document.addEventListener("keydown", (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || e.target.tagName === "SELECT" || $("help").open) return;
  if (e.target.tagName === "BUTTON" && (e.key === " " || e.key === "Enter")) return;
  const step = 40, now = state.clock ? state.clock.now : 0;
  const keys = {
    " ": togglePlay, ArrowLeft: () => view.pan(step, 0), ArrowRight: () => view.pan(-step, 0),
    ArrowUp: () => view.pan(0, step), ArrowDown: () => view.pan(0, -step), "+": () => view.zoom(1.25), "=": () => view.zoom(1.25),
    "-": () => view.zoom(0.8), f: () => { view.centre = null; view.draw(); },
    n: () => { view.headingUp = !view.headingUp; view.draw(); }, ",": () => seek(now - 1e6), ".": () => seek(now + 1e6),
    "?": () => $("help").showModal(), Escape: () => { view.chosen = null; view.draw(); showDetails(); },
  };
  const act = keys[e.key] || keys[e.key.toLowerCase()];
  if (act && (state.frame || e.key === "?")) { e.preventDefault(); act(); }
  const layer = Number(e.key);
  if (layer >= 1 && layer <= layerNames.length) $("layers").children[layer - 1].click();
});
function legend() {
  const items = [["LOCAL: seen by radar or camera", "local", (v) => v.drawLocal({ id: "", x: 0, y: 0, yaw: 0, len: 4.5, wid: 1.8, v: 0, vis: 0 })],
    ["PRIORITY: seen, and its V2V sender is believed", "priority", (v) => v.drawPriority({ id: "", x: 0, y: 0, yaw: 0, len: 4.5, wid: 1.8, local: "1" })],
    ["PRIORITY, hidden: carried by V2V; arc = budget left", "hidden", (v) => { v.frame = { priority: [], local: [] }; v.label = () => {}; v.drawPriority({ id: "", x: 0, y: 0, yaw: 0, len: 4.5, wid: 1.8, local: "", budget: 6, cov: [1, 0, 0.3] }); }],
    ["where a sender says it is; dashed: not validated", "sender", (v) => { v.frame = { priority: [], local: [] }; v.drawSender({ id: "", x: 0, y: 0, yaw: 0, trust: 1 }); }],
    ["a sender that is not believed", "bad", (v) => { v.frame = { priority: [], local: [] }; v.label = () => {}; v.drawSender({ id: "", x: 0, y: 0, yaw: 0, trust: 5 }); }]];
  $("legend").replaceChildren();
  for (const [text, , paint] of items) {
    const line = element("div"), canvas = element("canvas");
    line.append(canvas, element("span", text));
    $("legend").append(line);
    const v = new SceneView(canvas);
    canvas.width = 108; canvas.height = 52;
    v.g = canvas.getContext("2d");
    v.g.setTransform(2, 0, 0, 2, 0, 0);
    v.scale = 4; v.ox = 27; v.oy = 13; v.c = 1; v.s = 0; v.mx = v.my = 0; v.turn = 0;
    paint(v);
  }
}
legend();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { view.restyle(); legend(); view.draw(); });
new ResizeObserver(() => view.draw()).observe($("stage"));
showDetails();
