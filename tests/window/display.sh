# Sourced: start_display FOLDER WIDTHxHEIGHT starts an X server of its own, writes its number to FOLDER, and points the programs that follow
# at it, with settings and caches of their own in FOLDER. Sets `server`, its process.
start_display() {
    unset WAYLAND_DISPLAY XAUTHORITY
    Xvfb -displayfd 3 -screen 0 "${2}x24" -nolisten tcp -noreset 3>"$1/display" 2>"$1/server" &
    server=$!
    for _ in $(seq 300); do [ -s "$1/display" ] || sleep 0.2; done
    [ -s "$1/display" ] || { cat "$1/server"; exit 1; }
    export DISPLAY=":$(cat "$1/display")" LIBGL_ALWAYS_SOFTWARE=1 XDG_CACHE_HOME="$1/cache" XDG_CONFIG_HOME="$1/config"
}
