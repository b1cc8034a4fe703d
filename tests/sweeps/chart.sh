#!/usr/bin/env bash
# chart.sh, called by run.sh: the quick chart of speed against accuracy as a sweep on Slurm and on Dask: the same in all but times. CASES in the
# environment selects cases, KEEP names a folder that keeps both pages.
set -eu
if [ "${1:-}" = inside ]; then
    "$RIVULET" sweep chart.json --output chart_slurm --with slurm
    while [ -n "$(squeue --noheader)" ]; do sleep 1; done
    exit 0
fi
# shellcheck disable=SC2086  # names of cases
"$RIVULET" chart ${CASES:-} --quick --sweep chart.json
bash "$HERE/cluster.sh" bash "$HERE/chart.sh" inside
/usr/bin/python3 "$HERE/dask_sweeps.py" chart.json chart_dask
/usr/bin/python3 "$HERE/same_tables.py" chart_slurm/results.csv chart_dask/results.csv
for engine in slurm dask; do
    # shellcheck disable=SC2086
    "$RIVULET" chart ${CASES:-} --quick --points "chart_$engine" --out "page_$engine"
    # Without the columns of times, and of the Pareto front, which depends on them.
    /usr/bin/python3 -c '
import csv, sys
for row in csv.reader(open(sys.argv[1])):
    print(row[:6] + row[7:-1])' "page_$engine/speed_accuracy.csv" >"$engine.txt"
done
cmp slurm.txt dask.txt
[ -s slurm.txt ]
[ -z "${KEEP:-}" ] || cp -r page_slurm page_dask "$KEEP"
echo "the charts of Slurm and of Dask are the same in all but times"
