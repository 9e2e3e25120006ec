"""Every allocate statement of src has a status, and the next statement looks at it."""
import re
import sys
from pathlib import Path


def unchecked(path):
    """Lines of allocate statements that nobody checks."""
    text = path.read_text()
    for found in re.finditer(r'^(.*\b|)allocate \((?:.*&\n)*.*\n(.*)\n', text, re.M):
        if found.group(1).lstrip().startswith('!'):
            continue
        statement, after = found.group(0), found.group(2)
        status = re.search(r'stat=(\w+)\)$', statement[:statement.rindex('\n', 0, -1)])
        if not status or not re.search(rf'(if |call check_allocation)\({status.group(1)}\b', after):
            yield text.count('\n', 0, found.start()) + 1


paths = sorted(Path(sys.argv[1]).rglob('*.f90'))
if not paths:
    print(f'error: there are no Fortran sources in {sys.argv[1]}', file=sys.stderr)
    sys.exit(2)
bad = [f'{path}:{line}: allocate without stat= and call check_allocation after it'
       for path in paths for line in unchecked(path)]
print('\n'.join(bad), end='\n' if bad else '')
sys.exit(1 if bad else 0)
