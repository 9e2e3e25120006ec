"""Runs every deck of this folder through carom and sees that its error is reported as it should be.

    python3 run.py PATH_TO_CAROM [NAME...]

A deck says in comments at its top what is to be expected:
    ** expect: words that the message holds (any number of such lines)
    ** expect-line: number of the line it points at (absent: any line)
    ** expect-status: exit status (absent: 2)
The decks in good/ are odd but legal, and must pass `carom check` with status 0.
Names given on the command line choose the cases whose name holds one of them.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import hard_inputs

HERE = pathlib.Path(__file__).resolve().parent
TIME_LIMIT = 30.0

GOOD_DECK = """\
*NODE
1, 0., 0.
2, 1., 0.
*ELEMENT, TYPE=SPRINGA, ELSET=SPRINGS
1, 1, 2
*ELEMENT, TYPE=MASS, ELSET=MASSES
2, 2
*SPRING, ELSET=SPRINGS
1.
*MASS, ELSET=MASSES
1.
*BOUNDARY
1, 1
*STEP
*DYNAMIC, DIRECT
0.1, 1.
*END STEP
"""

# Cards of other programs, and words of what to do about them; the list of all cards is not shown
FOREIGN = {
    "DSLOAD": "write *DLOAD: a line is element or set, P1 to P4, pressure",
    "VISCO": "there is no creep here", "TIME POINTS": "FREQUENCY=n on *NODE FILE",
    "MODAL DAMPING": "*DAMPING, ALPHA=, BETA=", "MODAL DYNAMIC": "write *DYNAMIC:",
    "CONTROLS": "dt min, dt max", "BUCKLE": "loads of buckling", "PART": "without parts",
    "HEAT TRANSFER": "no temperatures", "COUPLED TEMPERATURE-DISPLACEMENT": "no temperatures",
    "TEMPERATURE": "no temperatures", "CREEP": "no creep", "COMPLEX FREQUENCY": "write *FREQUENCY",
    "STEADY STATE DYNAMICS": "not by modes", "ASSEMBLY": "Do not use parts and assemblies",
    "MPC": "write *EQUATION", "DISTRIBUTING COUPLING": "write *EQUATION", "TIE": "same nodes",
    "ORIENTATION": "isotropic", "HYPERELASTIC": "*ELASTIC", "CONTACT": "write *CONTACT PAIR",
    "CONTACT CONTROLS": "matter of *IMPACT", "SECTION CONTROLS": "*ELEMENT GROUP",
    "BULK VISCOSITY": "scaled mass", "MODEL CHANGE": "all steps", "MONITOR": "*NODE PRINT",
}


class Case:
    """A deck with what it must bring about; files are written beside it in its scratch folder."""

    def __init__(self, name, content, words=(), line=None, status=2, files=None, caret=True):
        self.name = name
        self.content = content
        self.words = list(words)
        self.line = line
        self.status = status
        self.files = files or {}    # name: bytes, or what makes the file at a path
        self.absent = []            # what the message must not hold
        self.caret = caret
        self.file = f"{name}.inp"
        self.defines = []


def read_case(path):
    """A case from a deck with its expectation in comments."""
    content = path.read_bytes()
    case = Case(path.stem, content)
    for line in content.decode("utf-8", "replace").splitlines():
        match = re.match(r"\*\*\s*expect(-line|-status)?:\s*(.*?)\s*$", line)
        if not match:
            continue
        if match.group(1) == "-line":
            case.line = int(match.group(2))
        elif match.group(1) == "-status":
            case.status = int(match.group(2))
        else:
            case.words.append(match.group(2))
    return case


def generated_cases():
    """Decks that cannot be kept as plain text, or consist of several files."""
    good = GOOD_DECK.encode()
    cases = [
        Case("empty_file", b"", ["empty"], caret=False),
        Case("blank_file", b"\n  \n** nothing here\n\n", ["empty"], caret=False),
        Case("binary_file", b"*HEADING\n\x7fELF\x00\x01\x02\x03\n" + bytes(range(256)),
             ["not a text file"], line=2),
        Case("binary_byte_at_the_end", good + b"** \x00\n", ["not a text file"], line=18),
        Case("lone_carriage_return", good.replace(b"1, 0., 0.\n", b"1, 0., 0.\r2, 3., 0.\n"),
             ["not a text file"], line=2),
        Case("crlf_keeps_line_numbers", good.replace(b"1, 1, 2", b"1, 1, 7").replace(b"\n", b"\r\n"),
             ["no such node: 7"], line=5),
        Case("tab_before_the_caret", good.replace(b"1, 1, 2", b"1,\t1,\t7"), ["no such node: 7"], line=5),
        Case("line_of_a_million_characters",
             good.replace(b"1, 1, 2", b"1, 1, " + b" " * 1000000 + b"7"), ["no such node: 7"], line=5),
        Case("line_of_a_million_fields", good.replace(b"1, 1, 2", b"1, " * 300000 + b"2"),
             ["too many fields"], line=5),
        Case("number_of_a_million_digits", good.replace(b"1., 0.", b"1" * 1000000 + b"., 0."),
             ["too large"], line=3),
        Case("no_newline_at_the_end", good.rstrip().replace(b"*END STEP", b"*END STOP"),
             ["unknown keyword"], line=17),
        Case("include_itself", b"*INCLUDE, INPUT=include_itself.inp\n" + good,
             ["include loop"], line=1),
        Case("include_each_other", b"*HEADING\n*INCLUDE, INPUT=a.inc\n" + good, ["include loop"],
             files={"a.inc": b"** a\n** a\n*INCLUDE, INPUT=b.inc\n",
                    "b.inc": b"*INCLUDE, INPUT=a.inc\n"}),
        Case("include_itself_by_another_path", b"*INCLUDE, INPUT=sub/../loop.inc\n" + good,
             ["include"], files={"loop.inc": b"*INCLUDE, INPUT=sub/../loop.inc\n", "sub/x": b""}),
        Case("include_a_folder", b"*INCLUDE, INPUT=sub\n" + good, ["cannot"], line=1,
             files={"sub/x": b""}),
        Case("include_nothing", b"*INCLUDE, INPUT=\n" + good, ["INPUT"], line=1),
        Case("include_with_an_error", b"*INCLUDE, INPUT=mesh.inc\n" + good,
             ["mesh.inc:2:", "not a number"],
             files={"mesh.inc": b"*NODE\n5, zero, 0.\n"}),
        Case("include_data_only_with_an_error", b"*NODE\n*INCLUDE, INPUT=nodes.inc\n" + good,
             ["nodes.inc:1:", "not a number"], files={"nodes.inc": b"5, zero, 0.\n"}),
    ]
    for keyword, cure in FOREIGN.items():
        case = Case(f"foreign_{keyword.lower().replace(' ', '_')}", good.replace(
            b"*STEP", f"*{keyword}\n1\n*STEP".encode(), 1), ["unknown keyword", cure], line=14)
        case.absent = ["allowed:"]
        cases.append(case)
    define = Case("define_unknown", b"*PARAMETER\nk = 1\n" + good, ["no such *PARAMETER", "K"],
                  status=1, caret=False)
    define.defines = ["--define", "m=2"]
    cases.append(define)
    define = Case("define_no_number", b"*PARAMETER\nk = 1\n" + good, ["not a number"],
                  status=1, caret=False)
    define.defines = ["--define", "k=soft"]
    cases.append(define)
    return cases


def good_cases():
    """Decks that must pass: those of good/, and some whose bytes an editor would spoil."""
    cases = [read_case(path) for path in sorted((HERE / "good").glob("*.inp"))]
    good = GOOD_DECK.encode()
    cases += [
        Case("good_crlf", good.replace(b"\n", b"\r\n")),
        Case("good_no_newline_at_the_end", good.rstrip()),
        Case("good_tabs", good.replace(b", ", b"\t,\t")),
        Case("good_byte_order_mark", b"\xef\xbb\xbf" + good),
        Case("good_utf8_comment", "** Stoß\n*HEADING\nStoß\n".encode() + good),
        Case("good_long_comment", b"** " + b"x" * 1000000 + b"\n" + good),
        Case("good_long_line", good.replace(b"1, 0., 0.", b"1, 0., 0." + b" " * 1000000)),
        Case("good_includes", b"*INCLUDE, INPUT=sub/mesh.inc\n" + good.split(b"1, 1, 2\n")[1].join(
            [b"*ELEMENT, TYPE=SPRINGA, ELSET=SPRINGS\n1, 1, 2\n", b""]),
            files={"sub/mesh.inc": b"*NODE\n*INCLUDE, INPUT = \"nodes.inc\"\n",
                   "sub/nodes.inc": b"1, 0., 0.\n2, 1., 0."}),
    ]
    for case in cases:
        case.status = 0
        case.words = []
    return cases + hard_inputs.good_cases(Case, good)


def complaints(case, result):
    """What is wrong with the answer of one run."""
    text = result.stdout + result.stderr
    wrong = []
    if result.returncode != case.status:
        wrong.append(f"exit status {result.returncode} instead of {case.status}")
    if "Backtrace" in text or "runtime error" in text:
        wrong.append("it crashed")
    for words in case.words:
        if words.lower() not in text.lower():
            wrong.append(f"the message does not say '{words}'")
    for words in case.absent:
        if words in text:
            wrong.append(f"the message holds {words!r} as it is")
    if case.status == 2 and case.caret:
        wrong += complaints_on_place(case, text)
    return wrong


def complaints_on_place(case, text):
    """The message must hold file:line, the line and a caret below something."""
    match = re.search(r"([^\s:]+):(\d+): ", text)
    if not match:
        return ["the message has no file:line"]
    line = int(match.group(2))
    if case.line is not None and line != case.line:
        return [f"the message points at line {line} instead of {case.line}"]
    rows = text.splitlines()
    for above, row in zip(rows, rows[1:]):
        carets = re.fullmatch(r"\s*(\^+)", row)
        if not carets:
            continue
        column = row.index("^")
        if "not a text file" in case.words or above[column:column + 1].strip():
            return []
        return ["the caret is below a blank"]
    return ["the message has no caret"]


def run_case(carom, command, case):
    """Runs one case in a scratch folder; answers a list of complaints."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="carom_deck_"))
    try:
        (folder / case.file).write_bytes(case.content)
        for name, content in case.files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            if callable(content):
                content(folder / name)
            else:
                (folder / name).write_bytes(content)
        before = {path.name for path in folder.iterdir()}
        try:
            result = subprocess.run([carom, command, case.file, *case.defines], cwd=folder,
                                    capture_output=True, text=True, errors="replace",
                                    timeout=TIME_LIMIT)
        except subprocess.TimeoutExpired:
            return [f"not done after {TIME_LIMIT:g} s"]
        wrong = complaints(case, result)
        left = sorted({path.name for path in folder.iterdir()} - before)
        if left and (case.status != 0 or command == "check"):
            wrong.append("files left behind: " + ", ".join(left))
        if wrong:
            wrong.append("it said:\n" + (result.stdout + result.stderr)[:1500])
        return wrong
    finally:
        shutil.rmtree(folder)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    carom = str(pathlib.Path(sys.argv[1]).resolve())
    wanted = sys.argv[2:]
    good = GOOD_DECK.encode()
    bad = [read_case(path) for path in sorted(HERE.glob("*.inp"))] + generated_cases()
    runs = [(case, command) for case in bad for command in ("check", "run")]
    runs += [(case, "check") for case in hard_inputs.bad_cases(Case, good)]
    runs += [(case, "check") for case in good_cases()]
    n_failed = n_runs = 0
    for case, command in runs:
        if wanted and not any(part in case.name for part in wanted):
            continue
        n_runs += 1
        wrong = run_case(carom, command, case)
        if wrong:
            n_failed += 1
            print(f"FAILED {command} {case.name}: " + "\n    ".join(wrong))
    print(f"{n_runs} runs, {n_failed} failed")
    sys.exit(1 if n_failed or not n_runs else 0)


main()
