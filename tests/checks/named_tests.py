#!/usr/bin/env python3
"""named_tests.py: every test that SECURITY.md and the table of docs/embedding.md name in backquotes exists. A star stands for any name."""

import fnmatch
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parents[2]
tests = set()
for source in (root / "tests").rglob("*_test.cpp"):
    tests.update(".".join(pair) for pair in re.findall(r"^TEST(?:_F|_P)?\((\w+), (\w+)\)", source.read_text(), re.M))
tests.update(f"embed.{path.parent.name}" for path in (root / "tests/embed").glob("*/run.sh"))
tests.update(f"embed.{path.stem}" for path in (root / "tests/embed/hosts").glob("*.png"))
missing = []
for page, least in (("SECURITY.md", 20), ("docs/embedding.md", 10)):
    text = (root / page).read_text()
    if page != "SECURITY.md":
        text = "\n".join(line for line in text.splitlines() if line.startswith("|"))
    names = set(re.findall(r"`([A-Za-z]+\.(?:\w+|\*))`", text))
    names = {name for name in names if not name.endswith((".h", ".c", ".py", ".so"))}
    lost = sorted(name for name in names if not fnmatch.filter(tests, name))
    for name in lost:
        print(f"{page} names the test {name}, which does not exist")
    if len(names) < least:
        lost.append("")
        print(f"{page} names only {len(names)} tests: is the pattern in {pathlib.Path(__file__).name} right?")
    missing += lost
sys.exit(1 if missing else 0)
