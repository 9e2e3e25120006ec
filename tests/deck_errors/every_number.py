"""Every number of every card: read exactly, or refused with its place. Never taken for zero.

    python3 every_number.py PATH_TO_CAROM

The decks of number_decks.py are run with their numbers written in many right ways, which must not
change a bit of the results; with another value in one place, which must change them; and with what is
no number in one place, which must end with status 2 and a caret below just that. Then the numbers of
the command line.
"""

import decimal
import fractions
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

import number_decks

# What is no number anywhere. A comma is in none of them: it parts fields.
NO_NUMBERS = [
    "x", "e5", ".e5", "d5", "1e", "1e+", "1d-", "1q5", "1q", "1+5", "1-5", "1e5e5", "1e5.0", "1..5",
    "1.5.2", "1.000.000", ".", "-", "+", "+.", "-.", "+-1", "--1", "- 1", "1 2", "1 .5", "1 e5", "1e 5",
    "1e+ 5", "1 000", "1\t2", "0x10", "0X1p3", "0b1", "0o7", "z'1F'", "#1F", "1_8", "1.5_wp", "1_000",
    "1'000", "1f", "1.5f0", "1L", "1u", "1%", "1k", "1;2", "1:2", "(1)", "[1]", "{1}", "'1'", '"1"',
    "1'", "T", ".true.", "&", "1&", "1!", "1#", "$1", "1*3", "3*1", "2*", "1**5", "1^5", "=1", "1=", "<1>",
    "1<", "/", "1/", "/1", "1//2", "\\", "nan", "-nan", "NaN(1)", "inf", "+inf", "-inf", "infinity",
    "1.#INF", "1e400", "-1e400", "1d400", "1e309", "1e99999999999999999999", "9" * 400,
    "-" + "9" * 400 + ".5", "1e-400", "1d-400", "1e-99999999999999999999", "0." + "0" * 400 + "1",
    "\u221e", "\u00bd", "\uff11", "\u22121", "1\u00a0", "1\u2009000", "\u0663", "1\u066b5", "\u202e1",
]
NO_INTEGERS = [
    "1.", "1.0", "1e0", "1d0", "1E5", ".1", "2147483648", "-2147483649", "4294967297",
    "9223372036854775808", "18446744073709551617", "-9223372036854775809", "1" + "0" * 400, "1/1",
]
NO_FRACTIONS = ["1/2/3", "1/0", "1/0.0", "1/-0", "1/1e400", "1e-300/1e300", "1e300/1e-300", "1/ ", "1/x"]
# Those that are numbers in parameters that may be fractions are not among NO_NUMBERS.
A_FEW = 5


class Failures:
    """Counts checks, and prints those that fail."""

    def __init__(self):
        self.n_checks = 0
        self.n_failed = 0

    def check(self, holds, text):
        self.n_checks += 1
        if not holds:
            self.n_failed += 1
            print("FAILED", text)


def right_spellings(slot, variant):
    """The value of a slot in another spelling."""
    if slot.letter == "i":
        value = int(slot.value)
        return [f"{value:+d}", f"\t{value:07d} ", "0" * 400 + str(value)][variant % 3]
    value = float(slot.value)
    if value == 0.0:
        return ["-0", "0e400", ".0D-400", "+0.e+0", "\t-000.000", "0" * 400][variant % 6]
    if slot.letter == "f" and variant % 6 == 5:
        part = fractions.Fraction(value)
        return f"{part.numerator} / {part.denominator}."
    exact = decimal.Decimal(slot.value)
    sign = "-" if value < 0.0 else "+"
    return [f"{exact:f}{'' if '.' in f'{exact:f}' else '.'}{'0' * 400}", f"{exact.scaleb(3):f}d-03",
            f"{sign}{'0' * 300}{abs(exact).scaleb(-3):f}E3", f"\t{exact:f}D+00\t",
            f"{exact:f}e0000000000000000000000", f"{exact.scaleb(25):f}E-25"][variant % 6]


def run(carom, command, text, options=()):
    """Runs a deck in the current folder."""
    pathlib.Path("deck.inp").write_text(text, encoding="utf-8")
    for name in ("deck.h5", "deck.log", "deck.sta"):
        pathlib.Path(name).unlink(missing_ok=True)
    return subprocess.run([carom, command, "deck.inp", *options], capture_output=True, text=True,
                          errors="replace", timeout=60)


def results():
    """All datasets of the last run but those that tell of the deck's text and of time spent."""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset) and not name.startswith(("cost", "model/deck", "restart")):
            found[name] = item[()]
    with h5py.File("deck.h5", "r") as file:
        file.visititems(keep)
    return found


def same(one, other):
    """Whether two results have the same numbers, bit for bit."""
    return one.keys() == other.keys() and all(
        np.asarray(one[name]).tobytes() == np.asarray(other[name]).tobytes() for name in one)


def forms_against(slot):
    """All texts that are wrong in a slot."""
    forms = list(NO_NUMBERS)
    if slot.letter == "i":
        forms += NO_INTEGERS
    elif slot.letter == "f":
        forms += NO_FRACTIONS
    else:
        forms += ["1/2"]
    return forms


def check_refused(failures, slot, form, result):
    """Status 2, the line, and carets below the text that is wrong, or the parameter that has it."""
    what = f"{slot.name}: {form[:30]!r}"
    failures.check(result.returncode == 2, f"{what}: status {result.returncode}\n{result.stderr[:400]}")
    if result.returncode != 2:
        return
    failures.check(f"deck.inp:{slot.line}:" in result.stderr, f"{what}: another line\n{result.stderr}")
    failures.check("cure:" in result.stderr, f"{what}: no cure\n{result.stderr}")
    failures.check("\x1b" not in result.stderr and "\u202e" not in result.stderr, f"{what}: raw control")
    rows = result.stderr.splitlines()
    carets = [k for k, row in enumerate(rows) if row.strip() and not row.strip(" ^")]
    failures.check(len(carets) == 1, f"{what}: no carets\n{result.stderr}")
    if len(carets) == 1 and form.isascii() and form.isprintable() and len(form) < 100:
        row = rows[carets[0]]
        marked = rows[carets[0] - 1][row.index("^"):len(row)]
        failures.check(form.strip() in marked, f"{what}: carets below {marked!r}")


def check_wrong_forms(failures, carom):
    """Every wrong form in one slot a letter, a few in each of the others, so that all come by."""
    seen = set()
    turn = 0
    for slot in number_decks.slots():
        forms = forms_against(slot)
        key = (slot.letter, slot.deck if slot.letter == "r" and slot.deck == "solid" else "")
        if key in seen:
            forms = [forms[(turn + k * len(forms) // A_FEW) % len(forms)] for k in range(A_FEW)]
            turn += 1
        seen.add(key)
        for form in forms:
            result = run(carom, "check", number_decks.deck_text(slot.deck, slot, form))
            check_refused(failures, slot, form, result)


def check_decimal_commas(failures, carom):
    """A decimal comma parts a number in two: one field too many, never half a number."""
    for slot in number_decks.slots():
        if slot.letter == "i":
            continue
        form = f"{float(slot.value)!r}".replace(".", ",")
        result = run(carom, "check", number_decks.deck_text(slot.deck, slot, form))
        failures.check(result.returncode == 2, f"{slot.name}: {form}: status {result.returncode}")


def check_right_forms(failures, carom):
    """Other spellings of all numbers of a deck at once, and another value in one place."""
    for deck in number_decks.DECKS:
        result = run(carom, "run", number_decks.deck_text(deck))
        failures.check(result.returncode == 0, f"{deck}: status {result.returncode}\n{result.stderr}")
        if result.returncode != 0:
            continue
        expected = results()
        own = [slot for slot in number_decks.slots() if slot.deck == deck]
        for variant in range(6):
            text = number_decks.spelled(deck, lambda k, v=variant, o=own: right_spellings(o[k], v + k))
            result = run(carom, "run", text)
            failures.check(result.returncode == 0, f"{deck} spelled {variant}\n{result.stderr}")
            failures.check(result.returncode == 0 and same(expected, results()),
                           f"{deck} spelled otherwise ({variant}) gives other results")
        for slot in own:
            if not slot.other:
                continue
            result = run(carom, "run", number_decks.deck_text(deck, slot, slot.other))
            failures.check(result.returncode == 0, f"{slot.name} as {slot.other}\n{result.stderr}")
            failures.check(result.returncode == 0 and not same(expected, results()),
                           f"{slot.name}: {slot.other} gives the same results")


def check_command_line(failures, carom):
    """Numbers of --define and of the options: status 1 for what is none."""
    text = number_decks.deck_text("springs")
    wrong = [("--define", f"stiff={form}") for form in NO_NUMBERS + ["1/2", "1,5"]]
    wrong += [("--threads", form) for form in ["0", "-1", "1.", "1e0", "x", "", "1 2", "1/", "2*3", "/",
                                               "2147483648", "99999999999999999999", "1025"]]
    wrong += [("--memory", form) for form in ["0", "-1", "x", "", "M", "1.5.2G", "1 2", "1/G", "1e400",
                                              "nan", "inf", "1GG", "0x10", "9" * 400]]
    wrong += [("--time-limit", form) for form in ["0", "-1", "x", "", ":", "1:2:3:4", "1:", "1 2", "/",
                                                  "nan", "1e9", "2*3"]]
    for option, value in wrong:
        if "\0" in value:
            continue
        result = run(carom, "check", text, [option, value])
        failures.check(result.returncode == 1, f"{option} {value[:30]!r}: status {result.returncode}"
                       f"\n{result.stderr[:300]}")
    run(carom, "run", number_decks.deck_text("springs").replace("100.", "101."))
    expected = results()
    for form in ("101", "+101.", " 1.01D2 ", "0101e0", "1010000000e-7"):
        result = run(carom, "run", text, ["--define", f"stiff={form}", "--threads", "01"])
        failures.check(result.returncode == 0 and same(expected, results()), f"--define stiff={form!r}")


def check_locales(failures, carom):
    """Reading and writing do not depend on the locale."""
    text = number_decks.deck_text("impact")
    run(carom, "run", text)
    expected, increments = results(), pathlib.Path("deck.sta").read_text()
    for name in ("C", "POSIX", "C.UTF-8", "de_DE.UTF-8", "no_such_place"):
        os.environ["LC_ALL"] = os.environ["LC_NUMERIC"] = os.environ["LANG"] = name
        run(carom, "run", text)
        failures.check(same(expected, results()), f"locale {name} changes the results")
        failures.check(pathlib.Path("deck.sta").read_text() == increments,
                       f"locale {name} changes the status file")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    carom = str(pathlib.Path(sys.argv[1]).resolve())
    failures = Failures()
    home = os.getcwd()
    with tempfile.TemporaryDirectory(prefix="carom_numbers_") as folder:
        os.chdir(folder)
        check_right_forms(failures, carom)
        check_wrong_forms(failures, carom)
        check_decimal_commas(failures, carom)
        check_command_line(failures, carom)
        check_locales(failures, carom)
        os.chdir(home)
    print(f"{failures.n_checks} checks, {failures.n_failed} failed")
    sys.exit(1 if failures.n_failed else 0)


main()
