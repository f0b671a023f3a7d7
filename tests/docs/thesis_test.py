"""What docs/thesis.md names exists, and it leaves no equation, algorithm, table, figure or erratum of the thesis out.

usage: thesis_test.py SOURCE
"""

import pathlib
import re
import sys

# How many the thesis has, by chapter.
EQUATIONS = {"1": 23, "2": 19, "3": 13, "4": 8, "5": 10, "6": 36, "7": 18, "8": 32, "A": 7, "D": 11}
FIGURES = {"1": 2, "2": 4, "3": 18, "4": 1, "5": 3, "6": 25, "7": 3, "8": 11}
TABLES = {"2": 4, "8": 2}
ALGORITHMS = [1, 2, 3, 4, 5, 6]

# Places whose printed form has a mistake, as their rows name them.
ERRATA = """(1.1) (1.6) (1.10) (1.15) Table_2.1 (2.6) (2.8) (2.11) (2.13) (2.16) Table_2.3 (3.2) Algorithm_1 (3.6) (3.13)
(4.3) (4.6) 4.2 (4.7) (5.1) (5.6) (6.4) (6.10) (6.13) (6.14) (6.15) Algorithm_4 (6.19) (6.24) (6.25) (6.33) (7.1)
(7.3) (7.13) (8.13) (8.20) (8.31) (A.1) (D.1) Algorithm_6""".split()

ROW = re.compile(r"^\| (?!thesis|---)(.*) \|$", re.M)
NAME = re.compile(r"`([\w/.-]+)`")


def numbers(text, pattern):
    """Chapter.number pairs that a pattern such as Fig names, ranges filled in."""
    found = set()
    for first, last in re.findall(pattern, text):
        chapter, start = first.split(".")
        end = last.split(".")[1] if last else start
        found |= {(chapter, n) for n in range(int(start), int(end) + 1)}
    return found


def equations(text):
    return numbers(text, r"\(([1-8A-D]\.\d+)\)(?:-\(([1-8A-D]\.\d+)\))?")


def figures(text, word):
    """Those that the lists after "Fig." or "Figs." name; the same of tables."""
    found = set()
    for group in re.findall(rf"{word}s?\.? ((?:\d\.\d+(?:-\d\.\d+)?(?:, | and )?)+)", text):
        found |= numbers(group, r"(\d\.\d+)(?:-(\d\.\d+))?")
    return found


def missing(name, wanted, found):
    return [f"{name} {c}.{n} is not in it" for c, count in wanted.items() for n in range(1, count + 1)
            if (c, n) not in found]


def stands_for_file(source, column, name):
    """Whether a name of the second or third column is a file, as the head of the page says."""
    if name.startswith("examples."):
        return name in (source / "tests" / "examples" / "CMakeLists.txt").read_text()
    if column == "test":
        places = [f"tests/{name}_test.cpp", f"tests/levelset/{name}_test.cpp"]
    else:
        places = [f"src/csrbf/{name}.hpp", f"src/csrbf/{name}.cpp", f"{name}.cpp", f"{name}.py", name,
                  f"src/csrbf/surface/baselines/{name}.cpp"]
    return any((source / place).exists() for place in places)


def files_of_rows(source, text):
    """Problems with what the columns called file and test name."""
    problems, count, heads = [], 0, []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if line.startswith("| thesis"):
            heads = [head.split(",")[0] for head in cells]
            continue
        if not ROW.match(line) or not heads:
            continue
        for head, cell in zip(heads, cells):
            if head not in ("file", "test"):
                continue
            for name in NAME.findall(re.sub(r"\(`[^`]*`\)", "", cell)):
                count += 1
                if not stands_for_file(source, head, name):
                    problems.append(f"the {head} `{name}` of \"{cells[0]}\" does not exist")
    return problems, count


def main():
    source = pathlib.Path(sys.argv[1])
    text = (source / "docs" / "thesis.md").read_text()
    rows = "\n".join(ROW.findall(text))
    problems, count = files_of_rows(source, text)
    problems += missing("equation", EQUATIONS, equations(rows))
    problems += missing("figure", FIGURES, figures(text, "Fig"))
    problems += missing("table", TABLES, figures(rows, "Table"))
    problems += [f"algorithm {n} is not in it" for n in ALGORITHMS if f"Algorithm {n}" not in rows]
    departing = "\n".join(row for row in ROW.findall(text) if re.search(r"\| (corrected|changed|not built)", row))
    known = {f"({c}.{n})" for c, n in equations(departing)}
    for place in ERRATA:
        if place not in known and place.replace("_", " ") not in departing:
            problems.append(f"the mistake printed in {place.replace('_', ' ')} is in no row called corrected")
    print("\n".join(problems) if problems else f"{count} files and tests exist, nothing is left out")
    sys.exit(1 if problems or not count else 0)


if __name__ == "__main__":
    main()
