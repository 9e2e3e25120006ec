"""scripts/bench.py on small sizes: every key is there and its figure makes sense. Times are not
judged: other tests run beside this one."""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEYS = ('factor_100_ratio_dgemm_1t factor_200_ratio_dgemm_1t factor_2t_speedup '
        'solve_ratio_bandwidth_1t explicit_q4_updates_1t explicit_2t_speedup block_step_ms '
        'sdof_process_ms event_solves memory_ratio parse_mb_s peers').split()
# Of sizes that are not small, or of what this build or machine may lack: may be null
OPEN = ('factor_100_ratio_dgemm_1t', 'factor_200_ratio_dgemm_1t', 'factor_2t_speedup',
        'explicit_2t_speedup', 'event_solves')
# Within which figures must lie whatever the machine does
BOUNDS = {
    'sdof_error': (0.0, 1e-2), 'solution_29_error': (0.0, 1e-10), 'memory_ratio': (1.0, 2.0),
    'block_substep_balance_error': (0.0, 1e-9), 'exponent_skyline_memory': (1.3, 1.7),
}


def main():
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, '-B', ROOT / 'scripts/bench.py', '--build', sys.argv[1], '--output',
                   folder, '--quick', '--sizes', 'small', '--no-peers']
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f'FAILED: bench.py\n{done.stdout}{done.stderr}')
        report = json.loads((Path(folder) / 'bench.json').read_text())
        if not (Path(folder) / 'bench.png').is_file():
            failures.append('no bench.png')
    for key in KEYS:
        if key not in report:
            failures.append(f'no key {key}')
        elif report[key] is None and key not in OPEN:
            failures.append(f'{key} is null: {report["reasons"].get(key)}')
    for key, value in report.items():
        if isinstance(value, float) and not math.isfinite(value):
            failures.append(f'{key} is {value}')
    for key, (low, high) in BOUNDS.items():
        value = report.get(key)
        if value is None or not low <= value <= high:
            failures.append(f'{key} is {value}, not within {low:g} and {high:g}')
    print(done.stdout)
    for failure in failures:
        print('FAILED:', failure)
    sys.exit(bool(failures))


main()
