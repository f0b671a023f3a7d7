"""What the measurements that write a page share."""

from pathlib import Path


def write_page(text, output):
    """To that file; with - to the standard output."""
    if str(output) == "-":
        print(text, end="")
    else:
        Path(output).write_text(text)
