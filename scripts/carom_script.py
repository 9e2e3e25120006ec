"""What every script needs: the error the user can put right, and the way a script ends."""

import argparse
import importlib
import math
import string
import sys

FOLDING = str.maketrans(string.ascii_lowercase, string.ascii_uppercase, " \t\r\n")


class ScriptError(Exception):
    """Something the user can put right; its text is all that is shown."""


class MissingError(ScriptError, AttributeError, KeyError):
    """A name that the file does not have."""

    def __str__(self):
        return str(self.args[0])


def run(main):
    """Calls main(); an error the user can put right becomes one line and exit status 1."""
    try:
        main()
    except ScriptError as error:
        sys.exit(f"error: {error}")
    except BrokenPipeError:
        sys.exit(1)


def finite(text):
    """An argument that is a number, and finite."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"'{text}' is no finite number")
    return value


def folded(name):
    """A name as carom has it: without blanks, a to z in upper case, other letters as they are."""
    return name.translate(FOLDING)


def need(package, what):
    """A Python package that only some need; without it an error that says how to get it."""
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ScriptError(
            f"{what} needs the Python package {package}: python3 -m pip install {package} ({error})"
        ) from None
