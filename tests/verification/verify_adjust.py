"""ADJUST, and the error of nodes that overlap at the start.

Slave nodes are brought onto their masters, straight, curved and rigid, without strain; the run then begins in
touch; elements stay sound or are refused; weighted rows and second passes take what is left as zero.
"""
import numpy as np

from carom_case import Checks, run_deck
from plane_bodies import Deck, block, frames, positions, ring


def stacked(nodes=4, overlap=0.03, options='ADJUST', shift=0.0, on_top=5):
    """A block on a fixed block, too low; a speed upward keeps both free of force."""
    deck = Deck()
    deck.body('low', block(4, 2, nodes, (0.0, 0.0), (2.0, 1.0))).fix('low')
    deck.body('top', block(on_top, 2, nodes, (shift, 1.0 - overlap), (shift + 2.0, 2.0)))
    deck.surface('FLOOR', ('low', 3)).surface('SOLE', ('top', 1))
    return deck.pair('SOLE', 'FLOOR', options)


def check_blocks(checks):
    for nodes in (4, 8):
        run = run_deck(stacked(nodes).text(0.01, 0.1))
        name = f'block of {nodes}-node elements'
        x, log = positions(run), run.path.with_suffix('.log').read_text()
        n = 6 if nodes == 4 else 11
        checks.true(f'moved {n} nodes, by at most 0.03' in log, f'{name}: the log says what moved')
        y = x[-len(block(5, 2, nodes, (0, 0), (1, 1)).x):, 1]
        checks.close(np.sort(y)[:n], np.ones(n), 1e-14, f'{name}: sole')
        checks.close(run['energy/strain'], 0.0 * run['energy/strain'], 1e-20, f'{name}: strain energy')
        checks.close(frames(run, 'U'), 0.0 * frames(run, 'U'), 1e-13, f'{name}: stays where it is')
        if nodes == 8:
            mid = np.sort(y)[n:n + 6]
            checks.close(mid, np.full(6, 0.5 * (1.0 + 0.97 + 1.03 / 2)), 1e-12, f'{name}: middle nodes amid')
    run = run_deck(stacked(overlap=-0.02).text(0.01, 0.1))
    checks.true('found nothing to move' in run.path.with_suffix('.log').read_text(), 'an open gap stays')
    run = run_deck(stacked(overlap=-0.02, options='ADJUST=0.03').text(0.01, 0.1))
    checks.true('moved 6 nodes, by at most 0.02' in run.path.with_suffix('.log').read_text(),
                'ADJUST=0.03 closes a gap of 0.02')


def check_errors(checks):
    run = run_deck(stacked(options='').text(0.01, 0.1), expect_status=2)
    checks.true('6 nodes of SOLE-FLOOR overlap at the start, the worst of them: node 16 by 0.03, node 17 by' in run.text
                and run.text.count('by 0.03') == 5, 'overlap: ' + run.text.splitlines()[0])
    checks.true('ADJUST' in run.text and 'SOLE, FLOOR' in run.text, 'overlap: the cure and the pair')
    # an overlap of round-off is none, however small the gaps are beside the bodies
    for overlap in (1e-12, 1e-15):
        run_deck(stacked(overlap=overlap, options='').text(0.01, 0.1))
    checks.true(True, 'an overlap of round-off is none')
    # an element that ADJUST folds: a flat one at the bottom
    deck = Deck()
    deck.body('low', block(2, 1, 4, (0.0, 0.0), (2.0, 1.0))).fix('low')
    deck.body('top', block(1, 8, 4, (0.5, 0.7), (1.5, 1.5)))
    deck.surface('FLOOR', ('low', 3)).surface('SOLE', ('top', 1)).pair('SOLE', 'FLOOR', 'ADJUST')
    run = run_deck(deck.text(0.01, 0.1), expect_status=2)
    checks.true('ADJUST' in run.text and 'element' in run.text, 'a folded element: ' + run.text.splitlines()[0])


def check_rigid(checks):
    deck = Deck()
    deck.add('*RIGID SURFACE, NAME=WALL, TYPE=PLANE\n0., 0.\n-0.6, 0.8')
    deck.body('top', block(3, 2, 4, (-1.0, 0.6875), (1.0, 1.6875)))
    deck.surface('SOLE', ('top', 1)).pair('SOLE', 'WALL', 'ADJUST')
    run = run_deck(deck.text(0.01, 0.1))
    sole = positions(run)[:4]
    gap = sole[:, :2] @ [-0.6, 0.8]
    checks.close(gap, np.array([1.15, 0.75, 0.35, 0.0]), 1e-14, 'slanted plane: gaps')
    for radius in (2.0, -2.0):
        deck = Deck()
        deck.add(f'*RIGID SURFACE, NAME=DISC, TYPE=CIRCLE\n0.3, 0.2\n{radius!r}')
        y = 2.15 if radius > 0.0 else -1.75
        deck.body('top', block(6, 2, 8, (-0.3, y), (0.9, y + 1.0)))
        deck.surface('SOLE', ('top', 1)).pair('SOLE', 'DISC', 'ADJUST')
        run = run_deck(deck.text(0.01, 0.1))
        sole = positions(run)[:13, :2] - (0.3, 0.2)
        gap = np.sign(radius) * (np.hypot(*sole.T) - 2.0)
        checks.at_least(np.min(gap), -1e-14, f'circle of radius {radius}: smallest gap')
        checks.at_least(np.sum(np.abs(gap) < 1e-14), 3, f'circle of radius {radius}: nodes on it')
        checks.close(run['energy/strain'], 0.0 * run['energy/strain'], 1e-20, f'circle of radius {radius}: strain energy')


def bush(options, nodes=(8, 8), counts=(24, 16), bodies='RIM-BORE', rim=1.0):
    """A ring in a ring, the inner one's sides cut the outer one's."""
    deck = Deck()
    deck.body('out', ring(counts[0], 1, nodes[0], 1.0, 1.5)).fix('out')
    deck.body('in', ring(counts[1], 1, nodes[1], 0.5, rim))
    deck.surface('BORE', ('out', 1)).surface('RIM', ('in', 3))
    return deck.pair(*bodies.split('-'), options)


def check_curved(checks):
    for nodes in ((4, 4), (8, 8), (8, 4)):
        run = run_deck(bush('ADJUST', nodes).text(0.01, 0.1, every=10))
        name = f'ring in ring, {nodes[1]} in {nodes[0]} nodes'
        checks.at_least(np.min(run['history/contact_RIM-BORE/CDIS']), -1e-13, f'{name}: smallest gap')
        checks.close(run['energy/total'], 0.0 * run['energy/total'], 1e-20, f'{name}: energy')
        for options, counts in (('TYPE=SURFACE TO SURFACE', (16, 24)), ('PASSES=2', (24, 16))):
            if nodes != (8, 4):
                check_allowance(checks, f'{name}, {options}', options, nodes, counts)


def check_allowance(checks, name, options, nodes, counts):
    """What nodal positions cannot close counts as zero: nothing moves, and a push is met at once."""
    bodies = 'BORE-RIM' if options == 'PASSES=2' else 'RIM-BORE'
    run_deck(bush(options, nodes, counts, bodies, 1.02).text(0.01, 0.1), expect_status=2)
    deck = bush('ADJUST, ' + options, nodes, counts, bodies)
    run = run_deck(deck.text(0.01, 0.1, every=10))
    log = run.path.with_suffix('.log').read_text()
    checks.true('at the start as zero' in log, f'{name}: the log says what counts as zero')
    checks.close(run['energy/total'], 0.0 * run['energy/total'], 1e-20, f'{name}: energy')
    bore = deck.mesh['in'].at(t=0)
    held = ''.join(f'{deck.node("in", k)}, 1\n{deck.node("in", k)}, 2, 2, -1e-4\n' for k in bore)
    text = deck.text(1.0, 1.0, cards='*BOUNDARY\n' + held).replace('*DYNAMIC, DIRECT', '*STATIC')
    run = run_deck(text)
    force = run[f'history/contact_{bodies}/CF2'][-1]
    checks.at_least(abs(force), 0.01, f'{name}: pushed, the bush answers')
    # where a vertex meets a vertex the total follows the edge that round-off picks, the nodes do not
    first = deck.node('in') - 1
    on_bush = frames(run, 'CF')[-1][first:first + len(deck.mesh['in'].x)].sum(axis=0)
    checks.at_most(abs(on_bush[0]), 1e-9 * abs(force), f'{name}: side force on the bush')
    checks.close(abs(on_bush[1]), abs(force), 1e-9 * abs(force), f'{name}: the total is that of the nodes')
    checks.at_most(abs(run[f'history/contact_{bodies}/CF1'][-1]), 1e-4 * abs(force), f'{name}: side force')
    checks.at_least(np.min(run[f'history/contact_{bodies}/CDIS'][-1]), -1e-12, f'{name}: smallest gap')


def check_allowance_in_motion(checks):
    """Weighted rows whose gap of 0.02 counts as none are closed when the block comes, however slowly."""
    deck = stacked(overlap=-0.02, options='TYPE=SURFACE TO SURFACE, ADJUST=0.03').speed('top', 0.0, -0.1)
    run = run_deck(deck.text(0.001, 0.01))
    gap = run['history/contact_SOLE-FLOOR/CDIS']
    checks.at_most(np.abs(gap).max(), 1e-12, 'a gap that counts as none is closed from the first step on')


def check_corner(checks):
    """A node in the corner of two walls is moved onto both, whatever their angle."""
    for angle in (90.0, 60.0, 120.0):
        n = np.array([np.sin(np.radians(angle)), -np.cos(np.radians(angle))])
        deck = Deck().point('ball', (0.49, 0.23))
        deck.add('*RIGID SURFACE, NAME=FLOOR, TYPE=PLANE\n0.5, 0.25\n0., 1.')
        deck.add(f'*RIGID SURFACE, NAME=WALL, TYPE=PLANE\n0.5, 0.25\n{float(n[0])!r}, {float(n[1])!r}')
        deck.pair('ball_S', 'FLOOR', 'ADJUST').pair('ball_S', 'WALL', 'ADJUST')
        run = run_deck(deck.text(0.01, 0.1))
        gaps = (positions(run)[0, :2] - (0.5, 0.25)) @ np.array([[0.0, n[0]], [1.0, n[1]]])
        checks.at_least(np.min(gaps), -1e-15, f'corner of {angle} degrees: smallest gap')


checks = Checks()
check_blocks(checks)
check_errors(checks)
check_rigid(checks)
check_curved(checks)
check_allowance_in_motion(checks)
check_corner(checks)
checks.finish()
