#!/usr/bin/env bash
# run.sh BUILD: OpenCL shares memory with OpenGL through the driver of icd.cpp: the tests of sharing; then pictures of a scene, which must
# be those that are drawn without sharing, nearly: what is copied through the host comes as 16-bit floats. Exit 77: PoCL is not installed, or EGL has no OpenGL 4.5 here.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../.." && pwd)"
build="$(cd "$1" && pwd)"
lacks() {
    echo "skipped: $1"
    [ -z "${RIVULET_TEST_DEVICES:-}" ] || exit 1
    exit 77
}
[ -f "${POCL_ICD:-/etc/OpenCL/vendors/pocl.icd}" ] || lacks "PoCL is not installed"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
echo "$build/libsharing_icd.so" >"$work/sharing.icd"
export RIVULET_ASSETS="$root/assets" LIBGL_ALWAYS_SOFTWARE=1 XDG_CACHE_HOME="$work/cache"
shares() { OCL_ICD_VENDORS="$work/sharing.icd" RIVULET_SHARING="${sharing:-1}" "$@"; }
shares "$build/bin/test_parity" --gtest_filter='GlSharingTest.ADriverThatShares*:GlSharingTest.TheCurrent*' >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
sharing=ordered shares "$build/bin/test_parity" --gtest_filter='GlSharingTest.ADriverThatShares*' >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
! grep -q SKIPPED "$work/log" || lacks "$(grep -m 1 -A 1 Skipped "$work/log")"
for scene in paddle_wheel; do
    draw() { "$build/bin/rivulet" run $scene --headless --backend cl --size 160x90 --frames 9 --still 0.05 --still 0.1 \
        --set fluid.spacing=0.05 --set fluid.foam.most=500 --stats "$work/$1.json" --out "$work/$1" >"$work/log" 2>&1; }
    draw copied || { cat "$work/log"; exit 1; }
    sharing=ordered shares draw ordered || { cat "$work/log"; exit 1; }
    shares draw shared || { cat "$work/log"; exit 1; }
    /usr/bin/python3 - "$work" $scene <<'PY'
import json, pathlib, subprocess, sys
work, scene = pathlib.Path(sys.argv[1]), sys.argv[2]
for way, wanted in ("copied", "ring"), ("shared", "shared with OpenCL"), ("ordered", "shared with OpenCL"):
    said = json.loads((work / f"{way}.json").read_text())
    assert said["transfer"]["way"] == wanted, (scene, said["transfer"])
pictures = sorted(path.name for path in (work / "copied").glob("*.png"))
assert len(pictures) >= 2, pictures
def pixels(path):
    return subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], check=True, capture_output=True).stdout


for name in pictures:
    copied, shared = pixels(work / "copied" / name), pixels(work / "shared" / name)
    assert len(copied) == len(shared) == 3 * 160 * 90
    off = [abs(a - b) for a, b in zip(copied, shared)]
    assert max(off) <= 8 and sum(map(bool, off)) < 0.01 * len(off), f"{scene}: {name} differs with shared memory by up to {max(off)}"
    assert pixels(work / "ordered" / name) == shared, f"{scene}: {name} differs where the driver orders the commands of both"
PY
    rm -rf "$work/copied" "$work/shared" "$work/ordered"
done
