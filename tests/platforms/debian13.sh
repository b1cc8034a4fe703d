#!/usr/bin/env bash
# Debian 13 beside Debian 12: builds everything in a chroot with its g++, Dear ImGui, GLFW, assimp, oneTBB, Mesa and PoCL, and runs the tests.
#   bash tests/platforms/debian13.sh [arguments of ctest]      default: -L fast
set -u
. "$(dirname "${BASH_SOURCE[0]}")/chroot.sh"
system_of trixie
mapfile -t wanted < <(packages_of run; packages_of test)
packages "${wanted[@]}"
[ $# -gt 0 ] || set -- -L fast
inside bash -c 'g++ --version | head -n 1; dpkg-query -W -f "\${Package} \${Version}\n" libimgui-dev libglfw3-dev libassimp-dev libtbb-dev libgl1-mesa-dri pocl-opencl-icd'
inside bash -c 'cmake -S /src -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DRIVULET_TESTS=ON && cmake --build /build && ctest --test-dir /build -LE lint --output-on-failure "$@"' _ "$@"
