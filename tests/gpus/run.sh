#!/usr/bin/env bash
# Compiles every shader that scenes use for GPUs that are not here, and compares registers, spills and waves with table.csv: see README.md.
#   run.sh [BUILD]               as the tests do; BUILD is build/release
#   run.sh [BUILD] --write       writes table.csv
#   run.sh [BUILD] --all         for more GPUs
#   run.sh [BUILD] variants      writes variants.txt: runs all scenes, minutes
# Exit status 77: a package of the section [gpus] of third_party/packages.txt is not installed.
set -u
here="$(cd "$(dirname "$0")" && pwd)"
build="$here/../../build/release"
if [ $# -gt 0 ] && [ -d "$1" ]; then
    build="$1"
    shift
fi
exec python3 "$here/table.py" "$build" "$@"
