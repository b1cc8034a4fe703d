#!/usr/bin/env bash
# screens.sh BUILD OUT: a first quarter of an hour in the window, by X events, with a picture of each stage in OUT/*.png to be looked at.
# Exit 77: there is no xdotool, Xvfb or ffmpeg.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
program="$(cd "$1/bin" && pwd)/rivulet"
mkdir -p "$2" && out="$(cd "$2" && pwd)"
for tool in xdotool Xvfb ffmpeg; do command -v $tool >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }; done
work="$(mktemp -d)"
running= server=
trap 'kill $running $server 2>/dev/null || true; rm -rf "$work"' EXIT
. "$here/display.sh"
start_display "$work" 1280x720
cd "$work"
slow="${SCREENS_SLOW:-1}" # times the waits
rest() { sleep "$(awk "BEGIN { print $1 * $slow }")"; }
shot() {
    rest "${2:-3}"
    ffmpeg -loglevel error -y -f x11grab -draw_mouse 1 -video_size 1280x720 -i "$DISPLAY" -frames:v 1 "$out/$1.png"
}
keys() { for k in "$@"; do xdotool key "$k"; rest 1.5; done; }
type_() { xdotool type --delay 350 "$1"; rest 1.5; }
at() { xdotool mousemove "$1" "$2"; rest 1.5; }
click() { at "$1" "$2"; xdotool mousedown 1; rest 1; xdotool mouseup 1; rest 1.5; }

"$program" run dam_break >said 2>&1 &
running=$!
for _ in $(seq 300); do
    window="$(xdotool search --name '^dam_break - rivulet' 2>/dev/null | head -1)"
    [ -z "$window" ] || break
    sleep 0.3
done
xdotool windowfocus "$window"
shot 01_welcome 4
keys x
shot 02_first 6
keys ctrl+f && type_ "viscosity"
shot 03_search
at 160 "485" && xdotool mousedown 1 && rest 1 && at 185 "485" && xdotool mouseup 1
shot 04_slider 6
for _ in 1 2 3 4 5 6 7 8 9; do xdotool key BackSpace; sleep 0.4; done
click 700 600
keys F8 && rest 6 && keys F8 space
click 800 685
shot 05_timeline
click 370 685 && keys o
shot 06_scenes 8
type_ "fountain" && click 380 200
shot 07_fountain 25
keys p && at 640 400 && xdotool mousedown 1
shot 08_pour 8
xdotool mouseup 1 && keys p m
click 1068 50
shot 09_chart 5
echo '{"name": "bad", "fluid": {"spacin": 1}}' >bad.json
python3 "$here/x.py" drop "$window" 640 400 bad.json
shot 10_error 4
xdotool windowsize "$window" 800 500
shot 11_small 6
xdotool windowsize "$window" 1280 720 && rest 4 && keys ctrl+equal ctrl+equal ctrl+equal
shot 12_large 6
kill -INT "$running" && wait "$running" || true
running=
cat said
