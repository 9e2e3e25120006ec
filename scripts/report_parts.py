"""Parts of report.py that other scripts compute: trade of speed for accuracy, stability, extremes.

Each runs its script into a folder of the report and shows the pictures and tables it leaves there.
"""

import csv
import os
import re
import shutil
import signal
import subprocess
import sys
from html import escape

from carom_results import Result
from carom_script import ScriptError
from report_page import Section, folded, image_tag, table
from report_runs import ROOT
from report_verdicts import at_most, largest

LIMIT = 600.0       # seconds that a script may take
MARK_GOOD, MARK_BAD = "holds", "fails"

# The cases of the trade: name, title, deck, error that is wanted, grid
BODIES = ["--method", "TRANS,FICT,LAGR,PENALTY", "--error", "force,impulse,energy"]
TRADES = (
    ("sdof", "one mass on a spring, e = 1 and 0.6", "sdof/sdof.inp", 1e-3,
     ["--define", "e=1,0.6", "--method", "TRANS,FICT", "--dt", "0.16:0.0025:7"]),
    ("fourth", "one mass on a spring, second and fourth order", "sdof/sdof.inp", 1e-8,
     ["--order", "2,4", "--dt", "0.32:0.005:7"]),
    ("tolerance", "one mass on a spring, TOLERANCE", "sdof/sdof.inp", 1e-3,
     ["--tolerance", "1e-2:1e-6:5"]),
    ("two_dof", "two masses on springs", "two_dof/two_dof.inp", 1e-3,
     ["--method", "TRANS,FICT", "--dt", "0.16:0.005:6"]),
    ("ball", "a bouncing ball", "ball/ball.inp", 1e-3, []),
    ("masses", "colliding masses", "colliding_masses/colliding_masses.inp", 1e-3, []),
    ("cradle", "a cradle", "cradle/cradle.inp", 1e-3, []),
    ("bar", "an elastic bar", "bar/bar_implicit.inp", 0.02,
     [*BODIES, "--stiffness", "1e3,1e5", "--dt", "0.0133333:0.000833333:5"]),
    ("strip", "a strip of plane elements", "strip/implicit.inp", 0.02,
     [*BODIES, "--stiffness", "1e3,1e5", "--dt", "0.00433333:0.000541667:4"]),
    ("elastic_strip", "the strip in contact node by node", "elastic_strip/q4.inp", 0.02,
     [*BODIES, "--stiffness", "1e3", "--dt", "0.0133333:0.00166667:4"]),
    ("two_bars", "two strips head-on", "two_bars/equal.inp", 0.05,
     ["--dt", "0.0133333:0.00333333:3"]),
    ("oblique_ball", "an elastic ball hits a rough plane", "oblique_ball/elastic.inp", 1e-3, []),
    ("sliding_block", "a block slides to rest", "sliding_block/sliding.inp", 1e-3, []),
    ("buildings", "two buildings in an earthquake", "buildings/buildings.inp", 1e-3, []),
)
NOT_VERIFIED = ("oblique_ball", "sliding_block", "buildings")   # would take a run twice as fine
CHECKED = re.compile(r"^(?:ok|FAILED)\s+(.*): (\S+) <= (\S+)$", re.M)     # a line of stability.py
DELIVERED = 5.0     # the error over TOLERANCE, at most


def run_script(words, limit=LIMIT):
    """Runs a script of the checkout: output, messages, exit status. It and all its children end with
    the limit."""
    path = ROOT / words[0]
    if not path.is_file():
        raise ScriptError(f"{words[0]} is not there")
    process = subprocess.Popen(
        [sys.executable, "-B", str(path), *map(str, words[1:])], cwd=ROOT, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
        start_new_session=True,
    )
    try:
        output, messages = process.communicate(timeout=limit)
    except BaseException as error:
        os.killpg(process.pid, signal.SIGKILL)
        output, messages = process.communicate()
        if not isinstance(error, subprocess.TimeoutExpired):
            raise
        said = tail(output + messages)
        raise ScriptError(f"{words[0]} took more than {limit:.0f} s\n{said}") from None
    return output, messages, process.returncode


def tail(text, lines=12):
    """The last lines of an output."""
    return "\n".join(text.strip().splitlines()[-lines:])


def command_text(words):
    """The command as one gives it, with paths from the top of the checkout."""
    shown = []
    for word in words:
        path = str(word)
        shown.append(os.path.relpath(path, ROOT) if os.path.isabs(path) else path)
    return "python " + " ".join(shown)


def script_section(section, words, folder, harmless="\n"):
    """Runs a script that writes into a folder of its own, and shows its pictures and what it prints. It
    has failed if its status is not 0, unless its messages hold the harmless words."""
    print(f"   {section.title}", flush=True)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        section.output, messages, status = run_script(words)
        if status != 0 and harmless not in messages.strip():
            section.fail(f"{words[0]} ended with status {status}\n{tail(section.output + messages)}")
        pictures = sorted(folder.rglob("*.png"))
        for picture in pictures:
            section.body.append(image_tag(picture.read_bytes(), f"{section.title}: {picture.stem}"))
        if not pictures:
            section.fail(f"{words[0]} drew nothing")
        section.body.append(folded("What the script says", section.output.strip()))
    except (ScriptError, OSError) as error:
        section.fail(str(error))
    section.body.append(folded("Command", command_text(words)))
    return section


def trades(carom, folder, jobs):
    """The trade of every case."""
    sections = [Section("trade", "The trade of speed for accuracy")]
    sections[0].paragraph(
        "Each deck over a grid of methods and steps: error against cost. Left and below is better; "
        "the line joins those runs that none beats in both."
    )
    left = sorted({path.parent.name for path in (ROOT / "input").glob("*/*.inp")}
                  - {deck.split("/")[0] for _, _, deck, _, _ in TRADES})
    sections[0].paragraph(
        "Not here, because they stand still or take too long for this page: "
        f"{', '.join(left)}. scripts/tradeoff.py computes those that move."
    )
    for name, title, deck, wanted, grid in TRADES:
        where = (folder / "trade" / name).resolve()
        words = ["scripts/tradeoff.py", f"input/{deck}", "-o", where, "--carom", carom,
                 "--jobs", jobs, "--for", wanted, *grid]
        words += [] if name in NOT_VERIFIED else ["--verify"]
        section = Section(f"trade-{name}", f"Trade: {title}", level=3)
        script_section(section, words, where, harmless="nothing to verify")
        if not section.failure:
            try:
                recommended(section, where, wanted)
            except (ScriptError, OSError, KeyError, ValueError) as error:
                section.fail(f"tradeoff.h5 is not as expected: {error}")
        sections.append(section)
    return sections


def recommended(section, folder, wanted):
    """Adds to the section of a trade what tradeoff.py recommends, and how that turned out."""
    with Result(str(folder / "tradeoff.h5")) as results:
        attributes = results.file.attrs
        said = f"{attributes['recommendation']} Errors against {attributes['truth']}."
        section.body.insert(0, f"<p>{escape(said)}</p>")
        asked = results.array("points/tolerance")
        found = results.array("points/displacement") if (asked != "").any() else None
    again = re.search(r"^verified: run again it is off by ([-+.\deE]+)", section.output, re.M)
    if again:
        section.verdicts.append(at_most("what is recommended for an error delivers it when run again",
                                        float(again[1]), wanted, "error").own())
    if found is not None:
        ratios = found[asked != ""] / asked[asked != ""].astype(float)
        section.verdicts.append(at_most("TOLERANCE is delivered", largest(ratios), DELIVERED,
                                        "largest error over TOLERANCE").own())


def stability(carom, folder, jobs):
    """The stability map."""
    where = (folder / "stability").resolve()
    words = ["scripts/stability.py", "-o", where, "--carom", carom]
    section = Section("stability", "Stability of the program's own step")
    section.paragraph("Amplification over one step, measured on runs, over what theory says.")
    script_section(section, words, where)
    limits = where / "limits.csv"
    if limits.is_file():
        section.body.append("<h3>Largest stable ωh</h3>" + csv_table(limits))
    for claim, value, limit in CHECKED.findall(section.output):
        section.verdicts.append(at_most(claim, float(value), float(limit), "figure").own())
    return [section]


def csv_table(path, good=None):
    """A table of a file with a head; good: whether a row is as it should be."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f"{path.name} has no rows")
    kinds = [MARK_GOOD if good(row) else MARK_BAD for row in rows] if good else None
    cells = [[shorter(text) for text in row.values()] for row in rows]
    return table(list(rows[0]), cells, kinds)


def shorter(text):
    """A number with more than eight characters with six digits."""
    try:
        return f"{float(text):.6g}" if len(text) > 8 else text
    except ValueError:
        return text


def extremes(carom, folder, jobs):
    """The table of the extremes."""
    section = Section("extremes", "Extremes")
    section.paragraph("Each case at an extreme, what it must bring about, and what it did.")
    where = (folder / "extremes").resolve()
    where.mkdir(parents=True, exist_ok=True)
    scripts = sorted((ROOT / "tests" / "extremes").glob("cases_*.py"))
    if not scripts:
        section.fail("there are no tests/extremes/cases_*.py")
    for script in scripts:
        path = where / f"{script.stem}.csv"
        path.unlink(missing_ok=True)
        words = [script.relative_to(ROOT), carom, "--table", path, "--jobs", jobs]
        try:
            output, messages, status = run_script([str(word) for word in words])
            if status != 0:
                section.fail(f"{script.name} ended with status {status}\n{tail(output + messages)}")
            heading = script.stem.replace("cases_", "").replace("_", " ").capitalize()
            shown = csv_table(path, lambda row: row["outcome"] == "ok")
            section.body.append(f"<h3>{heading}</h3>{shown}")
        except (ScriptError, OSError, ValueError) as error:
            section.fail(str(error))
        section.body.append(folded("Command", command_text(words)))
    return [section]


PARTS = {"trade": trades, "stability": stability, "extremes": extremes}
