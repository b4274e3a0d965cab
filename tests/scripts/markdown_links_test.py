#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every relative link in the repository's Markdown files leads to a file, and to a heading of it."""

import os
import re
import subprocess
import sys
import urllib.parse

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LINK = re.compile(r"!?\[[^\]\[]*\]\(([^)\s]+)\)")


def prose(text):
    """The text without fenced code blocks and code spans."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(path):
    """Anchors of a page's headings, as GitHub makes them."""
    found, fenced = set(), False
    with open(path, encoding="utf-8") as file:
        for line in file:
            fenced ^= line.startswith("```")
            heading = None if fenced else re.match(r"#+ (.*)", line)
            if not heading:
                continue
            name = re.sub(r"[^\w\- ]", "", heading.group(1).strip().lower()).replace(" ", "-")
            count = sum(1 for other in found if re.fullmatch(re.escape(name) + r"(-\d+)?", other))
            found.add(name if count == 0 else f"{name}-{count}")
    return found


def faults(pages, exists, anchors_of):
    """Returns 'page: link' for each relative link that leads nowhere. `pages`: {path: text}."""
    found = []
    for page, text in sorted(pages.items()):
        for target in LINK.findall(prose(text)):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = urllib.parse.unquote(target).partition("#")
            path = os.path.normpath(os.path.join(os.path.dirname(page), name)) if name else page
            if path.startswith("..") or not exists(path):
                found.append(f"{page}: {target}")
            elif anchor and path.endswith(".md") and anchor not in anchors_of(path):
                found.append(f"{page}: {target} (no such heading)")
    return found


def test_of_the_test():
    pages = {"a/b.md": "[x](c.md) [y](../d.md#gone) `[z](no.md)` [w](https://x.org) [v](e.md)\n"}
    have = {"a/c.md", "d.md"}
    expected = ["a/b.md: ../d.md#gone (no such heading)", "a/b.md: e.md"]
    assert faults(pages, have.__contains__, lambda _: {"here"}) == expected


def main():
    test_of_the_test()
    listing = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT,
                             capture_output=True, text=True, check=False)
    names = listing.stdout.split()
    if listing.returncode != 0:  # A tree without git.
        names = [os.path.relpath(os.path.join(folder, name), ROOT)
                 for folder, _, files in os.walk(ROOT) for name in files
                 if name.endswith(".md") and "/build" not in folder]
    pages = {}
    for name in names:
        if os.path.exists(os.path.join(ROOT, name)):
            with open(os.path.join(ROOT, name), encoding="utf-8") as file:
                pages[name] = file.read()
    found = faults(pages, lambda path: os.path.exists(os.path.join(ROOT, path)),
                   lambda path: anchors(os.path.join(ROOT, path)))
    for fault in found:
        print(fault, file=sys.stderr)
    print(f"{len(pages)} pages, {len(found)} links that lead nowhere")
    return 1 if found or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
