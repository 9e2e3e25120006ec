"""The HTML page of report.py: one file, pictures inside, well-formed as XML too."""

import base64
import io
from dataclasses import dataclass, field
from html import escape

from carom_plots import plt
from report_verdicts import FAILS, HOLDS, OPEN

STYLE = """
body { font-family: sans-serif; line-height: 1.45; max-width: 62em; margin: 1em auto;
       padding: 0 1em; color: #111; background: #fff; }
img { max-width: 100%; height: auto; }
table { border-collapse: collapse; margin: 0.7em 0; font-size: 0.92em; }
td, th { border: 1px solid #bbb; padding: 0.25em 0.6em; text-align: left; vertical-align: top; }
th { background: #eee; }
pre { background: #f4f4f4; padding: 0.6em; overflow-x: auto; font-size: 0.85em; }
section { border-top: 1px solid #ccc; margin-top: 1.5em; }
.holds { background: #d7ecff; } .fails { background: #ffe0c8; } .open { background: #eeeeee; }
.broken { border: 3px solid #b30000; padding: 0.6em; background: #fff0f0; }
.wide { overflow-x: auto; }
nav li { margin: 0.1em 0; }
"""
CLASSES = {HOLDS: "holds", FAILS: "fails", OPEN: "open"}
SIGNS = {HOLDS: "✓", FAILS: "✗", OPEN: "?"}


@dataclass
class Section:
    """A part of the page: its body is HTML; a failed one says why."""

    anchor: str
    title: str
    body: list = field(default_factory=list)
    verdicts: list = field(default_factory=list)
    failure: str = ""
    output: str = ""        # what a script that made it has printed
    level: int = 2

    def paragraph(self, text):
        """A paragraph of plain text."""
        self.body.append(f"<p>{escape(text)}</p>")

    def fail(self, message):
        """Notes what went wrong; it is shown at the head of the section."""
        self.failure = f"{self.failure}\n{message}".strip()


def picture_tag(picture, words, dpi=90):
    """A figure of matplotlib as an image in the page; the figure is closed."""
    stream = io.BytesIO()
    picture.savefig(stream, format="png", dpi=dpi, metadata={"Software": None})
    plt.close(picture)
    return image_tag(stream.getvalue(), words)


def image_tag(png, words):
    """The bytes of a PNG file as an image in the page."""
    data = base64.b64encode(png).decode("ascii")
    return f'<p><img alt="{escape(words)}" src="data:image/png;base64,{data}"/></p>'


def table(head, rows, classes=None):
    """A table of plain texts; classes: one of each row."""
    lines = ["<div class=\"wide\"><table>", row("th", head)]
    for k, cells in enumerate(rows):
        lines.append(row("td", cells, classes[k] if classes else ""))
    return "\n".join([*lines, "</table></div>"])


def row(tag, cells, kind=""):
    """A row of a table."""
    attribute = f' class="{kind}"' if kind else ""
    return f"<tr{attribute}>" + "".join(f"<{tag}>{escape(str(c))}</{tag}>" for c in cells) + "</tr>"


def verdict_table(verdicts):
    """The verdicts of a section."""
    rows = [(("carom: " if v.ours else "") + v.claim, v.measured, v.limit,
             f"{SIGNS[v.outcome]} {v.outcome}") for v in verdicts]
    return table(("claim", "measured", "limit", "verdict"), rows,
                 [CLASSES[v.outcome] for v in verdicts])


def folded(title, text):
    """Text that opens by a click."""
    return f"<details><summary>{escape(title)}</summary><pre>{escape(text)}</pre></details>"


def section_html(section):
    """A section with its heading."""
    level = section.level
    lines = [f'<section id="{section.anchor}">', f"<h{level}>{escape(section.title)}</h{level}>"]
    if section.failure:
        lines.append('<div class="broken"><strong>This part failed.</strong>'
                     f"<pre>{escape(section.failure)}</pre></div>")
    lines += section.body
    if section.verdicts:
        lines.append(verdict_table(section.verdicts))
    return "\n".join([*lines, "</section>"])


def contents(sections):
    """The table of contents."""
    items = []
    for section in sections:
        mark = " (failed)" if section.failure else ""
        indent = ' style="margin-left: 1.5em"' if section.level > 2 else ""
        link = f'<a href="#{section.anchor}">{escape(section.title)}</a>'
        items.append(f"<li{indent}>{link}{mark}</li>")
    return "<nav><h2>Contents</h2><ul>" + "\n".join(items) + "</ul></nav>"


def summary_table(sections, outcome):
    """The claims that ended in one way; those of carom that hold stand in their sections alone."""
    rows = []
    for section in sections:
        link = f'<a href="#{section.anchor}">{escape(section.title.partition(":")[0])}</a>'
        for verdict in section.verdicts:
            if verdict.outcome == outcome and not (verdict.ours and outcome == HOLDS):
                cells = [("carom: " if verdict.ours else "") + verdict.claim, verdict.measured,
                         verdict.limit]
                rows.append(f'<tr class="{CLASSES[outcome]}"><td>{link}</td>'
                            + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
    if not rows:
        return ""
    head = "<tr><th>where</th><th>claim</th><th>measured</th><th>limit</th></tr>"
    heading = f"<h3>{SIGNS[outcome]} {escape(outcome)}</h3>"
    return "\n".join([heading, '<div class="wide"><table>', head, *rows, "</table></div>"])


def summary(sections):
    """All claims, those that do not hold first, and how many of the source's hold."""
    counts = {outcome: sum(v.outcome == outcome and not v.ours for s in sections for v in s.verdicts)
              for outcome in CLASSES}
    ours = [v.outcome for s in sections for v in s.verdicts if v.ours]
    said = ", ".join(f"{number} {'hold' if what == HOLDS else what.replace('does', 'do')}"
                     for what, number in counts.items())
    failed = [section.title for section in sections if section.failure]
    lines = [f"<p>Of the source's claims put to runs here: {escape(said)}. "
             "Those that begin with “carom:” are claims of this program: "
             f"{ours.count(HOLDS)} of {len(ours)} hold.</p>"]
    if failed:
        lines.append(f'<p class="broken">Failed parts: {escape("; ".join(failed))}</p>')
    tables = [summary_table(sections, outcome) for outcome in (FAILS, OPEN, HOLDS)]
    return "\n".join([*lines, *tables])


def page(title, lead, sections):
    """The whole page; lead: paragraphs (plain text) under the title."""
    verdicts = Section("verdicts", "Which claims hold")
    verdicts.body.append(summary(sections))
    shown = [verdicts, *sections]
    lines = ["<!DOCTYPE html>", '<html lang="en" xmlns="http://www.w3.org/1999/xhtml">', "<head>",
             '<meta charset="utf-8"/>',
             '<meta name="viewport" content="width=device-width, initial-scale=1"/>',
             f"<title>{escape(title)}</title>", f"<style>{STYLE}</style>", "</head>", "<body>",
             f"<h1>{escape(title)}</h1>"]
    lines += [f"<p>{escape(text)}</p>" for text in lead]
    lines.append(contents(shown))
    lines += [section_html(section) for section in shown]
    return "\n".join([*lines, "</body>", "</html>"]) + "\n"
