"""The page of scripts/report.py: its verdicts follow from what is measured, its parts are all there,
what fails is shown as failed."""
import base64
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np

from carom_case import ROOT, Checks, scratch_folder
from report_source import all_figures
from report_verdicts import FAILS, HOLDS, OPEN, at_least, at_most, convergent

HTML = '{http://www.w3.org/1999/xhtml}'
NUMBERS = [f'3.{k}' for k in range(3, 8)] + [f'5.{k}' for k in range(1, 13) if k != 9]


def make_page(*options, program=sys.argv[1]):
    """Runs report.py: its exit status, what it said, and its page (None if there is none)."""
    folder = scratch_folder()
    words = [sys.executable, '-B', str(ROOT / 'scripts' / 'report.py'), '--carom', str(program),
             '-o', str(folder), *options]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    page = folder / 'report.html'
    return (done.returncode, done.stdout + done.stderr,
            ElementTree.parse(page).getroot() if page.exists() else None)


def sections_of(page):
    """The sections of a page by their anchors."""
    return {section.get('id'): section for section in page.iter(HTML + 'section')}


def rows_of(section):
    """The rows of a section's tables as lists of texts."""
    return [[''.join(cell.itertext()) for cell in row] for row in section.iter(HTML + 'tr')]


def check_verdicts(checks):
    """A claim is decided by number and limit alone; without a number it is open."""
    for judged, expected in ((at_most('', 1.0, 2.0, ''), HOLDS), (at_most('', 2.1, 2.0, ''), FAILS),
                             (at_least('', 2.0, 2.0, ''), HOLDS), (at_least('', 1.9, 2.0, ''), FAILS),
                             (at_most('', np.nan, 2.0, ''), OPEN), (at_least('', None, 2.0, ''), OPEN),
                             (at_least('', np.inf, 2.0, ''), OPEN)):
        checks.true(judged.outcome == expected, f'{judged.measured}, {judged.limit}: {expected}')
    steps = 0.1 / 2.0**np.arange(6)
    checks.true(convergent('', steps, 3.0 * steps).outcome == HOLDS, 'errors like h converge')
    checks.true(convergent('', steps, 0.1 + 0.0 * steps).outcome == FAILS, 'constant ones do not')
    rough = steps * np.array([1, 1, 1, 9, 1, 1])
    checks.true(convergent('', steps, rough).outcome == FAILS, 'nor do those that rise between')


def check_page(checks):
    """Two figures: everything is in the page, every link leads somewhere, the verdicts are right."""
    status, said, page = make_page('--only', '3.3,5.5')
    checks.true(status == 0, f'two figures: status {status} {said[-300:] if status else ""}')
    sections = sections_of(page)
    checks.true(set(sections) == {'verdicts', 'source', 'figure-3-3', 'figure-5-5'},
                f'sections: {sorted(sections)}')
    targets = {link.get('href') for link in page.iter(HTML + 'a')}
    checks.true(targets == {f'#{name}' for name in sections}, 'contents and summary link them all')
    for name in ('figure-3-3', 'figure-5-5'):
        kind, data = next(sections[name].iter(HTML + 'img')).get('src').split(',', 1)
        checks.true(kind == 'data:image/png;base64'
                    and base64.b64decode(data)[:8] == b'\x89PNG\r\n\x1a\n', f'{name}: a picture')
        commands = ''.join(next(sections[name].iter(HTML + 'pre')).itertext())
        checks.true('build/carom run ' in commands, f'{name}: a command')
    check_figures(checks, {name: rows_of(section) for name, section in sections.items()})


def check_figures(checks, rows):
    """What is known of figures 3.3 and 5.5: beta = 1/4 loses nothing, 1/6 does."""
    outcome = {name: {row[0]: row[-1][2:] for row in table[1:]} for name, table in rows.items()}
    checks.true(set(outcome['figure-3-3'].values()) == {HOLDS}, 'figure 3.3: all claims hold')
    found = outcome['figure-5-5']
    checks.true(found['β = 1/6 loses less than β = 1/4'] == FAILS, 'figure 5.5: 1/4 loses less')
    row = next(row for row in rows['figure-5-5'] if row[0].startswith('β = 1/6 loses less than β'))
    figures = [float(text) for text in re.findall(r'[\d.]+e-\d+', ' '.join(row[1:3]))]
    checks.close(figures[0], 4.2e-6, 1e-7, 'figure 5.5: change of the energy with 1/6')
    checks.at_most(figures[1], 1e-12, 'figure 5.5: change of the energy with 1/4')
    whole = sum(len(table) for name, table in outcome.items() if name.startswith('figure'))
    listed = sum(len(row) == 4 and row[0] != 'where' for row in rows['verdicts'])
    checks.close(listed, whole, 0, 'claims in the summary')


def check_failures(checks):
    """A program that fails: the page says so, status 1. A part that does not exist: no page."""
    program = scratch_folder() / 'carom'
    program.write_text('#!/bin/sh\necho "error: nothing works"\nexit 4\n')
    program.chmod(0o755)
    status, said, page = make_page('--only', '5.12', program=program)
    checks.true(status == 1 and 'failed: Figure 5.12' in said, f'a run that fails: status {status}')
    text = ''.join(sections_of(page)['figure-5-12'].itertext())
    checks.true('This part failed' in text and 'nothing works' in text, 'and the page says why')
    status, said, page = make_page('--only', '3.2')
    checks.true(status == 1 and page is None and "no such part: 3.2" in said, 'no such figure')


checks = Checks()
listed = [figure.number for figure in all_figures()]
checks.true([number for number in listed if number in NUMBERS] == NUMBERS,
            'all figures of the source are there, in order')
check_verdicts(checks)
check_page(checks)
check_failures(checks)
checks.finish()
