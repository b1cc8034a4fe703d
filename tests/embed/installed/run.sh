#!/usr/bin/env bash
# run.sh BUILD: installs BUILD into a prefix of its own and builds hosts against it in empty folders, in C and in C++: by find_package, by
# pkg-config, by dlopen, as a shared library of the host. Then settings in which the library cannot work, and those in which it must; what
# the headers bring with them; the installed program where there is no source tree for it to find (its shaders must be inside it and its
# assets beside it); last, the examples of the guide for hosts. tests/checks/headers.sh compiles each installed header alone.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; echo "this failed: $*"; exit 1; }; }
quietly cmake --install "$1" --prefix "$work/prefix"
export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig:$work/prefix/lib64/pkgconfig:$work/prefix/lib/$(c++ -dumpmachine)/pkgconfig"
library="$(pkg-config --variable=libdir rivulet)/librivulet.so"
cp -r "$here/own" "$here"/host.* "$here/CMakeLists.txt" "$work"
cd "$work"

# find_package.
quietly cmake -S . -B host -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release
quietly cmake --build host
host/host_cpp
host/host_c
# A host in C alone looks for nothing but the shared library.
mkdir c_alone
cat >c_alone/CMakeLists.txt <<'HOST'
cmake_minimum_required(VERSION 3.25)
project(c_alone LANGUAGES C)
find_package(rivulet REQUIRED COMPONENTS c)
if(TARGET fmt::fmt OR TARGET glm::glm OR TARGET TBB::tbb)
    message(FATAL_ERROR "find_package(rivulet COMPONENTS c) looks for what only the static library needs")
endif()
include_directories(BEFORE ../own)
add_executable(host_c ../host.c)
target_link_libraries(host_c PRIVATE rivulet::c)
HOST
quietly cmake -S c_alone -B c_alone/build -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix"
quietly cmake --build c_alone/build
c_alone/build/host_c

# pkg-config.
warnings="-Wall -Wextra -Wpedantic -Werror -Iown"
read -ra fluid <<<"$(pkg-config --cflags --libs rivulet-fluid)"
read -ra c <<<"$(pkg-config --cflags --libs rivulet)"
c++ -std=c++20 $warnings -O1 host.cpp "${fluid[@]}" -o by_pkg_config
./by_pkg_config
cc -x c -std=c11 $warnings host.c -x none "${c[@]}" -Wl,-rpath,"${library%/*}" -o by_pkg_config_c
./by_pkg_config_c
c++ -x c++ -std=c++17 $warnings host.c -x none "${c[@]}" -Wl,-rpath,"${library%/*}" -o by_pkg_config_c_as_cpp
./by_pkg_config_c_as_cpp

# dlopen: nothing is linked.
read -ra include <<<"$(pkg-config --cflags rivulet)"
cc -x c -std=gnu11 -Wall -Wextra -Werror -Iown -DBY_DLOPEN host.c "${include[@]}" -o by_dlopen -ldl
./by_dlopen "$library"
c++ -x c++ -std=c++17 -Wall -Wextra -Werror -Iown -DBY_DLOPEN host.c "${include[@]}" -o by_dlopen_as_cpp -ldl
./by_dlopen_as_cpp "$library"

# A static rivulet in a host's shared library shows nothing of itself.
c++ -std=c++20 $warnings -O2 -fPIC -shared -fvisibility-inlines-hidden -Dmain=water host.cpp "${fluid[@]}" -Wl,--no-undefined -o plugin.so
nm -DC --defined-only plugin.so | grep -q ' water' || { echo "plugin.so lacks its own function"; exit 1; }
shown="$(nm -DC --defined-only plugin.so | grep -iE 'rivulet|glad' || true)"
[ -z "$shown" ] || { echo "a static rivulet in a host's shared library shows: $shown"; exit 1; }
# Without that flag, nothing but the host's own copies of inline functions.
c++ -std=c++20 $warnings -O0 -fPIC -shared -Dmain=water host.cpp "${fluid[@]}" -Wl,--no-undefined -o plugin.so
shown="$(nm -DC --defined-only plugin.so | grep -iE 'rivulet|glad' | grep -v '^[0-9a-f]* [WV] ' || true)"
[ -z "$shown" ] || { echo "a static rivulet in a host's shared library shows: $shown"; exit 1; }

# Settings of a host that change glm's types: the water falls as before.
for setting in GLM_FORCE_DEFAULT_ALIGNED_GENTYPES "GLM_FORCE_DEFAULT_ALIGNED_GENTYPES -DGLM_FORCE_INTRINSICS -msse4.1" GLM_FORCE_XYZW_ONLY \
    GLM_FORCE_SIZE_T_LENGTH GLM_FORCE_PRECISION_MEDIUMP_FLOAT "GLM_FORCE_LEFT_HANDED -DGLM_FORCE_DEPTH_ZERO_TO_ONE"; do
    quietly c++ -std=c++20 -Iown -O1 -D$setting host.cpp "${fluid[@]}" -o with_setting
    quietly ./with_setting
done
# Settings in which the library would misread what a host passes: one sentence, no program.
refused() { # SENTENCE ARGUMENTS...
    local sentence="$1"
    shift
    if c++ -Iown "$@" host.cpp "${fluid[@]}" -o refused >refused.txt 2>&1; then echo "this compiles and links: $*"; exit 1; fi
    grep -q "$sentence" refused.txt || { echo "with $* a host does not read '$sentence':"; head -20 refused.txt; exit 1; }
}
refused "do without GLM_FORCE_QUAT_DATA_WXYZ" -std=c++20 -DGLM_FORCE_QUAT_DATA_WXYZ
refused "undefined reference to .rivulet::library::is_built_with_GLIBCXX_DEBUG" -std=c++20 -D_GLIBCXX_DEBUG
refused "undefined reference to .rivulet::library::is_built_with_GLIBCXX_DEBUG" -std=c++20 -D_GLIBCXX_DEBUG -ffunction-sections -fdata-sections -Wl,--gc-sections
refused "undefined reference to .rivulet::library::is_built_with_GLIBCXX_USE_CXX11_ABI_0" -std=c++20 -D_GLIBCXX_USE_CXX11_ABI=0
refused "Rivulet needs C++20: compile with -std=c++20" -std=c++17
[ "$(grep -c 'error:' refused.txt)" -eq 2 ] || { echo "C++17 gives more than the sentence and the end:"; cat refused.txt; exit 1; }

# All headers together: what they bring is the standard library, glm and Rivulet, in either order with OpenGL's headers, and no macro of theirs
# without the prefix.
cd prefix/include
find rivulet -name '*.h' -not -path 'rivulet/shaders/*' | sort | sed 's/.*/#include "&"/' >"$work/all.h"
cat >>"$work/all.h" <<'SHARED'
#include "rivulet/shaders/fluid/world/step_params.h"
#include "rivulet/shaders/fluid/solids/wet_cells.h"
SHARED
cd "$work"
plain="$(grep -rhoE '# *include *"[^"]*"' prefix/include/rivulet --exclude='rivulet*.h' | grep -v '"rivulet/' || true)"
[ -z "$plain" ] || { echo "in the headers, a host's own headers may be taken for ours: $plain"; exit 1; }
read -ra flags <<<"$(pkg-config --cflags rivulet-fluid)"
foreign="$(c++ -std=c++20 "${flags[@]}" -x c++ -M all.h | tr ' \\' '\n\n' | grep -E '/(GL|CL|KHR|EGL|oneapi|fmt|json)/|glad|immintrin|json/|xxhash|zstd' || true)"
[ -z "$foreign" ] || { echo "the headers bring with them: $foreign"; exit 1; }
sed -n 's/^#include <\(.*\)>.*/#include <\1>/p' $(find prefix/include/rivulet -name '*.h') | grep -v 'needs_cxx_20\|immintrin' | sort -u >others.h
for compiler in c++ clang++; do
    command -v $compiler >/dev/null || continue
    for standard in 20 2b; do $compiler -std=c++$standard "${flags[@]}" -Wall -Wextra -Wpedantic -Werror -x c++ -fsyntax-only all.h; done
done
macros() { c++ -std=c++20 "${flags[@]}" -x c++ -dM -E "$1" | sed 's/^#define \([A-Za-z0-9_]*\).*/\1/' | sort -u; }
left="$(comm -23 <(macros all.h) <(macros others.h) | grep -v '^RIVULET_' || true)"
[ -z "$left" ] || { echo "the headers leave a host these macros: $left"; exit 1; }
names="FN STRUCT CONSTANT GLOBAL PASS EXACT TO_INT TO_UINT TO_DOUBLE"
for name in $names; do echo "#define $name HOSTS_OWN"; done >own_macros.h
kept="$(cat own_macros.h all.h | c++ -std=c++20 "${flags[@]}" -Werror -x c++ -dM -E - | grep -c HOSTS_OWN)"
[ "$kept" -eq "$(wc -w <<<"$names")" ] || { echo "the headers change macros of the host: $kept of $names are left"; exit 1; }
if echo '#include <GL/gl.h>' | c++ -x c++ -fsyntax-only - 2>/dev/null; then
    printf '#include <GL/gl.h>\n#include <GL/glcorearb.h>\n' >gl.h
    cat all.h gl.h | c++ -std=c++20 "${flags[@]}" -Wall -Wextra -Werror -x c++ -fsyntax-only -
    cat gl.h all.h | c++ -std=c++20 "${flags[@]}" -Wall -Wextra -Werror -x c++ -fsyntax-only -
fi
if [ -x /usr/bin/glad ]; then  # a loader of the host
    quietly /usr/bin/glad --reproducible --api gl:core=4.6 --out-path glad c
    { echo '#include <glad/gl.h>'; cat all.h; } | c++ -std=c++20 "${flags[@]}" -Iglad/include -Wall -Wextra -Werror -x c++ -fsyntax-only -
    { cat all.h; echo '#include <glad/gl.h>'; } | c++ -std=c++20 "${flags[@]}" -Iglad/include -Wall -Wextra -Werror -x c++ -fsyntax-only -
fi
grep -q 'Apache-2.0' prefix/share/doc/rivulet/third_party.md || { echo "the licences of dependencies are not installed"; exit 1; }

(
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
