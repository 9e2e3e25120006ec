"""The gallery of input/: every case has its picture, its place in the index and a README that names its
decks; and the committed pictures are those that scripts/gallery.py draws."""
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from carom_case import INPUT, ROOT, Checks, scratch_folder
from gallery import CASES, LARGEST, compute, draw, save_small

SIZE = (800, 500)
QUICK = ('sdof', 'ball', 'cantilever', 'thick_cylinder')
IMAGE = re.compile(r'!\[([^\]]*)\]\(([^)]+)\)')
NAMED = re.compile(r'`([\w-]+\.(?:inp|inc|py))`', re.ASCII)


def pixels(path, shrink=4):
    """The picture in grey, each value the mean of a square of so many points a side."""
    with Image.open(path) as image:
        grey = np.asarray(image.convert('L'), dtype=float)
    rows, columns = (n // shrink * shrink for n in grey.shape)
    parts = grey[:rows, :columns].reshape(rows // shrink, shrink, columns // shrink, shrink)
    return parts.mean(axis=(1, 3))


def unlike(one, other):
    """The share of places where two pictures differ by a fifth of black or more, of those that are not
    white in both: letters a point aside change little, another curve much."""
    a, b = pixels(one), pixels(other)
    inked = (a < 250) | (b < 250)
    return np.count_nonzero(np.abs(a - b) > 51) / np.count_nonzero(inked)


def check_pictures(checks, folders):
    """Small, readable, of one size, not empty, each another."""
    shown = {}
    for name in folders:
        path = INPUT / name / f'{name}.png'
        if not path.is_file():
            checks.true(False, f'{name}: no picture {path.name}')
            continue
        with Image.open(path) as image:
            image.load()
            kind = image.format, image.mode, image.size
        checks.true(kind == ('PNG', 'P', SIZE), f'{name}: {kind}')
        checks.at_most(path.stat().st_size, LARGEST, f'{name}: bytes of the picture')
        shown[path.read_bytes()] = name
        checks.true(0.03 < np.mean(pixels(path) < 250) < 0.9, f'{name}: neither empty nor full')
    checks.true(len(shown) == len(folders), f'{len(shown)} different pictures')


def check_readmes(checks, folders):
    """Each shows its picture, says how to run it, names all decks and meshes, and none that is not there."""
    for name in folders:
        text = (INPUT / name / 'README.md').read_text(encoding='utf-8')
        shown = [(words, where) for words, where in IMAGE.findall(text) if where == f'{name}.png']
        checks.true(text.startswith('# ') and len(shown) == 1 and len(shown[0][0]) > 40,
                    f'{name}: a title, and the picture with words for who does not see it')
        checks.true('\n## Run it\n' in text and '\n    carom run input/' in text and '\n## Files\n' in text,
                    f'{name}: commands and files')
        there = {path.name for path in (INPUT / name).iterdir() if path.suffix in ('.inp', '.inc')}
        told = set(NAMED.findall(text))
        checks.true(there <= told, f'{name}: files without a word: {sorted(there - told)}')
        gone = {file for file in told if not file.startswith('verify_')
                and not (INPUT / name / file).exists()}
        checks.true(not gone, f'{name}: files that are not there: {sorted(gone)}')


def check_index(checks, folders):
    """input/README.md shows every case, once, in a group."""
    text = (INPUT / 'README.md').read_text(encoding='utf-8')
    index = text[text.index('\n## Cases\n'):text.index('\n## Deck reference\n')]
    shown = re.findall(r'<a href="([^"]+)"><img src="([^"]+)" width="\d+" alt="([^"]+)"></a>'
                       r'<br>\[`([^`]+)`\]\(([^)]+)\) (\S[^|]{20,})\|', index)
    checks.true(sorted(row[3] for row in shown) == folders, f'index: {len(shown)} cases')
    for page, picture, words, name, link, _ in shown:
        checks.true(page == link == f'{name}/README.md' and picture == f'{name}/{name}.png'
                    and words == name, f'index: links of {name}')
    groups = re.findall(r'\n### (.+)\n', index)
    checks.true(len(groups) >= 6, f'index: groups {groups}')


def check_drawn_anew(checks, program):
    """Some pictures drawn anew look as those committed; one of another motion does not."""
    folder = scratch_folder()
    done = subprocess.run([sys.executable, '-B', str(ROOT / 'scripts' / 'gallery.py'), '--carom', program,
                           '--into', str(folder), *QUICK],
                          capture_output=True, text=True, timeout=300)
    checks.true(done.returncode == 0, f'gallery.py: status {done.returncode} {done.stderr[-300:]}')
    for name in QUICK:
        anew, kept = folder / f'{name}.png', INPUT / name / f'{name}.png'
        with Image.open(anew) as image:
            checks.true(image.size == SIZE, f'{name} anew: size {image.size}')
        checks.at_most(unlike(anew, kept), 0.02, f'{name} anew: share of ink that differs')
    CASES['sdof'].edit = slower
    path = compute(Path(program), 'sdof', 'sdof', folder)
    save_small(draw('sdof', {'sdof': path}), folder / 'slower.png')
    other = unlike(folder / 'slower.png', INPUT / 'sdof' / 'sdof.png')
    checks.true(other > 0.04, f'another motion differs in {other:.3f} of the ink')


def slower(deck):
    """A deck whose rebounds lose a tenth of the velocity."""
    deck.set('IMPACT', RESTITUTION='0.9')


def check_refusals(checks, program):
    """Wrong names end with a sentence, before anything is built or run."""
    for words, said in (([sys.executable, '-B', str(ROOT / 'scripts' / 'gallery.py'), '--carom', program,
                          'sdfo'], 'no such case: sdfo; there are: sdof'),
                        (['sh', str(ROOT / 'scripts' / 'demo.sh'), '--galery'], 'unknown option --galery')):
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, cwd=scratch_folder())
        checks.true(done.returncode == 1 and said in done.stderr,
                    f'{Path(words[-2]).name} {words[-1]}: status {done.returncode}, {done.stderr[-120:]!r}')


checks = Checks()
cases = sorted(path.name for path in INPUT.iterdir() if path.is_dir() and any(path.glob('*.inp')))
checks.true(sorted(CASES) == cases, f'gallery.py draws all {len(cases)} cases: '
            f'{sorted(set(CASES) ^ set(cases))} not')
check_pictures(checks, cases)
check_readmes(checks, cases)
check_index(checks, cases)
check_drawn_anew(checks, str(Path(sys.argv[1]).resolve()))
check_refusals(checks, str(Path(sys.argv[1]).resolve()))
checks.finish()
