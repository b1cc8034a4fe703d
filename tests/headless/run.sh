#!/bin/bash
# run.sh PROGRAM SCENE: the program runs the scene, and needs neither GLFW nor Dear ImGui: no library, and no function of them inside it.
set -euo pipefail
program=$1 scene=$2
env -u DISPLAY -u WAYLAND_DISPLAY "$program" "$scene"
for tool in readelf nm; do
    command -v "$tool" > /dev/null || { echo "skipped: $tool is not installed (binutils)"; exit 77; }
done
libraries=$(readelf -d "$program" | grep NEEDED)
functions=$(nm -C "$program")
if grep -iE 'glfw|imgui' <<< "$libraries"; then echo "FAILED: a library of windows or panels is linked"; exit 1; fi
if grep -E ' (glfw[A-Z]|ImGui::|ImFont|ImDraw)' <<< "$functions" | head; then
    echo "FAILED: functions of GLFW or Dear ImGui are linked"
    exit 1
fi
grep -q 'rivulet::Session::create' <<< "$functions" || { echo "FAILED: the program's symbols are stripped, so nothing was checked"; exit 1; }
echo "neither GLFW nor Dear ImGui is linked"
