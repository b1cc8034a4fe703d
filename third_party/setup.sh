# Sourced by demos/run.sh and tests/run.sh: installs what is missing of packages.txt, configures, builds.
# Every failure is one plain sentence on stderr and exit status 1. Asks nothing.
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

say() { printf 'rivulet: %s\n' "$*" >&2; }
fail() { say "$*"; exit 1; }

# packages_of SECTION: the package names in that section of packages.txt, one a line.
packages_of() {
    awk -v wanted="[$1]" '{ sub(/#.*/, "") } /^\[/ { on = ($1 == wanted); next } on && NF { print $1 }' "$root/third_party/packages.txt"
}

# install_packages SECTION...: apt-get, only for what dpkg does not know as installed.
install_packages() {
    local section missing=()
    if ! command -v dpkg-query >/dev/null; then
        say "this is no Debian system: the counterparts of third_party/packages.txt must be installed by hand; building with what is there."
        return 0
    fi
    for section in "$@"; do
        while read -r package; do
            [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
        done < <(packages_of "$section")
    done
    [ ${#missing[@]} -eq 0 ] && return 0
    command -v apt-get >/dev/null || fail "apt-get is not on this machine; install these packages by hand: ${missing[*]}"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || fail "there is no sudo here; as root, run: apt-get install ${missing[*]}"
        sudo -n true 2>/dev/null || fail "sudo wants a password; run this first: sudo apt-get install ${missing[*]}"
        as_root=(sudo -n)
    fi
    say "installing ${#missing[@]} packages: ${missing[*]}"
    local log
    log="$(mktemp)"
    if ! { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q update &&
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1 </dev/null; then
        tail -n 15 "$log" >&2
        rm -f "$log"
        fail "apt-get could not install: ${missing[*]}"
    fi
    rm -f "$log"
}

# quietly WHAT COMMAND...: with a log in $folder. The command's output is shown only when it fails, or live when stderr is a terminal and WHAT is "building".
quietly() {
    local what="$1" log="$folder/$1.log"
    shift
    if [ "$what" = building ] && [ -t 2 ]; then
        "$@" >&2 || fail "building failed."
        return 0
    fi
    "$@" >"$log" 2>&1 </dev/null && return 0
    tail -n 60 "$log" >&2
    fail "$what failed; the whole log is $log."
}

# build TARGET [CMAKE OPTION...]: preset release.
build() { build_preset release "$@"; }

# build_preset PRESET TARGET [CMAKE OPTION...]: in build/PRESET. A build folder that was moved or copied here is configured anew.
build_preset() {
    local preset="$1" folder="$root/build/$1" target="$2" fresh=()
    shift 2
    mkdir -p "$folder" || fail "the build folder $folder cannot be made."
    if [ -f "$folder/CMakeCache.txt" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then fresh=(--fresh); fi
    [ -f "$folder/bin/rivulet" ] || say "building; the first time takes some minutes."
    if [ ${#fresh[@]} -gt 0 ] || [ ! -f "$folder/build.ninja" ] || [ $# -gt 0 ]; then
        (cd "$root" && quietly configuring cmake --preset "$preset" "${fresh[@]}" "$@") || exit 1
    fi
    quietly building cmake --build "$folder" --target "$target"
}
