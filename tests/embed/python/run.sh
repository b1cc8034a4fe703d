#!/usr/bin/env bash
# run.sh BUILD: the package rivulet from an install prefix, which finds its library by itself; and the example that plots a dam break, whose front must
# be that of inviscid flow (within 5 %), as fast as what was measured in 1952 (within 5 %). Exit 77: a module is not installed (modules.sh).
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$here/../../.."
. "$here/../modules.sh"
need_modules matplotlib numpy
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
unset RIVULET_LIBRARY
export PYTHONPATH="$work/prefix/share/rivulet/python" PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR="$work"
export RIVULET_EXPECTED="$(sed -n 's/^project(rivulet VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")"
/usr/bin/python3 "$here/test.py" "$work"
/usr/bin/python3 "$here/par.py" "$work"
/usr/bin/python3 "$here/parity.py" "$root"
for program in contacts drawing; do
    status=0
    /usr/bin/python3 "$here/$program.py" "$work" || status=$?
    if [ $status -eq 77 ] && [ -z "${RIVULET_TEST_DEVICES:-}" ]; then status=0; fi
    [ $status -eq 0 ] || exit $status
done
# What README shows, and what the module says of itself.
sed -n '/^```python$/,/^```$/p' "$root/README.md" | grep -v '^```' >"$work/readme.py"
sed -n '/^    import rivulet$/,/^$/p' "$root/fluid/python/rivulet/__init__.py" | sed 's/^    //' >"$work/itself.py"
for snippet in readme itself; do
    [ -s "$work/$snippet.py" ] || { echo "there is no snippet of Python to be run: $snippet"; exit 1; }
    /usr/bin/python3 "$work/$snippet.py"
done
/usr/bin/python3 "$root/demos/embed_python/dam_break.py" "$work/front.png" | tee "$work/said"
awk '/inviscid/ { ideal = $(NF - 1); seen++ } /speed/ { speed = $(NF - 1); seen++ }
     END { exit !(seen == 2 && ideal < 5 && speed < 5 && speed > -5) }' "$work/said" || { echo "the front is too far from the references"; exit 1; }
/usr/bin/python3 - "$work/front.png" <<'PLOT'
import sys
import matplotlib.image
import numpy as np
picture = matplotlib.image.imread(sys.argv[1])[..., :3]
line, marks = (np.abs(picture - np.array(colour) / 255).max(axis=2) < 0.1 for colour in ((23, 105, 170), (192, 57, 43)))
columns = np.flatnonzero(line.any(axis=0))
assert columns.max() - columns.min() > 0.6 * picture.shape[1] and marks.sum() > 200, "the plot lacks its curve or its marks"
PLOT
