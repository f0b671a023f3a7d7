"""The blocks of code of a page in Markdown."""

import re
from dataclasses import dataclass

LANGUAGES = ("sh", "python", "cpp", "cmake")
FENCE = re.compile(r"^(?:<!-- *(?P<marker>not run|needs): *(?P<text>.*?) *-->\n)?"
                   r"```(?P<language>\w+)\n(?P<code>.*?)^```$", re.M | re.S)


@dataclass
class Snippet:
    language: str
    code: str
    line: int  # of the page, of the first line of code
    not_run: str = ""  # why it is not
    needs: str = ""  # a module of Python, or a name in it, without which it is not


def snippets(page):
    """Those in a language that can be run, in their order. Directives of the site have other names."""
    text = page.read_text()
    found = []
    for match in FENCE.finditer(text):
        if match["language"] not in LANGUAGES:
            continue
        line = text.count("\n", 0, match.start("code")) + 1
        marker, reason = match["marker"], match["text"]
        if marker and not reason:
            raise ValueError(f"{page}:{line}: the comment gives no reason")
        found.append(Snippet(match["language"], match["code"], line, reason if marker == "not run" else "",
                             reason if marker == "needs" else ""))
    return found
