#!/usr/bin/env bash
# From nothing to water: installs what is missing, builds the program alone (no tests), runs it.
#   bash demos/run.sh [--headless] [--seconds S] ...   the first scene, with further arguments of `rivulet run`
#   bash demos/run.sh SCENE [arguments]                another: a file, or a name of `bash demos/run.sh list`
#   bash demos/run.sh VERB [arguments]                 any verb of the program: run, list, info, voxelize, bench
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
install_packages run || exit 1
build rivulet

if [[ "${1:-}" =~ ^[a-z]+$ && -f "$root/demos/rivulet/verb_$1.cpp" ]]; then
    exec "$root/build/release/bin/rivulet" "$@"
fi
if [[ -n "${1:-}" && "$1" != -* ]]; then exec "$root/build/release/bin/rivulet" run "$@"; fi
exec "$root/build/release/bin/rivulet" run "$root/assets/scenes/column_over_spot.json" "$@"
