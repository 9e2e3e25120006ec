"""Mutants of all decks of input/ and of random small scenes: the program must end as it says it does.

    python3 fuzz.py CAROM [--first I] [--count N] [--seed S] [--jobs J] [--keep FOLDER] [--only I]

Mutant I of seed S is always the same. Each must end with status 0, 2, 3 or 4 within bounds of time
and memory (or with 5 in time, where it was asked to stop after 10 s), without a signal or an error of the language or a sanitizer, with a message that names a
place for status 2, and with numbers for status 0. Failing mutants are kept with the command that repeats them.
"""
import argparse
import collections
import shutil
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import spoil
import vary
from fuzz_deck import ROOT, count_increments, flattened, limit_increments, read_decks, shorten
from judge import judge, limit_files
from scenes import make_scene

MOST_INCREMENTS = 3000      # of a mutant, by its numbers
LARGE = 20000               # bytes of a deck: larger ones are taken seldom and mostly checked


class Source:
    """The decks that mutants come from, and those that only give cards."""

    def __init__(self):
        self.decks = read_decks(ROOT / "input", "*/*.inp")
        self.flat = [flattened(deck) for deck in self.decks]
        self.donors = self.flat + read_decks(ROOT / "tests" / "deck_errors", "*.inp")
        sizes = np.array([len(deck.text()) for deck in self.flat])
        weights = np.clip(LARGE/4/sizes, 0.1, 1.0)
        self.weights = weights/weights.sum()


class Mutant:
    """A changed deck, how it came about, and how it is to be run."""

    def __init__(self, deck, command, changes):
        self.deck, self.command, self.changes = deck, command, changes

    def write(self, folder):
        """Puts the deck and its files into a folder."""
        folder.mkdir(parents=True, exist_ok=True)
        files = {**self.deck.files, "deck.inp": self.deck.text()}
        for name, text in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(text.encode("latin-1", "replace"))


def make_mutant(source, seed, number):
    """Mutant `number` of a seed; one that would take very long is drawn again."""
    for attempt in range(20):
        rng = np.random.default_rng([seed, number, attempt])
        deck, large = draw_deck(source, rng)
        changes = [change(rng, deck, source) for _ in range(spoil.pick(rng, [1, 1, 1, 1, 2, 3, 6]))]
        if rng.random() < 0.9:
            limit_increments(deck)
        if count_increments(deck) <= MOST_INCREMENTS or rng.random() < 0.005:
            break
    # an increment of a large deck that yields where it is hit may take minutes
    run = rng.random() < (0.25 if large else 0.8) and not (large and deck.places("PLASTIC"))
    return Mutant(deck, "run" if run else "check", [f"of {deck.name}", *changes])


def draw_deck(source, rng):
    """A deck to be changed, its steps cut short, and whether it is large."""
    if rng.random() < 0.4:
        return make_scene(rng), False
    chosen = int(rng.choice(len(source.decks), p=source.weights))
    large = len(source.flat[chosen].text()) > LARGE
    deck = (source.decks if rng.random() < 0.2 else source.flat)[chosen].copy()
    shorten(deck, spoil.pick(rng, [1, 3, 5] if large else [1, 5, 20, 60]))
    return deck, large


def change(rng, deck, source):
    """Changes a deck once; the name of what was done."""
    kinds = vary if rng.random() < 0.6 else spoil
    for _ in range(10):
        _, what = kinds.CHANGES[int(rng.choice(len(kinds.CHANGES), p=kinds.WEIGHTS))]
        if what(rng, deck, source.donors):
            return what.__name__
    return "nothing"


class Campaign:
    """A number of mutants, the folder for the failing ones, and the counts."""

    def __init__(self, options):
        self.options, self.source = options, Source()
        self.counts = collections.Counter()
        self.failures, self.late, self.done = [], [], 0
        self.decks = set()

    def run_one(self, number):
        """Makes, runs and judges a mutant; keeps it if it fails."""
        options = self.options
        mutant = make_mutant(self.source, options.seed, number)
        with tempfile.TemporaryDirectory(prefix="carom_fuzz_") as name:
            folder = Path(name) / "run"
            mutant.write(folder)
            verdict = judge(options.carom, folder, mutant.command)
            faults = verdict.faults or (self.compare(mutant, verdict, Path(name), number))
            verdict.faults = faults
            if verdict.kind in ("failed", "long"):
                self.keep(number, mutant, verdict, folder)
        return mutant, verdict

    def compare(self, mutant, verdict, folder, number):
        """Now and then: what `run` refuses as a wrong deck, `check` refuses too."""
        if mutant.command != "run" or verdict.status != 2 or number % 10:
            return []
        mutant.write(folder / "check")
        other = judge(self.options.carom, folder / "check", "check")
        return other.faults or ([] if other.status == 2 else [f"check ends with {other.status}"])

    def keep(self, number, mutant, verdict, folder):
        """Copies a mutant with what it said into the folder of failures."""
        if self.options.keep is None:
            return
        kept = Path(self.options.keep) / f"{verdict.kind}_{self.options.seed}_{number}"
        shutil.rmtree(kept, ignore_errors=True)
        mutant.write(kept)
        (kept / "verdict.txt").write_text("\n".join([
            *verdict.faults, f"status {verdict.status}, {verdict.seconds:.1f} s, "
            f"{verdict.megabytes:.0f} MB", f"carom {mutant.command} deck.inp",
            f"repeat: {self.command(number)}", ", ".join(mutant.changes), "", verdict.text]))

    def command(self, number):
        """The command that repeats a mutant."""
        return (f"{sys.executable} {Path(__file__).resolve()} {self.options.carom} "
                f"--seed {self.options.seed} --only {number} --keep kept")

    def take(self, number, mutant, verdict):
        """Counts a verdict and says what failed."""
        self.done += 1
        self.decks.add(mutant.deck.name)
        self.counts[f"{mutant.command} {verdict.kind}"] += 1
        if verdict.faults:
            self.failures.append(number)
            print(f"FAILED mutant {number} ({mutant.command}, {', '.join(mutant.changes)}): "
                  f"{'; '.join(verdict.faults)}\n   {self.command(number)}", flush=True)
        elif verdict.kind == "long":
            self.late.append(number)
        if self.done % 1000 == 0:
            print(f"{self.done} done, {len(self.failures)} failed", flush=True)

    def run(self, numbers):
        """Runs all mutants of the given numbers."""
        begun = time.monotonic()
        with ThreadPoolExecutor(self.options.jobs) as pool:
            for number, (mutant, verdict) in zip(numbers, pool.map(self.run_one, numbers)):
                self.take(number, mutant, verdict)
        self.summarize(time.monotonic() - begun)

    def summarize(self, seconds):
        """Prints the counts."""
        for kind, count in sorted(self.counts.items()):
            print(f"{kind:>14} {count:7d}")
        print(f"{self.done} mutants of {len(self.decks)} decks, {len(self.failures)} failed, "
              f"{len(self.late)} stopped as too long {self.late[:20]}, {seconds:.0f} s")


def main():
    """Reads the command line; status 1 if a mutant failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("carom", type=lambda name: Path(name).resolve())
    parser.add_argument("--count", type=int, default=2000, help="number of mutants")
    parser.add_argument("--first", type=int, default=0, help="number of the first mutant")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep", help="folder for the mutants that fail or run long")
    parser.add_argument("--only", type=int, help="the number of one mutant")
    options = parser.parse_args()
    limit_files()
    campaign = Campaign(options)
    numbers = range(options.first, options.first + options.count)
    campaign.run(numbers if options.only is None else [options.only])
    sys.exit(1 if campaign.failures else 0)


if __name__ == "__main__":
    main()
