#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A CAN radar's frames, as `candump -l` or `candump -t a` writes them, into RADAR_<NAME>.

Usage: can_radar.py toyota|ars408 CANDUMP NAME OUT.lcm [--bus can1] [--offset-s SECONDS]
       candump -L can0 | can_radar.py ars408 - FRONT live

A radar is a small table: which ids carry objects, and where in the frame each figure lies. Bits are named as
in a .dbc file in Motorola order: `start` is the most significant bit, bit 7 the first of byte 0.
"""

import argparse
import collections
import math
import re
import sys

import v2vouch_lcm

Bits = collections.namedtuple("Bits", "start length scale offset signed", defaults=(1.0, 0.0, False))
# kind: "x", "y" (left positive; a negative scale turns it), "vx", "vy" relative to the sensor, "rate" (range
# rate), "rcs", "id"; `valid`: the frame counts where these bits are 1. `first`: the id
# that begins a measurement, None where only the pause between two tells.
RADARS = {
    # Toyota's factory radar as in opendbc toyota_adas.dbc; the id of the frame is the track's slot.
    "toyota": dict(ids=range(0x210, 0x220), first=None,
                   fields=dict(x=Bits(15, 15, 0.01), y=Bits(31, 11, -0.04, 0.0, True),
                               rate=Bits(47, 12, 0.025, 0.0, True), valid=Bits(48, 1))),
    # Continental ARS408, objects (0x60A starts a measurement, 0x60B are its objects); sensor id 0.
    "ars408": dict(ids=range(0x60B, 0x60C), first=0x60A,
                   fields=dict(id=Bits(7, 8), x=Bits(15, 13, 0.2, -500.0), y=Bits(18, 11, 0.2, -204.6),
                               vx=Bits(39, 10, 0.25, -128.0), vy=Bits(45, 9, 0.25, -64.0),
                               rcs=Bits(63, 8, 0.5, -64.0))),
}
SCAN_GAP_S = 0.03  # Frames of one measurement follow each other closely.
LINE = re.compile(r"\((\d+\.\d+)\)\s+(\S+)\s+([0-9A-Fa-f]+)(?:#|\s+\[\d+\]\s+)([0-9A-Fa-f ]*)")


def figure(bits, frame):
    """Reads Motorola bits: from `start` downwards in its byte, then from bit 7 of the next."""
    byte, bit = divmod(bits.start, 8)
    first = 8 * byte + 7 - bit
    value = int.from_bytes(frame.ljust(8, b"\0"), "big") >> (64 - first - bits.length) & ((1 << bits.length) - 1)
    if bits.signed and value >> (bits.length - 1):
        value -= 1 << bits.length
    return value * bits.scale + bits.offset


def detection(types, radar, number, frame):
    fields = {name: figure(bits, frame) for name, bits in radar["fields"].items()}
    if not fields.get("valid", 1):
        return None
    found = types.radar_detection_t()
    found.range_m = math.hypot(fields["x"], fields["y"])
    found.azimuth_rad = math.atan2(fields["y"], fields["x"])
    if "rate" in fields:
        found.range_rate_mps = fields["rate"]
    else:
        along = fields["x"] * fields["vx"] + fields["y"] * fields["vy"]
        found.range_rate_mps = along / max(found.range_m, 0.1)
    found.rcs_dbsm = fields.get("rcs", math.nan)
    found.snr_db = math.nan
    found.track_id = int(fields.get("id", number - radar["ids"][0]))
    return found


def scans(types, radar, name, lines, bus=None, offset_s=0.0):
    """Yields one radar_scan_t per measurement, stamped with the time of its last frame."""
    scan, seq, last = None, 0, -math.inf
    for line in lines:
        match = LINE.match(line.strip())
        number = int(match.group(3), 16) if match else -1
        if not match or (bus and match.group(2) != bus) or not (
                number in radar["ids"] or number == radar["first"]):
            continue
        stamp = float(match.group(1)) + offset_s
        if scan and (number == radar["first"] or stamp - last > SCAN_GAP_S):
            scan.num_detections = len(scan.detections)
            yield scan
            scan = None
        if scan is None:
            scan, seq = types.radar_scan_t(), seq + 1
            scan.sensor, scan.seq, scan.detections = name, seq, []
        last, scan.utime = stamp, int(round(stamp * 1e6))
        if number in radar["ids"]:
            found = detection(types, radar, number, bytes.fromhex(match.group(4).replace(" ", "")))
            if found:
                scan.detections.append(found)
    if scan:
        scan.num_detections = len(scan.detections)
        yield scan


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("radar", choices=sorted(RADARS))
    parser.add_argument("candump", help="file, or - for standard input")
    parser.add_argument("name", help="the radar's name in the vehicle file")
    parser.add_argument("out", help="LCM log to write, or `live`")
    parser.add_argument("--bus", help="only frames of this interface")
    parser.add_argument("--offset-s", type=float, default=0.0, help="added to the time of each frame, to get UTC")
    options = parser.parse_args()
    types = v2vouch_lcm.Types()
    log = None if options.out == "live" else v2vouch_lcm.LogWriter(options.out)
    publisher = v2vouch_lcm.Publisher() if log is None else None
    lines = sys.stdin if options.candump == "-" else open(options.candump, encoding="ascii", errors="replace")
    count = detections = 0
    for scan in scans(types, RADARS[options.radar], options.name, lines, options.bus, options.offset_s):
        if log:
            log.write(scan.utime, "RADAR_" + options.name, scan)
        else:
            publisher.publish("RADAR_" + options.name, scan)
        count, detections = count + 1, detections + scan.num_detections
    if log:
        log.close()
    print(f"{count} scans, {detections} detections", file=sys.stderr)
    if count == 0:
        print("no frame of this radar with a time: candump -l, -L or -t a write times; is the bus right?",
              file=sys.stderr)
    return 0 if count else 1


if __name__ == "__main__":
    sys.exit(main())
