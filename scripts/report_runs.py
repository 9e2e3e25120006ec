"""The runs behind report.py: decks with their changes, computed two at a time, and their results.

    case = Case("sdof_quarter", "input/sdof/sdof.inp", {"IMPACT": {"BETA": "1/4"}}, dt=0.04)
    runs = Runs("build/carom", "report", jobs=2)
    runs.compute([case])
    runs[case]["history/node_1/U1"]
"""

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from carom_deck import Deck, number_text, run_deck
from carom_results import Result
from carom_script import ScriptError

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 300.0       # seconds that a run may take


class Case:
    """A deck of the checkout, changed parameters of its cards, changed data lines, and definitions.

    changes: {keyword: {parameter: value, None takes it away}}; lines: {keyword: first data line};
    every: only each such row of the tables is recorded, and no fields.
    """

    def __init__(self, name, deck, changes=None, lines=None, every=None, **define):
        self.name, self.deck, self.define = name, deck, define
        self.changes, self.lines, self.every = changes or {}, lines or {}, every

    @property
    def changed(self):
        """Whether a deck of its own has to be written."""
        return bool(self.changes or self.lines or self.every)

    def edited(self):
        """The deck with its changes."""
        deck = Deck.read(ROOT / self.deck)
        for keyword, parameters in self.changes.items():
            deck.set(keyword, **parameters)
        for keyword, line in self.lines.items():
            for card in deck.cards(keyword):
                card.set_data(0, line)
        if self.every:
            deck.thin_output(frames=0, prints=self.every)
        return deck

    def words(self):
        """The changes in words."""
        said = []
        for keyword, parameters in self.changes.items():
            pairs = [f"without {name.replace('_', ' ')}" if value is None else f"{name}={value}"
                     for name, value in parameters.items()]
            said.append(f"*{keyword}: " + ", ".join(pairs))
        said += [f"*{keyword}: {line}" for keyword, line in self.lines.items()]
        return "; ".join(said)

    def command(self, folder):
        """How to run it again, from the top of the checkout; written decks are in the folder."""
        deck = f"{folder}/decks/{self.name}.inp" if self.changed else self.deck
        defined = [f"--define {name}={number_text(value)}" for name, value in self.define.items()]
        return " ".join(["build/carom run", deck, f"-o {self.name}.h5", *defined])


class Run:
    """What a finished run left; arrays by name."""

    def __init__(self, done):
        self.done, self.costs, self.results = done, done.costs, Result(done.result)

    def __getitem__(self, name):
        return self.results.array(name)

    def events(self, kind="impact"):
        """The rows of /events of one kind."""
        return self.results.events.filter(kind=kind)


class Runs:
    """All runs of a report: what ended badly is kept as its message."""

    def __init__(self, carom, folder, jobs=2):
        self.carom, self.folder, self.jobs = carom, Path(folder), jobs
        self.cases, self.found, self.failed = {}, {}, {}
        for name in ("decks", "runs"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)

    def compute(self, cases):
        """Computes the cases that have not been computed yet, as many at a time as there are jobs."""
        for case in cases:
            known = self.cases.setdefault(case.name, case)
            if vars(known) != vars(case):
                raise ScriptError(f"two different cases are named '{case.name}'")
        waiting = [case for name, case in self.cases.items()
                   if name not in self.found and name not in self.failed]
        with ThreadPoolExecutor(self.jobs) as pool:
            list(pool.map(self._compute, waiting))

    def _compute(self, case):
        try:
            deck = ROOT / case.deck
            if case.changed:
                deck = self.folder / "decks" / f"{case.name}.inp"
                case.edited().write(deck)
            result = self.folder / "runs" / f"{case.name}.h5"
            done = run_deck(self.carom, deck, result, case.define, limit=LIMIT)
            if not done.good:
                why = "took too long" if done.late else f"ended with status {done.status}"
                raise ScriptError(f"{case.name} {why}: {done.last_line}\n{done.messages}".strip())
            self.found[case.name] = Run(done)
        except ScriptError as error:
            self.failed[case.name] = str(error)

    def __getitem__(self, case):
        if case.name in self.failed:
            raise ScriptError(self.failed[case.name])
        return self.found[case.name]

    def seconds(self):
        """What all runs took together, one after another."""
        return sum(run.done.seconds for run in self.found.values())

    def close(self, keep=False):
        """Closes all result files, and removes them unless they are to be kept."""
        for run in self.found.values():
            run.results.close()
        if not keep:
            shutil.rmtree(self.folder / "runs")
