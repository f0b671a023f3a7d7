"""What a browser downloads, compressed by gzip, has at most so many bytes.

usage: size_test.py FOLDER (BYTES FILE...)...     each with the files that follow it
"""

import gzip
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
downloads = []  # [most, size, files]
for each in sys.argv[2:]:
    if each.isdigit():
        downloads.append([int(each), 0, []])
    else:
        downloads[-1][1] += len(gzip.compress((folder / each).read_bytes(), 9))
        downloads[-1][2].append(each)
for most, size, files in downloads:
    print(f"{size} bytes, at most {most}: {', '.join(files)}")
sys.exit(any(size > most for most, size, _ in downloads))
