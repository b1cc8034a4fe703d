# Sourced by the tests in Python.
# need_modules NAME...: ends the test with status 77 if one of these is not installed; with 1 if RIVULET_HOSTS is 1, which installs them.
need_modules() {
    local missing
    missing="$(/usr/bin/python3 -c 'import importlib.util, sys; print(*(name for name in sys.argv[1:] if not importlib.util.find_spec(name)))' "$@")"
    [ -n "$missing" ] || return 0
    echo "skipped: Python lacks $missing; section [hosts] of third_party/packages.txt has the packages"
    [ "${RIVULET_HOSTS:-}" != 1 ] || exit 1
    exit 77
}
