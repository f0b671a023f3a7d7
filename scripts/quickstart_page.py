"""Writes index.html, a page with pictures and figures that links to the reports, from the files that ./quickstart left
in a folder.

usage: quickstart_page.py FOLDER
"""

import base64
import html
import json
import os
import sys
from pathlib import Path

MODELS = {
    "bunny": ("Bunny", "points without normals: csrbf estimates and orients them first"),
    "kitten": ("Kitten", "points with normals"),
}

STYLE = """
:root { color-scheme: light; }
body { margin: 0 auto; max-width: 1120px; padding: 2.5rem 1.5rem 4rem; background: #fff; color: #1d2530;
  font: 16px/1.55 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.9rem; margin: 0 0 .3rem; letter-spacing: -.01em; }
h2 { font-size: 1.25rem; margin: 3rem 0 .2rem; }
p { margin: .3rem 0 1rem; max-width: 46rem; }
.note { color: #5b6675; }
.row { display: grid; grid-template-columns: repeat(2, 1fr); gap: 1rem; }
@media (max-width: 760px) { .row { grid-template-columns: 1fr; } }
figure { margin: 0; border: 1px solid #e2e6eb; border-radius: 6px; overflow: hidden; background: #fff; }
figure img { display: block; width: 100%; aspect-ratio: 1; object-fit: contain; }
figcaption { padding: .45rem .8rem; border-top: 1px solid #e2e6eb; font-size: .88rem; color: #5b6675; }
table { border-collapse: collapse; margin: .6rem 0 0; }
th, td { padding: .42rem 1.6rem .42rem 0; border-bottom: 1px solid #e2e6eb; text-align: left; }
td { font-variant-numeric: tabular-nums; }
thead th { border-bottom: 2px solid #c9d0d8; }
tbody th { font-weight: 400; color: #5b6675; }
pre { background: #f5f7f9; border: 1px solid #e2e6eb; border-radius: 6px; padding: .9rem 1.1rem; overflow-x: auto;
  font: .85rem/1.6 ui-monospace, "DejaVu Sans Mono", monospace; }
"""


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
<title>csrbf quickstart</title>
<style>{STYLE}</style>
</head>
<body>
<h1>csrbf: surfaces from points</h1>
<p class="note">Made on this machine by <code>./quickstart</code> with csrbf {html.escape(str(version))} on
{os.cpu_count()} cores. The point sets come with Debian's package libcgal-demo.</p>
{"".join(parts)}
<h2>Figures</h2>
{table(reports)}
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
