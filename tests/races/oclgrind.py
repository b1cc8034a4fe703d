#!/usr/bin/env python3
"""oclgrind.py LOG...: the reports of oclgrind in its output, by kind, kernel and line; exit status 1 if any is not in known_reports.txt."""

import collections
import pathlib
import re
import sys

KINDS = r"(?:(?:Read-write|Write-write) data race|Uninitialized \w+|Invalid (?:read|write)|Work-group divergence|OCLGRIND FATAL ERROR)"


def known():
    """Pairs of kind and kernel."""
    rows = set()
    for line in (pathlib.Path(__file__).parent / "known_reports.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            kind, kernel, why = (part.strip() for part in line.split("|"))
            assert why, "give a reason"
            rows.add((kind, kernel))
    return rows


def reports(text):
    """Kind, kernel and lines of each report."""
    for part in re.split(rf"\n(?={KINDS})", text)[1:]:
        kind = re.match(KINDS, part)[0]
        kernel = re.search(r"Kernel:\s+(\w+)|kernel '(\w+)'", part)
        lines = re.findall(r"At line (\d+) \(column \d+\) of ([\w/.]+)", part.split("\n\n\n")[0])
        yield kind, (kernel[1] or kernel[2]) if kernel else "?", tuple(sorted({f"{file}:{line}" for line, file in lines}))


def main():
    found = collections.Counter()
    for path in sys.argv[1:]:
        text = pathlib.Path(path).read_text(errors="replace")
        found.update(reports(text))
        if "suppressing further errors" in text:
            print(f"{path}: oclgrind reached its limit of reports")
    excused, bad = known(), 0
    for (kind, kernel, lines), count in sorted(found.items()):
        fine = (kind, kernel) in excused
        bad += not fine
        print(f"{'known ' if fine else 'FAULT '} {kind} in {kernel}, {count} times: {', '.join(lines)}")
    return 1 if bad else 0


sys.exit(main())
