"""Runs the blocks of code of a page as they are printed, in their order, in a folder of its own with the files that
they read; C++ at the end. A block that fails fails the test; those that are not run are counted.

usage: snippets_test.py PAGE.md --fixtures FOLDER --work FOLDER --program CSRBF --cpp PROGRAM [--prefix FOLDER]
                        [--no-python]
"""

import argparse
import importlib
import os
import pathlib
import shutil
import subprocess
import sys
import textwrap
import traceback
from collections import Counter

from snippets import snippets

PROJECT = """cmake_minimum_required(VERSION 3.25)
project(my_program LANGUAGES CXX)
add_executable(my_program main.cpp)
{}
"""


def is_there(name):
    """Whether a module of Python, or a name in it, exists."""
    module, *names = name.split(".")
    try:
        thing = importlib.import_module(module)
        for name in names:
            thing = getattr(thing, name)
    except (ImportError, AttributeError):
        return False
    return True


class Runner:
    def __init__(self, given):
        self.given = given
        self.names = {}
        if not given.no_python:
            code = (pathlib.Path(__file__).parent / "prelude.py").read_text()
            exec(compile(code, "prelude.py", "exec"), self.names)

    def why_not(self, snippet):
        if snippet.not_run:
            return snippet.not_run
        if snippet.language == "python" and self.given.no_python:
            return "needs the Python module"
        if snippet.needs and not is_there(snippet.needs):
            return f"needs {snippet.needs}"
        return ""

    def run(self, snippet):
        getattr(self, snippet.language)(snippet)

    def sh(self, snippet):
        self.call(["bash", "-euo", "pipefail", "-c", snippet.code])

    def python(self, snippet):
        # The blank lines give errors the line of the page.
        exec(compile("\n" * (snippet.line - 1) + snippet.code, self.given.page.name, "exec"), self.names)

    def cmake(self, snippet):
        folder = pathlib.Path("cmake_project")
        folder.mkdir()
        (folder / "main.cpp").write_text("int main() {}\n")
        (folder / "CMakeLists.txt").write_text(PROJECT.format(snippet.code))
        self.call(["cmake", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={self.given.prefix}"])

    def call(self, command):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"exit status {done.returncode}\n{done.stdout}{done.stderr}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--fixtures", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--cpp", type=pathlib.Path, required=True)
    parser.add_argument("--prefix", type=pathlib.Path)
    parser.add_argument("--no-python", action="store_true")
    given = parser.parse_args()
    shutil.rmtree(given.work, ignore_errors=True)
    shutil.copytree(given.fixtures, given.work)
    os.chdir(given.work)
    os.environ["PATH"] = f"{given.program.parent}:{os.environ['PATH']}"

    runner, ran, skipped, failures = Runner(given), Counter(), [], 0
    for snippet in snippets(given.page):
        reason = runner.why_not(snippet)
        if reason:
            skipped.append(f"  line {snippet.line} ({snippet.language}) is not run: {reason}")
            continue
        ran[snippet.language] += 1
        if snippet.language == "cpp":
            continue
        try:
            runner.run(snippet)
        except Exception:
            failures += 1
            print(f"{given.page.name}:{snippet.line}: this block fails:\n{textwrap.indent(snippet.code, '    ')}")
            traceback.print_exc(limit=-2, file=sys.stdout)
    if ran["cpp"]:
        try:
            runner.call([given.cpp, given.page.name])
        except Exception as error:
            failures += 1
            print(f"{given.page.name}: the C++ blocks fail: {error}")
    total = ", ".join(f"{count} {language}" for language, count in sorted(ran.items())) or "none"
    print(f"{given.page.name}: blocks run: {total}; not run: {len(skipped)}")
    print("\n".join(skipped))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
