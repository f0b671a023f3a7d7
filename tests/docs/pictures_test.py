"""The script that draws the pictures of the pages runs, and draws the same twice. Skipped without matplotlib.

usage: pictures_test.py SOURCE PROGRAM FOLDER
"""

import importlib.util
import pathlib
import subprocess
import sys

SKIPPED = 77
NAMES = ["concept_partition", "fit", "info", "segment"]  # quick ones


def main():
    source, program, folder = sys.argv[1:]
    if importlib.util.find_spec("matplotlib") is None:
        print("matplotlib is not installed (Debian: python3-matplotlib)")
        sys.exit(SKIPPED)
    contents = []
    for out in ("first", "second"):
        out = pathlib.Path(folder) / out
        subprocess.run([sys.executable, f"{source}/scripts/make_doc_images.py", "--program", program, "--out", out, *NAMES],
                       check=True)
        contents.append([(out / f"{name}.png").read_bytes() for name in NAMES])
    different = [name for name, first, second in zip(NAMES, *contents) if first != second]
    print(f"differ from run to run: {', '.join(different)}" if different else f"{len(NAMES)} pictures, the same twice")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
