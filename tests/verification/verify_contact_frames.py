"""Two frames that pound, against a run with a finer mesh and step: input/pounding_frame."""
import numpy as np

from carom_case import Checks
from contact_case import Folder

folder = Folder('pounding_frame', 'make_frames')
UNTIL = 1.5


def figures(contact, name):
    nodes = [key for key in contact.run.file['history'] if key.startswith('node_')]
    u = [contact.run[f'history/{key}/U1'] for key in nodes]
    early = contact.time <= UNTIL
    impulse = np.cumsum(contact.impulse)
    hits = contact.moments('impact')
    found = {'first': hits[0], 'before': impulse[early][-1], 'impulse': impulse[-1],
             'peaks': [np.abs(values[early]).max() for values in u]}
    print(f'        {name}: first blow at {found["first"]:.5f}, instants of impact {len(hits)}, impulse '
          f'until {UNTIL} {found["before"]:.4f}, in all {found["impulse"]:.4f}, largest displacements '
          + ' '.join(f'{1e3 * value:.4f}' for value in found['peaks'])
          + f' mm, smallest gap {contact.gap.min():.2g}, balance '
          f'{contact.balance / contact.energy.max():.2g}')
    return found


checks = Checks()
folder.check(checks)
coarse = folder.run('frames.inp')
fine = folder.run(folder.make.deck('fine', folder.make.mesh(2)), dt=2.5e-4)
one, two = figures(coarse, 'as committed'), figures(fine, 'fine')
checks.close(one['first'], two['first'], 2e-3, 'time of the first blow')
checks.close(one['before'] / two['before'], 1.0, 0.05, f'impulse until {UNTIL}')
checks.close(np.array(one['peaks']) / two['peaks'], np.ones(len(one['peaks'])), 0.02,
             'largest displacements')
checks.at_least(coarse.gap.min(), -1e-8 * 0.4, 'smallest gap')
checks.at_most(coarse.balance / coarse.energy.max(), 1e-9, 'balance of energy')
checks.finish()
