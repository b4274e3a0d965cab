# SPDX-License-Identifier: Apache-2.0
"""V2Vouch's messages in pure Python: logs and live lists, without the LCM package for Python.

Needs Python 3.8 and nothing else where V2Vouch is installed. In a source tree the message classes are made of the
.lcm files by lcm-gen (apt install liblcm-bin), once per run. One thread, no subscription queues.

    types = Types()                                # or Types("folder/of/lcmtypes")
    for utime, channel, message in read_log("drive.lcm", types): ...
    for utime, channel, message in listen(types, channels={"TRACKS_LOCAL"}): ...
"""

import collections
import importlib
import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import warnings

SYNC = 0xEDA1DA01
SHORT, FRAGMENT = 0x4C433032, 0x4C433033
LARGEST = 64 << 20


def _folder_of_types(folder):
    here = os.path.dirname(os.path.abspath(__file__))
    shares = [os.environ.get("V2VOUCH_SHARE"), os.path.join(here, "..", ".."),  # The source tree.
              os.path.join(here, "..", "..", "..", "..", "v2vouch"), "/usr/local/share/v2vouch", "/usr/share/v2vouch"]
    places = [folder] if folder else [os.path.join(s, n) for s in shares if s for n in ("python", "lcmtypes")]
    for place in places:
        if os.path.isdir(os.path.join(place, "v2vouch")):
            return place
        if os.path.isdir(place) and any(name.endswith(".lcm") for name in os.listdir(place)):
            return place
    raise FileNotFoundError("no message types of V2Vouch: install the package v2vouch, or set V2VOUCH_SHARE")


def _make_classes(folder, into):
    files = sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(".lcm"))
    try:
        subprocess.run(["lcm-gen", "--python", "--ppath", into, *files], check=True)
    except FileNotFoundError:
        raise FileNotFoundError("no lcm-gen, which makes Python classes of .lcm files: apt install liblcm-bin") from None


class Types:
    """Message classes by name (types.radar_scan_t) and by fingerprint (types.decode(bytes))."""

    def __init__(self, folder=None):
        """folder: of .lcm files, or of the classes made of them; default: what is installed or beside this file."""
        made, kept = None, sys.dont_write_bytecode
        sys.dont_write_bytecode = True  # Nothing of ours is left in folders of the system.
        try:
            classes = _folder_of_types(folder)
            if not os.path.isdir(os.path.join(classes, "v2vouch")):
                files, classes = classes, tempfile.mkdtemp(prefix="v2vouch_types_")
                made = classes
                _make_classes(files, made)
            sys.path.insert(0, classes)
            self._by_print = {}
            for file in sorted(os.listdir(os.path.join(classes, "v2vouch"))):
                name = file[:-len(".py")]
                if not file.endswith("_t.py"):
                    continue
                kind = getattr(importlib.import_module("v2vouch." + name), name)
                setattr(self, name, kind)
                self._by_print[kind()._get_packed_fingerprint()] = kind
            sys.path.remove(classes)
        finally:
            sys.dont_write_bytecode = kept
            if made:
                shutil.rmtree(made)

    def decode(self, data):
        """The message, or None: no type of ours, cut short, or damaged."""
        kind = self._by_print.get(bytes(data[:8]))
        try:
            return kind.decode(bytes(data)) if kind else None
        except (ValueError, struct.error, IndexError, MemoryError, OverflowError, UnicodeError):
            return None


def read_events(path):
    """(utime of recording, channel, bytes) of an LCM log; damage is skipped to the next event, with a warning."""
    with open(path, "rb") as file:
        data = file.read()
    at, damaged, is_damaged = 0, 0, False
    while at + 28 <= len(data):
        sync, _, utime, name, size = struct.unpack_from(">IqqII", data, at)
        end = at + 28 + name + size
        if sync != SYNC or not 1 <= name <= 63 or size > LARGEST or end > len(data):
            damaged, is_damaged = damaged + (not is_damaged), True
            at = data.find(struct.pack(">I", SYNC), at + 1)
            if at < 0:
                break
            continue
        is_damaged = False
        yield utime, data[at + 28:at + 28 + name].decode("ascii", "replace"), data[at + 28 + name:end]
        at = end
    damaged += not is_damaged and at != len(data)  # The file ends within a header.
    if damaged:
        warnings.warn(f"{path}: {damaged} damaged stretches, cut off or overwritten; what they held is missing")


def read_log(path, types):
    """The same with decoded messages; those of no type of ours are left out."""
    for utime, channel, data in read_events(path):
        message = types.decode(data)
        if message is not None:
            yield utime, channel, message


class LogWriter:
    def __init__(self, path):
        self._file, self._count = open(path, "wb"), 0

    def write(self, utime, channel, message):
        data = message if isinstance(message, bytes) else message.encode()
        name = channel.encode()
        self._file.write(struct.pack(">IqqII", SYNC, self._count, utime, len(name), len(data)) + name + data)
        self._count += 1

    def close(self):
        self._file.close()


def _address(url):
    url = url or os.environ.get("LCM_DEFAULT_URL") or "udpm://239.255.76.67:7667?ttl=0"
    if not url.startswith("udpm://"):
        raise ValueError(url + ": only udpm:// is spoken here")
    group, _, port = url[len("udpm://"):].partition("?")[0].partition(":")
    return group, int(port)


class Publisher:
    """Messages up to 65 kB, one datagram each; larger ones in fragments."""

    def __init__(self, url=None):
        self._to, self._seq = _address(url), 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)

    def publish(self, channel, message):
        data = message if isinstance(message, bytes) else message.encode()
        name = channel.encode() + b"\0"
        if len(name) + len(data) <= 65000:
            self._socket.sendto(struct.pack(">II", SHORT, self._seq) + name + data, self._to)
        else:
            pieces = [data[at:at + 60000] for at in range(0, len(data), 60000)]
            for number, piece in enumerate(pieces):
                head = struct.pack(">IIIIHH", FRAGMENT, self._seq, len(data), 60000 * number, number, len(pieces))
                self._socket.sendto(head + (name if number == 0 else b"") + piece, self._to)
        self._seq = (self._seq + 1) & 0xFFFFFFFF


def listen(types, channels=None, url=None, timeout_s=None):
    """(utime of reception, channel, message) as they come; ends after `timeout_s` without any."""
    group, port = _address(url)
    own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    own.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    own.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    own.bind((group, port))
    own.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + socket.inet_aton("0.0.0.0"))
    own.settimeout(timeout_s)
    parts = collections.OrderedDict()  # (sender, counter) -> [channel, {number: bytes}, count]
    while True:
        try:
            packet, sender = own.recvfrom(65536)
        except socket.timeout:
            return
        if len(packet) < 8:
            continue
        magic, seq = struct.unpack_from(">II", packet)
        if magic == SHORT and b"\0" in packet[8:72]:
            name, _, data = packet[8:].partition(b"\0")
        elif magic == FRAGMENT and len(packet) >= 20:
            _, _, number, count = struct.unpack_from(">IIHH", packet, 8)
            part = parts.setdefault((sender, seq), [b"", {}, count])
            body = packet[20:]
            if number == 0:
                part[0], _, body = body.partition(b"\0")
            part[1][number] = body
            while len(parts) > 16:
                parts.popitem(last=False)
            if len(part[1]) < count:
                continue
            parts.pop((sender, seq), None)
            name, data = part[0], b"".join(part[1][i] for i in sorted(part[1]))
        else:
            continue
        channel = name.decode("ascii", "replace")
        if channels is None or channel in channels:
            message = types.decode(data)
            if message is not None:
                yield int(time.time() * 1e6), channel, message
