#!/usr/bin/env bash
# Compiles every shader that scenes use for GPUs that are not here, and compares registers, spills and waves with table.csv: see README.md.
#   run.sh [BUILD] [whole|write|more|variants|check]      BUILD: the build folder, build/release by default; without a word: as the test gpus.table
# Exit status 77: a package of the section [gpus] of third_party/packages.txt is not installed.
set -u
here="$(cd "$(dirname "$0")" && pwd)"
build="$here/../../build/release"
if [ $# -gt 0 ] && [ -d "$1" ]; then
    build="$1"
    shift
fi
exec python3 "$here/table.py" "$build" "$@"
