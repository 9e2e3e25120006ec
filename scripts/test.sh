#!/bin/sh
# Builds carom with all its tests and runs them: scripts/test.sh [options of ctest]
# Installs what is missing (Debian, Ubuntu; as root or with sudo) and needs nothing but a shell.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
. "$root/scripts/common.sh"

prepare_environment
install_packages $test_packages
make_environment "$root/tests/requirements.txt"
configure_and_build "$build" all -DCMAKE_BUILD_TYPE=Release -DCAROM_TESTS=ON
say 'running the tests'
status=0
ctest --test-dir "$build" -j 2 --timeout 600 --output-on-failure "$@" || status=$?
skipped=$(grep -h '^skipped: ' "$build/Testing/Temporary/LastTest.log" 2>/dev/null | sort -u) || true
[ -z "$skipped" ] || {
   say 'not checked on this machine'
   printf '%s\n' "$skipped"
}
exit "$status"
