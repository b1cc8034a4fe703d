#!/usr/bin/env bash
# run.sh BUILD HOST [FRAMES]: draws the host's picture with water and without, in a display of its own, and compares; with a number of frames of
# one's own not with the reference. OGRE's texture and compositor must be as its window, and its picture afterwards as one without us. Exit 77:
# the host was not built, as its package is not installed, or there is nothing to draw into or to compare with.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
program="$1/bin/$2"
[ -x "$program" ] || { echo "skipped: $2 was not built: section hosts of third_party/packages.txt has what it needs"; exit 77; }
command -v xvfb-run >/dev/null || { echo "skipped: xvfb is not installed"; exit 77; }
/usr/bin/python3 -c 'import numpy, matplotlib.image' 2>/dev/null || { echo "skipped: python3-numpy or python3-matplotlib is not installed"; exit 77; }
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
export MPLCONFIGDIR="$work" LIBGL_ALWAYS_SOFTWARE=1  # the references are llvmpipe's
unset WAYLAND_DISPLAY
for water in wet dry; do
    flags=(--frames "${3:-26}" --picture "$work/$2_$water.ppm")
    [ $water = dry ] && flags+=(--dry)
    xvfb-run -a -s "-screen 0 1024x768x24" "$program" "${flags[@]}" >"$work/said" 2>&1 || { cat "$work/said"; exit 1; }
    if grep -iE 'opengl error|error|warning' "$work/said"; then exit 1; fi
done
if [ "$2" = embed_ogre ]; then
    for part in texture compositor; do
        cmp "$work/$2_wet.ppm" "$work/$2_wet.ppm.$part" || { echo "the water in the $part is not that in the window"; exit 1; }
    done
    cmp "$work/$2_wet.ppm.after" "$work/$2_dry.ppm" || { echo "after the water, OGRE's own picture is another"; exit 1; }
fi
[ -n "${3:-}" ] || /usr/bin/python3 "$here/compare.py" "$2" "$work"
