#!/usr/bin/env python3
"""same_tables.py A.csv B.csv: whether two tables of results are the same in all but times (columns that begin with `time.`)."""
import csv
import sys


def without_times(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    kept = [k for k, name in enumerate(rows[0]) if not name.startswith("time.")]
    return [[row[k] for k in kept] for row in rows]


a, b = (without_times(path) for path in sys.argv[1:3])
if a != b:
    sys.exit(f"{sys.argv[1]} and {sys.argv[2]} differ: {len(a)} and {len(b)} rows; first: "
             + str(next(((x, y) for x, y in zip(a, b) if x != y), "the number of rows")))
print(f"{len(a) - 1} tasks, {len(a[0])} columns without times: the same")
