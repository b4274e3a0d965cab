# SPDX-License-Identifier: Apache-2.0
"""What scripts/soak and scripts/chaos share: a drive played over LCM as fast as wanted, a radio flood, programs
with their memory and descriptors, and a listener that checks every list."""

import ctypes
import math
import os
import random
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "examples", "python"))
import v2vouch_lcm  # noqa: E402

OURS = ("TRUTH", "SIM", "TRACKS", "V2VOUCH", "MISBEHAVIOR", "WARNINGS", "CALIBRATION", "BSM_VERDICT")
SHORT = 0x4C433032


def in_private_network():
    """Starts the script anew in a network of its own."""
    if not os.environ.get("V2VOUCH_PRIVATE_LCM"):
        tool = os.path.join(ROOT, "scripts", "with_private_lcm")
        os.execv(tool, [tool, sys.executable, *sys.argv])


def group_and_port(url):
    group, _, port = url[len("udpm://"):].partition("?")[0].partition(":")
    return group, int(port)


def play(log, url, speed, loop_s, until_s, flood, pauses):
    """Ends after `until_s` of wall time. The drive begins anew every `loop_s` of its own time, stamps going on.

    flood: [(from_s, to_s, messages per second)] of BSMs with random identities round the first one's place;
    pauses: [(from_s, to_s)] without any message: the sources have been restarted. Wall time, both.
    """
    events = [(u, c, d) for u, c, d in v2vouch_lcm.read_events(log) if not c.startswith(OURS)]
    begin = events[0][0]
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
    to, seq, sent, flooded = group_and_port(url), 0, 0, 0
    pattern = next((d for _, c, d in events if c == "BSM"), None)
    chance, start, lap = random.Random(1), time.monotonic(), 0
    while True:
        for utime, channel, data in events:
            at_s = (lap * loop_s + (utime - begin) * 1e-6) / speed
            while (ahead := start + at_s - time.monotonic()) > 0:
                time.sleep(min(ahead, 0.01))
            if at_s > until_s:
                print(f"sent {sent} and {flooded} of the flood", flush=True)
                return
            if any(a <= at_s < b for a, b in pauses):
                continue
            shift = round(lap * loop_s * 1e6)
            names = [(channel, data)]
            for a, b, rate in flood if pattern else []:
                if not a <= at_s < b:
                    continue
                # As many as are due by now. id: 4 bytes after the count; latitude, longitude after secMark.
                while flooded < sum((min(at_s, y) - x) * r for x, y, r in flood if at_s > x):
                    body = bytearray(pattern)
                    struct.pack_into(">qqq", body, 8, utime, 0, flooded)
                    struct.pack_into(">I", body, 34, 0x10000000 + chance.randrange(1 << 24))
                    lat, lon = struct.unpack_from(">ii", body, 42)
                    struct.pack_into(">ii", body, 42, lat + chance.randrange(-30000, 30000),
                                     lon + chance.randrange(-30000, 30000))
                    names.append(("BSM", bytes(body)))
                    flooded += 1
            for name, body in names:
                stamp = struct.unpack_from(">q", body, 8)[0] + shift
                body = body[:8] + struct.pack(">q", stamp) + body[16:]
                if name == "BSM" and lap > 0:  # Neither an old message nor a repeated one: later, of other senders.
                    made, identity = struct.unpack_from(">q", body, 16)[0], struct.unpack_from(">I", body, 34)[0]
                    body = bytearray(body)
                    struct.pack_into(">q", body, 16, made + shift if made > 0 else 0)
                    struct.pack_into(">I", body, 34, (identity + lap * 0x9E3779B1) & 0xFFFFFFFF)
                try:
                    out.sendto(struct.pack(">II", SHORT, seq & 0xFFFFFFFF) + name.encode() + b"\0" + body, to)
                except OSError:
                    pass  # No route for a while.
                seq += 1
            sent += 1
        lap += 1


def end_with_parent():
    """In a child before exec: killed by the kernel when its parent ends, whatever ends that."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class Program:
    def __init__(self, name, *words, folder, before=None):
        self.name, self.words, self.folder, self.before = name, words, folder, before
        self.samples = []  # (wall s of this life, resident kB, descriptors, threads)
        self.lives, self.process = [], None

    def prepare(self):
        end_with_parent()
        if self.before:
            self.before()

    def start(self):
        self.log = open(os.path.join(self.folder, self.name + ".txt"), "ab")
        self.process = subprocess.Popen(self.words, stdout=self.log, stderr=self.log, preexec_fn=self.prepare)
        self.born, self.samples = time.monotonic(), []

    def sample(self):
        pid = self.process.pid
        try:
            with open(f"/proc/{pid}/status", encoding="ascii") as file:
                fields = dict(line.split(":", 1) for line in file)
            if "VmRSS" in fields:
                self.samples.append((time.monotonic() - self.born, int(fields["VmRSS"].split()[0]),
                                     len(os.listdir(f"/proc/{pid}/fd")), int(fields["Threads"])))
        except (FileNotFoundError, ProcessLookupError, KeyError):
            pass

    def said(self):
        with open(os.path.join(self.folder, self.name + ".txt"), encoding="utf-8", errors="replace") as file:
            return file.read()

    def has_ended_well(self, code):
        """On a busy machine the daemon may be in the middle of a step: 1, and said so."""
        return code == 0 or "in the middle of a step" in self.said()[-200:]

    def says(self, word, most_s=120.0):
        """Waits for that word of a program that has just been started. False: it ended, or never said it."""
        begin = time.monotonic()
        while word not in self.said():
            if not self.is_alive() or time.monotonic() - begin > most_s:
                return word in self.said()
            time.sleep(0.02)
        return True

    def is_alive(self):
        return self.process is not None and self.process.poll() is None

    def end(self, how=signal.SIGTERM):
        if self.is_alive():
            self.process.send_signal(how)
        code = self.process.wait(timeout=15)
        self.log.close()
        self.lives.append((code, self.samples))
        return code


def slope_kb_per_min(samples, after_s):
    """Least squares over what comes after `after_s` of a life."""
    late = [(t / 60, kb) for t, kb, _, _ in samples if t >= after_s]
    if len(late) < 10:
        return math.nan
    mean_t, mean_kb = sum(t for t, _ in late) / len(late), sum(kb for _, kb in late) / len(late)
    return sum((t - mean_t) * (kb - mean_kb) for t, kb in late) / sum((t - mean_t)**2 for t, _ in late)


class ListWatch(threading.Thread):
    """Hears the lists and the status. Every header is looked at, every `decode_each`-th list read whole."""

    def __init__(self, url, decode_each=1):
        super().__init__(daemon=True)
        self.types, self.decode_each = v2vouch_lcm.Types(), decode_each
        group, port = group_and_port(url)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self.socket.bind((group, port))
        member = socket.inet_aton(group) + socket.inet_aton("0.0.0.0")
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        self.socket.settimeout(0.2)
        self.lock, self.is_over = threading.Lock(), False
        self.lists, self.read, self.fresh, self.tracks, self.faults, self.status = 0, 0, 0, 0, [], None
        self.last, self.last_fresh = {}, None  # utime by channel; wall time of the last fresh list
        self.longest_silence_s, self.silent_from_s, self.born = 0.0, 0.0, time.monotonic()

    def new_life(self):
        """The daemon was ended on purpose: its time may begin anew, and silence is no fault."""
        with self.lock:
            self.last, self.last_fresh = {}, None

    def run(self):
        while not self.is_over:
            try:
                packet, _ = self.socket.recvfrom(65536)
            except socket.timeout:
                continue
            name, _, data = packet[8:].partition(b"\0")
            if struct.unpack_from(">I", packet)[0] != SHORT:
                continue
            if name == b"V2VOUCH_STATUS":
                self.status = self.types.decode(data) or self.status
            elif name in (b"TRACKS_LOCAL", b"TRACKS_PRIORITY"):
                with self.lock:
                    self.take(name.decode(), data)

    def take(self, channel, data):
        self.lists += 1
        utime, _, _, stale = struct.unpack_from(">qqib", data, 8)
        if utime < self.last.get(channel, 0):
            self.faults.append(f"{channel}: utime goes back {self.last[channel] - utime} us")
        self.last[channel] = utime
        if channel == "TRACKS_LOCAL" and not stale:
            now = time.monotonic()
            if self.last_fresh is not None and now - self.last_fresh > self.longest_silence_s:
                self.longest_silence_s, self.silent_from_s = now - self.last_fresh, self.last_fresh - self.born
            self.last_fresh = now
            self.fresh += 1
        if self.lists % self.decode_each:
            return
        self.read += 1
        message = self.types.decode(data)
        if message is None:
            self.faults.append(channel + ": cannot be read")
            return
        self.tracks += len(message.tracks)
        for track in message.tracks:
            figures = {"x": track.x_body_m, "y": track.y_body_m, "yaw": track.yaw_body_rad, "speed": track.speed_mps,
                       "existence": track.existence}
            figures.update((f"covariance {i}", figure) for i, figure in enumerate(track.covariance_body))
            wrong = {name: figure for name, figure in figures.items() if not math.isfinite(figure)}
            wrong.update((f"variance {i}", track.covariance_body[7 * i]) for i in range(6)
                         if track.covariance_body[7 * i] < 0)
            if wrong or not 0 <= track.existence <= 1:
                self.faults.append(f"{channel}: track {track.id} at {utime}: {wrong or track.existence}")
