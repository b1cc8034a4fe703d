#!/usr/bin/env bash
# Uninitialised values in the kernels of the cpu: valgrind over short runs with each method, foam, sleep, surface tension, emitters, moving and
# deforming solids, bodies and skins. About ten minutes. Exit status 1: valgrind found a fault.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
install_packages run sanitize || exit 1
build rivulet
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
faults=0
# under SCENE [PARAMETER=VALUE...]
under() {
    local words=("$root/build/release/bin/rivulet" run "$root/assets/scenes/$1.json" --no-render --backend cpu --frames 3 --stats "$work/stats.json")
    for setting in "${@:2}"; do words+=(--set "$setting"); done
    # valgrind 3.19 knows no AVX-512.
    if RIVULET_ISA=avx2 valgrind --quiet --error-exitcode=99 --leak-check=no --log-file="$work/log" "${words[@]}" >"$work/said" 2>&1; then
        printf 'passed  %s\n' "$*"
    else
        printf 'FAILED  %s\n' "$*"
        cat "$work/said" "$work/log"
        faults=$((faults + 1))
    fi
}
for method in wcsph pbf dfsph; do
    under dam_break fluid.spacing=0.06 fluid.method=$method fluid.foam.most=1000 fluid.forces.tension=0.07 fluid.forces.adhesion=0.07 fluid.ellipsoids=true
    under dam_break fluid.spacing=0.06 fluid.method=$method fluid.sleep.on=true fluid.sleep.speed=1 fluid.sleep.after=0.5
done
under fountain fluid.spacing=0.03
under rubber_ducks fluid.spacing=0.06
under waving_sheet fluid.spacing=0.05
under paddle_wheel fluid.spacing=0.05
under oil_on_water fluid.spacing=0.03
under crying
exit $((faults > 0))
