"""A cantilever ten times as long as high, by the elements through its height: where its stiffness is
off that of the beam by more than a tenth, `carom check` warns with a figure that is the measured one,
and with the cure the warning goes."""
import re

from carom_case import Checks, run_deck
from solid_mesh import Mesh

checks = Checks()
YOUNG, POISSON, LENGTH = 1e6, 0.3, 10.0


def cantilever(kind, layers, slenderness=1.0, section='', held='LEFT, 1, 2'):
    """A deck: height 1, elements `slenderness` times as long as high, a force of 1 at the end."""
    mesh = Mesh(round(LENGTH*layers/slenderness), layers, int(kind[3]), lambda s, t: (LENGTH*s, t))
    x = mesh.x.tolist()
    left = [str(n + 1) for n, point in enumerate(x) if point[0] < 1e-9]
    right = [str(n + 1) for n, point in enumerate(x) if point[0] > LENGTH - 1e-9]
    return '\n'.join([
        '*NODE, NSET=ALL', *(f'{n + 1}, {a!r}, {b!r}' for n, (a, b) in enumerate(x)),
        f'*ELEMENT, TYPE={kind}, ELSET=B',
        *(f'{e + 1}, ' + ', '.join(str(n + 1) for n in nodes)
          for e, nodes in enumerate(mesh.elements.tolist())),
        f'*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {POISSON}\n*DENSITY\n1.',
        f'*SOLID SECTION, ELSET=B, MATERIAL=M{section}\n1.', '*NSET, NSET=LEFT', *left,
        f'*NSET, NSET=RIGHT\n{right[0]}', f'*BOUNDARY\n{held}', '*STEP\n*STATIC\n*CLOAD',
        *(f'{n}, 2, {1.0/len(right)!r}' for n in right),
        '*NODE PRINT, NSET=RIGHT\nU\n*END STEP\n'])


def stiffness(deck, kind):
    """Stiffness of the end by that of the beam, its shear counted."""
    run = run_deck(deck)
    name = next(iter(run.file['history']))
    modulus = YOUNG if kind.startswith('CPS') else YOUNG/(1.0 - POISSON**2)
    beam = 4.0*LENGTH**3/modulus + 1.2*LENGTH*2.0*(1.0 + POISSON)/YOUNG
    return beam/run[f'history/{name}/U2'][-1]


def warning(deck):
    """The warning on bending and its cure, nothing where there is none."""
    text = ' '.join(run_deck(deck, command='check').text.split())
    found = re.search(r'warning: \S+ (C\S+ (?:are|in one layer).*?bending.*)', text)
    return found.group(1) if found else ''


CASES = [(kind, layers, 1.0, section) for kind, section in (('CPS4', ''), ('CPE4', ''), ('CPS4R', ''),
                                                            ('CPE4R', ''), ('CPE4', ', BBAR=YES'))
         for layers in (1, 2, 3, 4)]
CASES += [('CPS4', 4, 4.0, ''), ('CPE4', 1, 0.5, ''), ('CPE4', 1, 0.5, ', BBAR=YES'),
          ('CPE4', 2, 2.0, ', BBAR=YES'), ('CPS8R', 1, 1.0, ''), ('CPS8', 1, 1.0, ''), ('CPS6', 1, 1.0, '')]
for kind, layers, slenderness, section in CASES:
    deck = cantilever(kind, layers, slenderness, section)
    ratio, said = stiffness(deck, kind), warning(deck)
    name = f'{kind}{section}, {layers} through the height, {slenderness} as long as high'
    print(f'{name}: stiffness {ratio:.3f} of the beam')
    if ratio < 0.1:
        checks.true('hourglass control only' in said and 'cure: ' in said, f'{name}: hourglasses')
    elif ratio > 1.1 or ratio < 1.0/1.1:
        way = 'stiff' if ratio > 1.0 else 'soft'
        excess = 100.0*(max(ratio, 1.0/ratio) - 1.0)
        figure = re.match(rf'C\S+ are about (\S+) % too {way} in bending, and the body of element 1, 10 '
                          rf'long and 1 thick, has at most {layers} of them .*cure: ', said)
        checks.true(figure, f'{name}: warned of, too {way}')
        if figure:
            checks.close(float(figure.group(1)), excess, 0.06*excess + 0.5, f'{name}: per cent too {way}')
    else:
        checks.true(not said, f'{name}: no warning')

checks.true('BBAR=YES on *SOLID SECTION, or mesh with CPE8R' in warning(cantilever('CPE4', 1)), 'cure of CPE4')
checks.true('BBAR' not in warning(cantilever('CPS4', 1)), 'cure of CPS4, which has no BBAR')
checks.true('four or more' in warning(cantilever('CPS4R', 2)), 'cure of CPS4R')
checks.true(not warning(cantilever('CPE4', 1, held='ALL, 2\nLEFT, 1')), 'what is held across its length '
            'does not bend')
checks.finish()
