#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the demo's summary from the output of v2vouch-eval.

Usage: scripts/demo_table.py EVAL_30.json EVAL_10.json

Both files: `v2vouch-eval LOG --paper PAPER_LOG --json --cutoff C`, C = 30 and 10.
"""

import json
import sys

LISTS = ("local", "v2v", "priority")

# Table of the paper: means over its run of its scenario, c = 30, p = 2, alpha = 2.
PAPER = {
    "gospa_mean": (56.12, 7.517, 48.62),
    "missed_mean": (30.0, 0.0, 21.2),
    "false_mean": (47.43, 0.0, 42.43),
    "switching_mean": (0.0, 0.0, 0.0),
}


def number(value, decimals=2):
    return "none" if value is None else f"{value:.{decimals}f}"


def row(name, values):
    return f"  {name:<34}" + "".join(f"{number(value):>10}" for value in values)


def of_lists(lists, key):
    return [lists.get(name, {}).get(key) for name in LISTS]


def paper_scale(evaluation):
    """The paper's own figures beside ours: every list against every vehicle, c = 30."""
    ours = evaluation["all_vehicles"]
    paper_method = evaluation.get("paper_method", {}).get("all_vehicles")
    lines = ["Means over the run, c = 30 m as in the paper, every list against every vehicle",
             f"  {'':<34}{'LOCAL':>10}{'V2V':>10}{'PRIORITY':>10}"]
    for key, title in (("gospa_mean", "GOSPA"), ("missed_mean", "missed"),
                       ("false_mean", "false"), ("switching_mean", "switching")):
        lines.append(row(f"{title}: the paper, its scenario", PAPER[key]))
        if paper_method:
            lines.append(row("  the paper's method, this run", of_lists(paper_method, key)))
        lines.append(row("  V2Vouch, this run", of_lists(ours, key)))
        if key == "gospa_mean":
            lines.append(row("  bound, this run", of_lists(ours, "bound_mean")))
    return lines


def headline(evaluation):
    """c = 10, each list against what it is for."""
    ours = evaluation["lists"]
    lines = ["Means over the run, c = 10 m; LOCAL against every vehicle, V2V and PRIORITY against "
             "senders",
             f"  {'':<34}{'LOCAL':>10}{'V2V':>10}{'PRIORITY':>10}"]
    paper_method = evaluation.get("paper_method", {}).get("lists")
    if paper_method:
        lines.append(row("GOSPA, the paper's method", of_lists(paper_method, "gospa_mean")))
    for key, title in (("gospa_mean", "GOSPA, V2Vouch"), ("bound_mean", "bound"),
                       ("ratio", "GOSPA / bound"),
                       ("localisation_rms_m", "localisation RMS [m]"),
                       ("false_tracks_total", "false track instants"),
                       ("switches", "identity switches")):
        lines.append(row(title, of_lists(ours, key)))
    hidden = evaluation["hidden"]
    lines.append("  Hidden vehicles in PRIORITY: " + ("none" if hidden["rms_m"] is None else
                 f"{number(hidden['rms_m'])} m RMS, {number(hidden['max_m'])} m at most, "
                 f"over {number(hidden['seconds'], 1)} s"))
    for name, gate in evaluation.get("gates", {}).items():
        verdict = "ok  " if gate["pass"] else "MISS"
        lines.append(f"  gate {verdict} {name}: {number(gate['value'], 4)} "
                     f"(at most {gate['limit']:g})")
    return lines


def main(arguments):
    if arguments in (["-h"], ["--help"]):
        print(__doc__)
        return 0
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    evaluations = []
    for path in arguments:
        try:
            with open(path, encoding="utf-8") as file:
                evaluations.append(json.load(file))
        except (OSError, ValueError) as error:
            print(f"demo_table: {path}: {error}", file=sys.stderr)
            return 1
    try:
        print("\n".join(paper_scale(evaluations[0]) + [""] + headline(evaluations[1])))
    except KeyError as error:
        print(f"demo_table: v2vouch-eval's output lacks {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
