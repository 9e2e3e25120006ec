#!/usr/bin/env python3
"""Turns a pFUnit test file into Fortran, and writes the driver of a test program.

    preprocess.py test_x.pf test_x.F90
    preprocess.py --driver driver.f90 test_x test_y ...

Only a subset of pFUnit is accepted; everything else is rejected with file, line, cause and cure,
so that what passes here also means the same under real pFUnit.
"""
import re
import sys
from pathlib import Path

from pf_source import Source

MAX_COLUMNS = 132

# positional arguments (least, most), keywords allowed, keywords required
ASSERTS = {
    "assertEqual": (2, 2, {"tolerance", "message", "whitespace"}, set()),
    "assertNotEqual": (2, 2, {"message"}, set()),
    "assertLessThan": (2, 2, {"message"}, set()),
    "assertLessThanOrEqual": (2, 2, {"message"}, set()),
    "assertGreaterThan": (2, 2, {"message"}, set()),
    "assertGreaterThanOrEqual": (2, 2, {"message"}, set()),
    "assertRelativelyEqual": (2, 2, {"tolerance", "message"}, {"tolerance"}),
    "assertTrue": (1, 1, {"message"}, set()),
    "assertFalse": (1, 1, {"message"}, set()),
    "assertIsNaN": (1, 1, {"message"}, set()),
    "assertIsFinite": (1, 1, {"message"}, set()),
    "assertFail": (0, 1, {"message"}, set()),
    "assertExceptionRaised": (0, 1, {"message"}, set()),
    "assertSameShape": (2, 2, {"message"}, set()),
}
ROUTINE_MARKS = ("test", "before", "after")
# pFUnit's generated suite function declares these names
SUITE_NAMES = {"t", "suite", "cases", "testparameter", "iparam", "icase"}
# pFUnit's module funit exports these, among others
FUNIT_NAMES = {"run", "initialize", "finalize"}
CPP_CONDITIONALS = {"if", "ifdef", "ifndef", "else", "elif", "endif"}


class Test:
    """A procedure that follows @test"""

    def __init__(self, name, ifdef, disabled):
        self.name = name
        self.ifdef = ifdef
        self.disabled = disabled


class Preprocessor:
    """Checks one test file line by line and collects the lines of the Fortran file"""

    def __init__(self, path):
        self.path = path
        self.source = Source(path)
        self.errors = []
        self.output = []
        self.tests = []
        self.before = None
        self.after = None
        self.pending = None  # a mark that waits for its subroutine: dict(kind, line, ...)

    def reject(self, line, cause, cure):
        self.errors.append((line, f"{self.path}:{line}: error: {cause}; {cure}"))

    def run(self):
        self.check_module()
        self.check_uses()
        self.check_names()
        for number in range(1, len(self.source.raw) + 1):
            self.process_line(number)
        if self.pending:
            self.reject_dangling()
        self.check_tests_are_public()
        return not self.errors

    # ---- the module as a whole

    def check_module(self):
        source, stem = self.source, self.path.stem
        if not re.fullmatch(r"test_\w{1,50}", stem):
            self.reject(1, f"'{self.path.name}' is no name of a test file",
                        "call it test_<what>.pf")
        if not source.statements:
            self.reject(1, "the file is empty", f"write 'module {stem}'")
            return
        first, text = source.statements[0]
        if text != f"module {stem.lower()}" or source.trailing(first).strip():
            self.reject(first, "the file must begin with its module",
                        f"write 'module {stem}' and nothing else on the line")
        if source.module_end is None:
            self.reject(len(source.raw), "the module does not end",
                        f"write 'end module {stem}', or close the procedure left open")
        for line in source.after_module[:1]:
            self.reject(line, "code after the end of the module",
                        "one module is all a test file holds")
        if source.contains is None:
            self.reject(first, "the module has no 'contains'", "write it before the tests")
        if "implicit none" not in source.specification:
            self.reject(first, "the module has no 'implicit none'",
                        "write it after the use statements")
        if "use funit" not in source.specification:
            self.reject(first, "the module does not use funit", "write 'use funit', without only:")

    def check_uses(self):
        for use in self.source.uses:
            if use.module == "funit":
                if use.only is not None or not use.at_module_level:
                    self.reject(use.line, "funit is imported in part, or in a procedure",
                                "write 'use funit' once, before 'implicit none'")
            elif use.only is None:
                self.reject(use.line, f"'use {use.module}' imports every name",
                            "add 'only:' and the names, real funit exports common ones such as run")

    def check_names(self):
        for line, name in self.source.module_names:
            if name in FUNIT_NAMES:
                self.reject(line, f"'{name}' is also a name of pFUnit's module funit",
                            f"rename it, as in 'only: my_{name} => {name}'")
            elif name in SUITE_NAMES and self.source.is_public(name):
                self.reject(line, f"the public name '{name}' clashes with pFUnit's suite function",
                            f"write 'private :: {name}', or rename it")

    def check_tests_are_public(self):
        routines = [test.name for test in self.tests] + [self.before, self.after]
        for name in filter(None, routines):
            if not self.source.is_public(name.lower()):
                self.reject(self.source.line_of_procedure(name.lower()),
                            f"'{name}' is private, the suite function cannot see it",
                            f"write 'public :: {name}'")

    # ---- line by line

    def process_line(self, number):
        raw, code = self.source.raw[number - 1], self.source.code[number - 1]
        if code.lstrip().startswith("@"):
            self.process_mark(number, raw, code)
            return
        if self.pending:
            self.take_subroutine(raw.rstrip())
        elif "@" in code:
            self.reject(number, "'@' inside a statement",
                        "an @assert stands alone on its line: write a block if, or two lines")
        elif code.startswith("#"):
            self.check_cpp(number, code)
        self.output.append(raw)

    def check_cpp(self, number, code):
        word = re.match(r"#\s*(\w*)", code).group(1)
        if word not in CPP_CONDITIONALS:
            self.reject(number, f"'#{word}' in a test file",
                        "only #if, #ifdef … #endif are allowed")

    def process_mark(self, number, raw, code):
        name = re.match(r"\s*@(\w*)", code).group(1)
        if self.source.continues(number):
            self.reject(number, f"@{name} inside a continued statement", "remove the '&' before it")
        elif name.startswith("assert"):
            self.process_assert(number, raw, code, name)
            return
        elif name in ROUTINE_MARKS:
            self.process_routine_mark(number, raw, name)
        elif name == "disable":
            self.process_disable(number, raw)
        else:
            self.reject(number, f"'@{name}' is not in the subset",
                        "known are @test, @before, @after, @disable and "
                        + ", ".join("@" + known for known in ASSERTS) + ", spelled so")
        self.output.append("!" + raw)

    def process_routine_mark(self, number, raw, kind):
        if self.pending:
            self.reject_dangling()
        plain = re.fullmatch(r"\s*@(test|before|after)\s*", raw)
        ifdef = re.fullmatch(r"\s*@test\s*\(\s*ifdef\s*=\s*([A-Za-z_]\w*)\s*\)\s*", raw)
        if not plain and not ifdef:
            self.reject(number, f"@{kind} is not alone on its line, or has arguments",
                        "write it alone; only @test(ifdef=MACRO) takes an argument")
        elif self.source.contains is None or number < self.source.contains:
            self.reject(number, f"@{kind} before the module's 'contains'", "move it after")
        elif self.source.depth[number - 1] > 0:
            self.reject(number, f"@{kind} inside a procedure", "tests are module procedures")
        elif kind != "test" and getattr(self, kind):
            self.reject(number, f"a second @{kind}", "a file has one at most: join the two")
        self.pending = {"kind": kind, "line": number, "disabled": False,
                        "ifdef": ifdef.group(1) if ifdef else None}

    def process_disable(self, number, raw):
        if not self.pending or self.pending["kind"] != "test" or self.pending["disabled"]:
            self.reject(number, "@disable without a @test", "write it between @test and subroutine")
            return
        if raw.strip() != "@disable":
            self.reject(number, "@disable is not alone on its line, or has arguments",
                        "write it alone")
        self.pending["disabled"] = True

    def reject_dangling(self):
        kind, line = self.pending["kind"], self.pending["line"]
        self.pending = None
        self.reject(line, f"@{kind} is not directly before a plain subroutine",
                    "the next line must be 'subroutine name()' and nothing else")

    def take_subroutine(self, text):
        match = re.fullmatch(r"\s*subroutine\s+([A-Za-z]\w*)\s*\(\s*\)", text, re.IGNORECASE)
        if not match:
            self.reject_dangling()
            return
        mark, self.pending = self.pending, None
        name = match.group(1)
        if name.lower() in [test.name.lower() for test in self.tests]:
            self.reject(mark["line"], f"a second test named {name}", "rename it")
        if mark["kind"] == "test":
            self.tests.append(Test(name, mark["ifdef"], mark["disabled"]))
        else:
            setattr(self, mark["kind"], name)

    # ---- assertions

    def process_assert(self, number, raw, code, name):
        arguments = self.assert_arguments(number, raw, code, name)
        if arguments is None:
            self.output.append("!" + raw)
            return
        indent = raw[:len(raw) - len(raw.lstrip())]
        call = f"{indent}call {name}({arguments}, &" if arguments else f"{indent}call {name}( &"
        if len(call) > MAX_COLUMNS:
            self.reject(number, f"expanded, the line has {len(call)} columns",
                        f"{MAX_COLUMNS} are allowed: assign the arguments to variables first")
        self.output += [
            self.line_marker(number), call,
            f"{indent}   location=SourceLocation('{self.path.name}', {number}))",
            f"{indent}if (anyExceptions()) return", self.line_marker(number + 1)]

    def assert_arguments(self, number, raw, code, name):
        """The text between the parentheses, or None if the line was rejected"""
        if self.pending:
            self.reject_dangling()
        if name not in ASSERTS:
            self.reject(number, f"'@{name}' is not in the subset",
                        "known are " + ", ".join("@" + known for known in ASSERTS))
            return None
        if self.source.depth[number - 1] == 0:
            self.reject(number, f"@{name} outside a procedure", "move it into a test")
            return None
        opening = re.match(r"\s*@\w+(\s*)\(", code)
        if not opening or opening.group(1):
            self.reject(number, f"@{name} without '(' directly after it", f"write '@{name}(…)'")
            return None
        pieces, close = split_arguments(code, opening.end())
        if close is None:
            self.reject(number, f"@{name} does not end on its line",
                        "pFUnit knows no continuation here: assign long arguments to variables")
            return None
        if raw[close + 1:].strip():
            self.reject(number, f"text after the closing parenthesis of @{name}",
                        "put a comment on a line of its own")
            return None
        if not self.arguments_fit(number, name, [code[start:end] for start, end in pieces]):
            return None
        return raw[opening.end():close].strip()

    def arguments_fit(self, number, name, pieces):
        least, most, allowed, required = ASSERTS[name]
        keywords = [re.match(r"\s*([a-z]\w*)\s*=(?!=)", piece, re.IGNORECASE) for piece in pieces]
        given = [match.group(1) for match in keywords if match]
        positional = keywords.index(next(filter(None, keywords))) if given else len(keywords)
        wanted = str(most) if least == most else f"{least} or {most}"
        keyword_text = " and ".join(f"{word}=" for word in sorted(allowed)) or "none"
        cure = f"it takes {wanted} by position, then these by keyword: {keyword_text}"
        before = len(self.errors)
        if any(not piece.strip() for piece in pieces):
            self.reject(number, f"@{name} has an empty argument", cure)
        elif not least <= positional <= most:
            self.reject(number, f"@{name} has {positional} positional arguments", cure)
        elif None in keywords[positional:]:
            self.reject(number, f"@{name} has a positional argument after a keyword", cure)
        elif len(set(given)) < len(given) or not set(given) <= allowed:
            self.reject(number, f"@{name} does not take {', '.join(given)} so", cure)
        elif least == 0 and len(pieces) > 1 or name == "assertFail" and not pieces:
            self.reject(number, f"@{name} has {len(pieces)} arguments", "its only one is a message")
        elif not required <= set(given):
            self.reject(number, f"@{name} lacks {', '.join(required)}=", cure)
        return len(self.errors) == before

    # ---- output

    def line_marker(self, number):
        return f'#line {number} "{self.path.as_posix()}"'

    def fortran(self, output_path):
        lines = [self.line_marker(1)] + self.output
        lines.append(f'#line {len(lines) + 2} "{Path(output_path).as_posix()}"')
        return "\n".join(lines + self.suite_function()) + "\n"

    def suite_function(self):
        module = self.path.stem
        extra = "".join(f", {keyword}={name}" for keyword, name in
                        (("setUp", self.before), ("tearDown", self.after)) if name)
        lines = ["", f"function {module}_suite() result(suite)",
                 "   use funit, only: TestMethod, TestSuite", f"   use {module}",
                 "   implicit none", "   type(TestSuite) :: suite", "",
                 f"   suite = TestSuite('{module}_suite')"]
        for test in self.tests:
            flag = ", disabled=.true." if test.disabled else ""
            add = ["   call suite%addTest(TestMethod( &",
                   f"      '{test.name}', {test.name}{extra}{flag}))"]
            lines += [f"#ifdef {test.ifdef}", *add, "#endif"] if test.ifdef else add
        return lines + [f"end function {module}_suite"]


def split_arguments(code, start):
    """(first, after last) of each argument from `start` on, and where the parenthesis closes"""
    pieces, depth, begin = [], 0, start
    for i in range(start, len(code)):
        if code[i] in ")]" and depth == 0:
            if pieces or code[begin:i].strip():
                pieces.append((begin, i))
            return pieces, i
        if code[i] in "([":
            depth += 1
        elif code[i] in ")]":
            depth -= 1
        elif code[i] == "," and depth == 0:
            pieces.append((begin, i))
            begin = i + 1
    return pieces, None


def driver(modules):
    """The main program that runs the suites of these test modules"""
    lines = ["program test_driver", "   use funit, only: TestSuite",
             "   use lite_runner, only: runner_type", "   implicit none", ""]
    for module in modules:
        lines += ["   interface", f"      function {module}_suite() result(suite)",
                  "         import :: TestSuite", "         type(TestSuite) :: suite",
                  f"      end function {module}_suite", "   end interface"]
    lines += ["", "   type(runner_type) :: runner", "   logical :: ok, failed", "",
              "   call runner%read_options(ok)", "   if (.not. ok) stop 2"]
    lines += [f"   call runner%run_suite({module}_suite())" for module in modules]
    lines += ["   call runner%report(failed)", "   if (failed) stop 2", "end program test_driver"]
    return "\n".join(lines) + "\n"


def main(arguments):
    if len(arguments) >= 2 and arguments[0] == "--driver":
        modules = arguments[2:]
        if len({module.lower() for module in modules}) < len(modules):
            sys.exit(f"{arguments[1]}: error: two test files of one name; rename one")
        Path(arguments[1]).write_text(driver(modules), encoding="utf-8")
        return 0
    if len(arguments) != 2:
        sys.exit(__doc__)
    preprocessor = Preprocessor(Path(arguments[0]))
    if preprocessor.run():
        Path(arguments[1]).write_text(preprocessor.fortran(arguments[1]), encoding="utf-8")
        return 0
    for _, text in sorted(preprocessor.errors):
        print(text, file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
