"""The man page and the completion know what `carom --help` knows, and the other way round; what is installed
is complete and works there; the archive of the sources has all of them: check_packaging.py CAROM BUILD CMAKE CPACK"""
import gzip
import os
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGING = ROOT / 'scripts' / 'packaging'
OPTION = re.compile(r'(?<![\w-])--?[a-z][a-z-]*')
failures = []


def expect(good, sentence):
    """Notes a check; all failed ones are printed in the end."""
    print(('ok      ' if good else 'FAILED  ') + sentence)
    if not good:
        failures.append(sentence)


def same(found, wanted, what):
    """Both sets are equal; else what is missing and what is too much."""
    expect(found == wanted, f'{what}: {len(wanted)} of them'
           + ''.join(f', no {word}' for word in sorted(wanted - found))
           + ''.join(f', {word} is not in --help' for word in sorted(found - wanted)))


def output(*words, **more):
    """What a program prints; it must end with status 0."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=120, **more)
    if done.returncode:
        sys.exit(f'FAILED: {words} ended with {done.returncode}:\n{done.stdout}{done.stderr}')
    return done.stdout + done.stderr


def usage(help_text):
    """The options of each command: {'run': {'-o', ...}, '--version': set(), ...}."""
    commands = {}
    lines = re.search(r'^usage:(.*?)\n\n', help_text, re.S | re.M)[1]
    for part in re.split(r'\bcarom ', lines)[1:]:
        if part.startswith('-'):
            commands.update({word: set() for word in OPTION.findall(part)})
        else:
            commands.setdefault(part.split()[0], set()).update(OPTION.findall(part))
    return commands


def completed(folder, *words):
    """What the completion offers for the last word."""
    script = (f'. {shlex.quote(str(PACKAGING / "carom.bash"))}; COMP_WORDS=({shlex.join(words)}); '
              f'COMP_CWORD={len(words) - 1}; _carom; printf "%s\\n" "${{COMPREPLY[@]}}"')
    return set(output('bash', '-c', script, cwd=folder).split())


def check_completion(program, commands, scratch):
    """Commands, options of each, and the files and names that stand behind options."""
    same(completed(scratch, 'carom', ''), set(commands), 'commands in the completion')
    for command, options in commands.items():
        if options:
            same(completed(scratch, 'carom', command, '-'), options, f'options of {command} in the completion')
    folder = scratch / 'decks'
    (folder / 'more').mkdir(parents=True)
    shutil.copy(ROOT / 'input' / 'sdof' / 'sdof.inp', folder / 'a deck.inp')
    shutil.copy(ROOT / 'input' / 'sdof' / 'sdof.inp', folder / 'b.inp')
    for name in ('old.h5', 'old.log', 'c.vtkhdf'):
        (folder / name).touch()
    decks = completed(folder, 'carom', 'run', '')
    expect(decks == {'a', 'deck.inp', 'b.inp', 'more'}, f'decks and folders are offered: {decks}')
    expect(completed(folder, 'carom', 'run', 'b') == {'b.inp'}, 'those that begin as the word does')
    results = completed(folder, 'carom', 'run', 'b.inp', '--restart', '')
    expect(results == {'old.h5', 'c.vtkhdf', 'more'}, f'results behind --restart: {results}')
    names = completed(folder, 'carom', 'run', 'b.inp', '--define', '')
    expect(names == {'dt=', 'end=', 'e='}, f'the parameters of the deck behind --define: {names}')
    cards = completed(folder, str(program), 'help', 'CONT')
    expect(cards == {'contact'}, f'cards behind help: {cards}')
    cards = completed(folder, str(program), 'help', 'contact', '')
    expect(cards == {'file', 'output', 'pair', 'print'}, f'their second words: {cards}')
    for words in (('CONTACT', 'pair', ''), ('a/b', ''), ('[', ''), ('.*', '')):
        cards = completed(folder, str(program), 'help', *words)
        expect(cards == set(), f'nothing behind help {" ".join(words)}: {cards}')
    for words in (('dt', '='), ('dt', '=', '0')):
        offered = completed(folder, 'carom', 'run', 'b.inp', '--define', *words)
        expect(offered == set(), f'no deck as the value of --define {"".join(words)}: {offered}')
    expect('1' in completed(folder, 'carom', 'run', 'b.inp', '--threads', ''), 'threads')
    expect(completed(folder, 'carom', 'run', 'b.inp', '--time-limit', '') == set(), 'no file as a time')


def check_man_page(commands, help_text):
    """Options and commands of the man page, its exit status, and that formatters have nothing to warn of."""
    page = (PACKAGING / 'carom.1').read_text()
    plain = page.replace('\\-', '-')
    every = set(OPTION.findall(help_text)) | {'-h'}
    same(set(OPTION.findall(plain)), every, 'options in the man page')
    for command in commands:
        if not command.startswith('-'):
            expect(f'.B carom {command}' in plain and re.search(rf'^\.B[IR]? {command}\b', plain, re.M),
                   f'the man page has {command} in its synopsis and among the commands')
    for status, word in re.findall(r'(\d) (\w+)', help_text[help_text.index('exit status:'):]):
        section = plain[plain.index('.SH EXIT STATUS'):plain.index('.SH ENVIRONMENT')]
        expect(re.search(rf'^\.B {status}$', section, re.M), f'exit status {status} ({word}) in the man page')
    for words in (('mandoc', '-T', 'lint', '-W', 'warning'), ('groff', '-man', '-ww', '-Tutf8', '-z'),
                  ('man', '--warnings', '-E', 'UTF-8', '-l')):
        if not shutil.which(words[0]):
            continue
        done = subprocess.run([*words, PACKAGING / 'carom.1'], capture_output=True, text=True,
                              env={**os.environ, 'MANROFFSEQ': '', 'MANWIDTH': '80', 'PAGER': 'cat'})
        said = done.stderr + (done.stdout if words[0] == 'mandoc' else '')
        expect(not said.strip(), f'{words[0]} has nothing to say of the man page {said.strip()[:200]}')


def check_installed(program, build, cmake, scratch):
    """`cmake --install` into an empty folder: the files, the program, the scripts without the checkout."""
    prefix = scratch / 'prefix'
    output(cmake, '--install', build, '--prefix', prefix)
    share = prefix / 'share'
    for name in ('bin/carom', 'share/bash-completion/completions/carom', 'share/doc/carom/README.md',
                 'share/doc/carom/copyright', 'share/carom/input/sdof/README.md',
                 'share/carom/scripts/carom_results.py'):
        expect((prefix / name).is_file(), f'{name} is installed')
    pages = list((share / 'man' / 'man1').glob('carom.1*'))
    expect(len(pages) == 1, 'one man page is installed')
    read = gzip.decompress if pages[0].suffix == '.gz' else bytes
    expect(read(pages[0].read_bytes()) == (PACKAGING / 'carom.1').read_bytes(), 'it is that of the sources')
    tracked = {path.relative_to(ROOT) for kind in ('inp', 'inc') for path in ROOT.glob(f'input/*/*.{kind}')}
    installed = {path.relative_to(share / 'carom') for kind in ('inp', 'inc')
                 for path in share.glob(f'carom/input/*/*.{kind}')}
    same(set(map(str, installed)), set(map(str, tracked)), 'decks installed')
    expect(not list(share.rglob('__pycache__')) and not list(share.rglob('*.h5')), 'and nothing made by runs')
    said = output(prefix / 'bin' / 'carom', '--version')
    expect(said == output(program, '--version'), f'the installed program says {said.strip()}')
    output(prefix / 'bin' / 'carom', 'run', share / 'carom' / 'input' / 'sdof' / 'sdof.inp', '-o',
           scratch / 'sdof.h5', '--quiet')
    expect((scratch / 'sdof.h5').is_file(), 'it runs an installed deck')
    check_scripts(share / 'carom' / 'scripts', scratch)


def check_scripts(folder, scratch):
    """Every script that is installed says how it is used, without those that are not."""
    code = '''
import runpy, sys, pathlib
sys.dont_write_bytecode = True
folder = pathlib.Path(sys.argv[1])
sys.path[0] = str(folder)
for path in sorted(folder.glob("*.py")):
    sys.argv = [str(path), "--help"]
    try:
        runpy.run_path(str(path), run_name="__main__")
    except SystemExit as end:
        if end.code:
            sys.exit(f"{path.name}: {end.code}")
    print("script", path.name)
'''
    said = output(sys.executable, '-c', code, folder, cwd=scratch, env={**os.environ, 'MPLBACKEND': 'Agg'})
    count = len(re.findall(r'^script ', said, re.M))
    expect(count == len(list(folder.glob('*.py'))) > 5, f'{count} installed scripts work by themselves')


def check_source_archive(program, build, cpack, scratch):
    """The archive has what git tracks, the version, and nothing else of what stands in a checkout."""
    output(cpack, '--config', build / 'CPackSourceConfig.cmake', '-B', scratch / 'packed', cwd=build)
    archive, = (scratch / 'packed').glob('*.tar.gz')
    with tarfile.open(archive) as file:
        names = {name.split('/', 1)[1] for name in file.getnames() if '/' in name}
        folder = file.getnames()[0].split('/')[0]
        kept = file.extractfile(f'{folder}/src/version.txt').read().decode().strip()
    said = output(program, '--version').split(None, 1)[1].strip()
    expect(kept.split('-dirty')[0].split()[0] == said.split('-dirty')[0].split()[0],
           f'the archive keeps the version {kept}')
    expect(not [name for name in names if re.match(r'(build|\.git/|\.venv)', name)
                or re.search(r'\.(h5|sta|pyc)$', name)], 'no builds, results, environments in it')
    if (ROOT / '.git').exists() and shutil.which('git'):
        listed = subprocess.run(['git', '-C', ROOT, 'ls-files'], capture_output=True, text=True)
        there = {name for name in listed.stdout.split('\n') if name and (ROOT / name).exists()}
        missing = sorted(there - names)
        expect(not missing, f'all {len(there)} files of the repository in it {missing[:5]}')


def check_versions(program):
    """The number of --version, of project() and of CITATION.cff."""
    said = output(program, '--version').strip()
    expect(re.fullmatch(r'carom \d+\.\d+\.\d+( \([\w.+-]+\))?', said), f'--version: {said}')
    number = re.search(r'project\(carom VERSION (\S+)', (ROOT / 'CMakeLists.txt').read_text())[1]
    cited = re.search(r'^version: (\S+)$', (ROOT / 'CITATION.cff').read_text(), re.M)[1]
    expect(cited == number, f'CITATION.cff has the version of project(): {cited}')
    expect(number in (ROOT / 'CHANGELOG.md').read_text(), 'CHANGELOG.md has it as well')


def main():
    """All checks; status 1 if one failed."""
    program, build, cmake, cpack = (Path(word).resolve() for word in sys.argv[1:5])
    help_text = output(program, '--help')
    commands = usage(help_text)
    with tempfile.TemporaryDirectory(prefix='carom_packaging_') as name:
        scratch = Path(name)
        check_versions(program)
        check_completion(program, commands, scratch)
        check_man_page(commands, help_text)
        check_installed(program, build, cmake, scratch)
        check_source_archive(program, build, cpack, scratch)
    if failures:
        sys.exit(f'{len(failures)} failed:\n  ' + '\n  '.join(failures))


if __name__ == '__main__':
    main()
