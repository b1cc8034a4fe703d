#!/usr/bin/env bash
# Races, barriers and other drivers, which take minutes: see README.md.
#   run.sh [BUILD] [SUITE...]      suites: oclgrind zink validation swiftshader orders subgroups planted; without any: all but swiftshader
# BUILD: a build with tests, build/release by default. It exits with 1 if a suite fails, and says how many.
set -u
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
. "$here/../../third_party/setup.sh"
folder="$root/build/release"
if [ $# -gt 0 ] && [ -d "$1" ]; then
    folder="$(cd "$1" && pwd)"
    shift
fi
suites=("$@")
[ ${#suites[@]} -gt 0 ] || suites=(oclgrind zink validation orders subgroups planted)
tests="$folder/bin/test_races"
parity="$folder/bin/test_parity"
[ -x "$tests" ] && [ -x "$parity" ] || fail "$folder has no tests: cmake --preset release -DRIVULET_TESTS=ON, then build test_races and test_parity"
install_packages run test races || exit 1
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
export RIVULET_TEST_DEVICES=1 RIVULET_RACES=full XDG_RUNTIME_DIR="$work"
faults=0
# said NAME STATUS: prints whether a suite or a part of one passed.
said() {
    if [ "$2" -eq 0 ]; then
        printf 'passed  %s\n' "$1"
    else
        printf 'FAILED  %s\n' "$1"
        faults=$((faults + 1))
    fi
}

# The environment in which OpenCL is oclgrind. Optimised code would have intrinsics that oclgrind 21.10 does not know.
echo /usr/lib/oclgrind/liboclgrind-rt-icd.so >"$work/oclgrind.icd"
under_oclgrind() {
    OCL_ICD_VENDORS="$work" OCLGRIND_DATA_RACES=1 OCLGRIND_UNINITIALIZED=1 OCLGRIND_MAX_ERRORS=20000 OCLGRIND_NUM_THREADS=1 \
        OCLGRIND_BUILD_OPTIONS=-cl-opt-disable "$@"
}
# The environments in which OpenGL is Mesa's, also beside another vendor's: tests fail if its name is another one than $renderer.
mesa() { __EGL_VENDOR_LIBRARY_FILENAMES=/usr/share/glvnd/egl_vendor.d/50_mesa.json LIBGL_ALWAYS_SOFTWARE=1 RIVULET_EXPECT_RENDERER="$renderer" "$@"; }
on_llvmpipe() { renderer='llvmpipe (LLVM' mesa env GALLIUM_DRIVER=llvmpipe "$@"; }
# zink, on lavapipe or on the Vulkan driver of the file $icd.
icd=/usr/share/vulkan/icd.d/lvp_icd.x86_64.json
renderer='zink (llvmpipe'
on_zink() { mesa env GALLIUM_DRIVER=zink VK_ICD_FILENAMES="$icd" VK_DRIVER_FILES="$icd" "$@"; }
gl_tests='*gl*:*Gl*:*Barriers*:*Pictures*-*GlSharing*'
# What llvmpipe draws, to compare with: in $work/pictures.
draw_on_llvmpipe() {
    mkdir -p "$work/pictures"
    on_llvmpipe env RIVULET_PICTURES_TO="$work/pictures" "$tests" --gtest_filter='*Pictures*' >"$work/pictures.log" 2>&1 && return
    grep FAILED "$work/pictures.log"
    echo "pictures on llvmpipe failed"
    return 1
}

suite_oclgrind() {
    local status=0 world worlds
    worlds="$("$tests" --gtest_filter='Worlds/Orders.*' --gtest_list_tests | sed -n 's/^ *GiveTheSameResults\/cl_\([A-Za-z0-9]*\).*/\1/p')"
    [ -n "$worlds" ] || { echo "$tests lists no worlds on cl"; status=1; }
    for world in $worlds; do
        if ! under_oclgrind env RIVULET_WORLDS="$world" "$tests" --gtest_filter='*SmallWorlds*cl' >"$work/$world.log" 2>&1; then
            status=1
            tail -n 20 "$work/$world.log"
        fi
        printf '%-18s %s\n' "$world" "$(grep -o '[0-9]* kernels in .*' "$work/$world.log" | tail -1)"
    done
    cat "$work"/*.log | sed -n 's/.*: \([0-9]*\) kernels in \([0-9]*\) variants, \([0-9]*\) dispatches of \([0-9]*\) work items/\2 \3 \4/p' |
        awk '{ v += $1; d += $2; i += $3 } END { printf "under oclgrind: %d variants with repeats, %d dispatches of %d work items\n", v, d, i }'
    python3 "$here/oclgrind.py" "$work"/*.log || status=1
    said oclgrind $status
}
suite_zink() {
    local status=0
    draw_on_llvmpipe || status=1
    on_zink env RIVULET_PICTURES_LIKE="$work/pictures" "$tests" --gtest_filter="$gl_tests" >"$work/zink.log" 2>&1 || status=1
    on_zink "$parity" --gtest_filter="$gl_tests" >>"$work/zink.log" 2>&1 || status=1
    grep -E 'FAILED|kernels in|^pictures?[: ]|tests? from .* ran|RIVULET_EXPECT' "$work/zink.log" | sort -u
    said "zink on $(basename "$icd" .json)" $status
}
suite_validation() {
    # What the layer reports of good practice, not of rules, shows that it is there and writes.
    cat >"$work/vk_layer_settings.txt" <<END
khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG
khronos_validation.report_flags = error,warn,perf
khronos_validation.log_filename = $work/layer.log
khronos_validation.enables = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,VK_VALIDATION_FEATURE_ENABLE_BEST_PRACTICES_EXT
khronos_validation.enable_message_limit = false
END
    on_zink env VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation VK_LAYER_SETTINGS_PATH="$work" \
        "$tests" --gtest_filter='*Barriers*:*SmallWorlds*gl:*Pictures*' >"$work/validation.log" 2>&1
    local status=$?
    grep -E 'FAILED|kernels in|^pictures:|RIVULET_EXPECT' "$work/validation.log" | sort -u
    grep -q BestPractices "$work/layer.log" || { echo "the validation layer reported nothing: is it there?"; status=1; }
    # Mesa 22.3's zink's own: it sets the blending of no colour targets where there are none, and blending that the next pipeline has fixed. OpenGL
    # has no dynamic states by which we could cause it.
    local own='VUID-vkCmdSetColorBlendEquationEXT-attachmentCount-arraylength|VUID-vkCmdDrawMulti(Indexed)?EXT-None-02859.*DYNAMIC_STATE_COLOR_BLEND'
    if grep -E 'SYNC-|VUID-' "$work/layer.log" | grep -vE "$own" >"$work/broken.txt"; then
        grep -oE '(SYNC|VUID)-[A-Za-z0-9-]+' "$work/broken.txt" | sort | uniq -c
        status=1
    fi
    said validation $status
}
suite_swiftshader() {
    # Debian's chromium 156 does not bring it.
    local library="${RIVULET_SWIFTSHADER:-/usr/lib/chromium/libvk_swiftshader.so}"
    if [ ! -f "$library" ]; then
        echo "skipped swiftshader: there is no $library; set RIVULET_SWIFTSHADER to a libvk_swiftshader.so"
        return
    fi
    printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "%s", "api_version": "1.3.0"}}\n' "$library" >"$work/swiftshader.json"
    icd="$work/swiftshader.json" renderer='zink (SwiftShader' suite_zink
}
suite_orders() {
    "$tests" --gtest_filter='*Orders*:*WorkGroups*:*NanHabits*:*SmallWorlds*gl' >"$work/orders.log" 2>&1
    local status=$?
    grep -E 'FAILED|kernels in|tests? from .* ran' "$work/orders.log"
    said orders $status
}
suite_subgroups() {
    # llvmpipe runs 4, 8 or 16 work items at once. Its cache of shaders does not tell them apart.
    local status=0 lanes
    local against='*SortTest*gl*:*VoxelDevices*gl*:*VoxelDepthDevices*gl*:*MethodsParity*gl*:*SolverParity*gl*:*RelationsParity*gl*'
    for lanes in 4 8 16; do
        local renderer=", $((32 * lanes)) bits)"
        local on=(mesa env GALLIUM_DRIVER=llvmpipe MESA_SHADER_CACHE_DISABLE=true "LP_NATIVE_VECTOR_WIDTH=$((32 * lanes))")
        "${on[@]}" "$tests" --gtest_filter='*WorkGroups*gl*' >"$work/subgroups.log" 2>&1 || status=1
        "${on[@]}" "$parity" --gtest_filter="$against" >>"$work/subgroups.log" 2>&1 || status=1
        echo "$lanes lanes"
        grep -E 'FAILED|tests? from .* ran|RIVULET_EXPECT' "$work/subgroups.log" | sort -u
    done
    said subgroups $status
}
suite_planted() {
    bash "$here/planted/run.sh" "$folder" "$work"
    said planted $?
}

for suite in "${suites[@]}"; do
    declare -F "suite_$suite" >/dev/null || fail "$suite is no suite: oclgrind zink validation swiftshader orders subgroups planted"
    "suite_$suite"
done
[ $faults -eq 0 ]
