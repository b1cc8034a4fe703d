#!/usr/bin/env bash
# The Python package on a bare Debian 12: in a chroot with the packages that docs/python.md names, pip builds the wheel, and the page's code runs
# with it. Its plots are left in the system's /pictures.
#   bash tests/platforms/python.sh
set -u
. "$(dirname "${BASH_SOURCE[0]}")/chroot.sh"
system_of bookworm
packages g++ cmake ninja-build ccache pkg-config python3-glad libglm-dev libeigen3-dev libstb-dev libtbb-dev libfmt-dev libzstd-dev libxxhash-dev \
    libjsoncpp-dev ocl-icd-opencl-dev opencl-headers libegl1 libegl-mesa0 libgl1-mesa-dri \
    python3-venv python3-pip python3-numpy python3-setuptools python3-wheel python3-matplotlib python3-scipy
mkdir -p "$system/pictures"
inside bash /src/tests/embed/python/wheel.sh full /pictures || fail "the package failed."
say "the plots of docs/python.md are in $system/pictures"
