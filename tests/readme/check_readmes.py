"""Runs every command, deck and example that a README prints: check_readmes.py CAROM BUILD [README...]

Commands run in the order of the page, in a scratch copy of the checkout; they must end with status 0, or the
one the page says. What the page prints of a program's answer must be what the program prints, but for
times and memory; a line or place with … stands for any text. Decks run, fragments are put into a deck and
checked, Python examples run. What cannot be run as it stands is listed in readme_rules.py, and a
block that is none of these fails the test."""
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
os.environ['MPLBACKEND'] = 'Agg'
import h5py  # noqa: E402,F401  loaded once for all scripts: see readme_shell
import matplotlib.pyplot  # noqa: E402,F401

from readme_blocks import inline_commands, read_blocks, split_commands, table_lines  # noqa: E402
from readme_rules import DELEGATED, INSTEAD  # noqa: E402
from readme_shell import Shell  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
TIMES = re.compile(r'[\d.]+(e[-+]?\d+)? ?(s|ms|kB|MB|GB|%)(?![\w])|[\d.]+e?[-+]?\d* (increments|solves|steps)/s'
                   r'|\d{4}-\d\d-\d\d \d\d:\d\d:\d\d|pid \d+')
STEP_CARDS = r'^\*(STEP|END|STATIC|DYNAMIC|FREQUENCY|CLOAD|DLOAD|BASE|NODE PRINT|NODE FILE|EL |CONTACT PRINT' \
             r'|CONTACT FILE|ENERGY PRINT|RESTART)'


class Page:
    """One README: runs its blocks and keeps what went wrong."""

    def __init__(self, path, shell, used):
        self.path, self.shell, self.used = path, shell, used
        self.failures, self.counts, self.said, self.undo = [], {}, '', []

    def check(self):
        """Runs all blocks in the order of the page."""
        text = (ROOT / self.path).read_text()
        for block in read_blocks(text):
            started = time.process_time() + sum(os.times()[2:4])
            for change in self._marks(block, 'with'):
                self._change(change)
            kind = self._delegation(block) or block.kind
            self.counts[kind] = self.counts.get(kind, 0) + 1
            getattr(self, '_' + kind)(block)
            while self.undo:
                self.undo.pop()()
            used = time.process_time() + sum(os.times()[2:4]) - started
            if used > 2:
                print(f'        {self.path}:{block.start} takes {used:.1f} s')
        for line, name, parts in table_lines(text):
            self.counts['lines in a table'] = self.counts.get('lines in a table', 0) + len(parts)
            deck = [' '.join(part.split()) for part in (self.shell.folder / name).read_text().split('\n')]
            for part in parts:
                start = part.split('…')[0].strip()
                if not any(found.startswith(start) for found in deck):
                    self._fail(line, f'{name} has no line `{part}`')
            for card in deck:
                if re.match(r'\*[A-Z]', card) and not any(card.startswith(part.split('…')[0]) for part in parts):
                    self._fail(line, f'the table leaves out {card} of {name}')
        for line, command in inline_commands(text):
            self.counts['in sentences'] = self.counts.get('in sentences', 0) + 1
            self._run(command, line, 0)

    def _fail(self, line, sentence):
        self.failures.append(f'{self.path}:{line}: {sentence}')

    @staticmethod
    def _marks(block, name):
        return [text for kind, text in block.marks if kind == name]

    def _change(self, text):
        name, old, new = re.fullmatch(r'(\S+) changed: (.*?) => (.*)', text).groups()
        self.undo.append(self.shell.change(name, old, new))

    def _delegation(self, block):
        """'delegated' if readme_rules.py gives the block to another test."""
        for readme, pattern, test in DELEGATED:
            if readme == str(self.path) and block.kind != 'commands' and re.match(pattern, block.heading):
                self.used.add((readme, pattern, test))
                block.marks.append(('tested by', test))
                return 'delegated'
        return None

    def _delegated(self, block):
        test = ROOT / block.mark('tested by')
        if not test.is_file() or Path(self.path).name not in test.read_text():
            self._fail(block.start, f'{test} does not test this page')

    def _run(self, command, line, wanted):
        """Runs a command, or what readme_rules.py has in its place; keeps what it printed."""
        for row in INSTEAD:
            pattern, instead, _ = row
            plain = command.replace('build/carom', 'carom', 1)
            if re.match(pattern, plain):
                self.used.add(row)
                command = re.sub(pattern, instead, plain)
        words = command.split()
        if words[0] == 'OPTIONS':
            status, self.said = self._options(words[1:])
        elif words[0] == 'PRESET':
            status, self.said = self.shell.run('cmake --list-presets=configure && cmake --list-presets=build')
            status = status or int(self.said.count(f'"{words[1]}"') != 2)
        else:
            command = command.replace(' BUILD ', f' {self.shell.build} ')
            folder = self._folder(words)
            command = re.sub(r'^(make_\w+\.py)', r'python \1', command)
            command = re.sub(r'^(input/\S+\.py)', r'python \1', command)
            status, self.said = self.shell.run(command, folder)
        if status != wanted:
            self._fail(line, f'`{command}` ended with status {status}, not {wanted}:\n{self.said[-1500:]}')

    def _folder(self, words):
        """The folder of the page if the first file that a command names is found there only; else the top."""
        for word in words[:3]:
            if not word.startswith('-') and '/' not in word and (self.shell.folder / self.path.parent / word).is_file():
                return self.path.parent if not (self.shell.folder / word).is_file() else '.'
        return '.' if not words[1:] or not words[1].startswith('../../') else self.path.parent

    def _options(self, words):
        """A script that takes long: the options that the page gives it are those it has."""
        status, said = self.shell.run(f'python {words[0]} --help')
        missing = [word for word in words[1:] if word.strip('[]').startswith('-')
                   and word.strip('[]') not in said]
        return status or len(missing), said + ''.join(f'\nno option {word}' for word in missing)

    def _commands(self, block):
        commands = split_commands(block.lines)
        statuses = [int(word) for word in (block.mark('status') or '').split()]
        statuses = [0]*(len(commands) - len(statuses)) + statuses
        for (command, printed), wanted in zip(commands, statuses):
            self._run(command, block.start, wanted)
            self._compare(printed, block)

    def _printed(self, block):
        if block.mark('prints:') is not None:
            command = block.mark('prints:')
            self._run(command, block.start, int(block.mark('status') or 0))
        self._compare(block.lines, block)

    def _compare(self, printed, block):
        """The lines of the page stand in the same order in what the program said, without gaps but for …"""
        lines = [plain(line) for line in self.said.split('\n')]
        at, gap = 0, True
        for line in printed:
            if not line.strip():
                continue
            if line.strip() in ('…', '...'):
                gap = True
                continue
            pattern = re.compile('.*'.join(re.escape(part) for part in re.split('…', plain(line))) + '$')
            places = range(at, len(lines)) if gap else range(at, min(len(lines), at + 3))
            found = next((i for i in places if pattern.match(lines[i])), None)
            if found is None:
                self._fail(block.start, f'the page prints\n    {line}\nthe program printed\n{self.said[-3000:]}')
                return
            at, gap = found + 1, False

    def _python(self, block):
        status, self.said = self.shell.run_python('\n'.join(block.lines) + '\n')
        if status:
            self._fail(block.start, f'the Python example ended with status {status}:\n{self.said[-1500:]}')

    def _deck(self, block):
        """A whole deck runs; one without a step is at least sound."""
        deck = self.shell.folder / (block.mark('as') or 'page.inp')
        deck.write_text('\n'.join(block.lines) + '\n')
        self._run(f'carom run {deck.name} -o page.h5 --overwrite --quiet', block.start,
                  int(block.mark('status') or 0))

    def _cards(self, block):
        """A fragment goes before the first *STEP of a deck, or before *END STEP if it has cards of a step."""
        name = block.mark('cards for')
        text = (self.shell.folder / name).read_text()
        in_step = any(re.match(STEP_CARDS, line, re.I) for line in block.lines)
        place = re.search(r'^\*END STEP' if in_step else r'^\*STEP', text, re.M | re.I).start()
        deck = self.shell.folder / Path(name).parent / 'with_cards.inp'
        deck.write_text(text[:place] + '\n'.join(block.lines) + '\n' + text[place:])
        self._run(f'carom check {deck.relative_to(self.shell.folder)}', block.start,
                  int(block.mark('status') or 0))

    def _other(self, block):
        self._fail(block.start, 'this block is no command, deck, Python or output that the test knows; '
                   'say with a comment in front of it what it is (see tests/readme/readme_blocks.py):\n'
                   + '\n'.join(block.lines[:5]))


def plain(line):
    """A line with times, memory and shares replaced by #, and blanks made one."""
    if 'the run takes' in line:
        line = re.sub(r'(model|matrices|states|frames|contact|at most) [\d.]+', r'\1 #', line)
    return ' '.join(TIMES.sub('#', line).split())


def pages():
    """All Markdown files of the checkout; without git those where there are some."""
    names = []
    if shutil.which('git'):
        names = subprocess.run(['git', '-C', ROOT, 'ls-files', '*.md'], capture_output=True, text=True).stdout.split()
    names = names or [path.relative_to(ROOT) for path in ROOT.glob('**/*.md')
                                      if path.relative_to(ROOT).parts[0] in ('input', 'src', 'scripts', 'tests')
                                      or path.parent == ROOT]
    return sorted(map(Path, names))


def finds_mistakes(program, build):
    """A page of mistakes: each of its blocks must fail, and its table by two or more."""
    page = Page(Path('tests/readme/wrong_page.txt'), Shell(ROOT, program, build), set())
    try:
        page.check()
    finally:
        page.shell.close()
    wrong = sum(page.counts.values()) - page.counts['lines in a table']
    lines = {failure.split(': ')[0] for failure in page.failures}
    return wrong == 11 and len(lines) == wrong + 1 and len(page.failures) > wrong + 2


def main():
    """All pages, or those given; status 1 if anything failed."""
    program, build = (Path(word).resolve() for word in sys.argv[1:3])
    chosen = [Path(name) for name in sys.argv[3:]] or pages()
    used, failures = set(), []
    for path in chosen:
        shell = Shell(ROOT, program, build)
        try:
            page = Page(path, shell, used)
            page.check()
        finally:
            shell.close()
        failures += page.failures
        print(f'{path}: ' + (', '.join(f'{count} {kind}' for kind, count in page.counts.items()) or 'nothing to run'))
    if not sys.argv[3:]:
        failures += [f'readme_rules.py: nothing uses {row}' for row in INSTEAD + DELEGATED if row not in used]
        if not finds_mistakes(program, build):
            failures.append('the page of mistakes, tests/readme/wrong_page.txt, is not found wrong throughout')
    times = os.times()
    print(f'{times.user + times.system + times.children_user + times.children_system:.1f} s of processor time')
    if failures:
        sys.exit(f'{len(failures)} failed:\n' + '\n\n'.join(failures))


if __name__ == '__main__':
    main()
