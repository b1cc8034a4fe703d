#!/usr/bin/env bash
# A sheet of the crying face: front, three-quarter, from the side and macro, drawn at 1920x1080; dry in the first column, then at five moments.
#   bash demos/contact_sheet.sh SHEET.jpg [--preset NAME] [SECOND SECOND SECOND SECOND SECOND] [-- further arguments of `rivulet run`]
# Without --preset the scene is as it opens.
# Its single pictures are left in the folder SHEET. Needs the built program and ffmpeg.
set -eu
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
program="${RIVULET:-$root/build/release/bin/rivulet}"
[[ $# -gt 0 && "$1" == *.jpg ]] || { echo "contact_sheet: name the sheet, a .jpg" >&2; exit 2; }
sheet="$1" folder="${1%.jpg}" moments=() preset=
shift
if [[ "${1:-}" == --preset && $# -gt 1 ]]; then preset="$2"; shift 2; fi
while [[ $# -gt 0 && "$1" != -- ]]; do moments+=("$1"); shift; done
[[ $# -eq 0 ]] || shift
[[ ${#moments[@]} -gt 0 ]] || moments=(3 6 10 14 18)
[[ ${#moments[@]} -eq 5 ]] || { echo "contact_sheet: give five moments, in seconds" >&2; exit 2; }
# position, target, field of view
views=("0,-0.022,0.50 0,-0.018,0.06 30" "0.27,-0.012,0.41 0.008,-0.018,0.05 30" "-0.42,-0.012,0.20 0,-0.018,0.03 30" "0.07,0,0.30 0.034,0.012,0.06 10.5")

draw() {  # OUT, a view, further arguments
    local out="$1"
    read -r position target field <<< "$2"
    shift 2
    "$program" run "$root/assets/scenes/crying.json" --headless ${preset:+--preset "$preset"} --size 1920x1080 --out "$out" \
        --set "camera.position=$position" --set "camera.target=$target" --set "camera.fieldOfView=$field" \
        --set camera.aperture=0 --set flow.0.motion.swing=0,0,0 "$@" > "$out.log" || { cat "$out.log"; exit 1; }
}

rm -rf "$folder"/{dry,wet}{0,1,2,3}
mkdir -p "$folder"
inputs=() layout=""
for row in 0 1 2 3; do
    draw "$folder/dry$row" "${views[$row]}" --still "${moments[0]}" --set flow.0.sources.0.rate=0 "$@"
    draw "$folder/wet$row" "${views[$row]}" "${moments[@]/#/--still=}" "$@"
    for picture in "$folder/dry$row"/*.png "$folder/wet$row"/*.png; do
        inputs+=(-i "$picture")
    done
done
filter="" names=""
for ((k = 0; k < 24; ++k)); do
    filter+="[$k:v]crop=1440:1080,scale=480:360:flags=lanczos[p$k];"
    names+="[p$k]"
    layout+="${layout:+|}$((k % 6 * 480))_$((k / 6 * 360))"
done
ffmpeg -y -loglevel error "${inputs[@]}" -filter_complex "$filter${names}xstack=inputs=24:layout=$layout" -frames:v 1 -update 1 \
    -q:v 4 "$sheet"
echo "$sheet, and its pictures in $folder"
