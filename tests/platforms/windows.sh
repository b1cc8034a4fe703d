#!/usr/bin/env bash
# Windows: the library and rivulet.h, cross-built with mingw-w64 in a chroot of Debian 13, with fmt, JsonCpp, zstd and xxHash from the sources of
# Debian's packages; then a host in C steps water on the cpu under wine.
#   bash tests/platforms/windows.sh
set -u
. "$(dirname "${BASH_SOURCE[0]}")/chroot.sh"
system_of trixie
packages cmake ninja-build ccache pkg-config python3-glad g++-mingw-w64-x86-64-posix wine wine64 dpkg-dev libglm-dev libeigen3-dev libstb-dev
cat >"$system/windows.cmake" <<'END'
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_FIND_ROOT_PATH /windows)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
END
source_of windows fmtlib . -DFMT_TEST=OFF -DFMT_DOC=OFF
source_of windows libjsoncpp . -DJSONCPP_WITH_TESTS=OFF -DJSONCPP_WITH_POST_BUILD_UNITTEST=OFF -DBUILD_OBJECT_LIBS=OFF
source_of windows xxhash cmake_unofficial -DXXHASH_BUILD_XXHSUM=OFF
source_of windows libzstd build/cmake -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF
# Headers alone, which are for every system.
inside bash -c 'mkdir -p /windows/include /windows/lib/cmake/glm && cp -r /usr/include/glm /usr/include/stb /windows/include/
    printf "add_library(glm::glm INTERFACE IMPORTED)\nset_target_properties(glm::glm PROPERTIES INTERFACE_INCLUDE_DIRECTORIES /windows/include)\n" \
        >/windows/lib/cmake/glm/glmConfig.cmake'
inside bash -c 'export PKG_CONFIG_LIBDIR=/windows/lib/pkgconfig:/usr/share/pkgconfig && cmake -S /src -B /build-windows -G Ninja -DCMAKE_TOOLCHAIN_FILE=/windows.cmake \
        -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/windows/rivulet -DRIVULET_PROGRAM=OFF -DRIVULET_TESTS=OFF -DRIVULET_TBB=OFF -DRIVULET_OPENCL=OFF &&
    cmake --build /build-windows && cmake --install /build-windows' || fail "the build for Windows failed."
inside bash -c 'cd /tmp && x86_64-w64-mingw32-gcc-posix -std=c11 -O1 -Wall -Wextra -I/windows/rivulet/include /src/tests/platforms/fall.c -L/windows/rivulet/lib -lrivulet \
        -o fall.exe && cp /windows/rivulet/bin/librivulet.dll . && WINEDEBUG=-all wine fall.exe 2>/dev/null' || fail "the host failed."
