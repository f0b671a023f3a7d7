"""Draws the figures that csrbf-thesis computed, and writes a page with all of them and the table published / ours.

usage: thesis_page.py FOLDER

Reads FOLDER/*.json; writes FOLDER/*.png and FOLDER/index.html, one file with everything in it.
"""

import base64
import html
import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

# Okabe and Ito: distinct for all common kinds of colour vision; markers and dashes differ as well.
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DASHES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), "-"]

ORDER = ["chapter-1", "figure-2.4", "table-2.4", "figure-3.4", "figure-3.9", "figure-3.14", "figure-3.16", "k-space",
         "dimensions", "figure-6.4", "figure-6.5", "figure-6.6", "figure-6.8", "figure-6.10", "figure-6.17",
         "figure-6.18", "figure-6.21", "figure-7.1", "figure-8.2", "figure-8.4", "figure-8.6", "figure-8.8",
         "figure-8.10", "table-8.1"]

STYLE = """
:root { color-scheme: light; }
body { margin: 0 auto; max-width: 1100px; padding: 2.5rem 1.5rem 4rem; background: #fff; color: #1d2530;
  font: 16px/1.55 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.9rem; margin: 0 0 .3rem; }
h2 { font-size: 1.25rem; margin: 3rem 0 .2rem; }
p { margin: .3rem 0 1rem; max-width: 50rem; }
img { max-width: 100%; display: block; margin: .6rem 0; }
.note { color: #5b6675; }
.renders { display: grid; grid-template-columns: repeat(auto-fill, minmax(230px, 1fr)); gap: .6rem; }
.renders figure { margin: 0; }
.renders figcaption { color: #5b6675; font-size: .85rem; text-align: center; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .6rem 0 1rem; }
th, td { padding: .4rem 1.2rem .4rem 0; border-bottom: 1px solid #e2e6eb; text-align: left; vertical-align: top; }
td { font-variant-numeric: tabular-nums; }
thead th { border-bottom: 2px solid #c9d0d8; }
.fails { font-weight: 700; color: #b3261e; }
"""


class Columns:
    """A table of numbers by the names of its columns."""

    def __init__(self, table):
        self.names = table["columns"]
        self.data = np.array(table["rows"], dtype=float)

    def __getitem__(self, column):
        return self.data[:, column if isinstance(column, int) else self.names.index(column)]


def main(folder):
    plt.rcParams.update({
        "figure.dpi": 120, "font.size": 10, "axes.grid": True, "grid.color": "#e3e6ea", "axes.axisbelow": True,
        "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "axes.titlesize": 10,
        "savefig.bbox": "tight", "figure.constrained_layout.use": True})
    figures = [json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))]
    figures = [figure for figure in figures if figure["name"] in DRAW]
    if not figures:
        sys.exit(f"thesis_page.py: no results of csrbf-thesis in {folder}")
    figures.sort(key=lambda figure: ORDER.index(figure["name"]))
    parts = []
    for figure in figures:
        tables = {name: Columns(table) for name, table in figure["tables"].items()}
        images = [save(folder, f"{figure['name']}{suffix}.png", drawing)
                  for suffix, drawing in DRAW[figure["name"]](figure, tables)] if tables else []
        parts.append(section(figure, images, folder))
    (folder / "index.html").write_text(page(figures, parts))


def save(folder, name, drawing):
    path = folder / name
    drawing.savefig(path)
    plt.close(drawing)
    return path


# One figure each: a list of (suffix of the file, drawing).


def draw_chapter_1(_, tables):
    drawing, axes = plt.subplots(1, 3, figsize=(11, 3.3))
    t = tables["global polynomial"]
    lines(axes[0], t["degree"], [t["RMSE at the samples"], t["RMSE"]], ["at the samples", "on [-1, 1]"])
    style(axes[0], "degree", "root mean square error", "Global polynomial, 100 samples of (3.5)", y_log=True)
    axes[0].set_xticks(np.arange(4, 21, 4))
    t = tables["band-limited"]
    lines(axes[1], t[0], [t["largest error"]], [None])
    style(axes[1], "values on either side of [0, 1]", "largest error", "Band-limited series (1.5)", y_log=True)
    t = tables["frame iteration"]
    lines(axes[2], t["iteration"], [t["error"], t["bound"]], ["error", r"$((B-A)/(B+A))^n$"], markers=False)
    style(axes[2], "iteration n", "relative error", "Frame iteration (1.20)", y_log=True)
    return [("", drawing)]


def draw_figure_2_4(_, tables):
    t = tables["curves"]
    drawing, axes = plt.subplots(1, 3, figsize=(11, 3), sharey=True)
    for axis, name in zip(axes, t.names[2:]):
        axis.plot(t["x"], t["signal"], color="#9aa3ad", lw=2.5, label="signal (3.5)")
        axis.plot(t["x"], t[name], color=COLORS[0], lw=1.1, label="interpolant")
        style(axis, "x", "f" if axis is axes[0] else "", f"support {name}")
    axes[0].legend(loc="upper right", fontsize=8)
    first = ("-curves", drawing)
    t = tables["supports"]
    drawing, axes = plt.subplots(1, 3, figsize=(11, 3))
    for axis, column, label, y_log in [(axes[0], "RMSE", "root mean square error", True),
                                       (axes[1], "density", "share of the matrix that is not 0", False),
                                       (axes[2], "condition", "condition of the matrix", True)]:
        lines(axis, t[0], [t[column]], [None])
        style(axis, "support / sample distance", label, "", x_log=True, y_log=y_log)
    return [first, ("-supports", drawing)]


def draw_table_2_4(_, tables):
    compact, dense = tables["compact"], tables["global"]
    drawing, axes = plt.subplots(1, 3, figsize=(11, 3.3))
    for axis, column, label in [(axes[0], "assembly [s]", "build the matrix [s]"), (axes[1], "solve [s]", "solve [s]"),
                                (axes[2], "evaluation [us / point]", "evaluate at one point [µs]")]:
        for i, (t, name) in enumerate([(compact, "compact support"), (dense, "global support")]):
            axis.plot(t["samples"], t[column], ls=DASHES[i], marker=MARKERS[i], color=COLORS[i], ms=4,
                      label=f"{name}, $N^{{{order(t['samples'], t[column]):.1f}}}$")
        style(axis, "samples N", label, "", x_log=True, y_log=True)
        axis.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1))
    return [("", drawing)]


def draw_figure_3_4(_, tables):
    t, samples, errors = tables["levels"], tables["samples"], tables["errors by level"]
    levels = t.names[2:]
    shown = sorted({0, len(levels) // 3, 2 * len(levels) // 3, len(levels) - 1})
    drawing, axes = plt.subplots(2, 2, figsize=(9, 5), sharex=True, sharey=True)
    for axis, level in zip(axes.flat, shown):
        axis.plot(t["x"], t["signal"], color="#9aa3ad", lw=2.5, label="signal (3.5)")
        axis.plot(samples["x"], samples["s"], ".", color="#000000", ms=4, label="samples")
        axis.plot(t["x"], t[levels[level]], color=COLORS[1], lw=1.2, label="approximation")
        style(axis, "x" if level in shown[-2:] else "", "",
              f"{levels[level]}: {int(errors['centers'][: level + 1].sum())}"
              f" functions, RMSE {errors['RMSE'][level]:.2g}")
    axes.flat[0].legend(loc="upper right", fontsize=8)
    first = ("", drawing)
    t, noisy = tables["noisy curves"], tables["noisy samples"]
    drawing, axes = plt.subplots(1, 3, figsize=(11, 3), sharey=True)
    for axis, name in zip(axes, t.names[2:]):
        axis.plot(t["x"], t["signal"], color="#9aa3ad", lw=2.5, label="signal (3.5)")
        axis.plot(noisy["x"], noisy["s"], ".", color="#000000", ms=4, label="samples, 21 dB")
        axis.plot(t["x"], t[name], color=COLORS[1], lw=1.1, label="approximation")
        style(axis, "x", "", name)
    axes[0].legend(loc="upper right", fontsize=8)
    second = ("-noise", drawing)
    t = tables["thresholds"]
    drawing, axis = plt.subplots(figsize=(6.5, 4))
    for i, name in enumerate(t.names[1:]):
        axis.plot(t["threshold"], t[name], ls=DASHES[i], color=COLORS[i], label=name)
        best = np.argmin(t[name])
        axis.plot(t["threshold"][best], t[name][best], MARKERS[i], color=COLORS[i], ms=7)
    style(axis, "threshold", "root mean square error", "Fig. 3.6: error at the samples; markers: best threshold",
          x_log=True, y_log=True)
    axis.legend()
    return [first, second, ("-thresholds", drawing)]


def draw_figure_3_9(figure, tables):
    t = tables["errors by level"]
    drawing, axis = plt.subplots(figsize=(6.5, 3.6))
    lines(axis, t["level"], [t["RMSE"], t["largest error at the samples"]],
          ["RMSE between the samples", "largest error at the samples"])
    axis.axhline(0.1, color="#5b6675", lw=1, ls=":")
    axis.text(t["level"][0], 0.1, "bound", va="bottom", color="#5b6675", fontsize=8)
    style(axis, "level", "error", "", y_log=True)
    axis.xaxis.get_major_locator().set_params(integer=True)
    pictures = pairs(figure, extent=(-3, 3, -3, 3), cmap="cividis", origin="lower", signed=True)
    return [("-errors", drawing), ("", pictures)]


def draw_figure_3_14(figure, tables):
    t = tables["errors"]
    drawing, axis = plt.subplots(figsize=(6.5, 3.6))
    lines(axis, 100 * t[0], [t["err"], t["err_P"]], ["err, all pixels", r"err$_P$, samples"])
    style(axis, "functions / samples [%]", "relative error", "")
    axis.set_ylim(bottom=0)
    return [("", pairs(figure, cmap="gray", vertical=True)), ("-errors", drawing)]


def draw_figure_3_16(figure, tables):
    t = tables["levels"]
    drawing, axes = plt.subplots(1, 2, figsize=(9, 3.3))
    lines(axes[0], t["level"],
          [100 * t["largest error / range"], 100 * t["samples above 2 %"], 100 * t["RMSE / range"]],
          ["largest error at the samples [% of the range]", "samples above the bound [%]",
           "RMSE of all pixels [% of the range]"])
    axes[0].set_yscale("symlog", linthresh=0.01)
    axes[0].set_ylim(bottom=0)
    axes[0].axhline(2, color="#5b6675", lw=1, ls=":")
    axes[0].text(0, 2, "bound 2 %", va="bottom", color="#5b6675", fontsize=8)
    style(axes[0], "level", "%", "")
    axes[1].bar(t["level"], t["functions"], color=COLORS[0])
    style(axes[1], "level", "functions added", "")
    axes[1].grid(axis="x", visible=False)
    for axis in axes:
        axis.xaxis.get_major_locator().set_params(integer=True)
    return [("", pairs(figure, cmap="gray", vertical=True)), ("-levels", drawing)]


def draw_k_space(figure, tables):
    t = tables["errors"]
    errors = np.column_stack([t["fit"], t["nearest sample"]]).ravel()
    pictures = {name: image(picture) for name, picture in figure["pictures"].items()}
    reference = pictures["exact grid"]
    drawing, axes = plt.subplots(2, 5, figsize=(11.5, 4.9))
    for axis in axes.flat:
        axis.axis("off")
    for column, (name, values) in enumerate(pictures.items()):
        show(axes[0, column], values, name, cmap="gray", vmin=0, vmax=0.5)
        if column:
            shown = show(axes[1, column], np.abs(values - reference),
                         f"|error|: {100 * errors[column - 1]:.2g} %", cmap="magma", vmin=0, vmax=0.05)
    drawing.colorbar(shown, ax=axes[1, :], shrink=0.8)
    return [("", drawing)]


def draw_dimensions(_, tables):
    drawing, axes = plt.subplots(1, len(tables), figsize=(11.5, 3.4), sharey=True)
    for axis, (name, t) in zip(axes, tables.items()):
        for i, method in enumerate(t.names[1:]):
            axis.plot(t["samples"], t[method], ls=DASHES[i], marker=MARKERS[i], color=COLORS[i], ms=4, label=method)
        style(axis, "samples", "relative RMSE" if axis is axes[0] else "", name, x_log=True, y_log=True)
        axis.set_xticks(t["samples"], [f"{n:.0f}" for n in t["samples"]])
        axis.minorticks_off()
    drawing.legend(*axes[0].get_legend_handles_labels(), loc="upper center",
                   bbox_to_anchor=(0.5, 0), ncol=5)
    return [("", drawing)]


def draw_figure_6_6(_, tables):
    drawing, axes = plt.subplots(2, 3, figsize=(11, 6.4))
    axes[1, 2].axis("off")
    for axis, (name, t) in zip(axes.flat, tables.items()):
        lines(axis, t["centers"], [t[choice] for choice in t.names[1:]], t.names[1:])
        style(axis, "centres", "diagonals", name, x_log=True, y_log=True)
        plain_ticks(axis, t["centers"])
    return [("", drawing)]


def draw_figure_6_8(_, tables):
    drawing, axis = plt.subplots(figsize=(6.5, 3.6))
    t = tables["errors"]
    lines(axis, t["weight"], [t["rms Taubin"]], [None])
    chosen = tables["chosen"]["rms Taubin"][0]
    axis.axhline(chosen, color="#5b6675", lw=1, ls=":")
    axis.text(t["weight"][0], chosen, "chosen by cross-validation", va="bottom", color="#5b6675", fontsize=8)
    style(axis, "weight of the penalty", "rms Taubin distance [diagonals]", "", x_log=True, y_log=True)
    return [("", drawing)]


def draw_figure_6_10(_, tables):
    t = tables["bunny"]
    drawing, axis = plt.subplots(figsize=(6.5, 3.6))
    lines(axis, t["centers"], [t[name] for name in t.names[1:]], t.names[1:])
    style(axis, "centres", "support [diagonals]", "bunny", x_log=True, y_log=True)
    plain_ticks(axis, t["centers"])
    return [("", drawing)]


def draw_figure_6_17(_, tables):
    t = tables["rms Taubin"]
    drawing, axis = plt.subplots(figsize=(6.5, 3.8))
    lines(axis, t["centers"], [t[name] for name in t.names[1:]], t.names[1:])
    style(axis, "centres", "rms Taubin distance [diagonals]", "", x_log=True, y_log=True)
    plain_ticks(axis, t["centers"])
    return [("", drawing)]


def draw_figure_6_21(_, tables):
    t = tables["condition"]
    drawing, axis = plt.subplots(figsize=(6.5, 3.6))
    lines(axis, t["weight"], [t[name] for name in t.names[1:]], t.names[1:])
    style(axis, r"$(\epsilon / t)^2$", "condition number", "Fig. 6.23", x_log=True, y_log=True)
    return [("", drawing)]


def draw_figure_8_2(_, tables):
    drawing, axes = plt.subplots(1, 2, figsize=(10, 3.4))
    t = tables["noise"]
    places = np.arange(len(t["SNR [dB]"]))
    for i, name in enumerate(["collocation", "segment()"]):
        mean = 1 - t[f"Dice, {name}"]
        axes[0].plot(places, mean, ls=DASHES[i], marker=MARKERS[i], color=COLORS[i], ms=5, label=name)
    style(axes[0], "signal to noise", "1 - Dice", "Fig. 8.2, mean of the seeds")
    axes[0].set_xticks(places, ["no noise" if snr == 99 else f"{snr:.0f} dB" for snr in t["SNR [dB]"]])
    axes[0].set_ylim(bottom=0)
    axes[0].legend(fontsize=8)
    t = tables["supports"]
    lines(axes[1], t["rho"], [t["length [pixels]"]], [None])
    style(axes[1], r"support $\rho$ [fill distances]", "length of the contour [pixels]", "Fig. 8.3, 20 dB", x_log=True)
    plain_ticks(axes[1], t["rho"])
    middle = t["length [pixels]"].mean()
    axes[1].set_ylim(0.98 * middle, 1.02 * middle)
    return [("", drawing)]


def draw_figure_8_4(_, tables):
    t = tables["iterations"]
    drawing, axes = plt.subplots(2, 2, figsize=(9, 5.6), sharex=True)
    for column, name in enumerate(["without", "with"]):
        lines(axes[0, column], t["iteration"], [t[f"change {name}"]], [None])
        lines(axes[1, column], t["iteration"], [t[f"energy {name}"]], [None])
        style(axes[0, column], "", "largest change of a coefficient" if column == 0 else "", f"{name} normalisation")
        style(axes[1, column], "iteration", "energy" if column == 0 else "", "")
        for axis in axes[:, column]:
            axis.set_ylim(bottom=0)
    return [("", drawing)]


def draw_figure_8_6(_, tables):
    t = tables["centres"]
    drawing, axis = plt.subplots(figsize=(6.5, 3.6))
    squares, triangles, along = (t["kind"] == kind for kind in range(3))
    for i, (chosen, column, name) in enumerate([
            (squares, "Dice, collocation", "lattice, collocation"), (along, "Dice, collocation", "along the shape"),
            (triangles, "Dice, collocation", "triangles"), (squares, "Dice, segment()", "lattice, segment()")]):
        axis.plot(t["centers"][chosen], 1 - t[column][chosen], ls=DASHES[i], marker=MARKERS[i], color=COLORS[i], ms=5,
                  label=name)
    axis.legend(fontsize=8)
    style(axis, "centres", "1 - Dice", "", x_log=True, y_log=True)
    plain_ticks(axis, [400, 1600, 5000, 10000, 22500])
    return [("", drawing)]


def draw_table_8_1(_, tables):
    t = tables["times"]
    drawing, axis = plt.subplots(figsize=(7.5, 3.6))
    places = np.arange(len(t["nodes"]))
    for i, (column, name) in enumerate([("published total [s]", "published"), ("total [s]", "collocation"),
                                        ("segment() [s]", "segment()")]):
        axis.bar(places + 0.27 * (i - 1), t[column], 0.25, color=COLORS[i], label=name)
    axis.set_xticks(places, ["Simulation 1", "Simulation 2", "U.S.", "Calcaneous"])
    axis.legend(fontsize=8)
    style(axis, "", "s", "", y_log=True)
    return [("", drawing)]


def draw_nothing(_figure, _tables):
    return []


DRAW = {"figure-6.4": draw_nothing, "figure-6.5": draw_nothing, "figure-6.6": draw_figure_6_6,
        "figure-6.8": draw_figure_6_8, "figure-6.10": draw_figure_6_10, "figure-6.17": draw_figure_6_17,
        "figure-6.18": draw_nothing, "figure-6.21": draw_figure_6_21, "chapter-1": draw_chapter_1, "figure-2.4": draw_figure_2_4, "table-2.4": draw_table_2_4,
        "figure-3.4": draw_figure_3_4, "figure-3.9": draw_figure_3_9, "figure-3.14": draw_figure_3_14,
        "figure-3.16": draw_figure_3_16, "k-space": draw_k_space, "dimensions": draw_dimensions,
        "figure-7.1": draw_nothing, "figure-8.2": draw_figure_8_2, "figure-8.4": draw_figure_8_4,
        "figure-8.6": draw_figure_8_6, "figure-8.8": draw_nothing, "figure-8.10": draw_nothing,
        "table-8.1": draw_table_8_1}

# Parts of drawings.


def lines(axis, x, ys, labels, markers=True):
    for i, (y, label) in enumerate(zip(ys, labels)):
        axis.plot(x, y, ls=DASHES[i], marker=MARKERS[i] if markers else None, color=COLORS[i], ms=4, label=label)
    if any(labels):
        axis.legend(fontsize=8)


def style(axis, x_label, y_label, title, x_log=False, y_log=False):
    axis.set_xlabel(x_label)
    axis.set_ylabel(y_label)
    axis.set_title(title)
    if x_log:
        axis.set_xscale("log")
    if y_log:
        axis.set_yscale("log")


def plain_ticks(axis, values):
    axis.set_xticks(values, [f"{value:.0f}" for value in values], fontsize=7)
    axis.minorticks_off()


def image(picture):
    return np.array(picture["values"]).reshape(picture["height"], picture["width"])


def show(axis, values, title, **options):
    shown = axis.imshow(values, interpolation="nearest", **options)
    axis.set_title(title, fontsize=9)
    axis.grid(False)
    return shown


def pairs(figure, cmap, extent=None, origin="upper", signed=False, vertical=False):
    """The pictures above their errors; pictures share one scale, errors another."""
    pictures = {name: image(picture) for name, picture in figure["pictures"].items()}
    names = [name for name in pictures if not name.startswith("error")]
    errors = {name: next((e for e in pictures if e.startswith("error") and e.endswith(name)), None) for name in names}
    limits = {"vmin": min(pictures[n].min() for n in names[:1]), "vmax": max(pictures[n].max() for n in names[:1])}
    if signed:
        limits = {"vmin": -6.6, "vmax": 8.1}
    largest = np.percentile(np.abs(np.concatenate([pictures[e].ravel() for e in errors.values() if e])), 99.5)
    drawing, axes = plt.subplots(2, len(names), figsize=(2.4 * len(names) + 0.8, 4.6 if vertical else 5))
    for axis in axes.flat:
        axis.axis("off")
    options = {"extent": extent, "origin": origin}
    for column, name in enumerate(names):
        top = show(axes[0, column], pictures[name], name, cmap=cmap, **limits, **options)
        if errors[name] is None:
            continue
        if signed:
            bottom = show(axes[1, column], pictures[errors[name]], "error", cmap="RdBu", vmin=-largest, vmax=largest,
                          **options)
        else:
            bottom = show(axes[1, column], pictures[errors[name]], "|error|", cmap="magma", vmin=0, vmax=largest,
                          **options)
    drawing.colorbar(top, ax=axes[0, :], shrink=0.85)
    drawing.colorbar(bottom, ax=axes[1, :], shrink=0.85)
    return drawing


def order(x, y):
    return np.polyfit(np.log(x), np.log(y), 1)[0]


# The page.


def embedded(path, text):
    content = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{html.escape(text)}" src="data:image/png;base64,{content}">'


def section(figure, images, folder):
    pictures = "".join(embedded(path, figure["title"]) for path in images)
    renders = "".join(
        f'<figure>{embedded(folder / render["file"], render["caption"])}'
        f'<figcaption>{html.escape(render["caption"])}</figcaption></figure>' for render in figure.get("renders", []))
    if renders:
        pictures += f'<div class="renders">{renders}</div>'
    return (f'<h2 id="{figure["name"]}">{html.escape(figure["title"])}</h2>\n'
            f'<p class="note">{html.escape(figure["text"])}</p>\n{pictures}\n')


def page(figures, parts):
    rows = "".join(
        f'<tr><td><a href="#{figure["name"]}">{html.escape(figure["name"])}</a></td>'
        f'<td>{html.escape(claim["what"])}</td><td>{html.escape(claim["published"])}</td>'
        f'<td>{html.escape(claim["ours"])}</td>'
        f'<td class="{"fails" if claim["verdict"] == "fails" else ""}">{html.escape(claim["verdict"])}</td></tr>\n'
        for figure in figures for claim in figure["claims"])
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>csrbf: the thesis, computed again</title>
<style>{STYLE}</style>
</head>
<body>
<h1>The thesis, computed again</h1>
<p class="note">Chapters 1 to 3 and 6 to 8 of A. Gelas, 2006: what they say and show, and what csrbf gives on this machine. Most of
the published curves are pictures without numbers; where a number cannot be read it says so.</p>
<div class="scroll"><table>
<thead><tr><th></th><th>what</th><th>published</th><th>ours</th><th>verdict</th></tr></thead>
<tbody>
{rows}</tbody>
</table></div>
{"".join(parts)}
</body>
</html>
"""


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
