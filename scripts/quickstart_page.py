"""Writes index.html, a page with pictures and figures that links to the reports, from the files that ./quickstart left
in a folder.

usage: quickstart_page.py FOLDER
"""

import array
import ast
import base64
import html
import json
import math
import os
import sys
from pathlib import Path

from quickstart_data import png

MODELS = {
    "bunny": ("Bunny", "points without normals: csrbf estimates and orients them first"),
    "kitten": ("Kitten", "points with normals"),
}

STYLE = """
:root { color-scheme: light dark; --ground: #fff; --panel: #f7f8fa; --text: #1b2330; --muted: #5a6575; --line: #dfe3e9;
  --accent: #24658f; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #14181e; --panel: #1b2028; --text: #e4e8ee; --muted: #9aa5b4; --line: #2d343f; --accent: #6fb3e0; }
}
body { margin: 0 auto; max-width: 1120px; padding: 2.5rem 1.5rem 4rem; background: var(--ground); color: var(--text);
  font: 16px/1.55 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.9rem; margin: 0 0 .3rem; letter-spacing: -.01em; }
h2 { font-size: 1.25rem; margin: 2.8rem 0 .2rem; }
p { margin: .3rem 0 1rem; max-width: 46rem; }
a { color: var(--accent); }
.note { color: var(--muted); }
.row { display: grid; grid-template-columns: repeat(2, 1fr); gap: 1rem; }
@media (max-width: 760px) { .row { grid-template-columns: 1fr; } }
figure { margin: 0; border: 1px solid var(--line); border-radius: 8px; overflow: hidden; background: var(--panel);
  display: flex; flex-direction: column; }
figure > a, figure > .picture { flex: 1; display: grid; place-items: center; }
figure img { display: block; width: 100%; height: auto; }
figcaption { padding: .45rem .8rem; border-top: 1px solid var(--line); font-size: .88rem; color: var(--muted);
  background: var(--ground); }
.bar { height: .6rem; border-radius: 3px; margin: .3rem 0 .1rem; }
.ends { display: flex; justify-content: space-between; }
table { border-collapse: collapse; margin: .6rem 0 0; }
th, td { padding: .42rem 1.6rem .42rem 0; border-bottom: 1px solid var(--line); text-align: left; }
td { font-variant-numeric: tabular-nums; }
thead th { border-bottom: 2px solid var(--line); }
tbody th { font-weight: 400; color: var(--muted); }
.scroll { overflow-x: auto; }
pre { background: var(--panel); border: 1px solid var(--line); border-radius: 8px; padding: .9rem 1.1rem;
  overflow-x: auto; font: .85rem/1.6 ui-monospace, "DejaVu Sans Mono", monospace; }
.open { padding: .9rem 1.1rem; background: var(--panel); border: 1px solid var(--line); border-radius: 8px; margin: 1.4rem 0;
  max-width: none; }
"""

# Colours of low to high values, as the program draws them.
STOPS = ["#0c1d5c", "#1c4a7d", "#1f7a86", "#3aa57a", "#8fc860", "#f3e88a"]


def main(folder):
    reports = {name: json.loads((folder / f"{name}.json").read_text()) for name in MODELS}
    parts = [section(folder, name, report) for name, report in reports.items()]
    commands = (folder / "commands.txt").read_text()
    version = next(iter(reports.values())).get("csrbf", "")
    page = f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>csrbf quickstart</title>
<style>{STYLE}</style>
</head>
<body>
<h1>csrbf: surfaces, functions, regions</h1>
<p class="note">Made on this machine by <code>./quickstart</code> with csrbf {html.escape(str(version))} on
{os.cpu_count()} cores. The point sets come with Debian's package libcgal-demo; the samples and the picture are made.</p>
<p class="open">To work on all of this in the browser, with sliders for every option:<br>
<code>csrbf studio --folder {html.escape(str(folder.resolve()))}</code></p>
{"".join(parts)}
{function_section(folder)}
{image_section(folder)}
<h2>Figures</h2>
<div class="scroll">{table(reports)}</div>
<p class="note">Distances are from the input points to the surface, in parts per million of the diagonal of the
bounding box. All figures come from the reports (<code>--report</code>).</p>
<h2>Commands</h2>
<p>Run in <code>quickstart-output/</code>; put <code>build/release/bin</code> on the <code>PATH</code> to repeat them.</p>
<pre>{html.escape(commands)}</pre>
</body>
</html>
"""
    (folder / "index.html").write_text(page)


def section(folder, name, report):
    title, note = MODELS[name]
    link = f'<a href="{name}.html#up=y">'
    return f"""
<h2>{title}</h2>
<p class="note">{report["input"]["points"]:,} {note}. {link}Rotate and cut the surface, and see what was chosen and
why</a>.</p>
<div class="row">
<figure>{link}{image(folder / f"{name}.png", "surface")}</a><figcaption>The surface</figcaption></figure>
<figure>{link}{image(folder / f"{name}-curvature.png", "mean curvature")}</a>
<figcaption>Its mean curvature: red convex, blue concave</figcaption></figure>
</div>"""


def read_npy(path):
    """Shape and numbers of an array of doubles."""
    data = path.read_bytes()
    size = int.from_bytes(data[8:10], "little")
    shape = ast.literal_eval(data[10:10 + size].decode("latin1"))["shape"]
    numbers = array.array("d")
    numbers.frombytes(data[10 + size:])
    return shape, numbers


def color(t):
    place = min(max(t, 0), 1) * (len(STOPS) - 1)
    first = min(int(place), len(STOPS) - 2)
    low, high = (bytes.fromhex(STOPS[first + k][1:]) for k in (0, 1))
    return bytes(round(a + (place - first) * (b - a)) for a, b in zip(low, high))


def map_figure(values, width, height, caption, unit):
    """A figure of values row by row, the first row lowest, with its colour scale."""
    lo, hi = min(values), max(values)
    table = [color(i / 255) for i in range(256)]
    rows = []
    for y in reversed(range(height)):
        row = (values[y * width + x] for x in range(width))
        rows.append(b"".join(table[round(255 * (v - lo) / ((hi - lo) or 1))] if math.isfinite(v) else b"\x80\x80\x80" for v in row))
    data = base64.b64encode(png(rows, channels=3)).decode()
    return f"""<figure><div class="picture"><img alt="{caption}" src="data:image/png;base64,{data}"></div>
<figcaption>{caption}<div class="bar" style="background:linear-gradient(to right,{",".join(STOPS)})"></div>
<div class="ends"><span>{lo:.3g} {unit}</span><span>{hi:.3g} {unit}</span></div></figcaption></figure>"""


def function_section(folder):
    report = json.loads((folder / "seabed.json").read_text())
    shape, numbers = read_npy(folder / "seabed.npy")
    height, width = shape[0], shape[1]
    values, deviations = numbers[0::2], numbers[1::2]
    result = report["result"]
    return f"""
<h2>A function and its uncertainty</h2>
<p class="note">{result["samples"]:,} soundings along the tracks of a ship, with noise and a gap. Left-out samples are
predicted with an error of {result["cross_validation_rmse"]:.2g} m. <a href="seabed.html">The function as a landscape, its errors, and what
was chosen</a>.</p>
<div class="row">
{map_figure(values, width, height, "Depth", "m")}
{map_figure(deviations, width, height, "Standard deviation of a sample there: it grows in the gap", "m")}
</div>"""


def image_section(folder):
    report = json.loads((folder / "cells.json").read_text())
    contour = report["result"].get("contour", {})
    return f"""
<h2>An image and its contour</h2>
<p class="note">A noisy picture of cells. The contour encloses an area of {contour.get("area", 0):,.0f} ± {contour.get("area_error", 0):.1g} square
pixels. <a href="cells.html">The contour, intensities of the regions, and what was chosen</a>.</p>
<div class="row">
<figure><div class="picture">{image(folder / "cells.png", "the picture")}</div><figcaption>The picture</figcaption></figure>
<figure><a href="cells.html">{image(folder / "cells-contour.png", "contour")}</a><figcaption>Its contour</figcaption></figure>
</div>"""


def image(path, text):
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{text}" src="data:image/png;base64,{data}">'


def table(reports):
    def count(key):
        return lambda report: f'{report["result"][key]:,}'

    def millionths(key):
        return lambda report: f'{1e6 * report["result"][key]:,.0f}'

    rows = {
        "points": count("points"),
        "normals": lambda report: html.escape(str(report["result"]["normals"])),
        "method": lambda report: html.escape(str(report["result"]["method"])),
        "centres": count("centers"),
        "triangles": count("triangles"),
        "connected components": count("components"),
        "Euler characteristic": count("euler"),
        "watertight": lambda report: "yes" if report["result"]["watertight"] else "no",
        "distance, root mean square": millionths("rms_distance"),
        "distance, 99th percentile": millionths("p99_distance"),
        "time": lambda report: f'{report["time"]["total"]:.2f} s',
        "peak memory": lambda report: f'{report["peak_memory_mb"]:.0f} MB',
    }
    head = "".join(f"<th>{MODELS[name][0]}</th>" for name in reports)
    body = ""
    for label, get in rows.items():
        cells = "".join(f"<td>{cell(get, report)}</td>" for report in reports.values())
        body += f'<tr><th scope="row">{label}</th>{cells}</tr>'
    return f"<table><thead><tr><th></th>{head}</tr></thead><tbody>{body}</tbody></table>"


def cell(get, report):
    try:
        return get(report)
    except (KeyError, TypeError, ValueError):
        return "&ndash;"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    main(Path(sys.argv[1]))
