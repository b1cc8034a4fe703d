#!/usr/bin/env bash
# parallel.sh, called by run.sh: 100 tasks by GNU parallel; one that SIGKILL stops in the middle, taken up again.
set -eu
command -v parallel >/dev/null || { echo "skipped: parallel is not installed"; exit 77; }
"$RIVULET" sweep hundred.json --output parallel --with parallel --jobs 4
/usr/bin/python3 "$HERE/same_tables.py" reference/results.csv parallel/results.csv

setsid "$RIVULET" sweep slow.json --output killed --with parallel --jobs 4 &
sweep=$!
while [ ! -d killed/tasks/4 ]; do sleep 0.1; done
kill -KILL -- "-$sweep"
wait "$sweep" || true
for task in killed/tasks/*; do [[ "$task" == *.* ]] || cat "$task/process"; done >before.txt
"$RIVULET" sweep slow.json --output killed --with parallel --jobs 4
/usr/bin/python3 "$HERE/taken_up.py" killed 16 before.txt
