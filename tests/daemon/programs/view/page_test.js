// SPDX-License-Identifier: Apache-2.0
// The page in Chromium, and Foxglove's client library, against the real program: a log, then live.
// Run by page_test.sh inside a network of its own. Arguments: folder of the programs, scratch folder.
"use strict";
const assert = require("node:assert");
const { spawn, execFileSync } = require("node:child_process");
const fs = require("node:fs");
const http = require("node:http");
const net = require("node:net");
const path = require("node:path");
const puppeteer = require("puppeteer-core");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

const [bin, scratch] = process.argv.slice(2);
const children = [];
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
async function until(what, condition, ms = 20000) {
  for (const end = Date.now() + ms; Date.now() < end; await sleep(20)) {
    const value = await condition();
    if (value) return value;
  }
  throw new Error("never: " + what);
}
function start(name, ...args) {
  const child = spawn(path.join(bin, name), args, { stdio: ["ignore", "pipe", "inherit"] });
  children.push(child);
  return child;
}
/** Starts v2vouch-view; its addresses. */
async function startView(...args) {
  const child = start("v2vouch-view", "--port", "0", ...args);
  let text = "";
  child.stdout.on("data", (data) => { text += data; });
  await until("address", () => text.includes("foxglove:"), 20000);
  const page = /page: +(\S+)/.exec(text)[1], foxglove = /foxglove: +(\S+)/.exec(text)[1];
  return { child, page: page.replace("/#", "/?test#"), foxglove, port: new URL(page).port, token: page.split("t=")[1] };
}
const residentKb = (pid) => Number(/VmRSS:\s+(\d+)/.exec(fs.readFileSync(`/proc/${pid}/status`, "utf8"))[1]);

const tests = [];
const test = (name, run) => tests.push([name, run]);
let browser, log, faults = [], strangers = [];
async function openPage(url) {
  const page = await browser.newPage();
  page.on("console", (m) => { if (["error", "warning"].includes(m.type())) faults.push(m.text()); });
  page.on("pageerror", (e) => faults.push(e.message));
  page.on("request", (r) => {
    if (!/^(http|ws):\/\/127\.0\.0\.1:|^(data|blob):/.test(r.url())) strangers.push(r.url());
  });
  page.setDefaultTimeout(60000);  // A busy machine takes long to load a page.
  await page.setViewport({ width: 1100, height: 700 });
  await page.goto(url);
  await page.waitForSelector("body[data-ready]");
  return page;
}
const frameOf = (page) => page.evaluate(() => window.__state.frame);
const control = (page, play, speed, second) => page.evaluate((p, s, t) => {
  client.control(p, s, t === null ? null : window.__state.clock.begin + t * 1e6);
}, play, speed, second);
const status = (options) => new Promise((resolve, reject) => {
  const request = http.request({ host: "127.0.0.1", port: log.port, ...options }, (response) => {
    response.resume();
    resolve(response);
  });
  request.on("upgrade", (response, socket) => { socket.destroy(); resolve(response); });
  request.on("error", reject);
  request.end();
});
const upgrade = (headers, target = "/") => status({ path: target, headers: {
  Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": "13",
  "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Protocol": "foxglove.sdk.v1", ...headers } })
  .then((response) => response.statusCode);

test("numbers on the page equal the lists that Foxglove's client gets at the same moment", async () => {
  const page = await openPage(log.page);
  await control(page, false, 1, 4.5);
  await until("pause", () => page.evaluate(() => window.__state.clock.status === 1));
  await sleep(300);
  const frame = await frameOf(page);
  assert.ok(frame.local.length > 0 && frame.priority.length > 0, "vehicles in both lists");
  const client = new FoxgloveClient({ ws: new WebSocket(log.foxglove, ["foxglove.websocket.v1"]) });
  const channels = await new Promise((resolve) => client.on("advertise", resolve));
  for (const [topic, list] of [["/v2vouch/local", frame.local], ["/v2vouch/priority", frame.priority]]) {
    const id = client.subscribe(channels.find((c) => c.topic === topic).id);
    const event = await new Promise((resolve) => client.on("message", (m) => { if (m.subscriptionId === id) resolve(m); }));
    const update = JSON.parse(new TextDecoder().decode(event.data));
    assert.deepStrictEqual(update.entities.map((e) => [e.id.split("_")[1], e.cubes[0].pose.position.x, e.cubes[0].pose.position.y]),
      list.map((t) => [t.id, t.x, t.y]));
  }
  client.close();
  const shown = await page.$eval("#counts", (e) => e.textContent);
  assert.ok(shown.startsWith(`${frame.local.length} LOCAL, ${frame.priority.length} PRIORITY`), shown);
  const chosen = frame.priority[0];
  await page.evaluate((id) => { view.chosen = { kind: "priority", id }; showDetails(); }, chosen.id);
  const details = await page.$eval("#details", (e) => e.textContent);
  assert.ok(details.includes("existence" + chosen.ex.toFixed(3)) && details.includes(chosen.sender), details);
  await page.close();
});

test("a click on an event seeks there; keys play, pause and step", async () => {
  const page = await openPage(log.page);
  const count = await page.$$eval("#events button", (all) => all.length);
  assert.ok(count > 0, "events");
  const at = await page.$eval("#events button", (b) => { b.click(); return Number(b.dataset.t); });
  await until("seek", () => page.evaluate((t) => Math.abs(window.__state.clock.now - (t - 500000)) < 400000, at));
  const status = () => page.evaluate(() => window.__state.clock.status);
  await control(page, false, 1, 1);
  await until("pause", async () => (await status()) === 1);
  await page.keyboard.press(" ");
  await sleep(600);
  assert.strictEqual(await status(), 0, "playing");
  await page.keyboard.press(" ");
  await page.keyboard.press(" ");  // At once: the second undoes the first.
  await sleep(600);
  assert.strictEqual(await status(), 0, "still playing");
  await page.keyboard.press(" ");
  await sleep(600);
  assert.strictEqual(await status(), 1, "paused");
  await page.close();
});

test("Foxglove's protocol: both names, playback control, all topics readable", async () => {
  for (const name of ["foxglove.sdk.v1", "foxglove.websocket.v1"]) {
    const socket = new WebSocket(log.foxglove, [name]);
    const client = new FoxgloveClient({ ws: socket });
    const info = await new Promise((resolve) => client.on("serverInfo", resolve));
    assert.strictEqual(socket.protocol, name);
    assert.ok(info.capabilities.includes("playbackControl") && info.dataEndTime.sec > 0);
    client.close();
  }
  const socket = new WebSocket(log.foxglove, ["foxglove.sdk.v1"]);
  const seen = new Set();
  let answer = null;
  const names = new Map();
  socket.on("message", (data, isBinary) => {
    if (isBinary && data[0] === 5 && data.length > 19) answer = data;
    if (isBinary && data[0] === 1) { seen.add(names.get(data.readUInt32LE(1))); JSON.parse(data.subarray(13)); }
    if (isBinary) return;
    const message = JSON.parse(data);
    if (message.op !== "advertise") return;
    for (const channel of message.channels) { JSON.parse(channel.schema); names.set(channel.id, channel.topic); }
    socket.send(JSON.stringify({ op: "subscribe", subscriptions: message.channels.map((c) => ({ id: c.id, channelId: c.id })) }));
    const request = Buffer.alloc(21);
    request[0] = 3; request.writeFloatLE(2.0, 2); request[6] = 1;
    request.writeBigUInt64LE(BigInt(log.begin + 2000000) * 1000n, 7);
    request.writeUInt32LE(2, 15); request.write("ab", 19);
    socket.send(request);
  });
  await until("answer to playback control", () => answer);
  assert.strictEqual(answer.subarray(19).toString(), "ab");
  assert.ok(Math.abs(Number(answer.readBigUInt64LE(2) / 1000n) - log.begin - 2000000) < 300000);
  await until("topics", () => ["/v2vouch/local", "/v2vouch/senders", "/v2vouch/radar", "/v2vouch/truth", "/tf", "/ego/gnss",
    "/v2vouch/log", "/v2vouch/status", "/v2vouch/plot/local", "/v2vouch/plot/priority"].every((topic) => seen.has(topic)));
  socket.close();
});

// Overlaps of labels on a SceneView.
const overlaps = (view) => view.placed.filter((a, i) => view.placed.some((b, k) => k > i &&
  a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3])).length;
// Where the vehicle nearest to the car is on the canvas.
const nearest = (view) => view.frame.local.map((o) => [Math.hypot(o.x - view.frame.ego.x, o.y - view.frame.ego.y), view.at(o.x, o.y)])
  .sort((a, b) => a[0] - b[0])[0][1];

test("what lies under the pointer is told; labels do not cover each other", async () => {
  const page = await openPage(log.page);
  await page.evaluate(`window.overlaps = ${overlaps}; window.nearest = ${nearest}`);
  for (const second of [1, 3, 4.5]) {
    await control(page, false, 1, second);
    await sleep(300);
    for (const zoom of [1, 0.3, 2]) {
      assert.strictEqual(await page.evaluate((z) => { view.scale = 6 * z; view.draw(); return overlaps(view); }, zoom), 0);
    }
  }
  const [x, y] = await page.evaluate(() => {
    view.scale = 4; view.draw();
    const box = view.canvas.getBoundingClientRect(), [px, py] = nearest(view);
    return [box.left + px, box.top + py];
  });
  await page.mouse.move(x, y);
  const text = await page.$eval("#hover", (e) => e.hidden ? "" : e.textContent);
  assert.ok(text.includes("vehicle") && /existence \d/.test(text), text);
  await page.mouse.move(2, 2);
  assert.ok(await page.$eval("#hover", (e) => e.hidden));
  await page.close();
});

test("the report plays the drive: same numbers, hover, zoom; the file asks nobody for anything", async () => {
  const folder = path.join(scratch, "report"), asked = [];
  execFileSync(path.join(bin, "v2vouch-eval"), [log.lists, "--report", folder], { stdio: "ignore" });
  const page = await browser.newPage();
  page.on("request", (r) => { if (!/^(file|blob|data):/.test(r.url())) asked.push(r.url()); });
  page.on("pageerror", (e) => faults.push(e.message));
  await page.setViewport({ width: 1200, height: 900 });
  await page.goto("file://" + folder + "/index.html?test");
  await page.waitForSelector("#clip[data-ready]", { timeout: 20000 });
  await page.evaluate(`window.overlaps = ${overlaps}; window.nearest = ${nearest}`);
  const live = await openPage(log.page);
  await control(live, false, 1, 4.5);
  await sleep(400);
  const frame = await frameOf(live);
  const same = await page.evaluate((t) => { const f = window.__clip.data.frames.find((g) => g.t === t); return f && [f.local, f.priority]; }, frame.t);
  if (same) assert.deepStrictEqual(same, [frame.local, frame.priority]);
  await live.close();
  const now = () => page.evaluate(() => window.__clip.now);
  const before = await now();
  await page.bringToFront();  // Nothing is played in the background.
  await page.click("#clip .play");
  await until("plays", async () => await now() > before, 10000);
  await page.click("#clip .play");
  assert.strictEqual(await page.evaluate(() => { __clip.seek(__clip.begin + 4e6); return overlaps(__clip.view); }), 0);
  await page.$eval("#clip", (e) => e.scrollIntoView());
  const [x, y] = await page.evaluate(() => {
    const v = __clip.view, box = v.canvas.getBoundingClientRect(), [px, py] = nearest(v);
    return [box.left + px, box.top + py];
  });
  await page.mouse.move(x, y);
  assert.match(await page.$eval("#clip .hover", (e) => e.hidden ? "" : e.textContent), /vehicle/);
  await page.mouse.click(x, y);
  assert.match(await page.$eval("#clip .details", (e) => e.textContent), /existence/);
  const scale = await page.evaluate(() => __clip.view.scale);
  await page.focus("#clip .scene");
  await page.mouse.wheel({ deltaY: -300 });
  await until("zoom", () => page.evaluate((s) => __clip.view.scale > s, scale), 3000);
  assert.deepStrictEqual(asked, []);
  await page.close();
});

test("wrong Host, Origin, token, sub-protocol, method and path are refused", async () => {
  const host = "127.0.0.1:" + log.port, good = "/?t=" + log.token;
  assert.strictEqual(await upgrade({ Host: host }, good), 101);
  assert.strictEqual(await upgrade({ Host: host, Origin: "http://" + host }, good), 101);
  for (const bad of ["attacker.example:" + log.port, "127.0.0.1.attacker.example:" + log.port, "127.0.0.1:1", "10.0.0.1:" + log.port]) {
    assert.strictEqual(await upgrade({ Host: bad }, good), 421, bad);
    assert.strictEqual((await status({ path: "/", headers: { Host: bad } })).statusCode, 421, bad);
  }
  for (const bad of ["http://attacker.example", "null", "http://localhost:" + log.port, "https://" + host]) {
    assert.strictEqual(await upgrade({ Host: host, Origin: bad }, good), 403, bad);
  }
  for (const bad of ["/", "/?t=", "/?t=" + log.token.slice(1), "/?t=" + "0".repeat(32)]) {
    assert.strictEqual(await upgrade({ Host: host }, bad), 401, bad);
  }
  assert.strictEqual(await upgrade({ Host: host, "Sec-WebSocket-Protocol": "chat" }, good), 400);
  assert.strictEqual((await status({ path: "/", method: "POST", headers: { Host: host } })).statusCode, 405);
  for (const bad of ["/../etc/passwd", "/app.js/..", "/x"]) {
    assert.strictEqual((await status({ path: bad, headers: { Host: host } })).statusCode, 404, bad);
  }
  const page = await status({ path: "/", headers: { Host: host } });
  assert.match(page.headers["content-security-policy"], /default-src 'none'/);
  assert.strictEqual(page.headers["access-control-allow-origin"], undefined);
});

test("garbage, half requests and oversized messages end their own connection only", async () => {
  let seed = 20261130;
  const random = () => (seed = (seed * 1103515245 + 12345) & 0x7fffffff) / 0x7fffffff;
  const head = `GET /?t=${log.token} HTTP/1.1\r\nHost: 127.0.0.1:${log.port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n` +
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n";
  for (let i = 0; i < 150; ++i) {
    const socket = net.connect(log.port, "127.0.0.1");
    socket.on("error", () => {});
    const bytes = Buffer.from(Array.from({ length: 1 + Math.floor(300 * random()) }, () => Math.floor(256 * random())));
    if (i % 3 === 0) socket.write(bytes);                                               // No HTTP.
    else if (i % 3 === 1) socket.write(head.slice(0, Math.floor(head.length * random())));  // Half a request.
    else { socket.write(head); socket.write(bytes); }                                  // No WebSocket frames.
    await sleep(4);
    socket.destroy();
  }
  const big = new WebSocket(log.foxglove, ["foxglove.sdk.v1"]);
  await new Promise((resolve) => big.on("open", resolve));
  big.on("error", () => {});
  big.send("x".repeat(100000));
  await new Promise((resolve) => big.on("close", resolve));
  await until("connections free again", async () => {
    try { return (await status({ path: "/health", headers: { Host: "127.0.0.1:" + log.port } })).statusCode === 200; } catch { return false; }
  }, 12000);
});

test("the program ends cleanly while clients are there", async () => {
  const view = await startView(log.lists);
  const ended = new Promise((resolve) => view.child.on("exit", (code, signal) => resolve([code, signal])));
  for (const name of ["foxglove.sdk.v1", "foxglove.websocket.v1"]) {
    const socket = new WebSocket(view.foxglove, [name]);
    socket.on("error", () => {});
    await new Promise((resolve) => socket.on("open", resolve));
  }
  view.child.kill("SIGTERM");
  assert.deepStrictEqual(await ended, [0, null]);
});

test("two pages, a reload, and a client that reads nothing cost no memory", async () => {
  const one = await openPage(log.page), two = await openPage(log.page);
  await control(one, true, 1, 0.5);
  const slow = new WebSocket(log.foxglove, ["foxglove.sdk.v1"]);
  await new Promise((resolve) => slow.on("open", resolve));
  slow.send(JSON.stringify({ op: "subscribe", subscriptions: [1, 2, 3, 4, 5, 6].map((id) => ({ id, channelId: id })) }));
  slow._socket.pause();
  const before = residentKb(log.child.pid);
  await one.reload();
  await one.waitForSelector("body[data-ready]");
  await sleep(3000);
  const grown = residentKb(log.child.pid) - before;
  assert.ok(grown < 8000, `grew by ${grown} kB`);
  const [a, b] = [await frameOf(one), await frameOf(two)];
  assert.ok(Math.abs(a.t - b.t) < 400000, "both see the same time");
  slow.terminate();
  await one.close();
  await two.close();
});

test("live: SIGSTOP of the daemon turns the page grey in half a second, SIGCONT brings it back", async () => {
  const began = Date.now(), step = (what) => console.log(`  ${what} at ${Date.now() - began} ms`);
  const daemon = start("v2vouchd");
  const live = await startView();
  const drive = start("v2vouch-sim", "run", "left_turn", "--seed", "1", "--live");
  step("drive started");
  const page = await openPage(live.page);
  step("page ready");
  await until("live picture", () => page.evaluate(() => document.getElementById("state").textContent.startsWith("live")), 30000);
  assert.ok(!(await page.evaluate(() => document.body.classList.contains("is-late"))));
  await until("latency on its strip", () => page.evaluate(() =>
    (strips.strips.get("latency p99, input to list") || { points: [] }).points.some(([, ms]) => ms > 0)));
  // By the page's own clock: from the last list to grey.
  await page.evaluate(() => {
    new MutationObserver(() => {
      if (document.body.classList.contains("is-late")) window.__greyAfter = performance.now() - window.__state.arrived;
    }).observe(document.body, { attributes: true });
  });
  daemon.kill("SIGSTOP");
  const took = await until("grey", () => page.evaluate(() => window.__greyAfter));
  console.log(`  grey ${took.toFixed(0)} ms after the last list`);
  assert.ok(took < 600, `${took} ms`);  // 500, and a busy machine.
  assert.match(await page.$eval("#late", (e) => e.textContent), /lists are \d\.\d s old/);
  step("grey");
  daemon.kill("SIGCONT");
  await until("colour again", () => page.evaluate(() => !document.body.classList.contains("is-late")));
  step("colour again");
  drive.kill("SIGINT");
  await page.close();
});

async function main() {
  const inputs = path.join(scratch, "in.lcm"), lists = path.join(scratch, "out.lcm");
  execFileSync(path.join(bin, "v2vouch-sim"), ["run", "smoke", "--seed", "1", "--out", inputs]);
  execFileSync(path.join(bin, "v2vouch-replay"), [inputs, "--out", lists]);
  log = await startView(lists);
  log.lists = lists;
  browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium", headless: true,
    args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-background-networking", "--no-first-run",
      "--disable-sync", "--user-data-dir=" + path.join(scratch, "browser")] });
  const first = await openPage(log.page);
  log.begin = await first.evaluate(() => window.__state.clock.begin);
  await first.close();
  let failed = 0;
  for (const [name, run] of tests) {
    if (process.env.ONLY && !name.includes(process.env.ONLY)) continue;
    const began = Date.now();
    try {
      await run();
      assert.deepStrictEqual([faults, strangers], [[], []], "console and requests");
      console.log(`ok   ${name} (${Date.now() - began} ms)`);
    } catch (error) {
      ++failed;
      console.log(`FAIL ${name}\n  ${error.stack}`);
    }
    faults = [];
    strangers = [];
  }
  return failed;
}
main().catch((error) => { console.log(error); return 1; }).then(async (failed) => {
  if (browser) await browser.close();
  for (const child of children) { child.kill("SIGCONT"); child.kill("SIGTERM"); }
  process.exit(failed ? 1 : 0);
});
