#!/usr/bin/env bash
# Other compilers: for each, the library with the generic instruction set and rivulet.h, with warnings as errors; every public header alone as
# C++20 and as C++23; then a host in C steps water on the cpu. clang 15 and 16 in a chroot of Debian 12, the others in one of Debian 13.
#   bash tests/platforms/compilers.sh [COMPILER...]      default: all below; libc++ is clang 19 with LLVM's standard library
set -u
[ $# -gt 0 ] || set -- clang-15 clang-16 g++-12 g++-13 g++-14 clang-17 clang-18 clang-19 libc++
. "$(dirname "${BASH_SOURCE[0]}")/chroot.sh"
libraries=(cmake ninja-build ccache pkg-config dpkg-dev python3-glad g++ libglm-dev libeigen3-dev libstb-dev
    libtbb-dev libfmt-dev libzstd-dev libxxhash-dev libjsoncpp-dev ocl-icd-opencl-dev)
made=""
for compiler in "$@"; do
    case "$compiler" in clang-1[56]) suite=bookworm ;; *) suite=trixie ;; esac
    [ "$made" = "$suite" ] || system_of "$suite"
    made="$suite"
    options=()
    case "$compiler" in
        g++-*) cc="gcc-${compiler#g++-}" cxx="$compiler" wanted=("$compiler") ;;
        clang-*) cc="$compiler" cxx="clang++-${compiler#clang-}" wanted=("$compiler") ;;
        libc++) cc=clang-19 cxx="clang++-19 -stdlib=libc++" wanted=(clang-19 libc++-19-dev libc++abi-19-dev) options=(-DRIVULET_TBB=OFF) ;;
        *) fail "'$compiler' is none of the compilers; see the start of ${BASH_SOURCE[0]}." ;;
    esac
    packages "${libraries[@]}" "${wanted[@]}"
    build="/build-$compiler"
    printf 'set(CMAKE_SYSTEM_NAME Linux)\nset(CMAKE_SYSTEM_PROCESSOR any)\nset(CMAKE_C_COMPILER %s)\nset(CMAKE_CXX_COMPILER %s)\n' "$cc" "${cxx%% *}" >"$system/$compiler.cmake"
    [ "$compiler" != libc++ ] || echo 'set(CMAKE_CXX_FLAGS_INIT -stdlib=libc++)' >>"$system/$compiler.cmake"
    if [ "$compiler" = libc++ ]; then  # C++ libraries are of one standard library
        source_of "$compiler" fmtlib . -DFMT_TEST=OFF -DFMT_DOC=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
        source_of "$compiler" libjsoncpp . -DJSONCPP_WITH_TESTS=OFF -DJSONCPP_WITH_POST_BUILD_UNITTEST=OFF -DBUILD_OBJECT_LIBS=OFF \
            -DCMAKE_POSITION_INDEPENDENT_CODE=ON
        options+=(-DCMAKE_PREFIX_PATH="/$compiler")
    fi
    inside rm -rf "$build"  # ccache keeps what is unchanged; times of files may be those of another tree
    say "$compiler: $(inside "${cxx%% *}" --version | head -n 1)"
    inside cmake -S /src -B "$build" -G Ninja -DCMAKE_TOOLCHAIN_FILE="/$compiler.cmake" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_{C,CXX}_COMPILER_LAUNCHER=ccache \
        -DCMAKE_INSTALL_PREFIX="/prefix-$compiler" -DRIVULET_PROGRAM=OFF -DRIVULET_TESTS=OFF -DRIVULET_WERROR=ON "${options[@]}" \
        >"$system/$compiler.log" 2>&1 && inside cmake --build "$build" >>"$system/$compiler.log" 2>&1 &&
        inside cmake --install "$build" >>"$system/$compiler.log" 2>&1 || fail "$compiler: the build failed; its log is $system/$compiler.log."
    inside bash -c 'cd "/prefix-$1/include" || exit 1
        for standard in 20 23; do
            [ "$standard" != 23 ] || "${@:2}" -std=c++23 -fsyntax-only -x c++ /dev/null 2>/dev/null || standard=2b
            for header in $(cd rivulet && find . -name "*.h" ! -path "./shaders/*"); do
                printf "#include \"rivulet/%s\"\n" "${header#./}" >/tmp/header.cpp
                "${@:2}" -std=c++$standard -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I. -isystem /libc++/include /tmp/header.cpp ||
                    { echo "$header fails as C++$standard"; exit 1; }
            done
        done' _ "$compiler" $cxx || fail "$compiler: a public header does not compile."
    inside bash -c 'cd /tmp && "$1" -std=c11 -O1 -Wall -Wextra -I"/prefix-$2/include" /src/tests/platforms/fall.c -L"/prefix-$2/lib" -lrivulet -lm \
        -Wl,-rpath,"/prefix-$2/lib" -o fall && ./fall' _ "$cc" "$compiler" || fail "$compiler: the host failed."
done
