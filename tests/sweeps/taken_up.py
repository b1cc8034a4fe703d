#!/usr/bin/env python3
"""taken_up.py DIR TASKS BEFORE: a sweep that was stopped and taken up again: all its tasks have ended, those that had ended before the stop
(lines "TASK PROCESS" of the file BEFORE) were not run again, and the table has a row for each."""
import pathlib
import sys

folder, tasks = pathlib.Path(sys.argv[1]), int(sys.argv[2])
before = dict(line.split() for line in pathlib.Path(sys.argv[3]).read_text().splitlines())
after = dict((folder / "tasks" / str(k) / "process").read_text().split() for k in range(tasks))
again = [k for k in before if after[k] != before[k]]
if again:
    sys.exit(f"tasks {again} had ended and were run again")
left = [path.name for path in (folder / "tasks").iterdir() if not path.name.isdigit()]
if left:
    sys.exit(f"{left} are left")
rows = (folder / "results.csv").read_text().splitlines()
if len(rows) != tasks + 1:
    sys.exit(f"the table has {len(rows) - 1} rows for {tasks} tasks")
print(f"{len(before)} of {tasks} tasks had ended before the stop and were kept; the others were done after it")
