#!/bin/sh
# Builds carom and the driver of its kernels, then times both: scripts/bench.sh [options of bench.py]
# Installs what is missing (Debian, Ubuntu; as root or with sudo) and needs nothing but a shell. Other
# programs to compare with are installed where that is possible, without them bench.py says so.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
. "$root/scripts/common.sh"

prepare_environment
install_packages
make_environment "$root/scripts/requirements.txt"
case " $* " in
*" --no-peers "*) ;;
*)
   has_command ccx || (install_packages calculix-ccx) || say 'without CalculiX'
   for package in openseespy akantu mujoco exudyn; do
      "$python" -c "import importlib.util, sys; sys.exit(not importlib.util.find_spec('$package'))" ||
         "$python" -m pip install --quiet --no-cache-dir --disable-pip-version-check "$package" ||
         say "without $package"
   done
   ;;
esac
configure_and_build "$build" carom_kernels -DCMAKE_BUILD_TYPE=Release -DCAROM_TESTS=ON
cd "$root"
exec "$python" -B scripts/bench.py --build "$build" "$@"
