"""Decks that no one means to write: sizes, depths, bytes and files far from any that one would choose.

`bad_cases(Case, good)` and `good_cases(Case, good)` answer cases for run.py, made from the text of a
good deck. Each must be answered within the time limit there.
"""

import os

MANY = 100_000
STEP_AT = b"*STEP\n"


def fifo(path):
    """A pipe that no one writes to."""
    os.mkfifo(path)


def link_to(target):
    """A symbolic link."""
    return lambda path: os.symlink(target, path)


def sparse(size):
    """A file of so many bytes that take no room."""
    def make(path):
        with open(path, "wb") as file:
            file.truncate(size)
    return make


def lines(form, count=MANY):
    """The form filled with 0, 1, 2 and so on, as bytes."""
    return "".join(form.format(i=i, next=i + 1) for i in range(count)).encode()


def before_step(good, text):
    """The good deck with more cards before its step."""
    return good.replace(STEP_AT, text + STEP_AT, 1)


def bad_files(Case, good):
    """Files that are no plain decks, and includes of such."""
    include = b"*INCLUDE, INPUT=part.inc\n"
    many_includes = {f"d{i}.inc": f"*INCLUDE, INPUT=d{i + 1}.inc\n".encode() * 2 for i in range(30)}
    many_includes["d30.inc"] = b"** nothing\n"
    deep = {f"d{i}.inc": f"*INCLUDE, INPUT=d{i + 1}.inc\n".encode() for i in range(60)}
    deep["d60.inc"] = b"** nothing\n"
    png = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + bytes(range(256))
    return [
        Case("include_a_pipe", include + good, ["pipe or device"], line=1, files={"part.inc": fifo}),
        Case("include_an_empty_file", include + good, ["is empty"], line=1, files={"part.inc": b""}),
        Case("include_a_device", b"*INCLUDE, INPUT=/dev/zero\n" + good, ["pipe or device"], line=1),
        Case("include_nowhere", b"*INCLUDE, INPUT=/dev/null\n" + good, ["pipe or device"], line=1),
        Case("include_a_dangling_link", include + good, ["cannot open"], line=1,
             files={"part.inc": link_to("not_there")}),
        Case("include_a_huge_file", include + good, ["2 147 483 646 bytes"], line=1,
             files={"part.inc": sparse(10 * 2**30)}),
        Case("include_a_long_path", b"*INCLUDE, INPUT=" + b"x" * 10_000 + b"\n" + good,
             ["cannot open", "too long"], line=1),
        Case("include_a_shell_word", b"*INCLUDE, INPUT=$HOME/x.inc\n" + good,
             ["cannot open '$HOME/x.inc'"], line=1),
        Case("include_a_home", b"*INCLUDE, INPUT=~/x.inc\n" + good, ["cannot open '~/x.inc'"], line=1),
        Case("includes_too_deep", b"*INCLUDE, INPUT=d0.inc\n" + good,
             ["too deep", "included at d1.inc:1", "included at includes_too_deep.inp:1"], files=deep),
        Case("includes_too_many", b"*INCLUDE, INPUT=d0.inc\n" + good, ["more than 10000 files"],
             files=many_includes),
        Case("include_says_the_way", b"** way\n*INCLUDE, INPUT=a.inc\n" + good,
             ["b.inc:2:", "included at a.inc:3", "included at include_says_the_way.inp:2"],
             files={"a.inc": b"** a\n** a\n*INCLUDE, INPUT=b.inc\n", "b.inc": b"*NODE\n5, x, 0.\n"}),
        Case("deck_is_a_picture", png, ["control byte"], line=2),
        Case("deck_is_a_program", b"\x7fELF\x02\x01\x01" + bytes(64), ["control byte 7F"], line=1),
        Case("deck_is_hdf5", b"\x89HDF\r\n\x1a\n" + bytes(64), ["control byte 1A"], line=2),
        Case("old_line_ends", good.replace(b"\n", b"\r"), ["carriage return without a line feed"]),
        Case("form_feed", good.replace(STEP_AT, b"\f" + STEP_AT), ["form feed"]),
    ]


def bad_bytes(Case, good):
    """Characters that a terminal would obey, or that deceive the eye: shown as escapes only."""
    def case(name, old, new, words, absent=()):
        found = Case(name, good.replace(old, new), words)
        found.absent = list(absent)
        return found
    latin = "ELSET=Stöße".encode("latin-1")
    return [
        case("escape_sequence", b"1., 0.", b"\x1b[31m1., 0.", ["control byte 1B", "\\x1B[31m"], ["\x1b"]),
        case("control_of_eight_bits", b"1., 0.", b"\x9b31m1, 0.",
             ["not a number", "the byte 9B", "\\x9B31m1"], ["\x9b"]),
        case("control_as_utf8", b"1., 0.", "\u009b1, 0.".encode(), ["\\u009B1"], ["\u009b"]),
        case("unicode_minus", b"1., 0.", "\u22121, 0.".encode(), ["not a number", "U+2212"]),
        case("wide_digits", b"1., 0.", "\uff11, 0.".encode(), ["not a number", "U+FF11"]),
        case("arabic_digits", b"1., 0.", "\u0661, 0.".encode(), ["not a number", "U+0661"]),
        case("no_break_space", b"1., 0.", "1.\u00a0, 0.".encode(), ["\\u00A0", "U+00A0"], ["\u00a0"]),
        case("no_break_space_in_a_name", b"ELSET=MASSES", "ELSET=A\u00a0B".encode(),
             ["cannot be seen", "A\\u00A0B"], ["\u00a0"]),
        case("right_to_left", b"*BOUNDARY", "*BOUND\u202eYRA".encode(),
             ["unknown keyword", "\\u202E"], ["\u202e"]),
        case("zero_width_in_a_name", b"ELSET=MASSES", "ELSET=MAS\u200bSES".encode(),
             ["cannot be seen", "MAS\\u200BSES"], ["\u200b"]),
        case("latin1_in_a_name", b"ELSET=MASSES", latin, ["cannot be seen", "ST\\xF6\\xDFE"]),
        case("broken_utf8", b"*MASS", b"*MA\xe2\x82SS", ["unknown keyword", "\\xE2\\x82"]),
        case("surface_with_a_slash", STEP_AT, b"*SURFACE, NAME=A/B, TYPE=NODE\n2\n" + STEP_AT,
             ["names a group of the results"]),
        case("commas_alone", b"2, 1., 0.", b",,,", ["node id: missing"]),
        case("parameter_twice_without_effect", STEP_AT, b"*OUTPUT, COMPRESS=1, COMPRESS=9\n" + STEP_AT,
             ["COMPRESS is given twice"]),
        case("blank_in_a_parameter", b"*NODE\n", b"*PARAMETER\nk = 1 2\n*NODE\n",
             ["'1 2' is not a number"]),
        case("comma_missing_behind_a_name", b"*NODE\n", b"*NODE, NSET=ALL INPUT=x\n",
             ["is a comma missing", "ALLINPUT=X"]),
    ]


def bad_sizes(Case, good):
    """Lines, names, counts and lists beyond any use."""
    def case(name, old, new, words, **keys):
        return Case(name, good.replace(old, new, 1), words, **keys)
    long_name = b"N" * 10_000
    return [
        case("line_of_a_hundred_million", b"1., 0.", b"1., 0." + b"," * 10**8, ["too long"], line=3),
        case("keyword_of_a_million", b"*MASS", b"*" + b"M" * 10**6, ["unknown keyword"]),
        case("many_parameters", b"*NODE\n", b"*NODE,\n" + lines("a{i}=1,\n") + b"NSET=A\n",
             ["too many parameters"]),
        case("long_set_name", b"ELSET=MASSES", b"ELSET=" + long_name, ["name is too long"], line=6),
        case("long_parameter", b"*NODE\n", b"*NODE, " + long_name + b"=1\n", ["unknown parameter"]),
        case("long_keyword_value", b"TYPE=MASS", b"TYPE=" + long_name, ["unknown value"]),
        case("long_amplitude_name", STEP_AT, b"*AMPLITUDE, NAME=" + long_name + b"\n0,1\n" + STEP_AT,
             ["name is too long"]),
        case("long_symbol_name", b"*NODE\n", b"*PARAMETER\n" + long_name + b"=1\n*NODE\n",
             ["is no name for a parameter"]),
        case("long_set_in_a_set", STEP_AT, b"*NSET, NSET=A\n" + long_name + b"\n" + STEP_AT,
             ["name is too long"]),
        case("set_loop_of_many", STEP_AT, lines("*NSET, NSET=S{i}\nS{next}\n") + b"*NSET, NSET=S%d\nS0\n"
             % MANY + STEP_AT, ["set loop"]),
        case("sets_too_large", STEP_AT, b"*NSET, NSET=S0\n1\n*NODE\n" + lines("1{i:06d}, 0., 0.\n", 14_500)
             + lines("*NSET, NSET=S{next}\nS{i}\n1{i:06d}\n", 14_500) + STEP_AT,
             ["more than 100000000 members"]),
        case("generate_beyond_the_nodes", STEP_AT,
             b"*NSET, NSET=A, GENERATE\n1, 2000000000, 1\n" + STEP_AT, ["no such node: 3"]),
        case("node_id_of_two_to_the_31", b"2, 1., 0.", b"2147483648, 1., 0.", ["out of range"], line=3),
        case("terms_beyond_all_lines", STEP_AT, b"*EQUATION\n2147483647\n1,1,1.\n" + STEP_AT,
             ["does not fit"]),
    ]


def bad_cases(Case, good):
    return bad_files(Case, good) + bad_bytes(Case, good) + bad_sizes(Case, good)


def good_files(Case, good):
    """Includes by odd paths; what was read is said."""
    nodes = b"*NODE\n1, 0., 0.\n2, 1., 0.\n"
    rest = good[len(nodes):]

    def case(name, path, file, **more):
        found = Case("good_include_" + name, b"*INCLUDE, INPUT=" + path + b"\n" + rest,
                     ["included:", "nodes", "3 lines"], status=0, files={file: nodes, **more})
        return found
    return [
        case("parent", b"sub/../nodes.inc", "nodes.inc", **{"sub/x": b""}),
        case("blanks", b"'my nodes.inc'", "my nodes.inc"),
        case("shell_words", b"~$HOME`nodes`.inc", "~$HOME`nodes`.inc"),
        case("link", b"a_link.inc", "nodes.inc", **{"a_link.inc": link_to("nodes.inc")}),
        case("latin1", "stöße_nodes.inc".encode("latin-1"), os.fsdecode("stöße_nodes.inc".encode("latin-1"))),
        Case("good_say_the_deck", good, ["deck: good_say_the_deck.inp, 17 lines"], status=0),
    ]


def good_sizes(Case, good):
    """Much of one thing, each within the time limit."""
    def case(name, text):
        return Case("good_many_" + name, before_step(good, text), status=0)
    return [
        case("sets", lines("*NSET, NSET=S{i}\n2\n")),
        case("sets_of_sets", lines("*NSET, NSET=S{i}\nS{next}\n") + b"*NSET, NSET=S%d\n2\n" % MANY),
        case("sets_in_a_set", b"*NSET, NSET=B\n2\n*NSET, NSET=A\n" + b"B\n" * MANY),
        case("amplitudes", lines("*AMPLITUDE, NAME=A{i}\n0., 0., 1., 1.\n")),
        case("materials", lines("*MATERIAL, NAME=A{i}\n*ELASTIC\n1., 0.\n", MANY // 2)),
        case("surfaces", lines("*SURFACE, NAME=A{i}, TYPE=NODE\n2\n")),
        case("interactions", lines("*SURFACE INTERACTION, NAME=A{i}\n")),
        case("parameters", b"*PARAMETER\n" + lines("a{i} = {i}\n")),
        case("parameters_used", b"*PARAMETER\n" + lines("a{i} = {i}\n", MANY // 2)
             + b"*AMPLITUDE, NAME=A\n" + lines("<a{i}>, 1.\n", MANY // 2)),
        case("headings", b"*HEADING\n" + lines("line {i}\n")),
        case("equations", b"*NODE\n" + lines("1{i:06d}, 0., 0.\n", MANY // 2)
             + lines("*EQUATION\n2\n1{i:06d},1,1.,2,1,-1.\n", MANY // 2)),
        case("cards_without_effect", b"*PREPRINT\n" * MANY),
    ]


def good_bytes(Case, good):
    """Text beyond ASCII where it may stand, and a heading of a million characters."""
    latin = "Stoß".encode("latin-1")
    return [
        Case("good_latin1_comment", b"** " + latin + b"\n" + good, status=0),
        Case("good_latin1_heading", b"*HEADING\n" + latin + b"\n" + good, ["Sto\\xDF"], status=0),
        Case("good_utf8_names", good.replace(b"MASSES", "Stöße_質量".encode()), status=0),
        Case("good_long_heading", b"*HEADING\n" + b"x" * 10**6 + b"\n" + good, status=0),
        Case("good_mixed_line_ends", good.replace(b"\n", b"\r\n", 5), status=0),
    ]


def good_cases(Case, good):
    return good_files(Case, good) + good_sizes(Case, good) + good_bytes(Case, good)
