#!/usr/bin/env bash
# run.sh BUILD: installs BUILD into a prefix of its own, builds a host against it, by find_package and by pkg-config, and runs both; then
# runs the installed program where there is no source tree for it to find: its shaders must be inside it and its assets beside it. Last, the
# examples of the guide for hosts. The installed headers are checked by tests/checks/headers.sh.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake -S "$here" -B "$work/host" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake --build "$work/host" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
"$work/host/installed_host"

export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig:$work/prefix/lib64/pkgconfig:$work/prefix/lib/$(c++ -dumpmachine)/pkgconfig"
read -ra flags <<<"$(pkg-config --cflags --libs rivulet-fluid)"
c++ -std=c++20 -O1 "$here/main.cpp" "${flags[@]}" -o "$work/by_pkg_config"
"$work/by_pkg_config"

(
    cd "$work"
    unset DISPLAY WAYLAND_DISPLAY
    export RIVULET_SHADERS="$work/no_such_folder"
    "$work/prefix/bin/rivulet" list scenes >"$work/scenes.txt" && grep -q "$work/prefix" "$work/scenes.txt" || { echo "the installed program does not find its own scenes"; exit 1; }
    "$work/prefix/bin/rivulet" run "$work/prefix/share/rivulet/assets/scenes/sheet_on_sphere.json" --headless --frames 1 --size 64x48
    [ -s "$work/out/sheet_on_sphere.mp4" ]
    # Models are read by a program beside it, which alone links assimp.
    if ldd "$work/prefix/bin/rivulet" | grep -q assimp; then echo "rivulet links assimp"; exit 1; fi
    mv "$work/prefix/bin/rivulet_import" "$work/prefix/bin/elsewhere"
    status=0
    "$work/prefix/bin/rivulet" voxelize "$work/prefix/share/rivulet/assets/meshes/plate.obj" --resolution 8 --out plate.rvox 2>error.txt || status=$?
    [ $status -eq 1 ] && grep -q 'rivulet_import' error.txt || { echo "without rivulet_import, rivulet ended with $status:"; cat error.txt; exit 1; }
)

# What the guide for hosts shows.
guide=(python3 "$here/../guide.py" "$work/prefix" "$here/../../..")
if command -v xvfb-run >/dev/null; then
    xvfb-run -a -n 150 -s "-screen 0 1024x768x24" "${guide[@]}"  # far from what tests beside this one take
else
    "${guide[@]}"
fi
