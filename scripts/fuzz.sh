#!/bin/sh
# Runs mutants of all decks under sanitizers and bounds checks: scripts/fuzz.sh [N] [SEED] [JOBS]
# Those that fail are kept in fuzz/, each with its deck, what it said and the command that repeats it.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
. "$root/scripts/common.sh"

count=${1:-2000}
seed=${2:-1}
jobs=${3:-$(getconf _NPROCESSORS_ONLN)}
prepare_environment
install_packages
make_environment "$root/scripts/requirements.txt"
configure_and_build "$root/build-sanitize" carom -DCMAKE_BUILD_TYPE=Sanitize
say "running $count mutants of seed $seed"
exec "$python" "$root/tests/fuzz/fuzz.py" "$root/build-sanitize/carom" \
   --count "$count" --seed "$seed" --jobs "$jobs" --keep "$root/fuzz"
