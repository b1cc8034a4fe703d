#!/usr/bin/env python3
"""named_tests.py: every test that SECURITY.md names in backquotes exists. A star stands for any name."""

import fnmatch
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parents[2]
tests = set()
for source in (root / "tests").rglob("*_test.cpp"):
    tests.update(".".join(pair) for pair in re.findall(r"^TEST(?:_F|_P)?\((\w+), (\w+)\)", source.read_text(), re.M))
tests.update(f"embed.{path.parent.name}" for path in (root / "tests/embed").glob("*/run.sh"))
text = (root / "SECURITY.md").read_text()
names = set(re.findall(r"`([A-Za-z]+\.(?:\w+|\*))`", text)) - {"rivulet.h"}
missing = sorted(name for name in names if not fnmatch.filter(tests, name))
for name in missing:
    print(f"SECURITY.md names the test {name}, which does not exist")
if len(names) < 20:
    missing.append("")
    print(f"SECURITY.md names only {len(names)} tests: is the pattern in {pathlib.Path(__file__).name} right?")
sys.exit(1 if missing else 0)
