#!/usr/bin/env bash
# Fails when a C++ file is not formatted as .clang-format says. Kernels are left alone: their macros are no C++ to clang-format.
set -u
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
command -v clang-format >/dev/null || { echo "skipped: clang-format is not installed"; exit 77; }
find engine fluid demos tests assets -name build -prune -o \( -name '*.cpp' -o -name '*.h' \) -print0 | xargs -0 -r clang-format --dry-run -Werror
