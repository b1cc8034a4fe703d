#!/usr/bin/env bash
# slurm.sh, called by run.sh: 100 tasks as array jobs, with one index a task and with fewer indices than tasks; an array job that scancel stops
# in the middle, taken up again.
set -eu
wait_for_jobs() { while [ -n "$(squeue --noheader)" ]; do sleep 0.3; done; }
if [ "${1:-}" = inside ]; then
    "$RIVULET" sweep hundred.json --output "slurm_$ARRAY" --with slurm
    wait_for_jobs
    /usr/bin/python3 "$HERE/same_tables.py" reference/results.csv "slurm_$ARRAY/results.csv"
    [ "$ARRAY" = 1001 ] || exit 0

    "$RIVULET" sweep slow.json --output cancelled --with slurm
    while [ ! -d cancelled/tasks/4 ]; do sleep 0.1; done
    scancel --user=root
    wait_for_jobs
    ended="$(ls cancelled/tasks | grep -cv '\.' || true)"
    [ "$ended" -ge 4 ] && [ "$ended" -lt 16 ] || { echo "scancel came too late or too early: $ended tasks had ended"; exit 1; }
    for task in cancelled/tasks/*; do [[ "$task" == *.* ]] || cat "$task/process"; done >before.txt
    "$RIVULET" sweep slow.json --output cancelled --with slurm
    wait_for_jobs
    /usr/bin/python3 "$HERE/taken_up.py" cancelled 16 before.txt
    exit 0
fi
ARRAY=1001 bash "$HERE/cluster.sh" bash "$HERE/slurm.sh" inside
ARRAY=31 bash "$HERE/cluster.sh" bash "$HERE/slurm.sh" inside
