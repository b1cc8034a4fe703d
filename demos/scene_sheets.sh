#!/usr/bin/env bash
# Sheets of the scenes glass, fountain, cove and splash_crown: four moments, and below each the same particles ray-marched.
#   bash demos/scene_sheets.sh DIR [SCENE...]           DIR/SCENE_sheet.jpg, and its single pictures in DIR/SCENE and DIR/SCENE_truth
#   bash demos/scene_sheets.sh --video DIR [SCENE...]   DIR/SCENE.mp4 instead, 1280x720, 8 s each
# Needs the built program and ffmpeg; a scene takes some minutes.
set -eu
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
program="${RIVULET:-$root/build/release/bin/rivulet}"
video=""
[[ "${1:-}" != --video ]] || { video=1; shift; }
[[ $# -gt 0 ]] || { echo "scene_sheets: name the folder that the sheets go to" >&2; exit 2; }
folder="$1"
shift
declare -A moments=([glass]="0.4 0.9 2 3.6" [fountain]="0.35 1.5 3 6" [cove]="1.4 3.2 5 7" [splash_crown]="0.0025 0.010 0.020 0.042")
scenes=("$@")
[[ ${#scenes[@]} -gt 0 ]] || scenes=(glass fountain cove splash_crown)

draw() {  # OUT, SCENE, further arguments
    local out="$1" scene="$2"
    shift 2
    rm -rf "$out"
    "$program" run "$root/assets/scenes/$scene.json" --headless --backend cpu --size 1280x720 --out "$out" "$@" > "$out.log" ||
        { cat "$out.log"; exit 1; }
    rm "$out.log"
}

mkdir -p "$folder"
for scene in "${scenes[@]}"; do
    [[ -n "${moments[$scene]:-}" ]] || { echo "scene_sheets: no moments are known of $scene" >&2; exit 2; }
    if [[ -n "$video" ]]; then
        draw "$folder/$scene" "$scene" --video "$folder/$scene.mp4"
        echo "$folder/$scene.mp4"
        continue
    fi
    stills=()
    for moment in ${moments[$scene]}; do stills+=(--still "$moment"); done
    draw "$folder/$scene" "$scene" "${stills[@]}"
    draw "$folder/${scene}_truth" "$scene" "${stills[@]}" --set look.renderer=reference
    inputs=() filter="" names="" layout="" k=0
    for picture in "$folder/$scene"/*.png "$folder/${scene}_truth"/*.png; do
        inputs+=(-i "$picture")
        filter+="[$k:v]scale=480:270:flags=lanczos[p$k];"
        names+="[p$k]"
        layout+="${layout:+|}$((k % 4 * 480))_$((k / 4 * 270))"
        k=$((k + 1))
    done
    ffmpeg -y -loglevel error "${inputs[@]}" -filter_complex "$filter${names}xstack=inputs=8:layout=$layout" -frames:v 1 -update 1 \
        -q:v 4 "$folder/${scene}_sheet.jpg"
    echo "$folder/${scene}_sheet.jpg"
done
