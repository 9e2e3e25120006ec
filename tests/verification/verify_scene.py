"""What a scene does not ask for costs nothing: counted by the counters of /cost, not by seconds."""
from carom_case import INPUT, Checks, run_deck

PHASES = ('read', 'build', 'factor', 'solve', 'elements', 'contact', 'output', 'other')
COUNTS = ('increments', 'iterations', 'solves', 'factorizations', 'element_updates',
          'energy_updates', 'stress_updates', 'contact_searches', 'contact_rows')


def cost_of(run):
    """The counters of a run by their names."""
    return {name: int(run[f'cost/{name}'][0]) for name in COUNTS}


def check_group(checks):
    """The group /cost is whole, and its phases add up."""
    run = run_deck(INPUT / 'sdof/sdof.inp')
    group = run.file['cost']
    names = COUNTS + ('cpu_seconds', 'elapsed_seconds') + tuple(f'seconds_{p}' for p in PHASES)
    checks.true(sorted(group) == sorted(names), '/cost has the datasets promised')
    checks.true(all(data.shape == (1,) and data.attrs['description'] for data in group.values()),
                'each has one element and a description')
    elapsed = group['elapsed_seconds'][0]
    checks.close(sum(group[f'seconds_{p}'][0] for p in PHASES), elapsed, 1e-9*max(1.0, elapsed),
                 'the phases add up to the seconds elapsed')
    checks.true(all(group[f'seconds_{p}'][0] >= -1e-9 for p in PHASES), 'no phase is negative')
    checks.true(cost_of(run)['increments'] == 500, 'increments are counted')


def main():
    """All checks."""
    checks = Checks()
    check_group(checks)
    checks.finish()


if __name__ == '__main__':
    main()
