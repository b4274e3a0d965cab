// SPDX-License-Identifier: Apache-2.0
// The page: joins connection, scene, panels, keys.
"use strict";
const $ = (id) => document.getElementById(id);
const view = new SceneView($("scene"));
const strips = new Strips($("strips"));
const timeline = new Timeline($("timeline"), (t) => seek(t));
const state = { frame: null, clock: null, status: null, events: [], linked: false, arrived: 0, heard: 0, rx: 0,
  seeks: 0, pictures: new Map(), drawWanted: false, asked: null };
if (new URLSearchParams(location.search).has("test")) window.__state = state;
const LATE_S = 0.4;  // Looked at every 50 ms: grey half a second after the last list.

const element = Details.element;

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
      const whole = status.latency.find((l) => l.stage === "input_to_list") || status.latency[status.latency.length - 1];
      if (whole) strips.add("latency p99, " + whole.stage.replaceAll("_", " "), "ms", t, whole.p99 / 1000);
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
    hands.showLines();
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
  else if (!state.frame) words = clock && !clock.live ? "no list up to here (a log of inputs alone: run v2vouch-replay over it first)" : "no list yet";
  else if (seconds > LATE_S) words = "lists are " + seconds.toFixed(1) + " s old";
  else late = false;
  document.body.classList.toggle("is-late", late);
  $("late").hidden = !late;
  $("late").textContent = words;
  let now = state.frame ? "late" : "no list";
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
function showDetails() { Details.fill($("details"), state.frame, view.chosen); }
function showInputs() {
  const panel = $("inputs");
  panel.replaceChildren();
  if (!state.status || !state.status.inputs) {
    panel.append(element("div", "no V2VOUCH_STATUS yet", "soft"));
    return;
  }
  const table = element("table");
  for (const input of state.status.inputs) {
    Details.rows(table, [[input.name, Words.number(input.hz, 0, "Hz") + ", age " + Words.number(input.age, 2, "s") +
      (input.gaps ? ", " + input.gaps + " lost" : "") + (input.silent ? ", silent" : ""), input.silent ? "bad" : ""]]);
  }
  for (const [name, count] of state.status.refusals) Details.rows(table, [["refused: " + name, String(count), "bad"]]);
  panel.append(table);
}
function addEvent(event) {
  const item = element("li"), button = element("button", undefined, event.kind);
  button.append(element("b", ""), document.createTextNode(Words.unbroken(event.text)));
  button.dataset.t = event.t;
  button.onclick = () => {
    view.chosen = Timeline.subject(event) || view.chosen;
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
    const size = 11 * bitmap.width / Math.max(1, canvas.clientWidth || bitmap.width);
    g.font = size + "px system-ui, sans-serif";
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
  timeline.draw({ begin, end, now: clock.live ? null : clock.now, events: state.events, colours: view.colours });
}

// --- hands
const layers = Hands.layers($("layers"), view);
const hands = new Hands(view, { hover: $("hover"), choose: showDetails });
$("play").onclick = togglePlay;
$("speed").onchange = () => client.control(playing(), Number($("speed").value), null);
$("help-button").onclick = () => $("help").showModal();
document.addEventListener("keydown", (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || e.target.tagName === "SELECT" || $("help").open) return;
  if (e.target.tagName === "BUTTON" && (e.key === " " || e.key === "Enter")) return;
  const now = state.clock ? state.clock.now : 0;
  const keys = {
    " ": togglePlay, ...Hands.keys(view), ",": () => seek(now - 1e6), ".": () => seek(now + 1e6),
    "?": () => $("help").showModal(), Escape: () => { view.chosen = null; view.draw(); showDetails(); },
  };
  const act = keys[e.key] || keys[e.key.toLowerCase()];
  if (act && (state.frame || e.key === "?")) { e.preventDefault(); act(); }
  const layer = Number(e.key);
  if (layer >= 1 && layer <= layers.length) layers[layer - 1].click();
});
function legend() {
  const items = [["LOCAL: seen by radar or camera", "local", (v) => v.drawLocal({ id: "", x: 0, y: 0, yaw: 0, len: 4.5, wid: 1.8, v: 0, vis: 0 })],
    ["PRIORITY: seen, and its V2V sender is believed", "priority", (v) => v.drawPriority({ id: "", x: 0, y: 0, yaw: 0, len: 4.5, wid: 1.8, local: "1" })],
    ["PRIORITY, hidden: carried by V2V; arc = budget left", "hidden", (v) => { v.frame = { priority: [], local: [] }; v.label = () => {}; v.drawPriority({ id: "", x: 0, y: 0, yaw: 0, len: 4.5, wid: 1.8, local: "", budget: 6, cov: [1, 0, 0.3] }); }],
    ["where a sender says it is; dashed: not validated", "sender", (v) => { v.frame = { priority: [], local: [] }; v.drawSender({ id: "", x: 0, y: 0, yaw: 0, trust: 1 }); }],
    ["a sender that is not believed", "bad", (v) => { v.frame = { priority: [], local: [] }; v.label = () => {}; v.drawSender({ id: "", x: 0, y: 0, yaw: 0, trust: 5 }); }],
    ["warned of; a cross where the contact would be", "bad", (v) => { v.frame = { warnings: [{ x: -3, y: 0, cx: 5, cy: 0, level: 3 }] }; v.label = () => {}; v.drawWarnings(); }]];
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
showInputs();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { view.restyle(); legend(); view.draw(); });
new ResizeObserver(() => { view.reserve = $("layers").offsetHeight + 12; view.draw(); }).observe($("stage"));
showDetails();
