#!/bin/sh
# Builds carom, runs the cases of input/ and draws each into demo/, some as moving pictures: scripts/demo.sh
# With --gallery it draws no more than the pictures that the READMEs of input/ show, into input/*/.
# Installs what is missing (Debian, Ubuntu; as root or with sudo) and needs nothing but a shell.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
. "$root/scripts/common.sh"

case ${1:-} in
'') where='--into demo' ;;
--gallery) where=--write ;;
*) fail "unknown option $1: scripts/demo.sh [--gallery]" ;;
esac

prepare_program
results=demo/results
mkdir -p "$results"

draw() {
   script=$1
   shift
   "$python" -B "scripts/$script.py" "$@" || fail "scripts/$script.py could not draw $2"
}

say 'running the cases of input/ and drawing them'
"$python" -B scripts/gallery.py $where --results "$results" --carom "$build/carom" ||
   fail 'scripts/gallery.py could not draw the cases'
[ "$where" != --write ] || exit 0

"$build/carom" run input/bar/bar_mixed.inp -o "$results/bar.bar_mixed.h5" --quiet --overwrite ||
   fail 'carom could not run input/bar/bar_mixed.inp'
draw compare_exact sdof "$results/sdof.sdof.h5" -o demo/sdof_exact.png
draw plot_phase "$results/sdof.sdof.h5" -o demo/sdof_phase.png --wall -0.5
draw compare_exact bar "$results/bar.bar_implicit.h5" -o demo/bar_exact.png
draw plot_energy "$results/bar.bar_implicit.h5" -o demo/bar_energy.png
draw plot_profile "$results/bar.bar_mixed.h5" -o demo/bar_mixed_profile.png
draw plot_history "$results/buildings.buildings.h5" -o demo/buildings_history.png \
   --columns node_13/U1,node_23/U1,contact_FLOORS/CDIS
draw animate "$results/buildings.buildings.h5" -o demo/buildings.gif --scale 25
draw plot_contact "$results/hertz.nonmatching.h5" -o demo/hertz_contact.png --hertz 0.75,998.901 --half
draw animate "$results/two_discs.oblique.h5" -o demo/discs.gif --field MISES --every 2
draw animate "$results/crack.slap.h5" -o demo/crack.gif --field S22 --scale 10 --every 4

say "pictures and result files are in $root/demo and $root/$results"
ls demo/*.png demo/*.gif
