#!/usr/bin/env bash
# run.sh BUILD: fits with a known answer. Exit 77: a module is not installed (modules.sh).
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../../.." && pwd)"
. "$here/../modules.sh"
need_modules matplotlib numpy scipy
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
RIVULET_LIBRARY="$(cd "$1" && pwd)/librivulet.so"
export RIVULET_LIBRARY PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR="$work"
export PYTHONPATH="$root/fluid/python:$root/demos/fit:$here/../python"
cd "$work"
/usr/bin/python3 "$here/check.py"
