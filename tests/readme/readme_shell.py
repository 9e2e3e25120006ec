"""Runs the commands of a README in a copy of the checkout, with the program under test as build/carom."""
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path


class Shell:
    """A scratch copy of what a checkout holds, in which commands run one after the other."""

    def __init__(self, root, program, build):
        self.root, self.build = root, build
        self.folder = Path(tempfile.mkdtemp(prefix='carom_readme_'))
        shutil.copytree(root / 'input', self.folder / 'input',
                        ignore=shutil.ignore_patterns('*.h5*', '*.sta', '*.log', '__pycache__'))
        for name in ('scripts', 'src', 'tests', '.ci', 'README.md', 'CMakeLists.txt', 'CMakePresets.json'):
            (self.folder / name).symlink_to(root / name)
        self._stand_in('build/carom', [str(program)])
        self._stand_in('bin/carom', [str(program)])
        for name in ('.venv/bin/python', 'bin/python', 'bin/python3'):
            self._stand_in(name, [sys.executable, '-B'])
        self.environment = {**os.environ, 'MPLBACKEND': 'Agg', 'OPENBLAS_NUM_THREADS': '1',
                            'PATH': f'{self.folder}/bin:{os.environ["PATH"]}', 'TMPDIR': str(self.folder)}

    def _stand_in(self, name, words):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f'#!/bin/sh\nexec {shlex.join(words)} "$@"\n')
        path.chmod(0o755)

    def close(self):
        """Removes the copy."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def change(self, name, old, new):
        """Changes a file of the copy; keeps what it was."""
        path = self.folder / name
        text = path.read_text()
        if text.count(old) != 1:
            raise ValueError(f'{name} has "{old}" {text.count(old)} times, not once')
        path.write_text(text.replace(old, new))
        return lambda: path.write_text(text)

    def run(self, command, folder='.'):
        """Exit status and text of a command, which is run from the top of the copy, or a folder there."""
        words = shlex.split(command, comments=True)
        where = self.folder / folder
        if len(words) > 1 and words[0] in ('python', 'python3', '.venv/bin/python') \
                and words[1].endswith('.py') and not set('|<>;&') & set(command):
            return self._run_python(where / words[1], words[2:], where)
        done = subprocess.run(['bash', '-c', command], cwd=where, capture_output=True, text=True,
                              timeout=300, env=self.environment, stdin=subprocess.DEVNULL)
        return done.returncode, done.stdout + done.stderr

    def run_python(self, code):
        """Exit status and text of lines of Python, with PYTHONPATH=scripts as README.md says."""
        path = self.folder / 'example.py'
        path.write_text(code)
        return self._run_python(path, [], self.folder, first_path=str(self.folder / 'scripts'))

    def _run_python(self, script, arguments, where, first_path=None):
        """A script in a copy of this process, which has loaded matplotlib and h5py already."""
        path = self.folder / 'printed'
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            _become(script, arguments, where, path, self.environment, first_path)
        _, status = os.waitpid(child, 0)
        return os.waitstatus_to_exitcode(status), path.read_text()


def _become(script, arguments, where, printed, environment, first_path):
    """Runs a script as `python script arguments` would, and ends the process."""
    import runpy
    import traceback
    status = 1
    try:
        descriptor = os.open(printed, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(descriptor, 1)
        os.dup2(descriptor, 2)
        os.chdir(where)
        os.environ.update(environment)
        sys.argv = [str(script), *arguments]
        sys.path[0] = str(Path(script).resolve().parent) if first_path is None else first_path
        sys.dont_write_bytecode = True
        runpy.run_path(str(script), run_name='__main__')
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
