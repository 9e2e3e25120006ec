"""A square of plane elements as a deck of any size: what the scripts about memory share."""


def rectangle(n, kind, procedure, requests):
    """A square of n x n plane strain elements of 4 or 8 nodes, held at its left side."""
    step = 2 if kind == 'CPE8' else 1
    across = step * n + 1

    def node(i, j):
        return j * across + i + 1

    lines = ['*NODE']
    lines += [f'{node(i, j)}, {i / (step * n):.12g}, {j / (step * n):.12g}'
              for j in range(across) for i in range(across) if step == 1 or not (i % 2 and j % 2)]
    lines += [f'*ELEMENT, TYPE={kind}, ELSET=body']
    places = [(0, 0), (step, 0), (step, step), (0, step)]
    if step == 2:
        places += [(1, 0), (2, 1), (1, 2), (0, 1)]
    for e in range(n * n):
        i, j = step * (e % n), step * (e // n)
        nodes = ', '.join(str(node(i + a, j + b)) for a, b in places)
        lines.append(f'{e + 1}, {nodes}')
    lines += ['*NSET, NSET=left'] + [str(node(0, j)) for j in range(across)]
    lines += ['*MATERIAL, NAME=m', '*ELASTIC', '1, 0.3', '*DENSITY', '1',
              '*SOLID SECTION, ELSET=body, MATERIAL=m', '1', '*BOUNDARY', 'left, 1, 2',
              '*INITIAL CONDITIONS, TYPE=VELOCITY', f'{node(across - 1, 0)}, 1, 0.01',
              '*STEP', procedure, f'{0.4 / n}, {4.0 / n}', *requests, '*END STEP']
    return '\n'.join(lines) + '\n'
