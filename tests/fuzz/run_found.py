"""Runs the decks that fuzzing has found to go wrong, each of which must now end as it says.

    python3 run_found.py CAROM [NAME...]

Comments at the top of a deck of found/ say what is expected:
    ** run: check (absent: run)
    ** expect-status: exit status (absent: 0)
    ** expect: words of the message (any number of such lines)
Beside that the deck is judged as every mutant is. Names choose the decks whose name holds one.
"""
import re
import sys
import tempfile
from pathlib import Path

from judge import judge, limit_files

FOUND = Path(__file__).resolve().parent / "found"
HEADER = re.compile(rb"^\*\* (run|expect-status|expect): *(.*?) *\r?$", re.MULTILINE)


def find_faults(carom, path):
    """What is wrong with the end of a deck, in words."""
    content = path.read_bytes()
    said = [(kind.decode(), value.decode()) for kind, value in HEADER.findall(content)]
    command = dict(said).get("run", "run")
    status = int(dict(said).get("expect-status", 0))
    with tempfile.TemporaryDirectory(prefix="carom_found_") as folder:
        (Path(folder) / "deck.inp").write_bytes(content)
        verdict = judge(carom, folder, command)
    faults = list(verdict.faults)
    if verdict.status != status:
        faults.append(f"status {verdict.status} instead of {status}: {verdict.text[:200]}")
    faults += [f"no '{words}' in: {verdict.text[:200]}" for kind, words in said
               if kind == "expect" and words not in verdict.text]
    return faults


def main():
    """Prints a line a deck; status 1 if one is wrong, or there was none."""
    limit_files()
    carom = Path(sys.argv[1]).resolve()
    decks = [path for path in sorted(FOUND.glob("*.inp"))
             if not sys.argv[2:] or any(name in path.stem for name in sys.argv[2:])]
    failed = 0
    for path in decks:
        faults = find_faults(carom, path)
        failed += bool(faults)
        print(f"{'FAILED' if faults else 'ok':6} {path.stem}: {'; '.join(faults)}")
    print(f"{len(decks) - failed} of {len(decks)} decks end as they should")
    sys.exit(1 if failed or not decks else 0)


if __name__ == "__main__":
    main()
