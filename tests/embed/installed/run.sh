#!/usr/bin/env bash
# run.sh BUILD: installs BUILD into a prefix of its own, builds a host against it and runs it; then runs the installed program where there is
# no source tree for it to find: its shaders must be inside it and its assets beside it.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake -S "$here" -B "$work/host" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake --build "$work/host" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
"$work/host/installed_host"

cd "$work"
unset DISPLAY WAYLAND_DISPLAY
export RIVULET_SHADERS="$work/no_such_folder"
"$work/prefix/bin/rivulet" list scenes | grep -q "$work/prefix" || { echo "the installed program does not find its own scenes"; exit 1; }
"$work/prefix/bin/rivulet" run "$work/prefix/share/rivulet/assets/scenes/sheet_on_sphere.json" --headless --frames 1 --size 64x48
[ -s "$work/out/sheet_on_sphere.mp4" ]
