#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the #include lines of daemon/, sim/ and calibration/ with scripts/layering.txt.

Usage: scripts/check_layering.py [--root DIR] [--table FILE]

Prints one line per fault and exits 1 if there is any, 2 if the table itself is wrong. Faults: an
include that the table does not list, a header that does not exist, a folder of sources that is no
room, a clock read in a room without the word `clock`, and a test that mirrors no room.
"""

import argparse
import os
import re
import sys

TOP_FOLDERS = ("daemon", "sim", "calibration")
SOURCE_ENDINGS = (".h", ".cc")

# Ability or library -> pattern of the headers behind it.
LIBRARIES = {
    "eigen": r"Eigen/.*",
    "yaml": r"yaml-cpp/.*",
    "boost": r"boost/.*",
    "lcm": r"lcm/.*",
    "lcmtypes": r"v2vouch/\w+_t\.hpp",
    "cli": r"CLI/.*",
    "spdlog": r"(spdlog|fmt)/.*",
    "json": r"nlohmann/.*",
    "geographic": r"GeographicLib/.*",
    "zlib": r"zlib\.h",
    "zstd": r"zstd\.h",
    "openssl": r"openssl/.*",
    "pcap": r"pcap/.*|pcap\.h",
    "ceres": r"(ceres|glog)/.*",
    "opencv": r"opencv2/.*",
    "files": r"fstream|filesystem|iostream",
    "threads": r"thread|mutex|shared_mutex|condition_variable|atomic|future|semaphore|pthread\.h",
    "system": r"(sys|netinet|arpa|net|linux)/.*|unistd\.h|termios\.h|fcntl\.h|poll\.h|dirent\.h|spawn\.h"
              r"|signal\.h|csignal|netdb\.h|ifaddrs\.h|dlfcn\.h",
}
STANDARD = re.compile(r"[a-z_0-9]+")  # <vector>, <cmath>; no dot, no slash.
CLOCK_READ = re.compile(
    r"\b(system_clock|steady_clock|high_resolution_clock|clock_gettime|gettimeofday)\b"
    r"|\bstd::(time|clock)\s*\(")
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')


class TableError(Exception):
    """The table cannot be used; the message says why."""


def read_table(text):
    """Returns {room: set of words}, groups resolved; walls and circles are checked."""
    groups, rooms, walls = {}, {}, []

    def resolve(words, where):
        resolved = set()
        for word in words:
            if word in groups:
                resolved |= groups[word]
            elif word in LIBRARIES or word == "clock" or "/" in word:
                resolved.add(word)
            else:
                raise TableError(f"{where}: unknown word '{word}'")
        return resolved

    for number, line in enumerate(text.splitlines(), 1):
        line = line.split("#", 1)[0].strip()
        where = f"line {number}"
        if not line:
            continue
        if line.startswith("group "):
            name, _, words = line[len("group "):].partition("=")
            groups[name.strip()] = resolve(words.split(), where)
            continue
        if line.startswith("wall "):
            folder, _, others = line[len("wall "):].partition(":")
            walls.append((folder.strip(), others.split()))
            continue
        room, colon, words = line.partition(":")
        room = room.strip()
        if not colon or not room:
            raise TableError(f"{where}: expected 'ROOM : word...'")
        if room in rooms:
            raise TableError(f"{where}: room {room} is listed twice")
        rooms[room] = resolve(words.split(), where)

    for room, words in rooms.items():
        for word in words:
            if "/" in word and word not in rooms:
                raise TableError(f"{room} names the room {word}, which has no line of its own")
    check_walls(rooms, walls)
    circle = find_circle(rooms) or find_circle(top_folders(rooms))
    if circle:
        raise TableError("arrows form a circle: " + " -> ".join(circle))
    return rooms


def check_walls(rooms, walls):
    """No room of a walled folder may name a room outside it and the folders it may use."""
    for folder, others in walls:
        inside = [room for room in rooms if room.startswith(folder + "/")]
        if not inside:
            raise TableError(f"wall {folder}: there is no such folder of rooms")
        allowed = tuple(name + "/" for name in [folder] + others)
        for room in inside:
            for word in sorted(rooms[room]):
                if "/" in word and not word.startswith(allowed):
                    raise TableError(f"wall {folder}: {room} reaches {word}")


def top_folders(rooms):
    """The same arrows between top-level folders."""
    tops = {}
    for room, words in rooms.items():
        top = room.split("/", 1)[0]
        reached = {word.split("/", 1)[0] for word in words if "/" in word}
        tops.setdefault(top, set()).update(reached - {top})
    return tops


def find_circle(rooms):
    """Returns a list of rooms that lead back to the first, or None."""
    done = set()

    def visit(room, path):
        if room in path:
            return path[path.index(room):] + [room]
        if room in done:
            return None
        for word in sorted(rooms[room]):
            if word in rooms:
                circle = visit(word, path + [room])
                if circle:
                    return circle
        done.add(room)
        return None

    for room in sorted(rooms):
        circle = visit(room, [])
        if circle:
            return circle
    return None


def without_comments(text):
    """Blanks comments, keeping the line numbers."""
    def blank(match):
        return "\n" * match.group(0).count("\n")
    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.S)


def sources_below(root, top):
    for folder, folders, names in os.walk(os.path.join(root, top)):
        folders.sort()
        for name in sorted(names):
            if name.endswith(SOURCE_ENDINGS):
                path = os.path.join(folder, name)
                yield os.path.relpath(path, root).replace(os.sep, "/")


def check_include(root, room, words, quoted, angled):
    """Returns what is wrong with one include, or None."""
    name = quoted or angled
    for word, pattern in LIBRARIES.items():
        if re.fullmatch(pattern, name):
            return None if word in words else f"{room} may not use {word} ({name})"
    if angled:
        if STANDARD.fullmatch(name):
            return None
        return f"<{name}> belongs to no library listed in check_layering.py"
    if not name.startswith(tuple(top + "/" for top in TOP_FOLDERS)):
        return f'"{name}" is not written from the root of the project'
    if not os.path.isfile(os.path.join(root, name)):
        return f'"{name}" does not exist'
    target = name.rsplit("/", 1)[0]
    if target == room or target in words:
        return None
    return f"{room} may not include {target} ({name})"


def check_file(root, path, rooms):
    room = path.rsplit("/", 1)[0]
    if room not in rooms:
        return [f"{path}: the folder {room} is not a room of the table"]
    words = rooms[room]
    with open(os.path.join(root, path), encoding="utf-8") as file:
        text = without_comments(file.read())
    faults = []
    for number, line in enumerate(text.splitlines(), 1):
        include = INCLUDE.match(line)
        if include:
            fault = check_include(root, room, words, include.group(1), include.group(2))
            if fault:
                faults.append(f"{path}:{number}: {fault}")
        elif "clock" not in words and CLOCK_READ.search(line):
            faults.append(f"{path}:{number}: {room} may not read a clock")
    return faults


def check_mirror(root, rooms):
    """Every test below tests/daemon, tests/sim, tests/calibration sits in its room's folder."""
    faults = []
    for top in TOP_FOLDERS:
        for path in sources_below(root, "tests/" + top):
            room = path.rsplit("/", 1)[0][len("tests/"):]
            if room not in rooms:
                faults.append(f"{path}: mirrors no room; is there a {room}?")
    return faults


def check(root, rooms):
    faults = []
    for top in TOP_FOLDERS:
        for path in sources_below(root, top):
            faults += check_file(root, path, rooms)
    return faults + check_mirror(root, rooms)


def main(arguments):
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=os.path.dirname(here), help="the project's folder")
    parser.add_argument("--table", default=os.path.join(here, "layering.txt"))
    options = parser.parse_args(arguments)
    try:
        with open(options.table, encoding="utf-8") as file:
            rooms = read_table(file.read())
    except (OSError, TableError) as error:
        print(f"{options.table}: {error}", file=sys.stderr)
        return 2
    faults = check(options.root, rooms)
    for fault in faults:
        print(fault)
    count = sum(1 for top in TOP_FOLDERS for _ in sources_below(options.root, top))
    print(f"{count} files, {len(rooms)} rooms, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
