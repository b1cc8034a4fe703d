#!/usr/bin/env bash
# Long runs: 24 simulated hours of each scene that never comes to rest, at a low resolution, and hours of the window under random input.
#   bash tests/soak.sh                             all: about a day on 2 cores
#   bash tests/soak.sh --hours 1 fountain koi      one simulated hour of two scenes
#   bash tests/soak.sh --window 10                 ten minutes of the window alone
# Prints a row for each run. Exit status 1: memory or open files grew, a particle was lost, or the ledger of volumes does not close.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
install_packages run test || exit 1
build rivulet
exec python3 "$root/tests/soak/soak.py" "$root" "$@"
