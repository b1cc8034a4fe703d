#!/usr/bin/env bash
# Installs what is missing, builds everything, says what it will run, runs the tests; exits as ctest does.
#   bash tests/run.sh [arguments of ctest]      -L fast: a tier (fast, gl, program, long); -L physics: a folder; -R include: by name
# RIVULET_HOSTS=1: with the packages of the hosts (other engines), whose tests are skipped without them. What reads the sources rather than
# runs them (clang, clang-tidy, format) is `ctest -L lint`, which .ci/run runs as well.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
sections=(run test)
[ "${RIVULET_HOSTS:-}" = 1 ] && sections+=(hosts)
install_packages "${sections[@]}" || exit 1
build all -DRIVULET_TESTS=ON
export RIVULET_TEST_DEVICES=1  # those packages bring OpenGL and OpenCL: a test that finds none fails, it is not skipped
cores="$(nproc)"
arguments=(--test-dir "$root/build/release" -LE lint "$@")
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
