#!/usr/bin/env bash
# The table of faults: fault | injected how | inputs | crashed | hung | lost. Builds what it needs; exit status 1 unless all numbers are zero.
#   bash tests/faults.sh [--quick] [--rows REGEX] [--cases REGEX] [--program PATH] [--seed N] [--keep FOLDER]
# tests/faults/README.md says what each row does.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/../third_party/setup.sh"
install_packages run test || exit 1
build rivulet_faults -DRIVULET_TESTS=ON
exec python3 "$root/tests/faults/table.py" "$root/build/release" "$@"
