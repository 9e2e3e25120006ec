"""Small decks of all features: those of `input/`, shorter, some with other parameters."""
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'scripts'))
from carom_deck import Deck   # noqa: E402  (from scripts)

# Feature, deck, length of the step, parameters of cards that are changed or taken away (None)
FEATURES = [
    ('transformation', 'sdof/sdof', 4.0, {}),
    ('fictitious force', 'sdof/sdof_fictitious', 1.0, {}),
    ('fictitious force, solved', 'sdof/sdof_fictitious', 1.0, {'IMPACT': {'SOLUTION': 'DIRECT', 'RETURN': None}}),
    ('tolerance', 'two_dof/two_dof', 2.0, {'DYNAMIC': {'DIRECT': None, 'TOLERANCE': 0.01}}),
    ('fourth order', 'two_dof/two_dof', 3.0, {'DYNAMIC': {'ORDER': 4}, 'IMPACT': {'BETA': None}}),
    ('anchored impacts', 'two_dof/two_dof', 3.0, {'IMPACT': {'EVENTS': 'ANCHOR', 'BETA': None}}),
    ('penalty', 'sdof/sdof', 2.0, {'IMPACT': {'METHOD': 'PENALTY', 'STIFFNESS': 100, 'RESTITUTION': None, 'BETA': None}}),
    ('Lagrange', 'sdof/sdof', 2.0, {'IMPACT': {'METHOD': 'LAGRANGE', 'RESTITUTION': None, 'BETA': None}}),
    ('gaps between masses', 'cradle/cradle', 1.5, {}),
    ('amplitudes and equations', 'buildings/buildings', 2.0, {}),
    ('sustained contact', 'bar/bar_implicit', 0.3, {}),
    ('explicit', 'bar/bar_explicit', 0.1, {}),
    ('implicit and explicit', 'bar/bar_mixed', 0.1, {}),
    ('friction', 'oblique_ball/elastic', 0.1, {}),
    ('redistributed mass', 'dropped_disc/q4_massless', 0.06, {}),
    ('sparse solver', 'dropped_disc/q8', 0.02, {'DYNAMIC': {'SOLVER': 'MUMPS'}}),
    ('two passes', 'two_discs/oblique', 0.012, {'CONTACTPAIR': {'PASSES': 2}}),
    ('averaged gaps', 'pounding_frame/frames', 0.006, {}),
    ('contact at rest', 'hertz/disc_on_plane', None, {}),
    ('adjusted overlap', 'hertz/nonmatching', None, {}),
    ('plasticity', 'thick_cylinder/plastic_cax4', None, {}),
    ('modes', 'cantilever/modes', None, {}),
]


def write_decks(folder):
    """Writes the deck of every feature into a folder; pairs of feature and path."""
    written = []
    for feature, name, end, changes in FEATURES:
        deck = Deck.read(ROOT / 'input' / f'{name}.inp')
        if end:
            deck.set_time_step(deck.time_step()[0], end)
        for keyword, values in changes.items():
            deck.set(keyword, **values)
        path = Path(folder) / f'{feature.replace(" ", "_").replace(",", "")}.inp'
        deck.write(path)
        written.append((feature, path))
    return written
