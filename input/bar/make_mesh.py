"""Writes bar_mesh.inc: a bar of truss elements along x (make_mesh.py [number of elements])."""
import sys
from pathlib import Path

LENGTH = 10.0


def main():
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    lines = ['** written by make_mesh.py', '*NODE, NSET=bar']
    lines += [f'{i + 1}, {i * LENGTH / n:.12g}, 0' for i in range(n + 1)]
    lines += ['*ELEMENT, TYPE=T2D2, ELSET=bar']
    lines += [f'{i}, {i}, {i + 1}' for i in range(1, n + 1)]
    lines += ['** the half next to the wall and the other one',
              '*ELSET, ELSET=near, GENERATE', f'1, {n // 2}',
              '*ELSET, ELSET=far, GENERATE', f'{n // 2 + 1}, {n}']
    path = Path(__file__).with_name('bar_mesh.inc')
    path.write_text('\n'.join(lines) + '\n')
    print(f'{path}: {n} elements')


if __name__ == '__main__':
    main()
