#!/usr/bin/env bash
# run.sh BUILD: data sets of recordings, read by h5py, zarr and xarray: the same numbers as in CSV files of the same run, bit for bit; and the
# pages' example, a sweep whose runs are loaded together. Exit 77: a reader is not installed (modules.sh).
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$here/../../.."
built="$(cd "$1" && pwd)"
program="$built/bin/rivulet"
. "$here/../modules.sh"
need_modules h5py netCDF4 numpy xarray zarr
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
export PYTHONDONTWRITEBYTECODE=1
# Water that falls from a block and from a tap: frames differ in their number of particles.
cat >fall.json <<'END'
{"name": "fall", "doc": "A column falls.", "fluid": {"spacing": 0.02, "viscosity": 2e-6, "box": {"max": [0.4, 1, 0.4]},
 "blocks": [{"min": [0.06, 0.6, 0.06], "max": [0.22, 0.8, 0.18]}]},
 "emitters": [{"position": [0.3, 0.4, 0.3], "direction": [0, -1, 0], "speed": 1, "size": [0.06, 0.06, 0.06]}]}
END
sed 's/"fall"/"column"/; s/"emitters".*/"duration": 1}/' fall.json >column.json
for scene in fall column; do "$program" run $scene.json --no-render --frames 15 --backend cpu --record $scene.rrec --out stats >log 2>&1 || { cat log; exit 1; }; done
for format in hdf5 zarr; do
    "$program" export fall.rrec --format $format --out sets >log 2>&1 || { cat log; exit 1; }
    "$program" export column.json --format $format --seconds 0.25 --backend cpu --out scene >log 2>&1 || { cat log; exit 1; }
done
"$program" export column.rrec --format hdf5 --every 3 --out sets >log 2>&1
"$program" export fall.json --format csv --seconds 0.25 --backend cpu --out csv >log 2>&1
"$program" run column.json --no-render --frames 50 --backend cpu --set fluid.foam.most=2000 --set fluid.foam.trappedAir=100000 --record foam.rrec --out stats >log 2>&1 || { cat log; exit 1; }
"$program" export foam.rrec --format zarr --out sets >log 2>&1
# A recording that the library made has its world's parameters, too.
RIVULET_LIBRARY="$built/librivulet.so" PYTHONPATH="$root/fluid/python" /usr/bin/python3 - <<'END'
import rivulet
scene = {"fluid": {"spacing": 0.04, "viscosity": 3e-6, "blocks": [{"max": [0.2, 0.4, 0.2]}]},
         "emitters": [{"position": [0.6, 0.6, 0.6], "speed": 1.5}]}
with rivulet.Context(backend="cpu") as context, context.world(scene) as world:
    world.set("fluid.viscosity", 4e-6)
    with world.record("library.rrec"):
        for _ in range(3):
            world.step(1 / 60)
END
"$program" export library.rrec --format hdf5 --out sets >log 2>&1
if grep -q "has no parameters" log; then cat log; exit 1; fi
/usr/bin/python3 "$here/check.py"
# An export that is killed leaves a hidden folder, which the next one of that name removes; not those of processes that run, or of other machines.
mkdir killed
"$program" export column.json --format zarr --seconds 20 --backend cpu --out killed >log 2>&1 &
victim=$!
until ls -d killed/.rivulet-*-$victim-column.zarr >/dev/null 2>&1; do kill -0 $victim 2>/dev/null || { cat log; exit 1; }; sleep 0.02; done
kill -9 $victim
wait $victim || true
[ -d killed/.rivulet-*-$victim-column.zarr ] && [ ! -e killed/column.zarr ] || { echo "the export was not killed in the middle"; exit 1; }
mkdir "killed/.rivulet-$(uname -n)-$$-column.zarr" "killed/.rivulet-another-$victim-column.zarr"
"$program" export column.json --format zarr --seconds 0.1 --backend cpu --out killed >log 2>&1 || { cat log; exit 1; }
[ "$(ls -A killed | LC_ALL=C sort | tr '\n' ' ')" = "$(printf '%s\n' ".rivulet-$(uname -n)-$$-column.zarr" ".rivulet-another-$victim-column.zarr" column.zarr | LC_ALL=C sort | tr '\n' ' ')" ] ||
    { echo "left in the folder:"; ls -A killed; exit 1; }

# The sweep of docs/datasets.md with 20 runs, each as a task of its own.
for name in dam.json SWEEP.json load.py; do
    awk -v name="file=$name" '/^```/ { inside = $2 == name; next } inside' "$root/docs/datasets.md" >$name
    [ -s $name ] || { echo "docs/datasets.md no longer has a block $name"; exit 1; }
done
sed -i 's/"samples": 1000/"samples": 20/' SWEEP.json
"$program" sweep SWEEP.json --output runs >log 2>&1 || { cat log; exit 1; }
/usr/bin/python3 load.py | tee said
grep -Eq '^\(20, 2\) \(20, 15, 1500, 3\) -0\.[5-9]' said || { echo "the runs are not those of the page"; exit 1; }
