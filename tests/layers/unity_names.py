"""Fails when two files that are compiled together (cmake/unity_build.cmake) give the same name to something in their
anonymous namespaces. Names are found by their form in formatted code, so overloads count as the same name.

usage: unity_names.py compiled_together.txt
"""

import collections
import re
import sys

DECLARATIONS = [
    re.compile(r"(?:class|struct|enum class|enum|union)\s+(\w+)"),
    re.compile(r"using\s+(\w+)\s*="),
    re.compile(r"(?:static |inline )?(?:thread_local |constinit )?(?:const|constexpr)\s[^(=]*?(\w+)(?:\[[^\]]*\])?\s*[={]"),
    re.compile(r"[\w:<>,&*\s\[\]]*?[\s&*](\w+)\("),
]


def anonymous_names(lines):
    """The names that start a line between `namespace {` and its end; those of types with what they stand for."""
    inside = False
    for line in lines:
        if line == "namespace {":
            inside = True
        elif line == "}  // namespace":
            inside = False
        elif inside and re.match(r"[A-Za-z]", line) and not line.startswith(("template", "namespace")):
            match = next(filter(None, (form.match(line) for form in DECLARATIONS)), None)
            if match:
                yield match[1], line if line.startswith("using") else None
                yield from ((name, None) for name in re.findall(r",\s*(\w+)\s*=", line) if line.startswith("const"))


def names_of(path):
    with open(path, encoding="utf-8") as file:
        return set(anonymous_names(file.read().splitlines()))


def same_alias(places):
    """A type may have the same name for the same other type twice."""
    return len({alias for _, alias in places}) == 1 and places[0][1] is not None


def main(groups_file):
    owners = collections.defaultdict(lambda: collections.defaultdict(list))
    with open(groups_file, encoding="utf-8") as lines:
        for group, path in (line.split(maxsplit=1) for line in lines.read().splitlines()):
            for name, alias in names_of(path):
                owners[group][name].append((path, alias))
    twice = [f"{name}: {', '.join(path for path, _ in places)}" for names in owners.values()
             for name, places in names.items() if len(places) > 1 and not same_alias(places)]
    for line in sorted(twice):
        print(f"the same name in files that are compiled together: {line}")
    if twice:
        sys.exit("rename one of them, or list a file after ALONE in the call of csrbf_compile_together")
    if not owners:
        sys.exit(f"{groups_file}: no files")


if __name__ == "__main__":
    main(*sys.argv[1:])
