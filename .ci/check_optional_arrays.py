"""No optional assumed-shape argument is passed on where it may be absent: gfortran then computes with
the strides of a descriptor that is not there, which a sanitizer reports when they happen to overflow.

    check_optional_arrays.py FOLDER    status 1 with a line for each, 2 if there are no sources"""
import re
import sys
from pathlib import Path

START = re.compile(r'^ *(?:(?:pure|elemental|recursive|module) )*(?:subroutine|function|\w+(?:\([^)]*\))? function) \w+')
SHAPE = r'\(:[:, ]*\)'


def statements(path):
    """Number of the first line and text of each statement: continued lines joined, comments left out."""
    begun, text = 0, ''
    for number, line in enumerate(path.read_text().split('\n'), 1):
        code = line.split('!')[0].rstrip()
        if not code and begun:
            continue
        begun = begun or number
        text += re.sub(r'^ *&', '', code) if text else code
        if text.endswith('&'):
            text = text[:-1].rstrip() + ' '
            continue
        yield begun, re.sub(r'(?<=\S) +', ' ', text)
        begun, text = 0, ''


def optional_arrays(code):
    """The names of optional arrays of assumed shape that a statement declares."""
    attributes, _, names = code.partition('::')
    if not re.search(r'\boptional\b', attributes):
        return []
    if re.search(rf'\bdimension *{SHAPE}', attributes):
        return re.findall(r'(\w+)', names)
    return re.findall(rf'(\w+) *{SHAPE}', names)


def passed_on(path):
    """Statements that pass an optional array on outside `if (present(...))`."""
    optional, guards = set(), []
    for number, code in statements(path):
        if START.match(code):
            optional, guards = set(), []
            continue
        if '::' in code and re.search(r'\boptional\b', code.partition('::')[0]):
            optional.update(optional_arrays(code))
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
            if re.search(rf'[(,] *(?:\w+ *= *)?{name} *[,)]', passes):
                yield number, name


def main():
    paths = sorted(Path(sys.argv[1]).rglob('*.f90'))
    if not paths:
        print(f'error: there are no Fortran sources in {sys.argv[1]}', file=sys.stderr)
        sys.exit(2)
    bad = [f'{path}:{line}: optional {name} is passed on where it may be absent; ask if (present({name}))'
           for path in paths for line, name in passed_on(path)]
    print('\n'.join(bad), end='\n' if bad else '')
    sys.exit(1 if bad else 0)


main()
