#!/usr/bin/env bash
# wheel.sh BUILD [PAGE]: pip makes a wheel, of which import works in a fresh environment, from another folder; also from the source distribution.
# BUILD: a build whose librivulet.so is packed, or `full`: CMake builds it, as for a user (minutes). PAGE: a folder that the pictures of
# docs/python.md, made with the wheel, are left in. Nothing is downloaded. Exit 77: a module is not installed (modules.sh).
set -eu
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
root="$(cd "$here/../../.." && pwd)"
. "$here/../modules.sh"
need_modules numpy pip setuptools wheel venv ensurepip
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
unset RIVULET_LIBRARY PYTHONPATH
export PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR="$work" MPLBACKEND=Agg PIP_NO_INDEX=1 PIP_DISABLE_PIP_VERSION_CHECK=1
quietly() { "$@" >"$work/log" 2>&1 || { tail -40 "$work/log"; echo "this failed: $*"; exit 1; }; }
quiet_build() { if [ "$build" = full ]; then quietly "$@"; else RIVULET_PREBUILT="$build/librivulet.so" quietly "$@"; fi; }
build="$1"
[ "$build" = full ] || build="$(cd "$build" && pwd)"

# A copy: the build writes into the source tree.
mkdir "$work/source"
(cd "$root" && tar -c --exclude=./build --exclude=./.git --exclude=./out --exclude=./tests --exclude=./demos .) | tar -x -C "$work/source"
cd "$work/source"
quietly /usr/bin/python3 setup.py sdist --dist-dir "$work/sdist"
quietly /usr/bin/python3 -m venv --system-site-packages "$work/venv"
pip="$work/venv/bin/pip"
quiet_build "$pip" wheel --no-build-isolation --no-deps --wheel-dir "$work/wheels" "$work"/sdist/rivulet-*.tar.gz
version="$(sed -n 's/^project(rivulet VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")"
wheel="$(echo "$work"/wheels/*.whl)"
case "${wheel##*/}" in "rivulet-$version-py3-none-linux_$(uname -m).whl") ;; *) echo "the wheel is named ${wheel##*/}"; exit 1 ;; esac
/usr/bin/python3 - "$wheel" <<'PY'
import sys
import zipfile
with zipfile.ZipFile(sys.argv[1]) as wheel:
    names = wheel.namelist()
for name in ("rivulet/librivulet.so", "rivulet/py.typed", "rivulet/world.py", "LICENSE", "third_party/README.md"):
    assert any(each == name or each.endswith(".dist-info/" + name.split("/")[-1]) for each in names), (name, names)
assert not [name for name in names if not name.startswith("rivulet")], names
PY
quietly "$pip" install "$wheel"
mkdir "$work/elsewhere"
cd "$work/elsewhere"
python="$work/venv/bin/python"
where="$("$python" -c 'import rivulet; print(rivulet.__file__)')"
[ "$where" = "$(echo "$work"/venv/lib/python3*/site-packages/rivulet/__init__.py)" ] || { echo "imported from $where"; exit 1; }
"$python" - "$version" <<'PY'
import sys
import rivulet
with rivulet.Context(backend="cpu") as context, context.world({"fluid": {"spacing": 0.05, "blocks": [{"max": [0.2, 0.2, 0.2]}]}}) as world:
    world.step(1 / 60)
    assert world.stats().particles == 64 and rivulet.version() == sys.argv[1]
PY
[ "$build" != full ] || RIVULET_EXPECTED="$version" "$python" "$here/test.py" "$work/elsewhere"
[ $# -lt 2 ] || "$python" "$root/tests/docs/python_page.py" "$root" "$2"
# With an isolated build environment, of the wheels that Debian has.
if ls /usr/share/python-wheels/wheel-*.whl >/dev/null 2>&1 && [ "$build" != full ]; then
    cd "$work/source"
    quietly "$pip" uninstall -y rivulet
    quiet_build "$pip" install --find-links /usr/share/python-wheels .
    cd "$work/elsewhere"
    [ "$("$python" -c 'import rivulet; print(rivulet.__file__)')" = "$where" ] || { echo "not installed with an isolated build"; exit 1; }
    cd "$work/source"
    # Editable: the package is the source's.
    quiet_build "$pip" install --no-build-isolation --no-deps --force-reinstall --editable .
    cd "$work/elsewhere"
    where="$("$python" -c 'import rivulet; print(rivulet.__file__, rivulet.version())')"
    [ "$where" = "$work/source/fluid/python/rivulet/__init__.py $version" ] || { echo "editable, imported from $where"; exit 1; }
fi
