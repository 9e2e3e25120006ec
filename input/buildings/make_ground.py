"""Writes ground.inc, a ground acceleration of 20 s, always the same: make_ground.py [seed]"""
import sys
from pathlib import Path

import numpy as np

STEP, END = 0.02, 20.0
PEAK = 0.35*9.81
FREQUENCIES = np.arange(0.4, 8.0, 0.15)      # Hz


def envelope(t):
    """Rises for 2 s, stays for 7 s, decays."""
    return np.where(t < 2, (t/2)**2, np.where(t < 9, 1.0, np.exp(-0.35*(t - 9))))


def spectrum(f, f_ground=1.6, damping=0.6):
    """Amplitudes of white noise filtered by a layer of soil (Kanai and Tajimi)."""
    r = f/f_ground
    return np.sqrt((1 + (2*damping*r)**2)/((1 - r**2)**2 + (2*damping*r)**2))


def record(seed):
    """Times and accelerations: sines of random phase under the envelope."""
    t = np.arange(0, END + STEP/2, STEP)
    phases = np.random.RandomState(seed).uniform(0, 2*np.pi, len(FREQUENCIES))
    angles = 2*np.pi*np.outer(FREQUENCIES, t) + phases[:, None]
    a = envelope(t)*(spectrum(FREQUENCIES) @ np.sin(angles))
    a -= a.mean()*envelope(t)/envelope(t).mean()
    return t, a*PEAK/np.abs(a).max()


def main():
    t, a = record(int(sys.argv[1]) if len(sys.argv) > 1 else 4)
    pairs = [f'{when:.2f}, {value:.6f}' for when, value in zip(t, a)]
    lines = ['** written by make_ground.py: acceleration in m/s2, largest 0.35 g',
             '*AMPLITUDE, NAME=ground']
    lines += [', '.join(pairs[i:i + 4]) for i in range(0, len(pairs), 4)]
    path = Path(__file__).with_name('ground.inc')
    path.write_text('\n'.join(lines) + '\n')
    top = np.abs(a).argmax()
    print(f'{path}: {len(pairs)} points, largest {abs(a[top]):.4f} at {t[top]:.2f}')


if __name__ == '__main__':
    main()
