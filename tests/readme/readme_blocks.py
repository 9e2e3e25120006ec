"""Finds the code blocks of a README and says what each is.

A block is fenced by ``` or indented by four blanks after an empty line. Comments in front of it,
which a page does not show, say what cannot be seen from its lines:

    <!-- status 2 -->                               the last command of the block ends so; 5 0: the last two
    <!-- prints: carom check input/a/a.inp -->      the block is what this command prints
    <!-- output of the block before -->             the block is what the commands there print
    <!-- cards for input/a/a.inp -->                a fragment, sound when put into this deck
    <!-- as a.inp -->                               the deck is kept under this name
    <!-- with input/a/a.inp changed: OLD => NEW --> first change the copy of this file so
    <!-- tested by tests/a/b.py -->                 that test runs it
    <!-- lines of input/a/a.inp -->                 the first column of the table below quotes this deck, card by card
"""
import re

PROGRAMS = {'carom', 'build/carom', 'python', 'python3', '.venv/bin/python', 'bash', 'sh', 'cmake', 'ctest',
            'cpack', 'mpirun', 'touch', 'kill', 'git', 'cd', 'cp', 'ls', 'apt', 'apt-get', 'sudo', 'pip',
            'source', 'man', 'paraview', 'gmsh', 'ccx', 'head', 'mkdir', 'export', 'echo'}
COMMAND = re.compile(r'(\w+=\S+ )*(\./)?((scripts|input|tests|\.ci|\.venv/bin)/\S+|make_\w+\.py|(?P<name>\S+))(\s|$)')
MARK = re.compile(r'<!--\s*(status|as|prints:|output of the block before|cards for|with|tested by)\s*(.*?)\s*-->')
LIST_ITEM = re.compile(r'\s*([-*+]|\d+\.)\s')


class Block:
    """The lines of a block, the line it starts at, the comments in front of it and its heading."""

    def __init__(self, lines, start, marks, heading, language):
        self.lines, self.start, self.marks = lines, start, marks
        self.heading, self.language = heading, language

    def mark(self, name):
        """What follows the name in the comment of that kind, or None."""
        found = [text for kind, text in self.marks if kind == name]
        return found[0] if found else None

    @property
    def kind(self):
        """commands, python, deck, printed (by a command) or other."""
        if self.mark('tested by') is not None:
            return 'delegated'
        if self.mark('prints:') is not None or self.mark('output of the block before') is not None:
            return 'printed'
        if self.mark('cards for') is not None:
            return 'cards'
        if self.language == 'python' or re.match(r'(import|from) \w', self.lines[0]):
            return 'python'
        if is_command(self.lines[0]):
            return 'commands'
        if self.lines[0].startswith('*') and not self.lines[0].startswith('* '):
            return 'deck'
        return 'other'


def is_command(line):
    """Does the line of a block begin with a program?"""
    words = line[2:] if line.startswith('$ ') else line
    found = COMMAND.match(words)
    return bool(found) and (found['name'] is None or found['name'] in PROGRAMS)


def remark_column(line):
    """Where the explanation of a command begins in its line, or None."""
    command = without_remark(line)
    rest = line[line.index(command) + len(command):]
    return len(line) - len(rest.lstrip()) if rest.strip() else None


def without_remark(line):
    """A command line without what stands behind it as an explanation: after ` # `, or after two blanks."""
    line = line[2:] if line.startswith('$ ') else line
    line = re.split(r'\s+# ', line, maxsplit=1)[0]
    parts = re.split(r'( {2,})', line)
    for i in range(2, len(parts), 2):
        if re.fullmatch(r"[\w']+[,:;]?", parts[i].split(' ')[0]):
            return ''.join(parts[:i]).strip()
    return line.strip()


def split_commands(lines):
    """The commands of a block, each with the lines that stand below it: what it prints."""
    commands = []
    joined = column = None
    for line in lines:
        if joined is not None:
            joined += ' ' + line.strip()
        elif is_command(line):
            joined = line
        elif commands:
            if column is not None and len(line) - len(line.lstrip()) == column:
                continue
            if line.strip() or commands[-1][1]:
                commands[-1][1].append(line)
            continue
        if joined.endswith('\\'):
            joined = joined[:-1].rstrip()
            continue
        column = remark_column(joined)
        commands.append((without_remark(joined), []))
        joined = None
    return commands


def read_blocks(text):
    """All blocks of a page, and the commands that stand within its sentences."""
    blocks, marks, heading = [], [], ''
    lines = text.split('\n')
    i = 0
    while i < len(lines):
        line = lines[i]
        fence = re.match(r'(\s*)(```+|~~~+)\s*(\w*)', line)
        if fence:
            end = next(j for j in range(i + 1, len(lines)) if lines[j].strip() == fence[2])
            body = [part[len(fence[1]):] for part in lines[i + 1:end]]
            blocks.append(Block(body, i + 2, marks, heading, fence[3]))
            marks, i = [], end
        elif line.startswith('    ') and line.strip() and begins_block(lines, i):
            end = i
            while end < len(lines) and (lines[end].startswith('    ') or not lines[end].strip()):
                end += 1
            while not lines[end - 1].strip():
                end -= 1
            blocks.append(Block([part[4:] for part in lines[i:end]], i + 1, marks, heading, ''))
            marks, i = [], end - 1
        elif MARK.match(line.strip()):
            marks.append(MARK.match(line.strip()).groups())
        elif line.startswith('#'):
            heading = line.lstrip('# ')
        elif line.strip() and marks:
            raise ValueError(f'line {i + 1}: a comment for the test stands before no block: {marks}')
        i += 1
    return [block for block in blocks if any(part.strip() for part in block.lines)]


def table_lines(text):
    """(line number, deck, lines it must have) of each table that quotes a deck."""
    found = []
    lines = text.split('\n')
    for i, line in enumerate(lines):
        quoted = re.match(r'<!-- lines of (\S+) -->', line)
        if quoted:
            rows = []
            for row in lines[i + 3:]:
                if not row.startswith('|'):
                    break
                rows += re.findall(r'`([^`]+)`', row.split(' | ')[0])
            found.append((i + 1, quoted[1], rows))
    return found


def begins_block(lines, i):
    """Indented lines are a block only after an empty line, a heading or a comment, not within a list."""
    if i and lines[i - 1].strip() and not lines[i - 1].lstrip().startswith('<!--'):
        return False
    before = next((line for line in reversed(lines[:i]) if line.strip() and not line.startswith(' ')), '')
    return not LIST_ITEM.match(before)


def inline_commands(text):
    """(line number, command) of what stands in backticks in sentences and is a command with words behind it."""
    found = []
    for number, line in enumerate(text.split('\n'), 1):
        if line.startswith(('    ', '```')):
            continue
        for span in re.findall(r'`([^`]+)`', line):
            if ' ' in span.strip() and is_command(span) \
                    and not re.search(r'[…<>]|\.\.\.|^kill -\w+$|\b(DECK|CARD)\b|^carom (run|check)$', span):
                found.append((number, span))
    return found
