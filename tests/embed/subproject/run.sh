#!/usr/bin/env bash
# run.sh ROOT [build]: Rivulet as a part of a host's own build, in an empty folder: fetched by FetchContent from a local repository, then the same
# source by add_subdirectory. The repository has only the folders that a host needs: no tests, demos or assets. Checks what is looked for, what
# becomes of the host's settings, and where files are written; compiles the host's own files. With `build` also the library, which takes 5 to 15
# minutes: the hosts run, and Rivulet is installed as a part, into a multiarch prefix that moves, and found there by pkg-config.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$1" && pwd)"
mode="${2:-configure}"
command -v git >/dev/null && git -C "$root" rev-parse --git-dir >/dev/null 2>&1 || { echo "skipped: $root is no git repository"; exit 77; }
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
quietly() { "$@" >"$work/log" 2>&1 || { tail -60 "$work/log"; echo "this failed: $*"; exit 1; }; }
mkdir "$work/repository" "$work/host"
(
    cd "$root"
    git ls-files -z --cached --others --exclude-standard -- CMakeLists.txt LICENSE docs/*.md engine fluid shaders third_party |
        while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done | xargs -0 cp --parents -t "$work/repository"
)
cd "$work/repository"
quietly git init -q -b main .
quietly git add .
quietly git -c user.name=host -c user.email=host@localhost commit -q -m all
cp -r "$here"/* "$here/../installed/own" "$here"/../installed/host.* "$work/host"
cd "$work/host"

# ccache knows most files from the build beside, wherever this one lies.
export CCACHE_BASEDIR="$work" CCACHE_NOHASHDIR=1
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache); fi
configure() { quietly cmake -S . -B build -G Ninja -DWAY="$1" -DSOURCE="$work/repository" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O3 \
    -DRIVULET_INSTALL=ON -DCMAKE_INSTALL_LIBDIR=lib/x86_64-linux-gnu -DCMAKE_INSTALL_PREFIX="$work/prefix" "${launcher[@]}"; }
check() {
    if [ "$mode" != build ]; then
        quietly cmake --build build --target CMakeFiles/host_cpp.dir/host.cpp.o CMakeFiles/host_c.dir/host.c.o
        return
    fi
    quietly cmake --build build
    build/host_cpp
    build/host_c
    build/without_opencl
}
configure FetchContent
grep -q '^RIVULET_WERROR:BOOL=OFF' build/CMakeCache.txt || { echo "warnings are errors in a host's build"; exit 1; }
looked="$(grep -iE '^(imgui|egl|assimp|bullet|glfw3?|CLI11|GTest)[A-Za-z_]*(_DIR|_FOUND|_LIBRARIES)[:=]' build/CMakeCache.txt || true)"
[ -z "$looked" ] || { echo "a host's configuration looks for what only the program needs: $looked"; exit 1; }
check
configure add_subdirectory
check
# Where OpenGL is too old, what is left is said.
cmake -S "$work/repository" -B mac -G Ninja -DAPPLE=ON >"$work/log" 2>&1 || { tail -60 "$work/log"; echo "this failed: configuring as on macOS"; exit 1; }
grep -q 'macOS has OpenGL 4.1.*backends cpu and cl' "$work/log" || { echo "on macOS, CMake does not say what is left"; exit 1; }
if cmake -S "$work/repository" -B mac -DRIVULET_PROGRAM=ON >"$work/log" 2>&1; then echo "the program is not refused on macOS"; exit 1; fi
tr -s ' \n' ' ' <"$work/log" | grep -q 'set RIVULET_PROGRAM to OFF' || { cat "$work/log"; echo "the remedy is missing"; exit 1; }
# Nothing is written into the source, nor into the host's folder outside our part.
[ -z "$(git -C build/_deps/rivulet-src status --porcelain)" ] || { git -C build/_deps/rivulet-src status; echo "the build writes into the source"; exit 1; }
outside="$(find build -mindepth 1 -maxdepth 1 -printf '%f\n' | grep -vE '^(\.cmake|_deps|CMakeCache.txt|CMakeFiles|\.ninja_(deps|log)|build.ninja|cmake_install.cmake|host_c|host_cpp|without_opencl)$' || true)"
[ -z "$outside" ] || { echo "the build writes into the host's binary folder: $outside"; exit 1; }
[ "$mode" = build ] || exit 0

# Installed as a part.
quietly cmake --install build
export PKG_CONFIG_PATH="$work/prefix/lib/x86_64-linux-gnu/pkgconfig"
mv "$work/prefix" "$work/moved"  # a prefix may move
export PKG_CONFIG_PATH="$work/moved/lib/x86_64-linux-gnu/pkgconfig"
[ "$(realpath "$(pkg-config --variable=includedir rivulet)")" = "$work/moved/include" ] || { echo "pkg-config says $(pkg-config --cflags rivulet)"; exit 1; }
if pkg-config --print-requires rivulet-fluid | grep -q OpenCL; then echo "pkg-config asks for OpenCL, which this library does not use"; exit 1; fi
read -ra fluid <<<"$(pkg-config --cflags --libs rivulet-fluid)"
c++ -std=c++20 -Iown host.cpp "${fluid[@]}" -o by_pkg_config
./by_pkg_config
read -ra c <<<"$(pkg-config --cflags --libs rivulet)"
cc -x c -std=c11 -Iown host.c -x none "${c[@]}" -Wl,-rpath,"$(pkg-config --variable=libdir rivulet)" -o by_pkg_config_c
./by_pkg_config_c
