#!/usr/bin/env bash
# dask.sh, called by run.sh: 100 tasks on a Dask cluster on loopback; a worker that SIGKILL ends in the middle.
set -eu
/usr/bin/python3 -c "import distributed" 2>/dev/null || { echo "skipped: python3-distributed is not installed"; exit 77; }
/usr/bin/python3 "$HERE/dask_sweeps.py"
/usr/bin/python3 "$HERE/same_tables.py" reference/results.csv dask/results.csv
/usr/bin/python3 "$HERE/taken_up.py" lost 16 before.txt
