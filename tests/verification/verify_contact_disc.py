"""A disc dropped on a rigid plane, two discs that collide: input/dropped_disc, input/two_discs."""
import numpy as np

from carom_case import Checks
from contact_case import Folder

dropped, pair = Folder('dropped_disc', 'make_disc'), Folder('two_discs', 'make_discs')


def duration(contact):
    """From the first to the last time in touch."""
    touched = contact.time[contact.size > 0]
    return touched[-1] - touched[0] + contact.step


def line(name, contact):
    print(f'        {name}: peak {contact.size.max():.4f} at {contact.time[contact.size.argmax()]:.3f}, '
          f'contact for {duration(contact):.4f}, impulse {contact.impulse.sum():.5f}, energy '
          f'{contact.energy[-1] / contact.energy[0]:.5f} (most '
          f'{contact.energy.max() / contact.energy[0]:.7f}), impacts {len(contact.moments("impact"))}, '
          f'most a step {contact.most_moments()}, smallest gap {contact.gap.min():.2g}')


def check_dropped(checks):
    """Against a mesh twice as fine at a quarter of the step: peak and duration within 3 %."""
    make = dropped.make
    fine = {nodes: dropped.run(make.deck('fine', make.mesh(nodes, 2)), dt=1e-3)
            for nodes in (4, 8)}
    runs = {name: dropped.run(f'{name}.inp') for name in ('q4', 'q8', 'q4_massless')}
    for nodes, contact in fine.items():
        line(f'fine, Q{nodes}', contact)
    for name, contact in runs.items():
        line(name, contact)
        reference = fine[8 if name.startswith('q8') else 4]
        checks.at_most(abs(contact.size.max() / reference.size.max() - 1), 3e-2,
                       f'{name}: peak force')
        checks.at_most(abs(duration(contact) / duration(reference) - 1), 3e-2, f'{name}: duration')
        checks.at_most(contact.most_moments(), 3, f'{name}: instants of impact in a step')
        checks.at_least(contact.gap.min(), -1e-8, f'{name}: smallest gap')
        checks.at_most(contact.energy.max() / contact.energy[0], 1 + 1e-9, f'{name}: largest energy')
        if name == 'q4_massless':     # its masses are not those of the mesh
            continue
        total = contact.momentum()[0][[0, -1]]
        checks.close(total[1] - total[0], [0, contact.impulse.sum()], 1e-9,
                     f'{name}: momentum gained is the impulse')
    return fine[4]


def check_fictitious(checks, reference):
    """Impulse within 2 %, peak within 10 %; the overlap left is that of the free step / (1 + alpha)."""
    contact = dropped.run('q4_fictitious.inp')
    line('fictitious force', contact)
    checks.at_most(abs(contact.impulse.sum() / reference.impulse.sum() - 1), 2e-2,
                   'fictitious force: impulse')
    checks.at_most(abs(contact.size.max() / reference.size.max() - 1), 0.1,
                   'fictitious force: peak force')


def check_equal(checks):
    """Two equal discs fly against each other: each moves as if there were a plane between them."""
    contact = pair.run('equal.inp', dt=4e-3, end=0.8)
    line('equal discs', contact)
    total, reference, current, size = contact.momentum()
    checks.at_most(np.abs(total - total[0]).max() / size, 1e-11, 'equal discs: drift of momentum')
    # the same on a plane: the disc of the left side, turned
    make = pair.make
    half = make.deck('half', make.mesh((4, 1.0), (4, 1.0)), (0.5, -0.5)).replace(
        'left_rim, right_rim', 'left_rim, plane')
    half = half.replace('*SURFACE INTERACTION', '*RIGID SURFACE, NAME=plane, TYPE=PLANE\n'
                        f'{1 + make.GAP / 2!r}, 0, 0\n-1, 0, 0\n*SURFACE INTERACTION', 1)
    on_plane = pair.run(half, dt=4e-3, end=0.8)
    line('one of them on a plane', on_plane)
    scale = on_plane.size.max()
    checks.close(contact.size / scale, on_plane.size / scale, 1e-2,
                 'equal discs: the force is that on a plane')


def check_oblique(checks):
    """Unequal discs, 8 on 4 nodes, nonmatching, with friction and without: linear momentum is kept;
    how far the angular one drifts, as a part of the sum of all momenta times length."""
    make = pair.make
    for rows, friction in ((make.SURFACES, ''), (make.SURFACES, make.FRICTION), ('', '')):
        drifts = []
        for speed in (1.0, 0.1):
            name = (f'oblique discs, {"weighted" if rows else "node"} rows'
                    + (', friction' if friction else '') + f', speed {speed}')
            deck = make.deck('oblique', '*INCLUDE, INPUT=oblique.inc\n', (speed, 0.0), (100, 200),
                             pair=rows, friction=friction)
            contact = pair.run(deck, end=0.8)
            line(name, contact)
            total, reference, current, size = contact.momentum()
            checks.at_most(np.abs(total - total[0]).max() / size, 1e-11, f'{name}: drift of momentum')
            checks.at_most(contact.energy[-1] / contact.energy[0], 1 + 1e-9, f'{name}: energy after')
            checks.at_most(contact.balance / contact.energy[0], 1e-4, f'{name}: balance of energy')
            checks.at_least(contact.gap.min(), -1e-6 if rows else -1e-8, f'{name}: smallest gap')
            drifts.append(np.abs(current - current[0]).max() / size)
            print(f'        {name}: angular momentum drifts by {drifts[-1]:.3g} about the current '
                  f'places, {np.abs(reference - reference[0]).max() / size:.3g} about the undeformed')


checks = Checks()
dropped.check(checks)
pair.check(checks)
reference = check_dropped(checks)
check_fictitious(checks, reference)
check_equal(checks)
check_oblique(checks)
checks.finish()
