#!/usr/bin/env bash
# run.sh BUILD: the window as a person has it, through real X events: a parameter is searched for and dragged, the view turned, a picture
# taken, the scene saved and opened again, the program interrupted. Exit 77: there is no xdotool or Xvfb.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
program="$(cd "$1/bin" && pwd)/rivulet"
command -v xdotool >/dev/null && command -v Xvfb >/dev/null || { echo "skipped: xdotool or xvfb is not installed"; exit 77; }
work="$(mktemp -d)"
running= server=
trap 'kill $running $server 2>/dev/null || true; rm -rf "$work"' EXIT
# A display of its own, whose number the server says once it is ready.
unset WAYLAND_DISPLAY XAUTHORITY
Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp -noreset 3>"$work/display" 2>"$work/server" &
server=$!
for _ in $(seq 300); do [ -s "$work/display" ] || sleep 0.2; done
[ -s "$work/display" ] || { cat "$work/server"; exit 1; }
export DISPLAY=":$(cat "$work/display")" LIBGL_ALWAYS_SOFTWARE=1 XDG_CACHE_HOME="$work/cache" XDG_CONFIG_HOME="$work/config"
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
    until_ 'window="$(xdotool search --name "^falling_cube - rivulet" 2>/dev/null | head -1)"; [ -n "$window" ]' "a window"
    until_ 'xdotool windowfocus "$window" 2>/dev/null' "the window's focus"
    sleep 2
}

open_window "$here/../../assets/scenes/falling_cube.json"
xdotool key space # still water: pictures can be compared
sleep 1
xdotool key F12
until_ '[ -s falling_cube_0001.png ] && grep -q 0001 said' "a picture"
drag 480 400 90
xdotool key F12
until_ '[ -s falling_cube_0002.png ] && grep -q 0002 said' "a second picture"
cmp -s falling_cube_0001.png falling_cube_0002.png && fail "a drag with the left button does not turn the view"

# Wherever the panel has it, from below: of all sliders only that one is shown, and nothing under it.
xdotool key ctrl+f
sleep 1
xdotool type --delay 120 "time scale"
sleep 1
for y in $(seq 600 -12 300); do drag 225 "$y" -50; done
xdotool mousemove 480 650 click 1 # no longer in the field
sleep 1
xdotool key ctrl+s
# Once the field has the keyboard; it is offered under the scene's name.
until_ '[ -s falling_cube.json ] || { sleep 1; xdotool key Return; false; }' "the saved scene"
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
echo "searched, dragged, turned, pictured, saved, opened: all by X events"
