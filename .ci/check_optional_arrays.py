"""No optional assumed-shape argument is passed on where it may be absent: gfortran then computes with
the strides of a descriptor that is not there, which a sanitizer reports when they happen to overflow."""
import re
import sys
from pathlib import Path

START = re.compile(r'^ *(?:(?:pure|elemental|recursive|module) )*(?:subroutine|function|\w+(?:\([^)]*\))? function) \w+')


def passed_on(path):
    """Lines that pass an optional array on outside `if (present(...))`."""
    optional, guards = set(), []
    for number, line in enumerate(path.read_text().split('\n'), 1):
        code = line.split('!')[0].rstrip()
        if START.match(code):
            optional, guards = set(), []
        if re.search(r'\boptional\b.*::', code):
            optional.update(re.findall(r'(\w+)\(:[:, ]*\)', code.split('::')[1]))
            continue
        guard = re.match(r' *if \(present\((\w+)\)', code)
        if re.match(r' *(if \(.*\) then|.*: *if \(.*\) then)$', code):
            guards.append(guard and guard.group(1))
        elif re.match(r' *else\b', code) and guards:
            guards[-1] = None
        elif re.match(r' *end if\b', code) and guards:
            guards.pop()
        for name in optional - set(guards) - {guard and guard.group(1)}:
            passes = re.sub(rf'present\({name}\)', '', code)
            if re.search(rf'[(,] *(?:\w+ *= *)?{name} *[,)&]', passes) and not START.match(code):
                yield number, name


bad = [f'{path}:{line}: optional {name} is passed on where it may be absent; ask if (present({name}))'
       for path in sorted(Path(sys.argv[1]).rglob('*.f90')) for line, name in passed_on(path)]
print('\n'.join(bad), end='\n' if bad else '')
sys.exit(1 if bad else 0)
