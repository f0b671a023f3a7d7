"""What a browser downloads, compressed by gzip, has at most so many bytes.

usage: size_test.py FOLDER NAME=BYTES...     NAME.js and NAME.wasm together
"""

import gzip
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
is_small = True
for each in sys.argv[2:]:
    name, most = each.split("=")
    size = sum(len(gzip.compress((folder / f"{name}.{kind}").read_bytes(), 9)) for kind in ("js", "wasm"))
    print(f"{name}: {size} bytes, at most {most}")
    is_small = is_small and size <= int(most)
sys.exit(not is_small)
