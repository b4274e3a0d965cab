# SPDX-License-Identifier: Apache-2.0
"""Scorecards of replayed logs, and their Markdown tables. Shared by the scripts measure_*."""
import concurrent.futures
import json
import lzma
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = ROOT / "build" / "release" / "bin"


def run(command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed:\n{done.stderr}")
    return done.stdout


def run_parallel(work, items, jobs):
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(work, items))


def settings_file(vehicle, settings, folder):
    """The vehicle file with `settings` (a.b=value) after it."""
    if not settings:
        return vehicle
    lines = [vehicle.read_text().rstrip("\n")]
    for setting in settings:
        key, _, value = setting.partition("=")
        parts = key.split(".")
        for depth, part in enumerate(parts):
            lines.append("  " * depth + part + ":" + (f" {value}" if depth == len(parts) - 1 else ""))
    path = folder / "vehicle.yaml"
    path.write_text("\n".join(lines) + "\n")
    return path


def score(out, evaluator, cutoff=10.0):
    return json.loads(run([evaluator / "v2vouch-eval", out, "--scorecard", "--json", "--cutoff", cutoff]))


def replay_and_score(log, vehicle, replayer, evaluator, folder, settings=()):
    """The scorecard of one log, with the replay's speed."""
    if log.suffix == ".xz":
        plain = folder / log.stem
        with lzma.open(log) as packed, open(plain, "wb") as unpacked:
            shutil.copyfileobj(packed, unpacked)
        log = plain
    out = folder / "out.lcm"
    replay = json.loads(run([replayer / "v2vouch-replay", log, "--config",
                             settings_file(vehicle, settings, folder), "--out", out, "--json"]))
    result = score(out, evaluator)
    result["realtime_factor"] = replay.get("realtime_factor")
    out.unlink()
    return result


DEVELOPMENT, REPORTING = 1000, 9000  # First seeds; reporting ones are for figures that are published.


def simulate(scenario, seed, family, folder, tools, duration=None):
    """A log with a sensor family, and the vehicle file that fits it."""
    log, vehicle = folder / "in.lcm", folder / "drawn.yaml"
    command = [tools / "v2vouch-sim", "run", scenario, "--seed", seed, "--sensors", family, "--out", log,
               "--vehicle-out", vehicle]
    run(command + (["--duration", duration] if duration else []))
    return log, vehicle


def pick(*path):
    def value(card):
        for key in path:
            card = card[key]
        return card
    return value


def percent(*path):
    def value(card):
        share = pick(*path)(card)
        return None if share is None else 100.0 * share
    return value


# title, value, decimals, whether more is worse
SHARED = [
    ("RMS m", pick("position", "all", "rms_m"), 2, True),
    ("moving", pick("position", "moving", "rms_m"), 2, True),
    ("standing", pick("position", "standing", "rms_m"), 2, True),
    ("partly hidden", pick("position", "partly_hidden", "rms_m"), 2, True),
    ("cars plain", pick("position", "plain_sight", "rms_m"), 2, True),
    ("lorries", pick("position", "lorries", "rms_m"), 2, True),
    ("near face", pick("lorry", "near_face_rms_m"), 2, True),
    ("velocity m/s", pick("velocity_rms_mps"), 2, True),
    ("yaw moving deg", pick("yaw_moving", "median_deg"), 1, True),
    ("yaw standing", pick("yaw_standing", "median_deg"), 1, True),
    ("ANEES", pick("nees_visible", "anees"), 1, True),
    ("median", pick("nees_visible", "median"), 2, True),
    ("> 9.21 %", percent("nees_visible", "share_above_9.21"), 1, True),
    ("hidden ANEES", pick("nees_hidden", "anees"), 1, True),
    ("missed %", percent("missed_share"), 1, True),
    ("plain %", percent("missed_plain_sight_share"), 1, True),
    ("false/list", pick("false_per_list"), 3, True),
    ("unseen s", pick("unseen", "seconds"), 1, True),
    ("ids > 0.5 s", pick("unseen", "lasting_ids"), 0, True),
    ("switches", pick("switches"), 0, True),
    ("first listing moving, mean s", pick("first_listing", "moving", "mean_s"), 2, True),
    ("p95", pick("first_listing", "moving", "p95_s"), 2, True),
    ("never", pick("first_listing", "moving", "never"), 0, True),
    ("plain mean s", pick("first_listing", "plain_sight", "mean_s"), 2, True),
    ("p95", pick("first_listing", "plain_sight", "p95_s"), 2, True),
    ("never", pick("first_listing", "plain_sight", "never"), 0, True),
    ("lead lists", pick("lead", "lists"), 0, None),
    ("absent", pick("lead", "absent"), 0, True),
    ("along RMS m", pick("lead", "along_rms_m"), 2, True),
]
PRIORITY = [
    ("hidden 1-2 s RMS m", pick("hidden_1_2_s", "rms_m"), 2, True),
    ("kept %", percent("hidden_1_2_s", "kept_share"), 0, False),
    ("3-4 s RMS m", pick("hidden_3_4_s", "rms_m"), 2, True),
    ("kept %", percent("hidden_3_4_s", "kept_share"), 0, False),
    ("validated %", percent("validated_share"), 0, False),
]


def cell(value, decimals):
    return "-" if value is None else f"{value:.{decimals}f}"


def worst_of(values, more_is_worse):
    known = [value for value in values if value is not None]
    if not known or more_is_worse is None:
        return None
    return max(known) if more_is_worse else min(known)


def line(name, values, columns):
    return f"| {name} | " + " | ".join(
        cell(value, column[2]) for value, column in zip(values, columns)) + " |"


def worst_row(rows, columns):
    return [worst_of([row[i] for row in rows], column[3]) for i, column in enumerate(columns)]


def table(values, first, columns, has_worst=True):
    """Markdown of {name: values}; the worst of each column last."""
    lines = [f"| {first} | " + " | ".join(title for title, *_ in columns) + " |",
             "|---" * (len(columns) + 1) + "|"]
    lines += [line(name, row, columns) for name, row in values.items()]
    if has_worst:
        lines.append(line("**worst**", worst_row(list(values.values()), columns), columns))
    return "\n".join(lines)


def values_of(result, kind, columns):
    return [value(result["scorecard"][kind]) for _, value, *_ in columns]


def print_tables(rows, first):
    """Both lists' tables of {name: result}."""
    for kind, columns in (("local", SHARED), ("priority", SHARED + PRIORITY)):
        values = {name: values_of(row, kind, columns) for name, row in rows.items()}
        print(f"{kind.upper()}\n\n" + table(values, first, columns) + "\n")


def print_worst_tables(groups, first):
    """Both lists' tables of {group: {name: result}}: each group's worst, the worst group first."""
    def order(group):
        rms = worst_of([SHARED[0][1](row["scorecard"]["local"]) for row in groups[group].values()], True)
        return -(rms or 0.0)

    for kind, columns in (("local", SHARED), ("priority", SHARED + PRIORITY)):
        values = {group: worst_row([values_of(row, kind, columns) for row in groups[group].values()], columns)
                  for group in sorted(groups, key=order)}
        print(f"{kind.upper()}\n\n" + table(values, first, columns) + "\n")
