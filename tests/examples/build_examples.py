"""Follow src/README.md: copy the sources, make the changes it tells, build the program and run it.

The changes are lines of two forms: "Copy `a` to `b`." and "In `file`, after|before|instead of
`line`:" with a block of code beneath. A line that a change hangs on must be there once.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys

COPY = re.compile(r"Copy `([^`]+)` to `([^`]+)`")
CHANGE = re.compile(r"In `([^`]+)`, (after|before|instead of) `([^`]+)`:$")


def read_changes(text):
    """Copies as (from, to) and changes as (file, how, line, block), in their order."""
    lines = text.splitlines()
    copies, changes = [], []
    for i, line in enumerate(lines):
        found = COPY.search(line)
        if found:
            copies.append(found.groups())
        found = CHANGE.search(line)
        if not found:
            continue
        if not lines[i + 1].startswith("  ```"):
            raise ValueError(f"no block of code after: {line}")
        end = lines.index("  ```", i + 2)
        changes.append((*found.groups(), [row[2:] for row in lines[i + 2:end]]))
    return copies, changes


def change(path, how, line, block):
    """Put a block after, before or instead of the one line of a file that reads so."""
    with open(path, encoding="utf-8") as file:
        rows = file.read().splitlines()
    places = [i for i, row in enumerate(rows) if row.strip() == line]
    if len(places) != 1:
        raise ValueError(f"{path}: {len(places)} lines read: {line}")
    at = places[0]
    if how == "before" and rows[at].lstrip().startswith("subroutine"):
        while rows[at - 1].lstrip().startswith("!"):
            at -= 1
    rows[at + (how == "after"):at + (how != "before")] = block
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(rows) + "\n")


def make_copy(source, target):
    """The sources in a new folder, with all that src/README.md adds."""
    shutil.rmtree(target, ignore_errors=True)
    os.makedirs(target)
    for name in os.listdir(source):
        if os.path.isfile(os.path.join(source, name)):
            shutil.copy(os.path.join(source, name), target)
    for name in ("src", "input", "scripts", "tests/unit/element", "tests/unit/base", "tests/pfunit_lite"):
        shutil.copytree(os.path.join(source, name), os.path.join(target, name),
                        ignore=shutil.ignore_patterns("__pycache__", "*.h5", "*.png"))
    with open(os.path.join(source, "src", "README.md"), encoding="utf-8") as file:
        copies, changes = read_changes(file.read())
    for origin, place in copies:
        shutil.copy(os.path.join(source, origin), os.path.join(target, place))
    for path, how, line, block in changes:
        change(os.path.join(target, path), how, line, block)
    return len(copies), len(changes)


TESTS = """find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter)
include(pfunit.cmake)
if(TARGET pfunit_lite)
  add_subdirectory(pfunit_lite)
endif()
add_subdirectory(unit/element)
"""


def build(source, target, compiler):
    """The program and the unit tests of elements; without optimization, which takes less time."""
    shutil.copy(os.path.join(source, "tests", "pfunit.cmake"), os.path.join(target, "tests"))
    with open(os.path.join(target, "tests", "CMakeLists.txt"), "w", encoding="utf-8") as file:
        file.write(TESTS)
    folder = os.path.join(target, "build")
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    subprocess.run(["cmake", *generator, "-S", target, "-B", folder, "-DCMAKE_BUILD_TYPE=None",
                    "-DPFUNIT_LITE=ON", f"-DCMAKE_Fortran_COMPILER={compiler}",
                    f"-DPython3_EXECUTABLE={sys.executable}"], check=True, stdout=subprocess.DEVNULL)
    made = subprocess.run(["cmake", "--build", folder, "--parallel", "2", "--target", "carom",
                           "unit_element"], capture_output=True, text=True, check=False)
    if made.returncode != 0 or "Warning:" in made.stdout:
        sys.exit(made.stdout[-6000:] + made.stderr[-2000:])
    return folder


def main():
    """Ends with status 1 where a change, the build, a unit test or a deck fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", help="folder of the sources")
    parser.add_argument("target", help="folder that is made anew")
    parser.add_argument("--compiler", default="gfortran", help="Fortran compiler")
    parser.add_argument("--copy-only", action="store_true", help="make the copy, build nothing")
    given = parser.parse_args()
    try:
        copies, changes = make_copy(given.source, given.target)
    except (OSError, ValueError) as failure:
        sys.exit(f"src/README.md: {failure}")
    print(f"{copies} files copied, {changes} changes made")
    if copies < 3 or changes < 30:
        sys.exit("src/README.md tells less than it did")
    if given.copy_only:
        return
    folder = build(given.source, given.target, given.compiler)
    subprocess.run(["ctest", "--test-dir", folder, "-R", "unit_element", "--output-on-failure",
                    "--no-tests=error"], check=True)
    here = os.path.dirname(os.path.abspath(__file__))
    subprocess.run([sys.executable, os.path.join(here, "verify_examples.py"),
                    os.path.join(folder, "carom")], check=True)


if __name__ == "__main__":
    main()
