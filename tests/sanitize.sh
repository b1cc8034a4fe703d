#!/usr/bin/env bash
# The tests under sanitizers, built by clang into build/asan or build/tsan, which takes about a quarter of an hour on 2 cores.
#   bash tests/sanitize.sh address [arguments of ctest]    memory, leaks, undefined behaviour: AddressSanitizer and UBSan
#   bash tests/sanitize.sh thread [arguments of ctest]     races: ThreadSanitizer
#   bash tests/sanitize.sh values                          uninitialised values in the kernels of the cpu: valgrind over build/release
# RIVULET_JOBS=N: N tests at once. What starts other builds (docs.recipes, embed) is left out. exit status: as ctest's.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
kind="${1:-}"
case "$kind" in
    address) folder=asan ;;
    thread) folder=tsan ;;
    values) ;;
    *) fail "say which: bash tests/sanitize.sh address, thread or values" ;;
esac
shift
install_packages run test || exit 1
jobs="${RIVULET_JOBS:-$(nproc)}"
export RIVULET_TEST_DEVICES=1
if [ "$kind" = values ]; then
    command -v valgrind >/dev/null || install_packages sanitize || exit 1
    build test_physics
    # valgrind 3.19 knows no AVX-512. Each method, foam, sleep, bodies, solids and emitters once.
    RIVULET_ISA=avx2 exec valgrind --quiet --error-exitcode=1 --track-origins=no --leak-check=no --undef-value-errors=yes \
        --suppressions="$root/tests/checks/valgrind.supp" "$root/build/release/bin/test_physics" \
        --gtest_filter="${1:-Methods/KernelsUnderValgrind.*}"
fi
build_folder="$root/build/$folder"
say "building with sanitizers; the first time takes about a quarter of an hour."
mkdir -p "$build_folder"
if ! { (cd "$root" && cmake --preset "$folder" -DRIVULET_TESTS=ON -DRIVULET_WERROR=OFF) && cmake --build "$build_folder"; } >"$build_folder/building.log" 2>&1 </dev/null; then
    tail -n 60 "$build_folder/building.log" >&2
    fail "building failed; the whole log is $build_folder/building.log."
fi
# Drivers of OpenGL and OpenCL keep memory until the end, and are not instrumented.
export ASAN_OPTIONS="detect_stack_use_after_return=1:strict_string_checks=1:detect_odr_violation=1:handle_abort=0:allocator_may_return_null=1"
export LSAN_OPTIONS="suppressions=$root/tests/checks/leaks.supp:print_suppressions=0"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"
export TSAN_OPTIONS="suppressions=$root/tests/checks/races.supp:ignore_noninstrumented_modules=1:second_deadlock_stack=1"
exec ctest --test-dir "$build_folder" -LE lint -E '^(docs\.|embed\.|checks\.)' --parallel "$jobs" --timeout 1800 --output-on-failure "$@"
