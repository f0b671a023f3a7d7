"""The page of the gallery: one HTML file with all pictures embedded."""

import base64
import html
import re
import struct

import csrbf
from csrbf.thesis import VERDICTS
from csrbf.thesis.coverage import CHAPTERS, chapter_of, published_in
from csrbf.thesis.errata import ERRATA, errata_of
from csrbf.thesis.plots import replace

MOST_ROWS = 24  # longer tables of numbers are curves, which the drawings show
CLASSES = {"holds": "holds", "fails": "fails", "not comparable": "open"}
SIGNS = {"holds": "✓", "fails": "✗", "not comparable": "–"}

STYLE = """
:root { color-scheme: light dark; --paper: #fff; --ink: #1b2430; --quiet: #566172; --line: #dfe4ea; --soft: #f4f6f8;
  --link: #0b5cad; --holds: #00664a; --holds-soft: #d9f2e8; --fails: #a8330a; --fails-soft: #fde5da;
  --open: #4c5767; --open-soft: #e8ecf1; }
@media (prefers-color-scheme: dark) { :root { --paper: #14181d; --ink: #e6eaef; --quiet: #9fabba; --line: #323b46;
  --soft: #1d232b; --link: #7fbdf5; --holds: #7fdcb9; --holds-soft: #12382d; --fails: #ffab85; --fails-soft: #47200f;
  --open: #bcc7d4; --open-soft: #2a323c; } }
* { box-sizing: border-box; }
html { scroll-behavior: smooth; }
@media (prefers-reduced-motion: reduce) { html { scroll-behavior: auto; } }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main, header { max-width: 1120px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 48px; }
h1 { font-size: 2.1rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.5rem; margin: 4rem 0 .6rem; padding-top: .8rem; border-top: 2px solid var(--line); }
h3 { font-size: 1.15rem; margin: 0 0 .2rem; }
h4 { font-size: .95rem; margin: 1.4rem 0 .3rem; }
p { margin: .4rem 0 1rem; max-width: 46rem; }
a { color: var(--link); text-underline-offset: .15em; }
.note { color: var(--quiet); }
.tiles { display: flex; flex-wrap: wrap; gap: 12px; margin: 1.4rem 0; padding: 0; list-style: none; }
.tiles li { flex: 1 1 140px; padding: 14px 18px; border-radius: 10px; background: var(--soft); color: var(--quiet); }
.tiles b { display: block; font-size: 1.9rem; line-height: 1.15; color: var(--ink); }
.tiles .holds { background: var(--holds-soft); } .tiles .holds, .tiles .holds b { color: var(--holds); }
.tiles .fails { background: var(--fails-soft); } .tiles .fails, .tiles .fails b { color: var(--fails); }
.tiles .open { background: var(--open-soft); } .tiles .open, .tiles .open b { color: var(--open); }
.badge { display: inline-block; padding: 1px 10px; border-radius: 999px; font-size: .84rem; font-weight: 600;
  white-space: nowrap; }
.badge.holds { color: var(--holds); background: var(--holds-soft); }
.badge.fails { color: var(--fails); background: var(--fails-soft); }
.badge.open { color: var(--open); background: var(--open-soft); }
nav ul { columns: 320px; column-gap: 40px; padding: 0; list-style: none; margin: .6rem 0; }
nav li { break-inside: avoid; padding-left: 1.3em; text-indent: -1.3em; } nav a { text-decoration-thickness: 1px; }
nav .chapter { font-weight: 600; margin: .5rem 0 .1rem; break-after: avoid; padding: 0; text-indent: 0; }
nav .mark { display: inline-block; width: 1.3em; text-indent: 0; font-weight: 700; }
.mark.holds { color: var(--holds); } .mark.fails { color: var(--fails); } .mark.open { color: var(--open); }
article { margin: 2.6rem 0 3.4rem; }
.meta { display: flex; flex-wrap: wrap; gap: 6px 10px; align-items: center; margin: .3rem 0 .6rem; color: var(--quiet);
  font-size: .9rem; }
.plot, .scroll { overflow-x: auto; }
.plot { margin: .8rem 0; padding: 10px; border-radius: 10px; background: #fff; border: 1px solid var(--line); }
.plot img { display: block; max-width: 100%; height: auto; margin: 0 auto; }
.renders { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(300px, 46%), 1fr)); gap: 12px;
  margin: .8rem 0; }
.renders figure { margin: 0; border-radius: 10px; overflow: hidden; border: 1px solid var(--line);
  background: var(--soft); }
.renders img { display: block; width: 100%; height: auto; max-height: 420px; object-fit: contain; background: #fff; }
.renders figcaption { padding: 5px 10px 8px; font-size: .86rem; line-height: 1.35; color: var(--quiet); }
table { border-collapse: collapse; width: 100%; font-size: .94rem; line-height: 1.42; }
th, td { padding: 7px 16px 7px 0; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
th { font-size: .84rem; color: var(--quiet); }
sup, sub { line-height: 0; font-size: .75em; }
.names { white-space: nowrap; }
td { font-variant-numeric: tabular-nums; }
.claims { table-layout: fixed; min-width: 560px; } .claims th:nth-child(1) { width: 29%; }
.claims th:nth-child(2) { width: 21%; } .claims th:nth-child(4) { width: 150px; }
.numbers { width: auto; } .numbers td, .numbers th { text-align: right; padding-right: 20px; }
.numbers td:first-child, .numbers th:first-child { text-align: left; }
details { margin: .8rem 0; } summary { cursor: pointer; color: var(--link); }
.errata { margin: .2rem 0; padding: 0; list-style: none; }
.errata li { padding: 5px 0 5px 14px; border-left: 3px solid var(--line); margin: 5px 0; }
.missing { padding: 12px 16px; border-radius: 10px; background: var(--open-soft); color: var(--open); }
footer { max-width: 1120px; margin: 4rem auto 0; padding: 20px 24px 40px; color: var(--quiet); font-size: .9rem; }
@media (max-width: 640px) {
  main, header, footer { padding-left: 16px; padding-right: 16px; }
  h1 { font-size: 1.6rem; } h2 { font-size: 1.3rem; }
  .plot img { max-width: none; min-width: 600px; width: 100%; }
  .claims { min-width: 0; } .claims thead { display: none; }
  .claims tr { display: block; padding: 10px 0; border-bottom: 1px solid var(--line); }
  .claims td { display: block; width: auto !important; padding: 1px 0; border: 0; }
  .claims td::before { content: attr(data-label); color: var(--quiet); font-size: .84rem; }
}
@media print { .plot, .renders figure, tr { break-inside: avoid; } }
"""


def text(words):
    """Words as HTML; numbers such as 1e-3, powers such as x^2 and indices such as p_k are typeset."""
    words = html.escape(words)
    words = re.sub(r"\b(\d+(?:\.\d+)?)e\+?(-?)0*(\d+)\b", r"\1·10^\2\3", words)
    words = re.sub(r"\b(\w)_(\w)\b", r"\1<sub>\2</sub>", words).replace("^-", "^−")
    return re.sub(r"\^(?:\(([^()]*)\)|(−?\d+(?:\.\d+)?|\w))", r"<sup>\1\2</sup>", words)


def write(path, figures, images, seconds):
    """Writes the page.

    figures: those of this run; images: the results of plots.save, by name; seconds: of the whole run.
    """
    content = page(figures, images, seconds)
    replace(path, lambda file: file.write(content.encode()))


def counts(figures):
    """ "12 hold, 2 fail, 3 not comparable" of the claims of all figures."""
    verdicts = [claim.verdict for figure in figures for claim in figure.claims]
    return ", ".join(counted(verdicts.count(verdict), verdict) for verdict in VERDICTS)


def counted(count, verdict):
    """ "1 holds", "2 hold"."""
    plural = {"holds": "hold", "fails": "fail"}
    return f"{count} {verdict if count == 1 else plural.get(verdict, verdict)}"


def page(figures, images, seconds):
    names = [figure.name for figure in figures]
    body = []
    for title, _ in CHAPTERS:
        of_chapter = [figure for figure in figures if chapter_of(figure.name) == title]
        if of_chapter:
            body.append(f'<h2 id="{anchor(title)}">{text(title)}</h2>')
            body += [article(figure, images[figure.name]) for figure in of_chapter]
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>csrbf: the thesis, reproduced</title>
<style>{STYLE}</style>
</head>
<body>
<header>
<h1>The thesis, reproduced</h1>
<p>The figures and tables of A. Gelas, “Compactly Supported Radial Basis Functions: Multidimensional Reconstruction and
Applications” (2006): its claims, and the results of csrbf {text(csrbf.__version__)} on this machine.</p>
{tiles(figures, seconds)}
<p class="note">A claim <b>holds</b> when our numbers confirm it, and <b>fails</b> when they do not, also when there is
no difference where one is claimed. It is <b>not comparable</b> where the thesis prints no number, where times depend on
the machine, and where something goes beyond the thesis. Most of its figures are pictures without numbers; where its
data are not free, others replace them and the text says so.</p>
{failures(figures)}
{contents(figures)}
</header>
<main>
{"".join(body)}
<h2 id="coverage">Every figure and table of the thesis</h2>
{coverage(names)}
<h2 id="errata">Errata</h2>
<p class="note">What is printed and what is correct, in {len(ERRATA)} places, in the order of the thesis.</p>
{errata_table(names)}
</main>
<footer>csrbf {text(csrbf.__version__)}. Written by <code>python3 -m csrbf.thesis</code> in {seconds:.0f} s.</footer>
</body>
</html>
"""


def anchor(title):
    return title.split(":")[0].lower().replace(" ", "-").replace(",", "")


def verdicts_of(figure):
    return [claim.verdict for claim in figure.claims]


def worst(figure):
    """The verdict that summarises all claims of a figure."""
    found = verdicts_of(figure)
    return next((verdict for verdict in ("fails", "holds") if verdict in found), "not comparable")


def badge(verdict, count=None):
    words = counted(count, verdict) if count else verdict
    return f'<span class="badge {CLASSES[verdict]}">{SIGNS[verdict]} {words}</span>'


def tiles(figures, seconds):
    verdicts = [verdict for figure in figures for verdict in verdicts_of(figure)]
    words = {"holds": "claims hold", "fails": "claims fail", "not comparable": "are not comparable"}
    parts = [f'<li class="{CLASSES[v]}"><b>{verdicts.count(v)}</b>{words[v]}</li>' for v in VERDICTS]
    computed = sum(not figure.missing for figure in figures)
    covered = sum(len(published_in(figure.name)) for figure in figures if not figure.missing)
    parts.append(f"<li><b>{covered}</b>figures, tables and topics of the thesis in {computed} sections</li>")
    parts.append(f'<li><b>{len(ERRATA)}</b><a href="#errata">errata</a></li>')
    parts.append(f"<li><b>{seconds:.0f} s</b>to compute and draw</li>")
    return f'<ul class="tiles">{"".join(parts)}</ul>'


def failures(figures):
    rows = [
        f'<li><a href="#{figure.name}">{text(figure.title.split(":")[0])}</a>: {text(claim.what)}. '
        f"Thesis: {text(claim.published)}. Ours: {text(claim.ours)}.</li>"
        for figure in figures
        for claim in figure.claims
        if claim.verdict == "fails"
    ]
    return f'<h4>What does not hold</h4><ul>{"".join(rows)}</ul>' if rows else ""


def contents(figures):
    items = []
    for title, _ in CHAPTERS:
        of_chapter = [figure for figure in figures if chapter_of(figure.name) == title]
        if of_chapter:
            items.append(f'<li class="chapter"><a href="#{anchor(title)}">{text(title)}</a></li>')
        for figure in of_chapter:
            verdict = worst(figure)
            mark = f'<span class="mark {CLASSES[verdict]}" title="{verdict}">{SIGNS[verdict]}</span>'
            items.append(f'<li>{mark}<a href="#{figure.name}">{text(figure.title)}</a></li>')
    items.append('<li class="chapter"><a href="#coverage">Every figure and table of the thesis</a></li>')
    items.append('<li class="chapter"><a href="#errata">Errata</a></li>')
    return f'<nav aria-label="Contents"><h4>Contents</h4><ul>{"".join(items)}</ul></nav>'


def article(figure, images):
    found = verdicts_of(figure)
    badges = "".join(badge(verdict, found.count(verdict)) for verdict in VERDICTS if verdict in found)
    covers = ", ".join(entry.number for entry in published_in(figure.name))
    parts = [
        f'<article id="{figure.name}"><h3>{text(figure.title)}</h3>',
        f'<div class="meta">{badges}<span>{text(covers)}</span><span>{duration(figure.seconds)}</span></div>',
        f'<p class="note">{text(figure.text)}</p>' if figure.text else "",
    ]
    if figure.missing:
        parts.append(f'<p class="missing">Left out: {text(figure.missing)}</p></article>')
        return "".join(parts)
    parts += [plot(path, inches, figure.title) for path, _, inches in images if inches]
    renders = [render(path, caption) for path, caption, inches in images if not inches]
    parts.append(f'<div class="renders">{"".join(renders)}</div>' if renders else "")
    parts.append(claims_table(figure.claims))
    parts.append(errata_list(figure.name))
    parts.append(numbers(figure.tables))
    parts.append("</article>\n")
    return "".join(parts)


def duration(seconds):
    return "less than 0.1 s" if seconds < 0.1 else f"{seconds:.1f} s"


def data(path):
    """A picture as a data URL, and its width and height in pixels."""
    content = path.read_bytes()
    width, height = struct.unpack(">II", content[16:24])
    return f"data:image/png;base64,{base64.b64encode(content).decode()}", width, height


def plot(path, inches, title):
    source, width, height = data(path)
    scale = 96 * inches
    size = f'width="{width * scale:.0f}" height="{height * scale:.0f}"'
    return f'<div class="plot"><img {size} alt="{html.escape(title)}" src="{source}"></div>\n'


def render(path, caption):
    source, width, height = data(path)
    return (
        f'<figure><img width="{width}" height="{height}" alt="{html.escape(caption)}" src="{source}">'
        f"<figcaption>{text(caption)}</figcaption></figure>\n"
    )


def claims_table(claims):
    rows = "".join(
        f'<tr><td>{text(claim.what)}</td><td data-label="thesis: ">{text(claim.published)}</td>'
        f'<td data-label="ours: ">{text(claim.ours)}</td><td>{badge(claim.verdict)}</td></tr>\n'
        for claim in claims
    )
    head = "<thead><tr><th>claim</th><th>thesis</th><th>ours</th><th>verdict</th></tr></thead>"
    return f'<div class="scroll"><table class="claims">{head}<tbody>{rows}</tbody></table></div>'


def errata_list(name):
    items = "".join(
        f'<li><a href="#erratum-{i}">{i}</a> {text(erratum.where)}: printed “{text(erratum.printed)}”; correct: '
        f"{text(erratum.correct)}.</li>"
        for i, erratum in errata_of(name)
    )
    return f'<h4>Errata</h4><ul class="errata">{items}</ul>' if items else ""


def numbers(tables):
    """The short tables; curves are in the drawings."""
    parts = []
    for name, table in tables.items():
        if len(table.rows) > MOST_ROWS or len(table.columns) > 16:
            continue
        columns = ([""] if table.labels else []) + table.columns
        head = "".join(f"<th>{text(column)}</th>" for column in columns)
        rows = ""
        for i, row in enumerate(table.rows):
            cells = ([table.labels[i]] if table.labels else []) + [f"{value:.4g}" for value in row]
            rows += "<tr>" + "".join(f"<td>{text(cell)}</td>" for cell in cells) + "</tr>"
        parts.append(
            f'<h4>{text(name)}</h4><div class="scroll"><table class="numbers"><thead><tr>{head}</tr></thead>'
            f"<tbody>{rows}</tbody></table></div>"
        )
    return f'<details><summary>The numbers</summary>{"".join(parts)}</details>' if parts else ""


def coverage(names):
    rows = []
    for title, entries in CHAPTERS:
        rows.append(f'<tr><th colspan="3">{text(title)}</th></tr>')
        for entry in entries:
            if not entry.figure:
                where = f"not covered: {text(entry.reason)}"
            elif entry.figure in names:
                where = f'<a href="#{entry.figure}">{entry.figure}</a>'
            else:
                where = f"{entry.figure} (not in this run)"
            rows.append(f"<tr><td>{text(entry.number)}</td><td>{text(entry.what)}</td><td>{where}</td></tr>")
    return f'<div class="scroll"><table><tbody>{"".join(rows)}</tbody></table></div>'


def errata_table(names):
    rows = []
    for i, erratum in enumerate(ERRATA, 1):
        links = "<br>".join(f'<a href="#{name}">{name}</a>' for name in erratum.figures if name in names)
        cells = "".join(f"<td>{text(words)}</td>" for words in (erratum.where, erratum.printed, erratum.correct))
        rows.append(f'<tr id="erratum-{i}"><td>{i}</td>{cells}<td class="names">{links}</td></tr>')
    head = "<thead><tr><th></th><th>where</th><th>printed</th><th>correct</th><th>seen in</th></tr></thead>"
    return f'<div class="scroll"><table>{head}<tbody>{"".join(rows)}</tbody></table></div>'
