#!/usr/bin/env bash
# run.sh BUILD: rivulet.h from C, against an install prefix and with pkg-config alone. Of a build with sanitizers, so are the programs: what
# leaks, reaches beyond its memory or races fails.
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig:$work/prefix/lib64/pkgconfig:$work/prefix/lib/$(cc -dumpmachine)/pkgconfig"
library="$(pkg-config --variable=libdir rivulet)/librivulet.so"

# The header and each of its parts alone, as C and as C++.
warnings="-Wall -Wextra -Wpedantic -Werror"
read -ra flags <<<"$(pkg-config --cflags rivulet)"
for language in "cc -x c -std=c11" "c++ -x c++ -std=c++17"; do
    for header in "$(pkg-config --variable=includedir rivulet)"/rivulet/rivulet*.h; do
        printf "#include <rivulet/%s>\n" "${header##*/}" | $language $warnings "${flags[@]}" -fsyntax-only -
    done
done

# Of what it needs at run time nothing opens windows, draws panels, reads models or moves rigid bodies.
needs="$(ldd "$library")"
if grep -iE 'glfw|imgui|assimp|bullet|not found' <<<"$needs"; then echo "librivulet.so needs what a host should not have to bring"; exit 1; fi
cc=(cc -O1)
if nm -D --undefined-only "$library" | grep -q __asan_init; then
    cc=(clang -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fsanitize-link-c++-runtime -Wl,--no-as-needed -lstdc++)
    export ASAN_OPTIONS=quarantine_size_mb=2  # what is freed and kept for the report would look like growth
fi
if nm -D --undefined-only "$library" | grep -q __tsan_init; then
    # What has several threads; the others would take hours.
    export TSAN_OPTIONS="suppressions=$here/../../checks/races.supp"
    read -ra flags <<<"$(pkg-config --cflags --libs rivulet egl gl) -Wl,-rpath,$(dirname "$library") -lm -lpthread -lstdc++"
    for program in jobs overlap; do
        cc -O1 -g -fsanitize=thread -std=c11 $warnings "$here/$program.c" "${flags[@]}" -o "$work/$program"
        status=0
        "$work/$program" || status=$?
        [ $status -eq 0 ] || [ $status -eq 77 ] || exit $status
    done
    exit 0
fi
# And of what it shows, nothing but rivulet.h: a host may have names of its own.
others="$(nm -D --defined-only "$library" | awk '{ print $3 }' | grep -v '^rivulet_' || true)"
[ -z "$others" ] || [ "${cc[0]}" = clang ] || { echo "librivulet.so shows more than rivulet.h: $others"; exit 1; }
declared="$(grep -oh '\brivulet_[a-z_]*(' "$(pkg-config --variable=includedir rivulet)"/rivulet/rivulet_*.h | tr -d '(' | sort -u)"
shown="$(nm -D --defined-only "$library" | awk '{ print $3 }' | grep '^rivulet_' | sort -u)"
for name in $shown; do
    grep -q "\b$name(" "$here"/*.c || { echo "$name is not used by a test"; exit 1; }
    grep -qx "$name" <<<"$declared" || { echo "$name is not in rivulet.h"; exit 1; }
done

for program in main couple faults jobs walls bodies gl scene many lost overlap attributes wet; do
    packages=rivulet
    case $program in gl|scene|many|lost|overlap|attributes|wet) packages="rivulet egl gl" ;; esac
    read -ra flags <<<"$(pkg-config --cflags --libs $packages)"
    "${cc[@]}" -std=c11 $warnings "$here/$program.c" "${flags[@]}" -Wl,-rpath,"$(dirname "$library")" -lm -lpthread -o "$work/$program"
done
read -ra flags <<<"$(pkg-config --cflags --libs rivulet)"
cxx=(c++ -O1)
[ "${cc[0]}" = cc ] || cxx=(clang++ "${cc[@]:1}")
"${cxx[@]}" -std=c++17 $warnings "$here/throws.cpp" "${flags[@]}" -Wl,-rpath,"$(dirname "$library")" -o "$work/throws"
"$work/main" "$work"
"$work/couple"
"$work/faults"
"$work/throws"
"$work/jobs"
"$work/walls"
"$work/bodies"
# Loaded and unloaded by dlopen. A sanitizer's own library cannot be loaded late.
runs=(gl scene many lost attributes "overlap $work" "wet $(pkg-config --variable=includedir rivulet)")
if [ "${cc[0]}" = cc ]; then
    read -ra flags <<<"$(pkg-config --cflags rivulet) $(pkg-config --cflags --libs egl gl)"
    "${cc[@]}" -std=c11 $warnings "$here/unload.c" "${flags[@]}" -ldl -lpthread -o "$work/unload"
    runs+=("unload cpu $library" "unload cl $library" "unload gl $library")
fi
for program in "${runs[@]}"; do
    status=0
    read -ra words <<<"$program"
    "$work/${words[0]}" "${words[@]:1}" || status=$?
    if [ $status -eq 77 ] && [ -z "${RIVULET_TEST_DEVICES:-}" ]; then echo "no OpenGL or OpenCL: $program is left out"; status=0; fi
    [ $status -eq 0 ] || exit $status
done
