"""SCHEME=AUTO: a fine patch in a coarse strip becomes implicit alone, and the motion is right."""
import numpy as np

from carom_case import Checks, run_deck

E, RHO, NU = 900.0, 1.0, 0.0
# a smooth pulse: no kink that one scheme takes otherwise than the other
PULSE = [f'{t:.6g}, {np.sin(np.pi * t / 0.4)**2:.12g}' for t in np.linspace(0, 0.4, 401)]


def strip(lengths, scheme, dt, steps, extra=''):
    """A strip of CPS4 elements of the given lengths, height 0.5, pulled at its right end."""
    x = np.concatenate([[0.0], np.cumsum(lengths)])
    n = len(x)
    lines = ['*NODE']
    lines += [f'{i + 1}, {a:.12g}, 0' for i, a in enumerate(x)]
    lines += [f'{n + i + 1}, {a:.12g}, 0.5' for i, a in enumerate(x)]
    lines += ['*ELEMENT, TYPE=CPS4, ELSET=body']
    lines += [f'{i + 1}, {i + 1}, {i + 2}, {n + i + 2}, {n + i + 1}' for i in range(n - 1)]
    lines += ['*MATERIAL, NAME=m', '*ELASTIC', f'{E}, {NU}', '*DENSITY', f'{RHO}',
              '*SOLID SECTION, ELSET=body, MATERIAL=m', '1']
    if scheme:
        lines += [f'*ELEMENT GROUP, ELSET=body, SCHEME={scheme}' + extra]
    lines += ['*NSET, NSET=all, GENERATE', f'1, {2 * n}', '*BOUNDARY', f'1, 1\n{n + 1}, 1',
              'all, 2, 2', '*AMPLITUDE, NAME=pulse', *PULSE, '*STEP',
              '*DYNAMIC, DIRECT', f'{dt:.12g}, {steps * dt:.12g}',
              '*CLOAD, AMPLITUDE=pulse', f'{n}, 1, 3\n{2 * n}, 1, 3',
              '*NODE PRINT', 'U', '*ENERGY PRINT', '*END STEP']
    return '\n'.join(lines) + '\n', n


def own_limit(length, height=0.5):
    """Critical step of one CPS4 rectangle on its lumped mass, by numpy."""
    g = 1.0 / np.sqrt(3.0)
    d = E / (1.0 - NU**2) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
    xi = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    k = np.zeros((8, 8))
    for a in (-g, g):
        for b in (-g, g):
            dx = xi[:, 0] * (1 + xi[:, 1] * b) / 4 * 2 / length
            dy = xi[:, 1] * (1 + xi[:, 0] * a) / 4 * 2 / height
            m = np.zeros((3, 8))
            m[0, ::2], m[1, 1::2], m[2, ::2], m[2, 1::2] = dx, dy, dy, dx
            k += m.T @ d @ m * length * height / 4
    return 2.0 / np.sqrt(np.linalg.eigvalsh(k)[-1] / (RHO * length * height / 4))


checks = Checks()
lengths = [0.5] * 20 + [0.05] * 6 + [0.5] * 20
coarse, fine = own_limit(0.5), own_limit(0.05)
dt = 0.5 * coarse
assert fine < dt < 0.95 * coarse
deck, n = strip(lengths, 'AUTO', dt, 400)
text = run_deck(deck, command='check').text
checks.true('40 of 46 elements explicit, 6 implicit' in text,
            'AUTO takes exactly the six fine elements as implicit')
checks.true('instead of' in text, 'check prints what AUTO saves')
run = run_deck(deck)
profile, implicit = run['model/profile'], run['model/implicit']
checks.close(int(implicit.sum()), 2 * 7, 0, 'equations that implicit elements touch')
checks.at_most(float(profile[implicit == 0].max()), 1.0, 'height of the explicit columns')
for factor, explicit in ((0.94, 46), (0.96, 6)):
    # all elements fine or coarse at a step just below and above the margin of the coarse ones
    text = run_deck(strip([0.5] * 46, 'AUTO', factor * coarse, 10)[0], command='check').text
    checks.true(f'{46 if factor < 0.95 else 0} of 46 elements explicit' in text,
                f'at {factor} of their critical step coarse elements are '
                + ('explicit' if factor < 0.95 else 'implicit'))
errors = []
for h in (dt, dt / 2, dt / 4):
    steps = int(round(400 * dt / h))
    # the partition of the largest step, so that the schemes compared stay the same
    mixed = run_deck(strip(lengths, 'AUTO', h, steps)[0])
    full = run_deck(strip(lengths, 'IMPLICIT', h, steps, ', MASS=LUMPED')[0])
    name = f'history/node_{n}/U1'
    errors.append(np.sqrt(np.mean((mixed[name] - full[name])**2))
                  / np.sqrt(np.mean(full[name]**2)))
    balance = np.max(np.abs(mixed['energy/balance_error'])) / np.max(mixed['energy/total'])
    checks.at_most(balance, 2e-3, f'h = {h:.4g}: energy balance error of the mixed run')
checks.at_most(errors[-1], 2e-3, 'mixed against implicit at the smallest step')
order = np.log2(errors[0] / errors[-1]) / 2
checks.at_least(order, 1.9, f'order of the difference to the implicit run {np.array(errors)}')
bad = run_deck(strip(lengths, 'AUTO', dt, 10)[0].replace('*DYNAMIC, DIRECT', '*STATIC'),
               command='check', expect_status=2)
checks.true('SCHEME=AUTO chooses by the step' in bad.text, 'AUTO without a dynamic step is an error')
checks.finish()
