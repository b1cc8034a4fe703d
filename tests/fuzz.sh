#!/usr/bin/env bash
# Fuzzers: builds every target of tests/fuzzers with clang, libFuzzer, ASan and UBSan into build/fuzz, and runs them.
#   bash tests/fuzz.sh                          all targets, a minute each, as many at once as there are cores
#   bash tests/fuzz.sh --seconds 3600 scene     one target, an hour
#   bash tests/fuzz.sh scene FILE               one input again
#   bash tests/fuzz.sh --coverage               lines of the parsers that the inputs reach, with a build of its own in build/fuzz_coverage
# Inputs that reach new code are kept in build/fuzz/corpus/NAME, inputs that fail in build/fuzz/finds/NAME. Exit status 1: one failed. Then
# mend the fault, and put the input into tests/fuzzers/finds/NAME, which every test run repeats (tests/README.md).
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
seconds=60
coverage=
targets=()
input=
while [ $# -gt 0 ]; do
    case "$1" in
        --seconds) [[ "${2:-}" =~ ^[1-9][0-9]*$ ]] || fail "--seconds needs a whole number of seconds, for example --seconds 60"; seconds="$2"; shift ;;
        --coverage) coverage=1 ;;
        -*) fail "$1 is no option of tests/fuzz.sh; its first lines name those that exist" ;;
        *) if [ -f "$1" ]; then input="$(realpath "$1")"; else targets+=("$1"); fi ;;
    esac
    shift
done
install_packages run test || exit 1
kept="$root/build/fuzz" # seeds, corpora, finds: of both builds
folder="$kept"
options=(-DRIVULET_SANITIZE=address,undefined "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -g1")
if [ -n "$coverage" ]; then
    folder="$root/build/fuzz_coverage"
    options=("-DCMAKE_CXX_FLAGS=-fprofile-instr-generate -fcoverage-mapping" -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1)
fi
mkdir -p "$folder"
say "building the fuzz targets; the first time takes some minutes."
if ! { cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
    -DRIVULET_FUZZERS=ON "${options[@]}" -DRIVULET_WERROR=OFF -DRIVULET_TESTS=ON &&
    ninja -C "$folder" rivulet_fuzz rivulet_import; } >"$folder/building.log" 2>&1 </dev/null; then
    tail -n 30 "$folder/building.log" >&2
    fail "building failed; the whole log is $folder/building.log."
fi
program="$folder/bin/rivulet_fuzz"
export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0:malloc_fill_byte=0 UBSAN_OPTIONS=print_stacktrace=1
TMPDIR="$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)" # of the files that targets read
trap 'rm -rf "$TMPDIR"' EXIT
export XDG_CACHE_HOME="$kept/cache" TMPDIR LLVM_PROFILE_FILE=/dev/null
RIVULET_FUZZ_SEEDS="$kept/seeds" "$program" || fail "the seeds could not be written to $kept/seeds."
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls "$kept/seeds")
for name in "${targets[@]}"; do
    [ -d "$kept/seeds/$name" ] || fail "there is no fuzz target '$name'; choose of: $(ls "$kept/seeds" | tr '\n' ' ')"
done
if [ -n "$input" ]; then
    [ ${#targets[@]} -eq 1 ] || fail "name one target for $input, for example: bash tests/fuzz.sh scene $input"
    RIVULET_FUZZ_TARGET="${targets[0]}" "$program" "$input"
    exit
fi

# fuzz NAME: runs one target; leaves its log. For coverage: only the inputs that there are.
fuzz() {
    local how=(-max_total_time="$seconds") inputs=("$kept/corpus/$1" "$kept/seeds/$1")
    [ -z "$coverage" ] || how=(-runs=0)
    [ ! -d "$root/tests/fuzzers/finds/$1" ] || inputs+=("$root/tests/fuzzers/finds/$1")
    mkdir -p "$kept/corpus/$1" "$kept/finds/$1"
    LLVM_PROFILE_FILE="$folder/$1.profraw" RIVULET_FUZZ_TARGET="$1" "$program" "${how[@]}" -timeout=60 -rss_limit_mb=3000 -malloc_limit_mb=2000 \
        -max_len=100000 -len_control=50 -print_final_stats=1 -artifact_prefix="$kept/finds/$1/" "${inputs[@]}" >"$folder/$1.log" 2>&1 </dev/null
    echo $? >"$folder/$1.status"
}
for name in "${targets[@]}"; do
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
    printf '%-12s %12s %10s %10s  %s\n' "$name" "${executions:-0}" "$(ls "$kept/corpus/$name" | wc -l)" "${edges:-0}" "$result"
done
if [ -n "$coverage" ]; then
    cd "$root" || exit 1
    llvm-profdata merge -o "$folder/all.profdata" "$folder"/*.profraw || fail "llvm-profdata could not merge what the targets counted."
    llvm-cov export --summary-only --instr-profile="$folder/all.profdata" "$program" >"$folder/coverage.json" ||
        fail "llvm-cov could not read $folder/all.profdata."
    python3 - "$folder/coverage.json" "$folder" "$root" engine/core/json*.cpp engine/core/param_set.cpp engine/core/param_value.cpp \
        engine/scene/load_image.cpp engine/scene/model_check.cpp engine/scene/model_wire.cpp fluid/io/recording.cpp \
        fluid/scene/{body,collider,flow,pour}_params.cpp fluid/scene/collider_kinds.cpp fluid/scene/face_marks.cpp fluid/scene/scene_file.cpp \
        fluid/sim/world/{contradictions,fluid_params,fluid_world_state,state_check,world_state}.cpp fluid/voxel/{packed_array,voxel_file}.cpp <<'END'
import json, os, sys
folder, root, wanted = sys.argv[2], sys.argv[3], sys.argv[4:]
lines = {}  # the names are relative to the build folder, or to the place of the build
for f in json.load(open(sys.argv[1]))["data"][0]["files"]:
    for base in (folder, root):
        lines[os.path.relpath(os.path.realpath(os.path.join(base, f["filename"])), root)] = f["summary"]["lines"]
rows = [(name, lines[name]["covered"], lines[name]["count"]) for name in wanted]
rows.append(("all", sum(r[1] for r in rows), sum(r[2] for r in rows)))
print(f"\n{'parser':42} {'lines':>6} {'reached':>8}")
for name, covered, count in rows:
    print(f"{name:42} {count:6} {100 * covered / max(count, 1):7.1f} %")
END
fi
[ "$failures" -eq 0 ]
