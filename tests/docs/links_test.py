"""Every link of the pages in Markdown leads to a file of the project and to a heading in it; every picture of the pages
is used; every page of the site is in its contents.

usage: links_test.py SOURCE
"""

import fnmatch
import pathlib
import re
import sys

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.*)$", re.M)
CONTENTS = re.compile(r"^```\{toctree\}\n(.*?)^```$", re.M | re.S)


def text_without_code(page):
    return re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.M | re.S)


def anchors(page):
    """Of its headings, as sites for Markdown make them."""
    names = set()
    for heading in HEADING.findall(text_without_code(page)):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        names.add(re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", heading)))
    return names


def pages_without_place(source):
    """Of the site, those that no table of contents lists."""
    entries = {"docs/index"}
    for page in source.glob("docs/**/*.md"):
        for contents in CONTENTS.findall(page.read_text()):
            names = [line for line in contents.split() if not line.startswith(":")]
            folder = page.parent.relative_to(source)
            entries |= {name[1:] if name.startswith("/") else (folder / name).as_posix() for name in names}
    pages = [*source.glob("docs/**/*.md"), *source.glob("benchmarks/*.md")]
    names = sorted(page.relative_to(source).with_suffix("").as_posix() for page in pages)
    return [name for name in names if not any(fnmatch.fnmatch(name, entry) for entry in entries)]


def main():
    source = pathlib.Path(sys.argv[1])
    pages = sorted([*source.glob("*.md"), *source.glob("docs/**/*.md"), *source.glob("benchmarks/*.md")])
    problems, used, count = [], set(), 0
    for page in pages:
        for link in LINK.findall(text_without_code(page)):
            if "://" in link:
                continue
            count += 1
            file, _, anchor = link.partition("#")
            target = (page.parent / file).resolve() if file else page
            used.add(target)
            if not target.exists():
                problems.append(f"{page.relative_to(source)}: {link} does not exist")
            elif anchor and target.suffix == ".md" and anchor not in anchors(target):
                problems.append(f"{page.relative_to(source)}: {link} has no such heading")
    for picture in sorted((source / "docs" / "images").iterdir()):
        if picture.resolve() not in used:
            problems.append(f"docs/images/{picture.name}: no page shows it")
    problems += [f"{name}.md: no toctree of the site lists it" for name in pages_without_place(source)]
    print("\n".join(problems) if problems else f"{len(pages)} pages, {count} links lead somewhere")
    sys.exit(1 if problems or not count else 0)


if __name__ == "__main__":
    main()
