// SPDX-License-Identifier: Apache-2.0
// The connection to v2vouch-view. Calls handlers; comes back by itself when the program was restarted.
"use strict";

class ViewClient {
  /** @param handlers {scene, map, status, events, clock, picture, link} */
  constructor(handlers) {
    this.handlers = handlers;
    this.token = new URLSearchParams(location.hash.slice(1)).get("t") || "";
    this.connect();
  }
  connect() {
    const protocols = ["v2vouch.view.v1"];
    if (/^[0-9a-f]+$/.test(this.token)) protocols.push("v2vouch.token." + this.token);
    const socket = this.socket = new WebSocket("ws://" + location.host + "/", protocols);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { this.handlers.link(true); };
    socket.onclose = () => {
      this.handlers.link(false);
      setTimeout(() => this.connect(), 1000);
    };
    socket.onmessage = (event) => {
      if (typeof event.data !== "string") return this.takeBinary(event.data);
      const message = JSON.parse(event.data);
      const handler = this.handlers[message.k];
      if (handler) handler(message);
    };
  }
  takeBinary(buffer) {
    const view = new DataView(buffer);
    if (view.getUint8(0) !== 16) return;
    const length = view.getUint32(1, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 5, length)));
    this.handlers.picture(head, new Uint8Array(buffer, 5 + length));
  }
  say(object) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(object));
  }
  drawn() { this.say({ op: "drawn" }); }
  pictures(on) { this.say({ op: "pictures", on }); }
  /** Foxglove's playback control. @param seek_us arrival time in the log, or null */
  control(play, speed, seek_us) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    const bytes = new DataView(new ArrayBuffer(19));
    bytes.setUint8(0, 3);
    bytes.setUint8(1, play ? 0 : 1);
    bytes.setFloat32(2, speed, true);
    bytes.setUint8(6, seek_us === null ? 0 : 1);
    bytes.setBigUint64(7, BigInt(Math.max(0, Math.round(seek_us || 0))) * 1000n, true);
    this.socket.send(bytes.buffer);
  }
}
