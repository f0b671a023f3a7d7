#!/usr/bin/env python3
"""Fails when a link or picture in a folder of HTML pages is broken, or a page loads anything from another site.

usage: check_site_links.py FOLDER
"""

import pathlib
import sys
from html.parser import HTMLParser
from urllib.parse import unquote, urldefrag

LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("source", "src"), ("iframe", "src")}


class Page(HTMLParser):
    """The links and the anchors of a page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.places, self.foreign = [], {""}, []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.places.add(value)
            if name in ("href", "src") and value and not value.startswith(("mailto:", "data:")):
                if "://" not in value:
                    self.links.append(value)
                elif (tag, name) in LOADED and "://" in value:
                    self.foreign.append(value)


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    pages = {path: Page(path) for path in folder.rglob("*.html")}
    problems, count = [], 0
    for path, page in pages.items():
        problems += [f"{path.relative_to(folder)}: loads {link}" for link in page.foreign]
        for link in page.links:
            count += 1
            file, place = urldefrag(link)
            target = (path.parent / unquote(file.split("?")[0])).resolve() if file else path
            if not target.exists():
                problems.append(f"{path.relative_to(folder)}: {link} does not exist")
            elif place and target in pages and unquote(place) not in pages[target].places:
                problems.append(f"{path.relative_to(folder)}: {link} has no such place")
    print("\n".join(problems) if problems else f"{len(pages)} pages, {count} links lead somewhere")
    sys.exit(1 if problems or not pages else 0)


if __name__ == "__main__":
    main()
