#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""v2vouch-obu against a second reader of J2735, which asn1c makes here and now of our own module.

Usage: second_decoder_test.py V2VOUCH_OBU

Published payloads, real units' messages, and the same with bits of their cores turned over: both
readers give the same 25 values, or both refuse. Exit code 77 (skipped) without asn1c or a C compiler.
"""

import gzip
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
DATA = os.environ.get("V2VOUCH_DATA", "../shared/data")
FIELDS = ["msgCnt", "id", "secMark", "lat", "long_", "elev", "semiMajor", "semiMinor", "orientation",
          "transmission", "speed", "heading", "angle", "accelSet_long", "accelSet_lat",
          "accelSet_vert", "accelSet_yaw", "wheelBrakes", "traction", "abs", "scs", "brakeBoost",
          "auxBrakes", "width", "length"]
CORE_BITS = range(3, 293)  # Behind the presence bits of the BSM.
TURNED_OVER = 4000


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(77)


def build(folder):
    subprocess.run(["asn1c", "-gen-PER", "-fcompound-names",
                    os.path.join(HERE, "second_decoder.asn")],
                   cwd=folder, check=True, capture_output=True)
    sources = [name for name in os.listdir(folder)
               if name.endswith(".c") and name != "converter-sample.c"]
    program = os.path.join(folder, "second_decoder")
    subprocess.run([shutil.which("cc"), "-w", "-I.", "-o", program,
                    os.path.join(HERE, "second_decoder.c")] + sources, cwd=folder, check=True)
    return program


def frame_of_record(record):
    """The MessageFrame in a unit's record: WSMP and 1609.2 as these units write them."""
    if record[:3] == b"\x03\x00\x20":
        record = record[4 if record[3] < 128 else 5:]
    if record[:2] == b"\x03\x81":
        record = record[4:]
    assert record[:2] == b"\x03\x80"
    size, start = record[2], 3
    if size >= 128:
        start = 3 + size - 128
        size = int.from_bytes(record[3:start], "big")
    return record[start:start + size]


def frames():
    with open(os.path.join(DATA, "j2735_bsm_vectors.json"), encoding="utf-8") as file:
        vectors = json.load(file)
    # One has its extension bit set and no extension: the second reader refuses it.
    found = [bytes.fromhex(vector["hex"]) for vector in vectors["vectors"]
             if vector["frame"]["frameExtBit"] == 0]
    rejects = [bytes.fromhex(reject["hex"]) for reject in vectors["reject"] if reject["hex"]]
    for name in ("bsmTx_commsignia.gz", "bsmLogDuringEvent_commsignia.gz", "rxMsg_BSM_and_TIM.gz",
                 "bsmTx.bin"):
        path = os.path.join(DATA, "obu", "wydot", name)
        opener = gzip.open if name.endswith(".gz") else open
        with opener(path, "rb") as file:
            log = file.read()
        at = 0
        while at + 26 <= len(log):
            size = int.from_bytes(log[at + 24:at + 26], "little")
            frame = frame_of_record(log[at + 26:at + 26 + size])
            if frame[:2] == b"\x00\x14":
                found.append(frame)
            at += 26 + size
            while at < len(log) and log[at] == 10:
                at += 1
    return found, rejects


def turned_over(good):
    random.seed(2735)
    for _ in range(TURNED_OVER):
        frame = bytearray(random.choice(good))
        start = 24 if frame[2] < 128 else 32
        for _ in range(random.randint(1, 6)):
            bit = start + random.choice(CORE_BITS)
            frame[bit // 8] ^= 128 >> bit % 8
        yield bytes(frame)


def main():
    if shutil.which("asn1c") is None:
        skip("no asn1c")
    if shutil.which("cc") is None:
        skip("no C compiler")
    if not os.path.exists(os.path.join(DATA, "obu", "wydot")):
        skip("no obu samples under V2VOUCH_DATA")
    good, rejects = frames()
    everything = good + rejects + list(turned_over(good))
    with tempfile.TemporaryDirectory() as folder:
        text = "".join(frame.hex() + "\n" for frame in everything)
        theirs = subprocess.run([build(folder)], input=text, capture_output=True, text=True,
                                check=True).stdout.splitlines()
        path = os.path.join(folder, "frames.hex")
        with open(path, "w", encoding="ascii") as file:
            file.write(text)
        ours = subprocess.run([sys.argv[1], "--decode", path, "--json", "--framing", "frame"],
                              capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(theirs) == len(ours) == len(everything), (len(theirs), len(ours), len(everything))

    differences = refused = 0
    for frame, their_line, our_line in zip(everything, theirs, ours):
        bsm = json.loads(our_line)["bsm"]
        if bsm is None:
            our_values = "refused"
            refused += 1
        else:
            bsm["id"] = int.from_bytes(bytes(bsm["id"]), "big")
            our_values = " ".join(str(bsm[field]) for field in FIELDS)
        if our_values != their_line:
            differences += 1
            print(frame.hex(), "\n  ours  ", our_values, "\n  theirs", their_line)
    print(f"{len(everything)} frames ({len(good)} real, {len(rejects)} rejects, {TURNED_OVER} with "
          f"bits turned over), {refused} refused by both, {differences} differences")
    assert len(good) == 166 + 803, len(good)
    sys.exit(1 if differences else 0)


if __name__ == "__main__":
    main()
