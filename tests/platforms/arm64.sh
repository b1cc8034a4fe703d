#!/usr/bin/env bash
# arm64: the library and rivulet.h, cross-built in a chroot of Debian 13; then a host in C steps water on the cpu under qemu-user.
#   bash tests/platforms/arm64.sh [tests]      tests: also builds the programs of tests, and runs the fast ones of unit and physics
set -u
. "$(dirname "${BASH_SOURCE[0]}")/chroot.sh"
system_of trixie arm64
packages cmake ninja-build ccache pkg-config python3-glad g++-aarch64-linux-gnu qemu-user libglm-dev libeigen3-dev libstb-dev \
    {libtbb,libfmt,libzstd,libxxhash,libjsoncpp,ocl-icd-opencl}-dev:arm64
cat >"$system/arm64.cmake" <<'END'
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L /)
END
inside bash -c 'export PKG_CONFIG_LIBDIR=/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig && cmake -S /src -B /build-arm64 -G Ninja \
        -DCMAKE_TOOLCHAIN_FILE=/arm64.cmake -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/arm64 -DRIVULET_PROGRAM=OFF -DRIVULET_TESTS=OFF &&
    cmake --build /build-arm64 && cmake --install /build-arm64' || fail "the build for arm64 failed."
inside bash -c 'cd /tmp && aarch64-linux-gnu-gcc -std=c11 -O1 -Wall -Wextra -I/arm64/include /src/tests/platforms/fall.c -L/arm64/lib -lrivulet -lm \
        -Wl,-rpath,/arm64/lib -o fall.arm64 && qemu-aarch64 -L / ./fall.arm64' || fail "the host failed."
[ "${1:-}" = tests ] || exit 0
packages {libglfw3,libegl,libgl,libimgui,libassimp,libbullet,libgtest}-dev:arm64 libcli11-dev opencl-headers {libegl-mesa0,libgl1-mesa-dri}:arm64
inside bash -c 'export PKG_CONFIG_LIBDIR=/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig && cmake -S /src -B /build-arm64-tests -G Ninja \
        -DCMAKE_TOOLCHAIN_FILE=/arm64.cmake -DCMAKE_BUILD_TYPE=Release -DRIVULET_TESTS=ON &&
    cmake --build /build-arm64-tests --target test_unit test_physics' || fail "the tests were not built for arm64."
# Tests start the reader of models as a process of its own: Linux must know what runs it.
binfmt=/proc/sys/fs/binfmt_misc
[ -e $binfmt/register ] || mount -t binfmt_misc none $binfmt || fail "Linux has no binfmt_misc."
if [ ! -e $binfmt/rivulet-aarch64 ]; then
    printf ':rivulet-aarch64:M::\\x7fELF\\x02\\x01\\x01%s\\x02\\x00\\xb7\\x00:%s\\x00%s\\xfe\\xff\\xff\\xff:%s:OCF' "$(printf '\\x00%.0s' {1..9})" \
        "$(printf '\\xff%.0s' {1..7})" "$(printf '\\xff%.0s' {1..8})" "$system/usr/bin/qemu-aarch64" >$binfmt/register || fail "binfmt_misc refuses qemu-aarch64."
    trap 'echo -1 >$binfmt/rivulet-aarch64; unmount' EXIT
fi
inside ctest --test-dir /build-arm64-tests -R '^(unit|physics)\.' -L fast --timeout 1200 || fail "a test failed."
