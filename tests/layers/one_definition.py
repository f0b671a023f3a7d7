"""Fails when two files define a type of the same name in the same namespace: the linker keeps one of the functions that
compilers make for them, such as the destructor, and calls it for both. Types are found by their form in formatted code.

usage: one_definition.py FOLDER...
"""

import collections
import pathlib
import re
import sys

TYPE = re.compile(r"(?:class|struct|enum class|enum|union)\s+(\w+)(?: final)?(?: : [^;]*)? \{")


def types_of(lines):
    """The types that start a line, with their namespaces, outside anonymous ones."""
    scope = []
    for line in lines:
        if opened := re.match(r"(?:inline )?namespace ?([\w:]*) ?\{$", line):
            scope.append(opened[1])
        elif line.startswith("}  // namespace"):
            scope.pop()
        elif "" not in scope and (match := TYPE.match(line)):
            yield "::".join([*scope, match[1]])


def main(*folders):
    places = collections.defaultdict(set)
    for folder in folders:
        for path in pathlib.Path(folder).rglob("*.[ch]pp"):
            for name in types_of(path.read_text(encoding="utf-8").splitlines()):
                places[name].add(str(path))
    for name, paths in sorted(places.items()):
        if len(paths) > 1:
            print(f"defined twice: {name}: {', '.join(sorted(paths))}")
    if not places:
        sys.exit("no types")
    if any(len(paths) > 1 for paths in places.values()):
        sys.exit("rename one of them, or put both in anonymous namespaces")


if __name__ == "__main__":
    main(*sys.argv[1:])
