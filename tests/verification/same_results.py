"""Compares result files dataset by dataset and attribute by attribute, bit for bit.

    python3 same_results.py A.h5 B.h5        a line a difference; exit status 1 if there is one

What a run has taken in time (`seconds` in the name) is left out, and so are the check sums of a state,
which has such times in it. All else must be the same: names, types, shapes, bytes, descriptions, how
datasets are cut into chunks and compressed. /restart counts too, unless it is left out.
"""
import argparse
import sys

import h5py
import numpy as np


def is_timing(name):
    """Whether a dataset says how long something took."""
    return 'seconds' in name.rsplit('/', 1)[-1] or name == '/restart/index/checks'


def objects_of(file):
    """All groups and datasets of a file by their paths, the file itself as '/'."""
    found = {'/': file}
    file.visititems(lambda name, item: found.update({f'/{name}': item}))
    return found


def attribute_bytes(item):
    """The attributes of an object as (type, shape, bytes) by their names."""
    values = {name: np.asarray(item.attrs[name]) for name in item.attrs}
    return {name: (str(value.dtype), value.shape, value.tobytes()) for name, value in values.items()}


def difference_of(one, other):
    """What differs between two objects of one path; None where nothing does."""
    if type(one) is not type(other):
        return 'a group in one, a dataset in the other'
    if attribute_bytes(one) != attribute_bytes(other):
        return 'attributes differ'
    if not isinstance(one, h5py.Dataset):
        return None
    for name in ('dtype', 'shape', 'maxshape', 'chunks', 'compression', 'compression_opts'):
        if getattr(one, name) != getattr(other, name):
            return f'{name} {getattr(one, name)} and {getattr(other, name)}'
    a, b = one[()], other[()]
    if np.asarray(a).tobytes() == np.asarray(b).tobytes():
        return None
    if np.shape(a) == () or a.dtype.kind not in 'fiu':
        return 'values differ'
    unlike = np.nonzero(~((a == b) | ((a != a) & (b != b))))
    if unlike[0].size == 0:
        return 'values differ in signs of zero or bits of NaN'
    first = tuple(int(index[0]) for index in unlike)
    return f'{unlike[0].size} of {a.size} values differ, first at {first}: {a[first]!r} and {b[first]!r}'


def differences(one, other, ignore=()):
    """Lists what differs between two result files; groups whose paths begin as in `ignore` do not count."""
    found = []
    with h5py.File(one, 'r') as a, h5py.File(other, 'r') as b:
        left, right = objects_of(a), objects_of(b)
        for name in sorted({*left, *right}):
            if is_timing(name) or any(name == path or name.startswith(path + '/') for path in ignore):
                continue
            if name not in left or name not in right:
                found.append(f'{name}: only in {other if name in right else one}')
                continue
            difference = difference_of(left[name], right[name])
            if difference:
                found.append(f'{name}: {difference}')
    return found


def main():
    """Compares the two files of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n', maxsplit=1)[0])
    parser.add_argument('one')
    parser.add_argument('other')
    parser.add_argument('--ignore', action='append', default=[], metavar='PATH',
                        help='a group that does not count, as /restart')
    arguments = parser.parse_args()
    found = differences(arguments.one, arguments.other, arguments.ignore)
    print('\n'.join(found) or 'the same')
    sys.exit(1 if found else 0)


if __name__ == '__main__':
    main()
