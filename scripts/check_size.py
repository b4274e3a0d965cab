#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Long functions, long files and large classes of daemon/, sim/ and calibration/, against their limits.

    scripts/check_size.py          what is over a limit; exit code 1 where there are too many
    scripts/check_size.py --list   the longest of each as well

A function is measured from the line of its name to its closing brace, a class as its body and the
bodies of its functions in the sources of its folder. Reads the braces of formatted code; needs git only.
"""
import argparse
import re
import subprocess
import sys

FUNCTION_LINES, FUNCTIONS = 60, 7  # How many lines a function may have; how many may have more.
FILE_LINES, FILES = 300, 4
CLASS_LINES, CLASSES = 500, 0

NOISE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\''
                   r'|^[ \t]*#(?:[^\n\\]|\\.|\\\n)*', re.S | re.M)
SCOPE = re.compile(r'\b(?:namespace\b|extern\b\s*$)')
TYPE = re.compile(r'\b(?:class|struct|union|enum)\b(?:\s+class)?(?:\s*\[\[\w+\]\])?\s*([\w:]*)[^()=]*$')
NAME = re.compile(r'((?:[\w~]+(?:<[^()]*>)?::)*(?:operator\s*(?:\(\)|[^\s\w(]+|[\w ]+)|~?\w+))\s*\(')


def blank(match):
    """The same number of lines, nothing in them."""
    return '""' + "\n" * match.group(0).count("\n") if match.group(0)[0] in "R\"'" else "\n" * match.group(0).count("\n")


def blocks(text):
    """(kind, name, first line, last line, inside a type?) of every type and every function that is no lambda."""
    text = NOISE.sub(blank, text)
    stack, head, head_line, line = [], "", 1, 1
    for index, letter in enumerate(text):
        if letter == "\n":
            line += 1
        if letter == "{":
            outer = all(kind in ("scope", "type") for kind, _, _ in stack)
            words = re.sub(r"^\s*template\s*<.*?>\s*(?=\w)", "", head, flags=re.S) if "template" in head else head
            kind, name = "block", ""
            if outer and SCOPE.search(words):
                kind = "scope"
            elif outer and (found := TYPE.search(words)) and not words.rstrip().endswith("="):
                kind, name = "type", found.group(1)
            elif outer and text[index - 1].isspace() and ")" in words and not words.rstrip().endswith(("=", ",", "(")):
                found = NAME.search(words)
                kind, name = "function", found.group(1) if found else "?"
                head_line += head.count("\n", 0, head.find(name)) if found else 0
            stack.append((kind, name, head_line))
            if kind != "block" or not outer:
                head = ""
        elif letter == "}":
            if stack:
                kind, name, first = stack.pop()
                if kind in ("type", "function"):
                    inside = [n for k, n, _ in stack if k == "type" and n]
                    yield kind, "::".join(inside + [name]), first, line, bool(inside)
                if kind != "block":
                    head = ""
        elif letter == ";":
            head = ""
        elif not head and letter.isspace():
            continue
        else:
            if not head:
                head_line = line
            head += letter


def measure(files):
    functions, sizes, classes = [], [], {}
    for path in files:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        sizes.append((text.count("\n"), path))
        folder = path.rsplit("/", 1)[0]
        for kind, name, first, last, is_inside in blocks(text):
            lines = last - first + 1
            if kind == "type":
                classes[folder, name] = classes.get((folder, name), 0) + lines
            else:
                functions.append((lines, f"{path}:{first} {name}"))
                owner = name.rsplit("::", 1)[0] if "::" in name else ""
                if owner and not is_inside:
                    classes[folder, owner] = classes.get((folder, owner), 0) + lines
    return functions, sizes, [(lines, f"{folder} {name}") for (folder, name), lines in classes.items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true", help="the ten longest of each, whatever the limits")
    arguments = parser.parse_args()
    listed = subprocess.run(["git", "ls-files", "daemon", "sim", "calibration"], check=True, capture_output=True,
                            text=True).stdout.split()
    functions, sizes, classes = measure([path for path in listed if path.endswith((".h", ".cc"))])
    failed = False
    for what, rows, limit, allowed in (("functions", functions, FUNCTION_LINES, FUNCTIONS),
                                       ("files", sizes, FILE_LINES, FILES),
                                       ("classes", classes, CLASS_LINES, CLASSES)):
        over = sum(lines > limit for lines, _ in rows)
        print(f"{over} of {len(rows)} {what} over {limit} lines (at most {allowed})")
        failed |= over > allowed
        for lines, place in sorted(rows, reverse=True)[:max(over, 10 if arguments.list else 0)]:
            print(f"  {lines:4} {place}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
