#!/usr/bin/env python3
"""CPU seconds of building csrbf from nothing: preset release without the tests, hence library, program and module.

usage: build_time.py [COMMIT...] [--dearest N] [--option -DNAME=VALUE ...]

Commits (HEAD if none is given) are built at the same time, each by one job, in folders of their own, so that a busy
machine delays all of them alike; compiler caches are off. Prints a table for BUILD.md: totals, and the dearest files
of the last commit.
"""

import argparse
import collections
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

LOG = "CSRBF_BUILD_TIME_LOG"
SOURCE = pathlib.Path(__file__).resolve().parent.parent

Build = collections.namedtuple("Build", "commit folder log process began")


def launch(command):
    """Runs a compiler and notes its CPU seconds; CMake calls this in place of the compiler."""
    code = subprocess.call(command)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    output = command[command.index("-o") + 1] if "-o" in command else "?"
    with open(os.environ[LOG], "a", encoding="utf-8") as log:
        log.write(f"{used.ru_utime + used.ru_stime:.2f} {output}\n")
    return code


def start(commit, folder, options):
    sources = folder / "csrbf"
    sources.mkdir(parents=True)
    archive = subprocess.run(["git", "archive", commit], cwd=SOURCE, check=True, capture_output=True).stdout
    subprocess.run(["tar", "-x", "-C", sources], input=archive, check=True)
    log = folder / "log"
    log.touch()
    launcher = f"{sys.executable};{pathlib.Path(__file__).resolve()};--launch"
    configure = ["cmake", "--preset", "release", "-DCSRBF_BUILD_TESTS=OFF", "-Wno-dev",
                 f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}", *options]
    script = 'cmake --build --preset release -j 1'
    environment = dict(os.environ, CCACHE_DISABLE="1", **{LOG: str(log)})
    command = ["sh", "-c", '"$@" && exec ' + script, "sh", *configure]
    with open(folder / "output", "wb") as output:
        process = subprocess.Popen(command, cwd=sources, env=environment, stdout=output, stderr=subprocess.STDOUT)
    return Build(commit, folder, log, process, time.monotonic())


def wait(builds):
    """CPU seconds (with configuring, linking and the viewer's bundler) and elapsed seconds of each."""
    found = {}
    while len(found) < len(builds):
        pid, status, used = os.wait4(-1, 0)
        for build in builds:
            if build.process.pid != pid:
                continue
            if status != 0:
                sys.exit(f"{build.commit} did not build:\n{(build.folder / 'output').read_text()[-3000:]}")
            found[build.commit] = (used.ru_utime + used.ru_stime, time.monotonic() - build.began)
    return found


def lines_of_code(folder):
    files = [path for part in ("src", "app", "python") for path in (folder / "csrbf" / part).rglob("*.[ch]pp")]
    return sum(path.read_bytes().count(b"\n") for path in files)


def dearest(log, count):
    rows = [line.split(" ", 1) for line in log.read_text().splitlines()]
    rows = sorted(((float(seconds), name) for seconds, name in rows), reverse=True)[:count]
    names = (re.sub(r"CMakeFiles/|\.dir|Unity/unity_in_|_cxx\.cxx|\.o(bj)?$", "", name) for _, name in rows)
    return [(name, seconds) for name, (seconds, _) in zip(names, rows)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("commits", nargs="*", default=["HEAD"])
    parser.add_argument("--dearest", type=int, default=10, metavar="N")
    parser.add_argument("--option", action="append", default=[], help="for CMake, such as --option=-DCSRBF_UNITY_BUILD=OFF")
    arguments = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="csrbf-build-time."))
    try:
        builds = [start(commit, folder / str(i), arguments.option) for i, commit in enumerate(arguments.commits)]
        found = wait(builds)
        print("| commit | lines of C++ | CPU seconds | per 1000 lines | elapsed |\n|---|---:|---:|---:|---:|")
        for build in builds:
            cpu, elapsed = found[build.commit]
            lines = lines_of_code(build.folder)
            print(f"| {build.commit} | {lines} | {cpu:.0f} | {1000 * cpu / lines:.1f} | {elapsed:.0f} s |")
        print(f"\n| dearest files of {builds[-1].commit} | CPU seconds |\n|---|---:|")
        for name, seconds in dearest(builds[-1].log, arguments.dearest):
            print(f"| {name} | {seconds:.0f} |")
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--launch"]:
        sys.exit(launch(sys.argv[2:]))
    main()
