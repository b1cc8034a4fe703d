#!/usr/bin/env python3
"""durations.py JUNIT.xml: rewrites tests/durations.txt from what `ctest --test-dir build/release --output-junit JUNIT.xml` wrote: seconds of
each suite whose tests take 2 s or more together, longest first. tests/CMakeLists.txt makes them the tier `long` (where they open no window,
no OpenGL context and start no program) and starts them first; tests/run.sh adds them up."""
import collections, pathlib, sys
import xml.etree.ElementTree

table = pathlib.Path(__file__).resolve().parents[1] / "durations.txt"
suites = collections.Counter()
for case in xml.etree.ElementTree.parse(sys.argv[1]).getroot().iter("testcase"):
    suites[".".join(case.get("name").split()[0].split(".")[:2])] += float(case.get("time"))
rows = [f"{seconds:.0f} {suite}\n" for suite, seconds in suites.most_common() if seconds >= 2]
table.write_text("# Written by tests/checks/durations.py: seconds on 2 cores, two tests at once, of each suite that takes 2 s or more.\n" + "".join(rows))
