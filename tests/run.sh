#!/usr/bin/env bash
# Installs what is missing, builds everything, runs the tests; exits as ctest does.
#   bash tests/run.sh [arguments of ctest]             e.g. -L physics, -R include; RIVULET_HOSTS=1: with the hosts' packages
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
sections=(run test)
[ "${RIVULET_HOSTS:-}" = 1 ] && sections+=(hosts)  # other engines, and what reads their files and pictures; without them their tests are skipped
install_packages "${sections[@]}" || exit 1
build all -DRIVULET_TESTS=ON
export RIVULET_TEST_DEVICES=1  # those packages bring OpenGL and OpenCL: a test that finds none fails, it is not skipped
exec ctest --test-dir "$root/build/release" --parallel 2 --output-on-failure "$@"
