#!/bin/sh
# Builds carom, runs six cases and draws them into demo/: scripts/demo.sh
# Installs what is missing (Debian, Ubuntu; as root or with sudo) and needs nothing but a shell.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
. "$root/scripts/common.sh"

prepare_program
mkdir -p demo

compute() {
   say "running $1"
   "$build/carom" run "$1" -o "$2" --quiet --overwrite || fail "carom could not run $1"
}

draw() {
   script=$1
   shift
   "$python" -B "scripts/$script.py" "$@" || fail "scripts/$script.py could not draw $2"
}

compute input/sdof/sdof.inp demo/sdof.h5
draw compare_exact sdof demo/sdof.h5 -o demo/sdof_exact.png
draw plot_history demo/sdof.h5 -o demo/sdof_history.png --events \
   --columns node_1/U1,node_1/V1,node_1/A1
draw plot_energy demo/sdof.h5 -o demo/sdof_energy.png
draw plot_phase demo/sdof.h5 -o demo/sdof_phase.png --wall -0.5

compute input/bar/bar_implicit.inp demo/bar.h5
draw compare_exact bar demo/bar.h5 -o demo/bar_exact.png
draw plot_energy demo/bar.h5 -o demo/bar_energy.png
compute input/bar/bar_mixed.inp demo/bar_mixed.h5
draw plot_profile demo/bar_mixed.h5 -o demo/bar_mixed_profile.png

compute input/buildings/buildings.inp demo/buildings.h5
draw plot_history demo/buildings.h5 -o demo/buildings_history.png \
   --columns node_13/U1,node_23/U1,contact_FLOORS/CDIS
draw plot_energy demo/buildings.h5 -o demo/buildings_energy.png
draw animate demo/buildings.h5 -o demo/buildings.gif --scale 25

compute input/hertz/nonmatching.inp demo/hertz.h5
draw plot_contact demo/hertz.h5 -o demo/hertz_contact.png --hertz 0.75,998.901 --half
compute input/two_discs/oblique.inp demo/discs.h5
draw animate demo/discs.h5 -o demo/discs.gif --field MISES --every 2
compute input/crack/slap.inp demo/crack.h5
draw animate demo/crack.h5 -o demo/crack.gif --field S22 --scale 10 --every 4

say "pictures and result files are in $root/demo"
ls demo/*.png demo/*.gif
