#!/usr/bin/env bash
# Installs what is missing, builds everything, says what it will run, runs the tests; exits as ctest does.
#   bash tests/run.sh [arguments of ctest]      -L fast: a tier (fast, gl, program, long); -L physics: a folder; -R include: by name
# RIVULET_SANITIZE=address or thread: under clang's AddressSanitizer with UBSan, or under ThreadSanitizer, in build/asan or build/tsan; without what
# starts builds of its own.
# RIVULET_TURN=1/4: of the suites of durations.txt the first of four parts, and all others.
# RIVULET_HOSTS=1: with the packages of the hosts (other engines), whose tests are skipped without them. What reads the sources rather than
# runs them (clang, clang-tidy, format) is `ctest -L lint`, which .ci/run runs as well.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
sections=(run test gpus)
[ "${RIVULET_HOSTS:-}" = 1 ] && sections+=(hosts)
install_packages "${sections[@]}" || exit 1
arguments=()
case "${RIVULET_SANITIZE:-}" in
    "")
        build all -DRIVULET_TESTS=ON
        arguments+=(--test-dir "$root/build/release" -LE lint)
        ;;
    address | thread)
        preset="${RIVULET_SANITIZE/address/asan}"
        preset="${preset/thread/tsan}"
        build_preset "$preset" all -DRIVULET_TESTS=ON
        # Drivers of OpenGL and OpenCL are not instrumented, and keep memory until the end.
        export ASAN_OPTIONS="detect_stack_use_after_return=1:strict_string_checks=1:allocator_may_return_null=1" UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"
        export LSAN_OPTIONS="suppressions=$root/tests/checks/leaks.supp:print_suppressions=0"
        export TSAN_OPTIONS="suppressions=$root/tests/checks/races.supp:ignore_noninstrumented_modules=1"
        arguments+=(--test-dir "$root/build/$preset" -LE "lint|docs|embed|checks" --timeout 1800)
        ;;
    *) fail "RIVULET_SANITIZE is '$RIVULET_SANITIZE'; set it to address or thread" ;;
esac
export RIVULET_TEST_DEVICES=1  # those packages bring OpenGL and OpenCL: a test that finds none fails, it is not skipped
cores="$(nproc)"
if [ -n "${RIVULET_TURN:-}" ]; then
    [[ "$RIVULET_TURN" =~ ^[1-9][0-9]*/[1-9][0-9]*$ ]] || fail "RIVULET_TURN is '$RIVULET_TURN'; write, for example, 1/4"
    others="$(awk -v turn="${RIVULET_TURN%/*}" -v turns="${RIVULET_TURN#*/}" '/^[0-9]/ && k++ % turns != turn % turns { printf "%s%s", sep, $2; sep = "|" }' "$root/tests/durations.txt")"
    [ -z "$others" ] || arguments+=(-E "^(${others//./\\.})(\\.|\$)")
fi
arguments+=("$@")
# Each suite counts as many seconds as durations.txt says, each test of the others a tenth of one.
ctest "${arguments[@]}" -N | awk -v cores="$cores" -v table="$root/tests/durations.txt" '
    BEGIN { while ((getline row < table) > 0) { split(row, word, " "); seconds[word[2]] = word[1] } }
    $1 == "Test" && $2 ~ /^#/ {
        tests++
        split($3, part, ".")
        suite = part[1] "." part[2]
        if (!(suite in seconds)) sum += 0.1
        else if (!(suite in seen)) sum += seconds[suite]
        seen[suite] = 1
    }
    END { printf "rivulet: %d tests, %d at once: about %d minutes with 2 cores free, fewer with more\n", tests, cores, sum / 60 / (cores < 2 ? 1 : 2) + 1 }' >&2
exec ctest "${arguments[@]}" --parallel "$cores" --output-on-failure
