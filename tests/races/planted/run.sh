#!/usr/bin/env bash
# Faults on purpose, in scratch copies of the shaders: each must be found, and the shaders as they are must pass the same check.
#   run.sh BUILD FOLDER        FOLDER: for scratch copies
set -u
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)"
build="$1" work="$2"
missed=0
# found NAME COMMAND...: the command must fail, or say what it found.
found() {
    if "${@:2}"; then printf '  found   %s\n' "$1"; else printf '  MISSED  %s\n' "$1"; missed=$((missed + 1)); fi
}
# copy NAME FILE SED: a copy of the shaders with one file changed by sed, which must change it.
copy() {
    mkdir -p "$work/$1"
    cp -r "$root/shaders" "$work/$1/"
    sed -i "$3" "$work/$1/$2"
    cmp -s "$root/$2" "$work/$1/$2" && { printf 'planted/run.sh no longer matches %s\n' "$2"; exit 1; }
}
copy race shaders/fluid/grid/cell_count.kernel 's/rank\[i\] = ATOMIC_ADD(cellParticles\[c\], 1u);/rank[i] = cellParticles[c]; cellParticles[c] = rank[i] + 1u;/'
copy barrier shaders/common/lang.h 's/^#define BARRIER barrier(CLK_LOCAL_MEM_FENCE)/#define BARRIER/; s/^        barrier();  *\\$/        \\/'
copy drop shaders/flow/born.kernel 's/ATOMIC_ADD(counter\[\([07]\)\], \(.*\));/counter[\1] = counter[\1] + (\2);/'

echo /usr/lib/oclgrind/liboclgrind-rt-icd.so >"$work/oclgrind.icd"
# On cl: a small world under oclgrind reports it in that kernel. Sums that are wrong may make it endless; what it has reported by then counts.
oclgrind() {
    RIVULET_SHADERS="$work/$1" OCL_ICD_VENDORS="$work" OCLGRIND_DATA_RACES=1 OCLGRIND_MAX_ERRORS=20 OCLGRIND_NUM_THREADS=1 \
        OCLGRIND_BUILD_OPTIONS=-cl-opt-disable RIVULET_RACES=full RIVULET_WORLDS=thesis \
        timeout 120 "$build/bin/test_races" --gtest_filter='*SmallWorlds*cl' >"$work/planted.log" 2>&1
    grep -A1 'data race' "$work/planted.log" | grep -q "Kernel: $2"
}
found "a race on cl: counting without an atomic" oclgrind race cell_count
found "a missing barrier on cl: the prefix sum" oclgrind barrier scan_reduce

# On gl: sorts come to something else.
sorts() { ! RIVULET_SHADERS="$work/$1" "$build/bin/test_parity" --gtest_filter='*SortTest*gl' >"$work/planted.log" 2>&1; }
found "a race on gl: counting without an atomic" sorts race
found "a missing barrier on gl: the prefix sum" sorts barrier
# A missing glMemoryBarrier, in the frame graph and in Device gl.
left_out() { "$build/bin/test_races" --gtest_filter='*Barriers*' >"$work/planted.log" 2>&1; }
found "a missing glMemoryBarrier on gl, of each kind" left_out

# On the cpu: under ThreadSanitizer.
threads() {
    local shaders="$1" program="$work/planted_$1"
    [ -x "$program" ] ||
        clang++ -std=c++20 -O1 -g -fsanitize=thread -I"$work/$shaders" -I"$root" -I"$build/include" -o "$program" \
            "$root/tests/races/planted/cpu.cpp" "$build/engine/librivulet_base.a" -lfmt -ljsoncpp -ltbb -lxxhash -lOpenCL -lpthread || exit 1
    TSAN_OPTIONS=exitcode=66 "$program" "${@:2}" >"$work/planted.log" 2>&1
}
mkdir -p "$work/plain" && cp -r "$root/shaders" "$work/plain/"
clean() { threads plain; }
reported() { ! threads "$@" && grep -q 'ThreadSanitizer: data race' "$work/planted.log"; }
found "nothing on the cpu, as it is" clean
found "a race on the cpu: a sum without an atomic" reported drop
found "a missing barrier on the cpu: a dispatch that returns early" reported plain early
[ $missed -eq 0 ]
