#!/usr/bin/env bash
# run.sh BUILD: draws demos/embed_skin without a window, with drops and without, and checks its pictures and what it prints. Exit 77: it was
# not built, or EGL has no OpenGL 4.5 here.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
program="$1/bin/embed_skin"
[ -x "$program" ] || { echo "skipped: embed_skin was not built: section hosts of third_party/packages.txt has what it needs"; exit 77; }
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
export LIBGL_ALWAYS_SOFTWARE=1
draw() {  # NAME FLAGS...
    local name="$1"
    shift
    "$program" --headless --out "$work/$name.ppm" "$@" >"$work/$name.txt" 2>"$work/error" && return
    cat "$work/error"
    if grep -q 'EGL' "$work/error"; then exit 77; fi
    exit 1
}
for frame in 20 60 75; do
    draw "wet_$frame" --frames $frame --backend cpu
    draw "dry_$frame" --frames $frame --backend cpu --dry
done
draw gl_60 --frames 60 --backend gl
/usr/bin/python3 "$here/check.py" "$work"
