"""Two frames that pound, against a run with a finer mesh and step: input/pounding_frame."""
import numpy as np

from carom_case import Checks
from contact_case import Folder

folder = Folder('pounding_frame', 'make_frames')
TIMES = (0.4, 0.65)


def figures(contact, name):
    x = contact.run['VTKHDF/Points'][:, 0]
    ids = contact.run['model/node_id'].tolist()
    peaks = {}
    for key in contact.run.file['history']:
        if key.startswith('node_'):
            side = 'left' if x[ids.index(int(key[5:]))] < 0 else 'right'
            peaks[side] = np.abs(contact.run[f'history/{key}/U1']).max()
    impulse = np.cumsum(np.abs(contact.impulse))
    found = {'first': contact.moments('impact')[0], 'peaks': [peaks['left'], peaks['right']],
             'impulses': [impulse[contact.time <= t + 1e-9][-1] for t in TIMES]}
    print(f'        {name}: first blow at {found["first"]:.5f}, instants of impact '
          f'{len(contact.moments("impact"))}, impulses until {TIMES}: '
          + ' '.join(f'{value:.3f}' for value in found['impulses']) + ', largest displacements '
          + ' '.join(f'{1e3 * value:.3f}' for value in found['peaks'])
          + f' mm, smallest gap {contact.gap.min():.2g}, balance '
          f'{contact.balance / contact.energy.max():.2g}')
    return found


checks = Checks()
folder.check(checks)
coarse = folder.run('frames.inp', end=0.65)
fine = folder.run(folder.make.deck('fine', folder.make.mesh(3)), dt=5e-4, end=0.65)
one, two = figures(coarse, 'as committed'), figures(fine, 'fine')
checks.close(one['first'], two['first'], 2e-3, 'time of the first blow')
checks.close(np.array(one['impulses']) / two['impulses'], np.ones(len(TIMES)), 0.03, 'impulses')
checks.close(np.array(one['peaks']) / two['peaks'], np.ones(2), 0.03, 'largest displacements')
checks.at_least(coarse.gap.min(), -1e-8 * 0.4, 'smallest gap')
# the floors slide on each other: rows turn within a step
checks.at_most(coarse.balance / coarse.energy.max(), 1e-4, 'balance of energy')
checks.finish()
