#!/usr/bin/env bash
# The types of the Python package, by mypy in its strict mode; and of a program that uses it. Exit 77: mypy or NumPy is not installed.
set -eu
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
[ -x /usr/bin/mypy ] && /usr/bin/python3 -c 'import numpy' 2>/dev/null || { echo "skipped: mypy or python3-numpy is not installed"; exit 77; }
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
types=(/usr/bin/mypy --strict --python-executable /usr/bin/python3 --cache-dir "$work/cache")
"${types[@]}" fluid/python/rivulet
cat >"$work/right.py" <<'PY'
import rivulet

with rivulet.Context(backend="cpu", off_screen=True) as context, context.world({"fluid": {}}) as world:
    world.step(1 / 60, gravity=(0, -9.81, 0))
    time: float = world.stats().time
    mass: int = world.particles().ids.size
    state: bytes = world.state()
    world.picture(rivulet.Camera((1, 1, 1), (0, 0, 0)), 320, 240).max()
PY
sed 's/time: float/time: bytes/' "$work/right.py" >"$work/wrong.py"
MYPYPATH=fluid/python "${types[@]}" "$work/right.py"
if MYPYPATH=fluid/python "${types[@]}" "$work/wrong.py" >"$work/said"; then echo "a wrong type is not noticed"; exit 1; fi
grep -q 'expression has type "float", variable has type "bytes"' "$work/said" || { cat "$work/said"; exit 1; }
