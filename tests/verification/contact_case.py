"""Bodies in contact: decks of input/ and their variants, figures of a run, momentum."""
import importlib.util
import sys

import numpy as np

from carom_case import INPUT, ROOT, run_deck
from solid_mesh import kept, rule, shapes

sys.path.insert(0, str(ROOT / 'scripts'))
CORNERS = {5: 3, 9: 4, 22: 6, 23: 8}     # VTK types: nodes


class Folder:
    """A folder of input/ with the script that makes its decks."""

    def __init__(self, name, script):
        self.path = INPUT / name
        spec = importlib.util.spec_from_file_location(script, self.path / f'{script}.py')
        self.make = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.make)

    def check(self, checks):
        """The files are what the script makes."""
        for name, text in self.make.texts().items():
            kept(checks, self.path / name, text)

    def run(self, deck, **definitions):
        """Runs one of its decks, or the text of one that includes its meshes."""
        if '\n' not in deck:
            return Contact(run_deck(self.path / deck, **definitions))
        return Contact(run_deck(deck.replace('INPUT=', f'INPUT={self.path}/'), **definitions))


class Contact:
    """The figures of a run with one contact pair."""

    def __init__(self, run):
        self.run = run
        self.time = run['history/time']
        pairs = [name for name in run.file['history'] if name.startswith('contact_')]
        self.pair = pairs[0]
        self.force = np.stack([run[f'history/{self.pair}/CF{i}'] for i in (1, 2)], axis=1)
        self.size = np.hypot(*self.force.T)
        self.gap = run[f'history/{self.pair}/CDIS']
        self.impulse = run[f'history/{self.pair}/impulse']
        self.energy = run['energy/total']
        self.balance = np.abs(run['energy/balance_error']).max()
        self.step = self.time[1] - self.time[0] if len(self.time) > 1 else 0.0

    def moments(self, kind):
        """The instants of events of a kind, each once."""
        times = np.sort(self.run.events(kind)['time'])
        return times[np.append(True, np.diff(times) > 1e-6 * self.step)] if times.size else times

    def most_moments(self):
        """The largest number of instants with an impact in one step."""
        steps = np.floor(self.moments('impact') / self.step - 1e-9)
        return np.unique(steps, return_counts=True)[1].max() if steps.size else 0

    def last(self, part=0.0):
        """The last time with a force above a part of the largest."""
        return self.time[self.size > part * self.size.max()][-1]

    def frames(self, name):
        """A field of all frames (frames, points, components)."""
        data = self.run[f'VTKHDF/PointData/{name}']
        n = len(self.run['VTKHDF/Points'])
        return data.reshape(-1, n, *data.shape[1:])

    def log(self):
        return self.run.path.with_suffix('.log').read_text()

    def masses(self, density=1.0, lumped=True):
        """What the velocity of each point counts in the momentum: the sums of the rows of the mass
        matrix, of lumped 8-node elements its diagonal made as large."""
        points = self.run['VTKHDF/Points'][:, :2]
        mass = np.zeros(len(points))
        connectivity, offsets = (self.run[f'VTKHDF/{name}'] for name in ('Connectivity', 'Offsets'))
        for kind, first in zip(self.run['VTKHDF/Types'], offsets):
            nodes = CORNERS[int(kind)]
            ring = connectivity[first:first + nodes]
            area, diagonal, rows = 0.0, np.zeros(nodes), np.zeros(nodes)
            for xi, weight in rule(nodes, 3):
                values, slopes = shapes(nodes, xi)
                part = weight * np.linalg.det(slopes @ points[ring])
                area += part
                diagonal += part * values**2
                rows += part * values
            by_diagonal = lumped and nodes in (6, 8)
            mass[ring] += density * (area * diagonal / diagonal.sum() if by_diagonal else rows)
        return mass

    def momentum(self, density=1.0, lumped=True):
        """Linear (frames, 2) and angular momentum (frames), the latter about the places of the
        undeformed bodies and about the current ones; and the sum of the sizes of all parts."""
        if density is None:           # contact nodes without mass: as the program says
            mass = self.run['model/mass'][:, 0]
        else:
            mass = self.masses(density, lumped)
        x = self.run['VTKHDF/Points'][:, :2]
        u, v = self.frames('U')[..., :2], self.frames('V')[..., :2]
        p = mass[:, None] * v
        now = x + u
        reference = (x[:, 0] * p[..., 1] - x[:, 1] * p[..., 0]).sum(axis=1)
        current = (now[..., 0] * p[..., 1] - now[..., 1] * p[..., 0]).sum(axis=1)
        return p.sum(axis=1), reference, current, np.abs(p[0]).sum()


def with_impact(text, card, pair=''):
    """A deck with another *IMPACT card and more on its pair."""
    old = next(line for line in text.splitlines() if line.startswith('*IMPACT'))
    text = text.replace(old, card)
    return text.replace('*CONTACT PAIR, INTERACTION=', '*CONTACT PAIR' + pair + ', INTERACTION=')
