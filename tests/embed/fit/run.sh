#!/usr/bin/env bash
# run.sh BUILD: fits with a known answer. Exit 77: NumPy, SciPy or Matplotlib is not installed, and RIVULET_TEST_DEVICES does not say that all must be.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../../.." && pwd)"
/usr/bin/python3 -c 'import matplotlib, numpy, scipy' 2>/dev/null || {
    echo "skipped: python3-numpy, python3-scipy or python3-matplotlib is not installed"
    [ -n "${RIVULET_TEST_DEVICES:-}" ] && exit 1
    exit 77
}
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
RIVULET_LIBRARY="$(cd "$1" && pwd)/librivulet.so"
export RIVULET_LIBRARY PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR="$work"
export PYTHONPATH="$root/fluid/python:$root/demos/fit"
cd "$work"
/usr/bin/python3 "$here/check.py"
