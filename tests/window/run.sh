#!/usr/bin/env bash
# run.sh BUILD: the window as a person has it, through real X events: each panel opened, a parameter searched for and dragged, the view
# turned, a picture taken, a file dropped, the scene saved and opened again, a body thrown, the program interrupted. Exit 77: there is no
# xdotool or Xvfb.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
program="$(cd "$1/bin" && pwd)/rivulet"
command -v xdotool >/dev/null && command -v Xvfb >/dev/null || { echo "skipped: xdotool or xvfb is not installed"; exit 77; }
work="$(mktemp -d)"
running= server=
trap 'kill $running $server 2>/dev/null || true; rm -rf "$work"' EXIT
. "$here/display.sh"
start_display "$work" 1280x800
mkdir -p "$work/config/rivulet" && touch "$work/config/rivulet/seen"  # who was here before is not greeted
cd "$work"

fail() {
    echo "$1"
    cat said
    exit 1
}
# until CONDITION WHAT: a slow machine shows a picture a second.
until_() {
    for _ in $(seq 500); do
        if eval "$1"; then return 0; fi
        sleep 0.2
    done
    fail "not in time: $2"
}
# drag X Y DX: at once, however few pictures a second are shown.
drag() {
    xdotool mousemove "$1" "$2" mousedown 1 mousemove_relative --sync -- "$3" 0 mouseup 1
    sleep 0.3
}
open_window() {
    "$program" run "$1" --set fluid.spacing=0.05 --set look.renderer=points --size 1000x700 >said 2>&1 &
    running=$!
    name="$(basename "$1" .json)"
    until_ 'window="$(xdotool search --name "^$name - rivulet" 2>/dev/null | head -1)"; [ -n "$window" ]' "a window"
    until_ 'xdotool windowfocus "$window" 2>/dev/null' "the window's focus"
    sleep 2
}

look() { python3 "$here/x.py" look "$@"; }
# other X Y W H OLD WHAT: until something else than OLD is to be seen there.
other() { until_ "[ \"\$(look $1 $2 $3 $4)\" != '$5' ]" "$6"; }

open_window "$here/../../assets/scenes/falling_cube.json"
xdotool key space # still water: pictures can be compared
sleep 1
xdotool key F12
until_ '[ -s falling_cube_0001.png ] && grep -q 0001 said' "a picture"
drag 480 400 90
xdotool key F12
until_ '[ -s falling_cube_0002.png ] && grep -q 0002 said' "a second picture"
cmp -s falling_cube_0001.png falling_cube_0002.png && fail "a drag with the left button does not turn the view"

# The tabs of what is measured, at the right: the bar shows which one is open, and is still.
mkdir tabs
xdotool key m
sleep 1.5
xdotool mousemove 500 690
for x in 673 728 782 852 925; do
    xdotool mousemove "$x" 50 click 1 mousemove 500 690
    sleep 1.5
    touch "tabs/$(look 330 42 660 18)"
done
[ "$(ls tabs | wc -l)" = 5 ] || fail "of five tabs only $(ls tabs | wc -l) were opened"
[ "$(look 330 42 660 18)" = "$(ls -t tabs | head -1)" ] || fail "the tabs are not still"
xdotool key m

# Wherever the panel has it, from below: of all sliders only that one is shown, and nothing under it.
xdotool key ctrl+f
sleep 1
xdotool type --delay 120 "time scale"
sleep 1
for y in $(seq 600 -12 300); do drag 225 "$y" -50; done
xdotool mousemove 480 650 click 1 # no longer in the field
sleep 1
before="$(look 400 100 200 500)"
python3 "$here/x.py" drop "$window" 480 400 "$here/../../assets/meshes/sphere.obj" || fail "the file was not taken"
other 400 100 200 500 "$before" "the ball that was dropped"
xdotool key ctrl+s
# Once the field has the keyboard; it is offered under the scene's name.
until_ '[ -s falling_cube.json ] || { sleep 1; xdotool key Return; false; }' "the saved scene"
grep -q 'sphere.obj' falling_cube.json || { cat falling_cube.json; fail "the mesh that was dropped is not in the saved scene"; }
grep -q '"timeScale": 0' falling_cube.json || { cat falling_cube.json; fail "the slider was not dragged, or what it says was not saved"; }
kill -INT "$running"
code=0
wait "$running" || code=$?
running=
[ "$code" = 130 ] || fail "control C ends with $code, not 130"

# What was saved opens as what it was: saved again it is the same.
cp falling_cube.json first.json
open_window "$work/falling_cube.json"
mkdir other && mv falling_cube.json other/
xdotool key ctrl+s
until_ '[ -s falling_cube.json ] || { sleep 1; xdotool key Return; false; }' "the scene saved again"
cmp first.json falling_cube.json || fail "a scene that was opened and saved is another one"
kill -INT "$running"
wait "$running" || true
running=

# A ball that floats in the middle of nothing, and stays there until it is thrown.
cat >thrown.json <<'EOF'
{"name": "thrown", "fluid": {"method": "pbf", "gravity": [0, 0, 0], "box": {"min": [0, 0, 0], "max": [4, 2, 1]}},
 "bodies": [{"shape": "sphere", "radius": 0.15, "position": [2, 1, 0.5], "density": 500}],
 "camera": {"position": [2, 1, 5], "target": [2, 1, 0.5], "fieldOfView": 35}}
EOF
open_window "$work/thrown.json"
still="$(look 400 250 200 200)"
sleep 1
[ "$(look 400 250 200 200)" = "$still" ] || fail "a body that nothing pulls moves"
xdotool mousemove 500 350 mousedown 1
for k in 1 2 3 4; do xdotool mousemove_relative --sync -- 8 -6; sleep 0.2; done
xdotool mouseup 1 mousemove 500 690
other 400 250 200 200 "$still" "the body that was lifted"
let_go="$(look 330 60 320 580)"
other 330 60 320 580 "$let_go" "the body that was thrown"
kill -INT "$running"
wait "$running" || true
running=
echo "looked through, searched, dragged, turned, pictured, dropped, saved, opened, thrown: all by X events"
