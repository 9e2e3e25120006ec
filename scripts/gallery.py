"""The pictures of the gallery, one a case: gallery.py [CASE ...] [--into demo | --write] [--list]

Runs the decks of the cases of input/ (all, or those named) and draws what comes out: CASE.png in
the folder given, by --write in input/CASE/, where the READMEs show them. Small files: 800 by 500
points in a palette. Result files go at the end, or stay in --results FOLDER and are used again
while they are younger than program and decks.
"""

import argparse
import contextlib
import io
import os
import tempfile
from concurrent.futures import ALL_COMPLETED, FIRST_COMPLETED, ThreadPoolExecutor, wait
from pathlib import Path

import gallery_bodies as bodies
import gallery_frames as frames
import gallery_masses as masses
from carom_deck import Deck, find_carom, run_deck
from carom_script import ScriptError, run
from gallery_style import STYLE, Run, plt
from PIL import Image

INPUT = Path(__file__).resolve().parents[1] / "input"
LARGEST = 100_000  # bytes of a picture


def at_anchored_events(deck):
    """Events take solutions, no steps of their own: for a deck whose own way takes minutes."""
    deck.set("IMPACT", EVENTS="ANCHOR")


class Case:
    """A folder of input/: the function that draws it, its decks, an edit of them."""

    def __init__(self, draw, *decks, edit=None):
        self.draw, self.decks, self.edit = draw, decks, edit


CASES = {
    "sdof": Case(masses.draw_sdof, "sdof"),
    "two_dof": Case(masses.draw_two_dof, "two_dof"),
    "ball": Case(masses.draw_ball, "ball", "ball_fictitious"),
    "colliding_masses": Case(masses.draw_colliding_masses, "colliding_masses"),
    "cradle": Case(masses.draw_cradle, "cradle"),
    "bar": Case(masses.draw_bar, "bar_implicit", "bar_explicit", "bar_fictitious"),
    "strip": Case(bodies.draw_strip, "implicit", "explicit"),
    "elastic_strip": Case(bodies.draw_elastic_strip, "q4", "q8", "q4_massless", "q4_fictitious"),
    "two_bars": Case(masses.draw_two_bars, "short_on_long"),
    "buildings": Case(masses.draw_buildings, "buildings"),
    "pounding_frame": Case(masses.draw_pounding_frame, "frames"),
    "cantilever": Case(bodies.draw_cantilever, "cantilever", "modes"),
    "thick_cylinder": Case(bodies.draw_thick_cylinder, "elastic_cax8", "plastic_cax4"),
    "from_gmsh": Case(frames.draw_from_gmsh, "ring"),
    "from_freecad": Case(frames.draw_from_freecad, "export/FEMMeshGmsh", "impact"),
    "hertz": Case(bodies.draw_hertz, "nonmatching", "nonmatching_nodes"),
    "block": Case(frames.draw_block, "block", edit=at_anchored_events),
    "dropped_disc": Case(frames.draw_dropped_disc, "q4", "q4_fictitious"),
    "two_discs": Case(frames.draw_two_discs, "oblique"),
    "sliding_block": Case(bodies.draw_sliding_block, "sliding", "slope"),
    "oblique_ball": Case(bodies.draw_oblique_ball, "point", "elastic"),
    "crack": Case(bodies.draw_crack, "slap"),
}
SLOW = "pounding_frame", "crack", "two_discs", "dropped_disc"


def is_fresh(result, carom, name):
    """Whether a result is younger than the program and all decks and meshes of its case."""
    if not result.exists():
        return False
    made = result.stat().st_mtime
    sources = [carom, *(INPUT / name).rglob("*.in[cp]")]
    return all(path.stat().st_mtime < made for path in sources)


def compute(carom, name, deck, results):
    """Runs a deck of a case, unless its result is there; the path of the result."""
    path = INPUT / name / f"{deck}.inp"
    result = results / f"{name}.{deck.replace('/', '.')}.h5"
    if is_fresh(result, carom, name):
        return result
    if CASES[name].edit:
        edited = Deck.read(path)
        CASES[name].edit(edited)
        path = results / f"{name}.{deck}.inp"
        edited.write(path)
    done = run_deck(carom, path, result)
    if done.status != 0:
        raise ScriptError(f"{path}: carom ended with status {done.status}: {done.last_line}")
    return result


def draw(name, paths):
    """The figure of a case, from the results of its decks."""
    with contextlib.ExitStack() as stack, plt.rc_context(STYLE):
        return CASES[name].draw({deck: stack.enter_context(Run(path))
                                 for deck, path in paths.items()})


def save_small(figure, path):
    """Writes the figure in as many colours as keep it small."""
    whole = io.BytesIO()
    with plt.rc_context(STYLE):
        figure.savefig(whole, format="png")
    plt.close(figure)
    image = Image.open(whole).convert("RGB")
    for colours in (256, 128, 64, 32):
        small = io.BytesIO()
        palette = image.quantize(colours, Image.Quantize.MAXCOVERAGE, 3,
                                 dither=Image.Dither.NONE)
        palette.save(small, format="png", optimize=True)
        if small.tell() <= LARGEST:
            break
    else:
        raise ScriptError(f"{path}: {small.tell()} bytes, more than {LARGEST}")
    try:
        Path(path).write_bytes(small.getvalue())
    except OSError as error:
        raise ScriptError(f"cannot write '{path}': {error.strerror}") from None


def make(chosen, carom, results, place):
    """Runs the decks of the cases, two at a time, the slow ones first; draws each case when its own
    are done."""
    with ThreadPoolExecutor(max_workers=min(2, os.cpu_count() or 1)) as workers:
        runs = {name: {deck: workers.submit(compute, carom, name, deck, results)
                       for deck in CASES[name].decks}
                for name in sorted(chosen, key=lambda name: name not in SLOW)}
        waiting = list(chosen)
        while waiting:
            wait([run for name in waiting for run in runs[name].values()],
                 return_when=FIRST_COMPLETED if len(waiting) > 1 else ALL_COMPLETED)
            for name in [n for n in waiting if all(run.done() for run in runs[n].values())]:
                save_small(draw(name, {deck: run.result() for deck, run in runs[name].items()}),
                           place(name))
                print(os.path.relpath(place(name)), flush=True)
                waiting.remove(name)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", help="folders of input/ (default: all)")
    parser.add_argument("--into", default="demo", help="folder for the pictures (demo)")
    parser.add_argument("--write", action="store_true", help="into input/CASE/ instead")
    parser.add_argument("--results", help="folder where result files are kept, and used again")
    parser.add_argument("--carom", help="the program (default: build/carom)")
    parser.add_argument("--list", action="store_true", help="the cases and their decks, no more")
    given = parser.parse_args()
    if given.list:
        for name, case in CASES.items():
            print(name, *case.decks)
        return
    unknown = [name for name in given.cases if name not in CASES]
    if unknown:
        raise ScriptError(f"no such case: {unknown[0]}; there are: {', '.join(CASES)}")
    if not given.write:
        os.makedirs(given.into, exist_ok=True)

    def place(name):
        return INPUT / name / f"{name}.png" if given.write else Path(given.into) / f"{name}.png"

    with tempfile.TemporaryDirectory() as scratch:
        results = Path(given.results or scratch)
        results.mkdir(parents=True, exist_ok=True)
        make(given.cases or list(CASES), find_carom(given.carom), results, place)


if __name__ == "__main__":
    run(main)
