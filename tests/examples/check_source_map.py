"""Check src/README.md against the sources, or write its table of files anew (--write).

Every `name.f90` it names must be in src, every `name.f90: thing` a procedure or type there, and every
file of src must stand once in its last section, "Every file". Its table of layers must say what
src/CMakeLists.txt says.
"""
import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TITLE = "## Every file\n"
MENTION = re.compile(r"([a-z0-9_]+\.f90)(?::\s+([a-z0-9_]+(?:,\s+[a-z0-9_]+)*))?")
PROCEDURE = re.compile(r"^ *(?!end )[^!'\n]*?\b(?:subroutine|function|program) +(\w+)", re.MULTILINE)
TYPE = re.compile(r"^ *type\b[^:(\n]*(?:\([^)\n]*\) *)?:: *(\w+)", re.MULTILINE)


def first_sentence(text):
    """The beginning of a file's `!>` comment, up to the end of its first sentence."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("!>"):
            break
        lines.append(line[2:].strip())
    words = " ".join(lines)
    end = re.search(r"(?<!\be\.g)(?<!\bJ)[.:](?=\s|$)", words)
    return words[:end.start()] if end else words


def layers(root):
    """What each layer may use, in the order of src/CMakeLists.txt."""
    text = (root / "src" / "CMakeLists.txt").read_text(encoding="utf-8")
    rows = re.findall(r"^carom_layer\((\w+)(?:\s+USES\s+([a-z\s]+))?", text, re.MULTILINE)
    return {name: set(used.split()) for name, used in rows}


def layer_faults(root, text):
    """Layers whose row in the text is not that of the build."""
    rows = dict(re.findall(r"^\| (\w+) \| [^|]+ \| ([a-z, –]+) \|$", text, re.MULTILINE))
    return [f"the row of layer {name} is not that of src/CMakeLists.txt"
            for name, used in layers(root).items()
            if set(re.findall(r"[a-z]+", rows.get(name, "none"))) != used]


def table(root):
    """One line a file, from its header, by layers."""
    parts = []
    for layer in layers(root):
        parts.append(f"\n| {layer} | |\n|---|---|")
        for path in sorted((root / "src" / layer).glob("*.f90")):
            said = first_sentence(path.read_text(encoding="utf-8"))
            parts.append(f"| `{path.name}` | {said.replace('|', '/')} |")
    return "\n".join(parts) + "\n"


def known_things(root):
    """Procedures and types of every file of src by its name, and names of files of tests."""
    things = {}
    for path in (root / "src").rglob("*.f90"):
        text = path.read_text(encoding="utf-8").lower()
        things[path.name] = {*PROCEDURE.findall(text), *TYPE.findall(text)}
    others = {path.name for path in (root / "tests").rglob("*.f90")}
    return things, others


def faults(files, others, text):
    """What is wrong with the text, a line each."""
    found = []
    for name, listed in MENTION.findall(text):
        if name not in files and name not in others:
            found.append(f"there is no file {name}")
        for thing in re.split(r",\s+", listed) if listed and name in files else []:
            if thing not in files[name]:
                found.append(f"{name} has no procedure or type {thing}")
    if TITLE not in text:
        return found + [f"no section {TITLE.strip()}"]
    rows = re.findall(r"^\| `([a-z0-9_]+\.f90)` \|", text.split(TITLE)[1], re.MULTILINE)
    own = {name for name in files if name != "main.f90"}
    found += [f"{name} is not listed in its last section" for name in sorted(own - set(rows))]
    found += [f"{name} is listed twice" for name in sorted({r for r in rows if rows.count(r) > 1})]
    return found


def self_test(files, others, text):
    """The check must see a wrong file, a wrong procedure and a file left out."""
    spoilt = [text.replace("`transformation.f90: advance`", "`transformation.f90: advanse`"),
              text + "\n`no_such_file.f90`\n",
              re.sub(r"^\| `structure\.f90` .*\n", "", text, flags=re.MULTILINE)]
    return all(len(faults(files, others, one)) == 1 for one in spoilt)


def main():
    """Ends with status 1 where src/README.md is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the table of files anew")
    given = parser.parse_args()
    path = ROOT / "src" / "README.md"
    text = path.read_text(encoding="utf-8")
    if given.write:
        text = text.split(TITLE)[0] + TITLE + table(ROOT)
        path.write_text(text, encoding="utf-8")
    known = known_things(ROOT)
    found = layer_faults(ROOT, text) + faults(*known, text)
    if not found and not self_test(*known, text):
        found = ["the check does not see a text that is spoilt"]
    if found:
        sys.exit("\n".join(["src/README.md:", *found,
                            "cure: mend the text; python3 tests/examples/check_source_map.py --write "
                            "makes the table of files"]))
    print(f"{len(MENTION.findall(text))} mentions of files and procedures are right")


if __name__ == "__main__":
    main()
