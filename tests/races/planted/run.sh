#!/usr/bin/env bash
# Faults on purpose, in scratch copies of the shaders: each must be found, and an unchanged copy must pass the same check.
#   run.sh BUILD FOLDER        FOLDER: for scratch copies
set -u
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)"
build="$1" work="$2"
export RIVULET_TEST_DEVICES=1
missed=0
# found NAME COMMAND..., clean NAME COMMAND...: the command succeeds where it finds the fault, or nothing in the unchanged copy.
found() {
    if "${@:2}"; then printf '  found   %s\n' "$1"; else printf '  MISSED  %s\n' "$1"; missed=$((missed + 1)); fi
}
clean() {
    if "${@:2}"; then printf '  clean   %s\n' "$1"; else printf '  FAILED  %s\n' "$1"; tail -n 20 "$log"; missed=$((missed + 1)); fi
}
log="$work/planted.log"
# copy NAME [FILE SED]: a copy of the shaders; one file is changed by sed, which must change it.
copy() {
    mkdir -p "$work/$1"
    cp -r "$root/shaders" "$work/$1/"
    [ $# -gt 1 ] || return
    sed -i "$3" "$work/$1/$2"
    cmp -s "$root/$2" "$work/$1/$2" && { printf 'planted/run.sh no longer matches %s\n' "$2"; exit 1; }
}
copy plain
copy race shaders/fluid/grid/cell_count.kernel 's/rank\[i\] = ATOMIC_ADD(cellParticles\[c\], 1u);/rank[i] = cellParticles[c]; cellParticles[c] = rank[i] + 1u;/'
copy barrier shaders/common/lang.h 's/^#define BARRIER barrier(CLK_LOCAL_MEM_FENCE)/#define BARRIER/; s/^        barrier();  *\\$/        \\/'
copy drop shaders/flow/born.kernel 's/ATOMIC_ADD(counter\[\([07]\)\], \(.*\));/counter[\1] = counter[\1] + (\2);/'

# On cl: a small world under oclgrind reports it in that kernel. Sums that are wrong may make it endless; what it has reported by then counts.
echo /usr/lib/oclgrind/liboclgrind-rt-icd.so >"$work/oclgrind.icd"
oclgrind() {  # COPY SECONDS
    RIVULET_SHADERS="$work/$1" OCL_ICD_VENDORS="$work" OCLGRIND_DATA_RACES=1 OCLGRIND_MAX_ERRORS=20 OCLGRIND_NUM_THREADS=1 \
        OCLGRIND_BUILD_OPTIONS=-cl-opt-disable RIVULET_RACES=full RIVULET_WORLDS=thesis \
        timeout "$2" "$build/bin/test_races" --gtest_filter='*SmallWorlds*cl' >"$log" 2>&1
}
reported_in() {
    oclgrind "$1" 120
    grep -A1 'data race' "$log" | grep -q "Kernel: $2"
}
reports_nothing() { oclgrind plain 900 && grep -q ' kernels in ' "$log" && ! grep -q 'data race' "$log"; }
clean "nothing on cl, as it is" reports_nothing
found "a race on cl: counting without an atomic" reported_in race cell_count
found "a missing barrier on cl: the prefix sum" reported_in barrier scan_reduce

# On gl: all kernels are compiled, all sorts come to an end, and one comes to something else than it must, by the assertion that is named.
sorts() { RIVULET_SHADERS="$work/$1" "$build/bin/test_parity" --gtest_filter='*SortTest*gl' >"$log" 2>&1; }
wrong_sort() {
    ! sorts "$1" && grep -q '^\[==========\] [0-9]* tests .* ran' "$log" && ! grep -q 'Value of: kernel$' "$log" && grep -qF "$2" "$log"
}
right_sorts() { sorts plain && grep -q '^\[  PASSED  \] [1-9][0-9]* tests' "$log"; }
clean "nothing on gl, as it is" right_sorts
found "a race on gl: counting without an atomic" wrong_sort race '  starts'
found "a missing barrier on gl: the prefix sum" wrong_sort barrier '  scanOnDevice('
# A missing glMemoryBarrier, in the frame graph and in Device gl. The tests leave each out, and none first.
left_out() {
    "$build/bin/test_races" --gtest_filter='*Barriers*' >"$log" 2>&1 && grep -q '^\[  PASSED  \] [1-9][0-9]* tests' "$log" && ! grep -q SKIPPED "$log"
}
found "a glMemoryBarrier that is left out on gl" left_out

# On the cpu: under ThreadSanitizer.
threads() {
    local shaders="$1" program="$work/planted_$1"
    [ -x "$program" ] ||
        clang++ -std=c++20 -O1 -g -fsanitize=thread -I"$work/$shaders" -I"$root" -I"$build/include" -o "$program" \
            "$root/tests/races/planted/cpu.cpp" "$build/engine/librivulet_base.a" -lfmt -ljsoncpp -ltbb -lxxhash -lOpenCL -lpthread || exit 1
    TSAN_OPTIONS=exitcode=66 "$program" "${@:2}" >"$log" 2>&1
}
reported() { ! threads "$@" && grep -q 'ThreadSanitizer: data race' "$log"; }
clean "nothing on the cpu, as it is" threads plain
found "a race on the cpu: a sum without an atomic" reported drop
found "a missing barrier on the cpu: a dispatch that returns early" reported plain early
[ $missed -eq 0 ]
