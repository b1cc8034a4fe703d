#!/usr/bin/env bash
# headers.sh BUILD: every installed header compiles alone, with warnings as errors. What they leave a host is checked by tests/embed/installed.
set -eu
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig:$work/prefix/lib64/pkgconfig:$work/prefix/lib/$(c++ -dumpmachine)/pkgconfig"

# Headers for C++; those under shaders/ are for kernels, which say first what they are compiled as.
cd "$work/prefix/include"
find rivulet -name '*.h' -not -path 'rivulet/shaders/*' | sort >"$work/headers"
export alone="c++ -x c++ -std=c++20 -Wall -Wextra -Wpedantic -Werror $(pkg-config --cflags rivulet-fluid) -fsyntax-only -"
xargs -P 2 -I {} sh -c 'printf "#include \"%s\"\n" {} | $alone || { echo "{} does not compile alone"; exit 1; }' <"$work/headers"
echo "$(wc -l <"$work/headers") headers compile alone"
