#!/usr/bin/env bash
# headers.sh BUILD: every installed header compiles alone, with warnings as errors, and together they leave a host no macro without a prefix.
set -eu
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig:$work/prefix/lib64/pkgconfig:$work/prefix/lib/$(c++ -dumpmachine)/pkgconfig"

# Headers for C++; those under shaders/ are for kernels, which say first what they are compiled as.
cd "$work/prefix/include"
find engine fluid -name '*.h' | sort >"$work/headers"
export alone="c++ -x c++ -std=c++20 -Wall -Wextra -Wpedantic -Werror -DCL_TARGET_OPENCL_VERSION=120 $(pkg-config --cflags rivulet-fluid) -fsyntax-only -"
xargs -P 2 -I {} sh -c 'printf "#include \"%s\"\n" {} | $alone || { echo "{} does not compile alone"; exit 1; }' <"$work/headers"
echo "$(wc -l <"$work/headers") headers compile alone"
sed 's/.*/#include "&"/' "$work/headers" | ${alone/-fsyntax-only/-E -dD} >"$work/preprocessed"
awk '/^# [0-9]+ "/ { ours = $3 ~ /^"(.*\/)?(engine|fluid|shaders)\// }
    /^#(define|undef) / { sub(/\(.*/, "", $2) }
    /^#define / { if (ours && $2 !~ /^RIVULET_/) left[$2] = 1; next }
    /^#undef / { delete left[$2] }
    END { delete left["ASSERT"]; for (name in left) print name }' "$work/preprocessed" | sort >"$work/macros"  # assert.h is there for ASSERT
[ ! -s "$work/macros" ] || { echo "the headers leave a host these macros:" $(cat "$work/macros"); exit 1; }
