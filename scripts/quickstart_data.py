"""Writes what ./quickstart works on besides the point sets: samples of a made seabed along the tracks of a ship, with
noise and a gap, and a picture of made cells with noise.

usage: quickstart_data.py FOLDER
"""

import math
import random
import struct
import sys
import zlib
from pathlib import Path


def depth(x, y):
    """Metres, of a place in kilometres: a slope with a channel and two hills."""
    channel = 18 * math.exp(-((y - 3 - 0.6 * math.sin(1.3 * x)) ** 2) / 0.5)
    hills = 14 * math.exp(-((x - 2.2) ** 2 + (y - 5.5) ** 2) / 0.8) + 9 * math.exp(-((x - 7) ** 2 + (y - 1.3) ** 2) / 0.6)
    return 40 + 3 * x + channel - hills


def soundings(source):
    """Rows x, y, depth along parallel tracks; none in a square that the ship did not cross."""
    for track in range(12):
        y = 0.2 + 0.58 * track
        for step in range(45):
            x = 0.2 * step + 0.05
            if 4.2 < x < 6.2 and 4 < y < 6.2:
                continue
            place = x + source.gauss(0, 0.01), y + source.gauss(0, 0.03)
            yield *place, depth(*place) + source.gauss(0, 0.25)


def cells(source, width=320, height=240):
    """Rows of grey values: bright round cells on a dark ground that brightens to the right."""
    centers = []
    while len(centers) < 22:
        x, y, r = source.uniform(14, width - 14), source.uniform(14, height - 14), source.uniform(9, 19)
        if all(math.hypot(x - a, y - b) > r + c + 4 for a, b, c in centers):
            centers.append((x, y, r))
    for y in range(height):
        row = bytearray()
        for x in range(width):
            value = 50 + 30 * x / width
            for a, b, r in centers:
                edge = math.hypot((x - a) * 1.1, y - b) - r
                value += 90 / (1 + math.exp(min(edge * 2, 50)))
            row.append(max(0, min(255, round(value + source.gauss(0, 22)))))
        yield bytes(row)


def png(rows, channels=1):
    """A picture of rows of bytes: grey (one channel) or colours (three)."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", len(rows[0]) // channels, len(rows), 8, 2 if channels == 3 else 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def main(folder):
    source = random.Random(11)
    rows = "".join(f"{x:.4f},{y:.4f},{z:.3f}\n" for x, y, z in soundings(source))
    (folder / "seabed.csv").write_text("x,y,depth\n" + rows)
    (folder / "cells.png").write_bytes(png(list(cells(source))))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    main(Path(sys.argv[1]))
