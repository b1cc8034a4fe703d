# Sourced by the scripts of this folder: a Debian system in a folder, in which they build and test. Needs root, debootstrap and Debian's mirror.
#   RIVULET_PLATFORMS: where the systems are kept (default: build/platforms); a second run uses what is there
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
. "$root/third_party/setup.sh"
systems="${RIVULET_PLATFORMS:-$root/build/platforms}"
mirror="${RIVULET_MIRROR:-http://deb.debian.org/debian}"
[ "$(id -u)" -eq 0 ] || fail "a Debian system in a folder needs root; run this script with sudo."
command -v debootstrap >/dev/null || fail "debootstrap is not installed; run: apt-get install debootstrap"

# system_of SUITE [ARCHITECTURE]: makes it if it is missing, with this source tree at /src; $system is its folder.
system_of() {
    [ -z "${system:-}" ] || unmount
    system="$systems/$1"
    mkdir -p "$systems"
    if [ ! -f "$system/made" ]; then
        say "making a Debian system in $system"
        debootstrap --variant=minbase "$1" "$system" "$mirror" >"$systems/$1.log" 2>&1 || fail "debootstrap failed; its log is $systems/$1.log."
        echo "deb-src $mirror $1 main" >"$system/etc/apt/sources.list.d/sources.list"
        touch "$system/made"
    fi
    mkdir -p "$system/src"
    mountpoint -q "$system/proc" || mount -t proc proc "$system/proc"
    mountpoint -q "$system/dev" || { mount --rbind /dev "$system/dev" && mount --make-rslave "$system/dev"; }
    mountpoint -q "$system/src" || { mount --bind "$root" "$system/src" && mount -o remount,bind,ro "$system/src"; }
    trap unmount EXIT
    cp /etc/resolv.conf "$system/etc/resolv.conf"
    inside apt-get -q update >"$systems/$1.log" 2>&1 || fail "apt-get update failed in $system; its log is $systems/$1.log."
    [ -z "${2:-}" ] || inside dpkg --add-architecture "$2"
    [ -z "${2:-}" ] || inside apt-get -q update >"$systems/$1.log" 2>&1 || fail "no packages of $2; the log is $systems/$1.log."
}

unmount() { umount -l "$system/src" "$system/dev" "$system/proc"; }

# inside COMMAND...: runs it in the system.
inside() {
    chroot "$system" /usr/bin/env -i PATH=/usr/lib/ccache:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}

# packages NAME...: installs them in the system.
packages() {
    inside apt-get -q install -y --no-install-recommends "$@" >"$system/packages.log" 2>&1 || fail "these packages could not be installed in $system: $*"
}

# source_of NAME PACKAGE FOLDER [CMake options]: the source in FOLDER of a Debian package, built by the toolchain file /NAME.cmake into /NAME.
source_of() {
    inside bash -c '
        set -e
        into="/$1" package="$2" folder="$3"
        mkdir -p "$into/sources" && cd "$into/sources"
        [ -f "$package.built" ] && exit 0
        mkdir -p "$package" && cd "$package"
        apt-get -q source --download-only "$package" || [ -n "$(ls ./*.orig.tar.* 2>/dev/null)" ]
        mkdir -p tree && tar xf ./*.orig.tar.* --strip-components=1 -C tree
        cmake -S "tree/$folder" -B build -G Ninja -DCMAKE_TOOLCHAIN_FILE="$into.cmake" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
            -DCMAKE_INSTALL_PREFIX="$into" "${@:4}"
        cmake --build build --target install
        touch "../$package.built"' _ "$@" >"$system/$2.log" 2>&1 || fail "$2 could not be built; its log is $system/$2.log."
}
