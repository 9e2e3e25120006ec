"""Parts of report.py that other scripts compute: trade of speed for accuracy, stability, extremes.

Each runs its script into a folder of the report and shows the pictures and tables it leaves there.
"""

import csv
import os
import signal
import subprocess
import sys

from carom_results import ScriptError
from report_page import Section, folded, image_tag, table
from report_runs import ROOT

LIMIT = 400.0       # seconds that a script may take
MARK_GOOD, MARK_BAD = "holds", "fails"

# The cases of the trade: name, deck, title
TRADES = (
    ("sdof", "input/sdof/sdof.inp", "One mass on a spring"),
    ("two_dof", "input/two_dof/two_dof.inp", "Two masses on springs"),
    ("ball", "input/ball/ball.inp", "A bouncing ball"),
    ("bar", "input/bar/bar_implicit.inp", "An elastic bar"),
    ("strip", "input/elastic_strip/q4.inp", "An elastic strip"),
)


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


def script_section(section, words, folder, limit=LIMIT):
    """Runs a script that writes into a folder, and shows its pictures and what it prints."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.png"):
        old.unlink()
    try:
        output, messages, status = run_script(words, limit)
        if status != 0:
            section.fail(f"{words[0]} ended with status {status}\n{tail(output + messages)}")
        pictures = sorted(folder.rglob("*.png"))
        for picture in pictures:
            section.body.append(image_tag(picture.read_bytes(), f"{section.title}: {picture.stem}"))
        if not pictures:
            section.fail(f"{words[0]} drew nothing")
        section.body.append(folded("What the script says", output.strip()))
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
    for name, deck, title in TRADES:
        where = (folder / "trade" / name).resolve()
        words = ["scripts/tradeoff.py", deck, "-o", where, "--carom", carom, "--jobs", jobs,
                 "--quick"]
        section = Section(f"trade-{name}", f"{title}: {deck}", level=3)
        sections.append(script_section(section, words, where))
    return sections


def stability(carom, folder, jobs):
    """The stability map."""
    where = (folder / "stability").resolve()
    words = ["scripts/stability.py", "-o", where, "--carom", carom, "--jobs", jobs, "--quick"]
    section = Section("stability", "Stability of the program's own step")
    section.paragraph("Amplification over one step, measured on runs, over what theory says.")
    return [script_section(section, words, where)]


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
            section.body.append(extremes_table(script.stem, path))
        except (ScriptError, OSError, ValueError) as error:
            section.fail(str(error))
        section.body.append(folded("Command", command_text(words)))
    return [section]


def extremes_table(title, path):
    """A table as a script of the extremes writes it."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f"{path.name} has no rows")
    good = [row["outcome"] == "ok" for row in rows]
    heading = f"<h3>{title.replace('cases_', '').replace('_', ' ').capitalize()}</h3>"
    return heading + table(list(rows[0]), [list(row.values()) for row in rows],
                           [MARK_GOOD if fine else MARK_BAD for fine in good])


PARTS = {"trade": trades, "stability": stability, "extremes": extremes}
