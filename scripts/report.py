"""The source's figures and claims, the trade, the stability map and the extremes on one page:

    report.py [--carom build/carom] [-o report] [--jobs 2] [--only 3.3,5.4,trade,stability,extremes]

Computes all of it and writes report.html, one page with its pictures inside, and beside it the
decks that differ from those of input/ (decks/). Every claim is judged by a measured figure and a limit. A
part that fails is shown as failed, and the exit status is 1; a claim that does not hold is no
failure. --list shows what there is.
"""

import argparse
import subprocess
import sys
import traceback
from pathlib import Path

from carom_deck import find_carom
from carom_script import ScriptError, run
from report_page import Section, folded, page, picture_tag
from report_parts import PARTS
from report_runs import Runs
from report_source import all_figures

TITLE = "carom: the source's figures and claims put to runs"
SOURCE = (
    "The source is the thesis on the numerical modelling of elastodynamic impact in which the "
    "fictitious force method (its chapter 3) and the transformation (its chapter 4) are derived, and "
    "tried (chapters 3 and 5). Its claims are told in words of our own, and none of its pictures is "
    "reproduced: beside a figure of the source means its quantity, axes, case and parameters, with "
    "what its text prints of it as marks."
)
HOW = (
    "Each verdict follows from a measured figure and a limit, both given. Two curves agree if they "
    "differ by at most 1 % of the height of the picture, which the eye cannot see; velocities, which "
    "jump, are compared in the mean over time, since no two curves jump at the same instant."
)


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--carom", help="the program (default: build/carom of this checkout)")
    parser.add_argument("-o", "--output", default="report", help="folder to write (report)")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time (default 2)")
    parser.add_argument("--only", default="", help="figures and parts, comma-separated; see --list")
    parser.add_argument("--keep", action="store_true", help="keep the result files, in runs/")
    parser.add_argument("--list", action="store_true", help="show what there is and stop")
    return parser.parse_args()


def choose(words, names):
    """What --only asks for, all if nothing."""
    asked = [word.strip() for word in words.split(",") if word.strip()]
    unknown = [word for word in asked if word not in names]
    if unknown:
        raise ScriptError(f"no such part: {', '.join(unknown)}; there are: {', '.join(names)}")
    return asked or names


def anchor_of(number):
    """The anchor of a figure."""
    return "figure-" + number.replace(".", "-").replace(" ", "-")


def heading(number):
    """Whether a number is that of a figure or of a section of the source."""
    if number == "abstract":
        return "Abstract"
    sections = ("4.2.3", "4.2.3 b", "3.2.2", "6.1")
    return f"Section {number.split()[0]}" if number in sections else f"Figure {number}"


def figure_section(figure, runs, folder):
    """A figure of the source beside ours: picture, verdicts, commands."""
    title = f"{heading(figure.number)}: {figure.title}"
    section = Section(anchor_of(figure.number), title, level=3)
    section.paragraph(figure.parameters + ".")
    try:
        picture, section.verdicts = figure.draw(figure, runs)
        section.body.append(picture_tag(picture, section.title))
    except ScriptError as error:
        section.fail(str(error))
    except Exception:       # a picture that cannot be drawn must not take the page with it
        section.fail(traceback.format_exc(limit=-3))
    if figure.note:
        section.paragraph(figure.note)
    commands = list(dict.fromkeys(commands_of(case, folder) for case in figure.cases))
    section.body.append(folded("Commands", "\n".join(commands)))
    return section


def commands_of(case, folder):
    """How a case is run again, with what its deck changes."""
    text = case.command(folder)
    return f"# {case.deck} with {case.words()}\n{text}" if case.words() else text


def source_sections(figures, runs, folder):
    """All figures of the source, failures included."""
    runs.compute([case for figure in figures for case in figure.cases])
    if not figures:
        return []
    lead = Section("source", "The figures and claims of the source")
    lead.paragraph(f"{len(runs.cases)} runs of carom are behind these figures, of which "
                   f"{len(runs.failed)} failed. Commands are given from the top of the checkout; "
                   f"decks that differ from those of input/ are in {folder}/decks.")
    return [lead, *(figure_section(figure, runs, folder) for figure in figures)]


def guarded(name, part, carom, given):
    """The sections of a part; an error in it becomes a section of its own that says so."""
    try:
        return part(carom, Path(given.output), given.jobs)
    except Exception:       # it must not take the page with it
        section = Section(name, f"The part '{name}'")
        section.fail(traceback.format_exc(limit=-3))
        return [section]


def facts(carom, given):
    """What the page says of itself: program, command."""
    try:
        said = subprocess.run([carom, "--version"], capture_output=True, text=True).stdout.strip()
    except OSError as error:
        raise ScriptError(f"cannot run '{carom}': {error.strerror}") from None
    only = f" --only {given.only}" if given.only else ""
    return f"Program: {said}. Made by: python scripts/report.py --jobs {given.jobs}{only}."


def main():
    given = arguments()
    figures = all_figures()
    names = [figure.number for figure in figures] + list(PARTS)
    if given.list:
        print("\n".join(names))
        return
    chosen = choose(given.only, names)
    carom = find_carom(given.carom)
    lead = [SOURCE, HOW, facts(carom, given)]
    runs = Runs(carom, given.output, given.jobs)
    print("computing the figures of the source", flush=True)
    sections = source_sections([f for f in figures if f.number in chosen], runs, given.output)
    runs.close(given.keep)
    for name, part in PARTS.items():
        if name in chosen:
            print(f"computing the part '{name}'", flush=True)
            sections += guarded(name, part, carom, given)
    path = Path(given.output) / "report.html"
    path.write_text(page(TITLE, lead, sections), encoding="utf-8")
    print(path)
    failed = [section.title for section in sections if section.failure]
    for title in failed:
        print(f"failed: {title}", file=sys.stderr)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    run(main)
