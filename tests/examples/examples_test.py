#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the examples. Usage: examples_test.py BIN_DIR"""

import csv
import math
import os
import subprocess
import sys
import tempfile
import warnings

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "examples", "python"))
import can_radar  # noqa: E402
import consume_lists  # noqa: E402
import v2vouch_lcm  # noqa: E402

BIN = os.path.abspath(sys.argv[1])
TYPES = v2vouch_lcm.Types()


def run(*words):
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


def test_a_replayed_log_reaches_the_python_consumer(folder):
    drive, tracks = folder + "/drive.lcm", folder + "/tracks.lcm"
    run(BIN + "/v2vouch-sim", "run", "left_turn", "--seed", "1", "--out", drive)
    run(BIN + "/v2vouch-replay", drive, "--out", tracks)
    words = run(sys.executable, ROOT + "/examples/python/consume_lists.py", tracks)
    for word in ("LOCAL ", "PRIORITY ", "hidden", "ahead watched"):
        assert word in words, (word, words)
    # Damage costs the event it is in.
    with open(tracks, "rb") as file:
        data = bytearray(file.read())
    whole = sum(1 for _ in v2vouch_lcm.read_events(tracks))
    data[len(data) // 2:len(data) // 2 + 40] = b"\xff" * 40
    with open(tracks, "wb") as file:
        file.write(data)
    assert whole - 3 <= sum(1 for _ in v2vouch_lcm.read_events(tracks)) <= whole


def test_the_python_reader_tells_of_a_log_that_is_cut_off_or_overwritten(folder):
    def read(content):
        with open(folder + "/damaged.lcm", "wb") as file:
            file.write(content)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            events = sum(1 for _ in v2vouch_lcm.read_events(folder + "/damaged.lcm"))
        return events, [str(each.message) for each in told]

    log = v2vouch_lcm.LogWriter(folder + "/whole.lcm")
    for utime in range(3):
        log.write(utime, "A", b"12345678")
    log.close()
    with open(folder + "/whole.lcm", "rb") as file:
        data = file.read()
    size = len(data) // 3
    assert read(data) == (3, []) and read(data[:2 * size]) == (2, [])
    for lost in range(1, size):
        events, told = read(data[:-lost])
        assert events == 2 and len(told) == 1 and "1 damaged stretches" in told[0], (lost, told)
    events, told = read(data[:size] + b"\xff" * 40 + data[size + 40:])
    assert events == 1 and len(told) == 1 and "1 damaged stretches" in told[0], told


def test_the_consumer_merges_by_local_id_and_knows_what_it_does_not_see():
    def track(**fields):
        made = TYPES.track_t()
        for name, value in fields.items():
            setattr(made, name, value)
        return made

    def listed(utime, *tracks):
        made = TYPES.track_list_t()
        made.utime, made.tracks = utime, list(tracks)
        return made

    around = consume_lists.Surroundings(TYPES)
    assert around.is_blind(0.0)
    around.take("TRACKS_LOCAL", listed(10, track(id=1), track(id=2)))
    suspect = track(id=9, local_id=1, trust_state=TYPES.track_t.TRUST_SUSPECT)
    around.take("TRACKS_PRIORITY", listed(10, track(id=7, local_id=2), track(id=8, local_id=0), suspect))
    assert [(t.id, p) for t, p in around.vehicles()] == [(7, True), (8, True), (1, False)]
    around.take("TRACKS_LOCAL", listed(9, track(id=3)))  # Late on the way.
    assert len(around.lists["TRACKS_LOCAL"].tracks) == 2
    around.take("TRACKS_LOCAL", listed(10, track(id=4)))  # A revision.
    assert [t.id for t in around.lists["TRACKS_LOCAL"].tracks] == [4]
    for first, last, state in ((-1.0, 1.0, TYPES.sector_health_t.BLIND), (3.0, -3.0, TYPES.sector_health_t.WATCHED)):
        sector = TYPES.sector_health_t()
        sector.from_rad, sector.to_rad, sector.state = first, last, state
        around.lists["TRACKS_LOCAL"].sectors.append(sector)
    assert around.is_blind(0.0) and not around.is_blind(math.pi) and around.is_blind(2.0)


def test_an_ars408_frame_made_by_hand():
    # 20 m ahead, 2 m to the left, 5 m/s faster than we, 10 dBsm, object 3.
    x, y, vx, vy, rcs = int(520 / 0.2), round(206.6 / 0.2), int(133 / 0.25), int(64 / 0.25), int(74 / 0.5)
    word = 3 << 56 | x << 43 | y << 32 | vx << 22 | vy << 13 | 1 << 8 | rcs
    lines = ["(10.000000) can0 60A#0100", f"(10.001000) can0 60B#{word:016X}", "(10.070000) can0 60A#0000"]
    made = list(can_radar.scans(TYPES, can_radar.RADARS["ars408"], "FRONT", lines))
    assert [len(scan.detections) for scan in made] == [1, 0], made  # No object is worth a scan.
    seen = made[0].detections[0]
    assert abs(seen.range_m - math.hypot(20, 2)) < 0.2 and abs(seen.azimuth_rad - math.atan2(2, 20)) < 0.02
    assert abs(seen.range_rate_mps - 5 * 20 / math.hypot(20, 2)) < 0.1
    assert (seen.rcs_dbsm, seen.track_id) == (10.0, 3)


def test_a_candump_without_times_is_told(folder):
    with open(folder + "/no_times.txt", "w", encoding="ascii") as file:
        file.write("  can0  60B   [8]  03 4E 28 00 00 00 00 94\n")
    done = subprocess.run([sys.executable, ROOT + "/examples/python/can_radar.py", "ars408", folder + "/no_times.txt",
                           "FRONT", folder + "/radar.lcm"], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "-t a" in done.stderr, done


def test_the_recorded_drive_of_a_toyota():
    folder = os.environ.get("V2VOUCH_DATA", ROOT + "/../shared/data") + "/radar/comma2k19_segment"
    if not os.path.isdir(folder):
        print("SKIPPED: no comma2k19 segment in V2VOUCH_DATA")
        return
    with open(folder + "/radar_can.candump.log", encoding="ascii") as lines:
        made = list(can_radar.scans(TYPES, can_radar.RADARS["toyota"], "FRONT", lines, "can1"))
    # Slots of one measurement come in no fixed order.
    seen = [d for scan in made for d in sorted(scan.detections, key=lambda d: d.track_id)]
    with open(folder + "/radar_tracks.csv", encoding="ascii") as table:
        rows = list(csv.DictReader(table))
    cycle, last = 0, None
    for row in rows:
        cycle += last is not None and float(row["t_boot_s"]) - last > can_radar.SCAN_GAP_S
        row["cycle"], last = cycle, float(row["t_boot_s"])
    rows.sort(key=lambda row: (row["cycle"], int(row["can_address"])))
    assert len(seen) == len(rows), (len(seen), len(rows))
    assert 750 <= len(made) <= 820, len(made)  # 40 s at 20 Hz.
    for found, row in zip(seen, rows):
        x, y = found.range_m * math.cos(found.azimuth_rad), found.range_m * math.sin(found.azimuth_rad)
        assert abs(x + 2.70 - float(row["long_dist_m"])) < 0.04, (x, y, row)
        assert abs(y - float(row["lat_left_m"])) < 0.01
        assert abs(found.range_rate_mps - float(row["rel_speed_mps"])) < 0.001
        assert found.track_id == int(row["can_address"]) - 528


def main():
    with tempfile.TemporaryDirectory() as folder:
        test_a_replayed_log_reaches_the_python_consumer(folder)
        test_the_python_reader_tells_of_a_log_that_is_cut_off_or_overwritten(folder)
        test_a_candump_without_times_is_told(folder)
    test_the_consumer_merges_by_local_id_and_knows_what_it_does_not_see()
    test_an_ars408_frame_made_by_hand()
    test_the_recorded_drive_of_a_toyota()
    print("examples_test: good")


if __name__ == "__main__":
    main()
