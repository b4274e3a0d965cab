#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Five drives of an independent simulator stay at least as good as they were made to be.

Each limit lies some way above the measured figure and far below what the fault gave that it guards
against (docs/results/foreign.md).
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# log: (figure, limit, whether it must lie below or above, the fault)
LIMITS = {
    "highway-501": [
        ("local.position.all.rms_m", 0.75, "<", "places off along the line of sight"),
        ("local.lead.absent_share", 0.0, "<=", "the car ahead not listed"),
        ("priority.position.all.rms_m", 0.45, "<", "lengths that senders tell not used: 0.68"),
        ("priority.validated", 0.9, ">", "senders that tell 3 to 5 m not used: 0.07"),
    ],
    "highway-502": [
        ("local.nees_visible.anees", 3.5, "<", "a lorry 6 m behind its place: 4.9"),
        ("priority.position.all.rms_m", 0.45, "<", "lengths that senders tell not used: 0.55"),
        ("priority.validated", 0.9, ">", "senders that tell 3 to 5 m not used: 0.46"),
    ],
    "left_turn-502": [
        ("local.false_per_list", 0.6, "<", "two tracks on one car: 0.94"),
        ("local.position.all.rms_m", 1.35, "<", "the farther of them kept: 1.58"),
    ],
    "urban-501": [
        ("local.false_per_list", 0.26, "<", "ghosts at existence 1.00: 0.27; second echoes: 0.44"),
        ("local.unseen.seconds", 16.0, "<", "second echoes kept alive: 23.7"),
    ],
    "urban-502": [
        ("local.position.all.rms_m", 1.5, "<", "tracks slip along a standing row: 1.74"),
        ("priority.position.all.rms_m", 0.6, "<", "the same: 2.8"),
    ],
}


def figure(card, path):
    if path == "priority.validated":
        return card["priority"]["validated_share"]
    for key in path.split("."):
        card = card[key]
    return card


def main():
    data = pathlib.Path(os.environ.get("V2VOUCH_DATA", ROOT.parent / "shared" / "data"))
    if not (data / "foreign").is_dir():
        print(f"SKIPPED: no drives of the independent simulator ({data / 'foreign'})")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "figures.json"
        subprocess.run([ROOT / "scripts" / "measure_foreign", *LIMITS, "--bin", sys.argv[1],
                        "--tools", sys.argv[1], "--json", out],
                       check=True, stdout=subprocess.DEVNULL, timeout=300)
        cards = json.loads(out.read_text())
    failed = 0
    for log, limits in LIMITS.items():
        for path, limit, sense, fault in limits:
            value = figure(cards[log]["scorecard"], path)
            good = {"<": value < limit, "<=": value <= limit, ">": value > limit}[sense]
            print(f"{'ok  ' if good else 'FAIL'} {log} {path} {value:.3f} {sense} {limit} ({fault})")
            failed += not good
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
