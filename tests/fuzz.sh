#!/usr/bin/env bash
# Fuzzers: builds every target of tests/fuzzers with clang, libFuzzer, ASan and UBSan into build/fuzz, and runs them.
#   bash tests/fuzz.sh                          all targets, a minute each, as many at once as there are cores
#   bash tests/fuzz.sh --seconds 3600 scene     one target, an hour
#   bash tests/fuzz.sh scene FILE               one input again
# Inputs that reach new code are kept in build/fuzz/corpus/NAME, inputs that fail in build/fuzz/finds/NAME. Exit status 1: one failed. Then
# mend the fault, and put the input into tests/fuzzers/finds/NAME, which every test run repeats.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
seconds=60
targets=()
input=
while [ $# -gt 0 ]; do
    case "$1" in
        --seconds) [[ "${2:-}" =~ ^[1-9][0-9]*$ ]] || fail "--seconds needs a whole number of seconds, for example --seconds 60"; seconds="$2"; shift ;;
        -*) fail "$1 is no option of tests/fuzz.sh; its first lines name those that exist" ;;
        *) if [ -f "$1" ]; then input="$(realpath "$1")"; else targets+=("$1"); fi ;;
    esac
    shift
done
install_packages run test || exit 1
folder="$root/build/fuzz"
mkdir -p "$folder"
say "building the fuzz targets; the first time takes some minutes."
if ! { cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
    -DRIVULET_FUZZERS=ON -DRIVULET_SANITIZE=address,undefined -DRIVULET_WERROR=OFF -DRIVULET_TESTS=ON &&
    ninja -C "$folder" rivulet_fuzz rivulet; } >"$folder/building.log" 2>&1 </dev/null; then
    tail -n 30 "$folder/building.log" >&2
    fail "building failed; the whole log is $folder/building.log."
fi
program="$folder/bin/rivulet_fuzz"
export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1
export XDG_CACHE_HOME="$folder/cache"
RIVULET_FUZZ_SEEDS="$folder/seeds" "$program" || fail "the seeds could not be written to $folder/seeds."
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls "$folder/seeds")
for name in "${targets[@]}"; do
    [ -d "$folder/seeds/$name" ] || fail "there is no fuzz target '$name'; choose of: $(ls "$folder/seeds" | tr '\n' ' ')"
done
if [ -n "$input" ]; then
    [ ${#targets[@]} -eq 1 ] || fail "name one target for $input, for example: bash tests/fuzz.sh scene $input"
    RIVULET_FUZZ_TARGET="${targets[0]}" exec "$program" "$input"
fi

# fuzz NAME: runs one target; leaves its log.
fuzz() {
    mkdir -p "$folder/corpus/$1" "$folder/finds/$1"
    RIVULET_FUZZ_TARGET="$1" "$program" -max_total_time="$seconds" -timeout=25 -rss_limit_mb=3000 -malloc_limit_mb=2000 -max_len=100000 -len_control=50 \
        -print_final_stats=1 -artifact_prefix="$folder/finds/$1/" "$folder/corpus/$1" "$folder/seeds/$1" "$root/tests/fuzzers/finds/$1" \
        >"$folder/$1.log" 2>&1 </dev/null
    echo $? >"$folder/$1.status"
}
for name in "${targets[@]}"; do
    mkdir -p "$root/tests/fuzzers/finds/$name" 2>/dev/null
    while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n; done
    fuzz "$name" &
done
wait
failures=0
printf '%-12s %12s %10s %10s  %s\n' target executions corpus edges result
for name in "${targets[@]}"; do
    executions="$(sed -n 's/^stat::number_of_executed_units: *//p' "$folder/$name.log")"
    edges="$(grep -o 'cov: [0-9]*' "$folder/$name.log" | tail -n 1 | cut -d' ' -f2)"
    result=passed
    if [ "$(cat "$folder/$name.status")" != 0 ]; then
        result="FAILED: $(sed -n 's/^.*Test unit written to //p' "$folder/$name.log" | tail -n 1) (log: $folder/$name.log)"
        failures=$((failures + 1))
    fi
    printf '%-12s %12s %10s %10s  %s\n' "$name" "${executions:-0}" "$(ls "$folder/corpus/$name" | wc -l)" "${edges:-0}" "$result"
done
[ "$failures" -eq 0 ]
