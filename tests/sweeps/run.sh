#!/usr/bin/env bash
# run.sh [BUILD [SUITE...]]: sweeps on other engines, each for real, compared with a sweep by one process. Suites: slurm parallel dask chart;
# default: the first three. BUILD: the build folder; default: build/release. Needs the packages of section [sweeps] in
# third_party/packages.txt, and root for Slurm: a suite without them is left out; exit status 77: all were. chart: the quick chart of speed
# against accuracy, as a sweep on Slurm and on Dask; minutes.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../.." && pwd)"
build="$(cd "${1:-$root/build/release}" && pwd)"
[ $# -gt 0 ] && shift
[ $# -gt 0 ] || set -- slurm parallel dask
export RIVULET="$build/bin/rivulet" RIVULET_ASSETS="$root/assets" ROOT="$root" HERE="$here"
export RIVULET_LIBRARY="${RIVULET_LIBRARY:-$build/librivulet.so}" PYTHONPATH="$root/fluid/python"
export WORK="$(mktemp -d /tmp/rivulet_sweeps.XXXXXX)"
trap 'rm -rf "$WORK"' EXIT
cd "$WORK"

# 100 short runs, whose table by one process is the reference.
cat >hundred.json <<'JSON'
{"command": "run falling_cube --no-render --backend cpu --frames 3 --set fluid.spacing=0.06 --stats {task}/stats.json",
 "sampling": "latin hypercube", "samples": 100, "seed": 1,
 "parameters": {"fluid.viscosity": {"from": 1e-6, "to": 1e-2, "scale": "log"}, "fluid.gravity": ["0,-9.81,0", "0,-1.62,0"],
                "fluid.method": ["pbf", "dfsph", "wcsph"]}}
JSON
# Tasks of a second, each of which leaves the number of its process.
cat >slow.json <<'JSON'
{"command": "/bin/sh -c 'echo {k} $$ >{task}/process; sleep 1'", "parameters": {"k": {"from": 0, "to": 15, "count": 16}}}
JSON
ran="" left_out=""
for suite in "$@"; do
    case "$suite" in
        slurm | parallel | dask) [ -d reference ] || "$RIVULET" sweep hundred.json --output reference --jobs 1 ;;
    esac
    echo "== $suite"
    status=0
    bash "$here/$suite.sh" || status=$?
    case "$status" in
        0) ran="$ran $suite" ;;
        77) left_out="$left_out $suite" ;;
        *) exit "$status" ;;
    esac
done
[ -z "$left_out" ] || echo "left out:$left_out"
[ -n "$ran" ] || exit 77
echo "passed:$ran"
