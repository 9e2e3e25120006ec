"""A test file as lines and statements: enough Fortran to check what preprocess.py accepts."""
import re
from collections import namedtuple

Use = namedtuple("Use", "line module only at_module_level")

PROCEDURE = re.compile(r"(?!end\b|end\s*(?:subroutine|function)\b)(?:[\w\s*=:(),]*[\s)])?"
                       r"(subroutine|function)\s+(\w+)\s*(?:\(|$)")
END_PROCEDURE = re.compile(r"end(\s*(subroutine|function|procedure)(\s+\w+)?)?$")
USE = re.compile(r"use\b(?:\s*,\s*(?:non_)?intrinsic\s*::|\s*::)?\s*(\w+)\s*(.*)$")


class Source:
    """The lines of a file, with strings and comments blanked out in `code`"""

    def __init__(self, path):
        self.raw = path.read_text(encoding="utf-8").splitlines()
        self.code = blank_strings_and_comments(self.raw)
        self.statements = join_statements(self.code)
        self.depth = [0] * len(self.raw)
        self.contains = None
        self.module_end = None
        self.after_module = []
        self.specification = set()
        self.uses = []
        self.module_names = []
        self._procedures = {}
        self._private = set()
        self._public = set()
        self._private_by_default = False
        self._scan()

    def trailing(self, line):
        """What the comment stripper took from the end of a line"""
        return self.raw[line - 1][len(self.code[line - 1].rstrip()):]

    def continues(self, line):
        """Whether a line continues the statement before it"""
        for i in range(line - 2, -1, -1):
            text = self.code[i].rstrip()
            if text:
                return text.endswith("&")
        return False

    def is_public(self, name):
        if name in self._public:
            return True
        return name not in self._private and not self._private_by_default

    def line_of_procedure(self, name):
        return self._procedures.get(name, 1)

    def _scan(self):
        depth, in_type, previous = 0, False, 0
        for line, text in self.statements:
            for i in range(previous, line - 1):
                self.depth[i] = depth
            previous = line - 1
            if self.module_end is not None:
                self.after_module.append(line)
                continue
            if PROCEDURE.match(text):
                if depth == 0 and self.contains is not None:
                    name = PROCEDURE.match(text).group(2)
                    self._procedures[name] = line
                    self.module_names.append((line, name))
                depth += 1
            elif depth > 0 and END_PROCEDURE.match(text):
                depth -= 1
            elif depth == 0 and re.match(r"end(\s*module(\s+\w+)?)?$", text):
                self.module_end = line
            elif depth == 0 and self.contains is None:
                in_type = self._scan_specification(line, text, in_type)
            if USE.match(text):
                self._scan_use(line, text, depth == 0)
        for i in range(previous, len(self.raw)):
            self.depth[i] = depth

    def _scan_specification(self, line, text, in_type):
        """One statement before the module's contains; returns whether a type is open after it"""
        if in_type:
            return not re.match(r"end\s*type\b", text)
        self.specification.add(" ".join(text.split()))
        if text == "contains":
            self.contains = line
        access, _, names = text.partition("::")
        declared = [re.match(r"\s*(\w*)", name).group(1) for name in split_top_level(names)]
        access = access.strip()
        if text == "private":
            self._private_by_default = True
        elif access == "private":
            self._private.update(declared)
        elif access == "public":
            self._public.update(declared)
        elif names and not text.startswith("use"):
            self.module_names += [(line, name) for name in declared]
            if re.search(r",\s*private\b", access):
                self._private.update(declared)
            if re.search(r",\s*public\b", access):
                self._public.update(declared)
        return bool(re.match(r"type\b(?!\s*\()", text))

    def _scan_use(self, line, text, at_module_level):
        module, rest = USE.match(text).groups()
        match = re.match(r",\s*only\s*:(.*)$", rest)
        only = None
        if match:
            only = [name.split("=>")[0].strip() for name in split_top_level(match.group(1))]
            if at_module_level:
                self.module_names += [(line, name) for name in only]
        self.uses.append(Use(line, module, only, at_module_level))


def split_top_level(text):
    """The parts between commas outside parentheses"""
    parts, depth = [""], 0
    for char in text:
        depth += (char in "([") - (char in ")]")
        if char == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += char
    return parts


def blank_strings_and_comments(lines):
    """The lines in the same length, with the inside of strings and the comments as blanks"""
    result, quote = [], None
    for line in lines:
        code = []
        for i, char in enumerate(line):
            if quote:
                if char == quote:
                    quote = None
                    code.append(char)
                elif char == "&" and not line[i + 1:].strip():
                    code.append(char)
                else:
                    code.append(" ")
                continue
            if char == "!":
                break
            if char in "'\"" and not line.startswith("#"):
                quote = char
            code.append(char)
        text = "".join(code)
        if quote and not text.rstrip().endswith("&"):
            quote = None  # an unclosed string: the compiler will say so
        result.append(text.ljust(len(line)))
    return result


def join_statements(code):
    """(line of its beginning, lower-case text) of each statement; lines of # and @ are left out"""
    statements, open_text, open_line = [], "", 0
    for number, line in enumerate(code, start=1):
        text = line.strip()
        if not text or text[0] in "#@":
            continue
        if not open_text:
            open_line = number
        elif text.startswith("&"):
            text = text[1:]
        if text.endswith("&"):
            open_text += text[:-1] + " "
            continue
        for statement in (open_text + text).split(";"):
            if statement.strip():
                statements.append((open_line, statement.strip().lower()))
        open_text = ""
    return statements
