"""Drawings of Part II."""

import numpy as np
from matplotlib.patches import Circle, Polygon, Rectangle

from csrbf.thesis.drawing import (
    COLORS,
    DASHES,
    MARKERS,
    QUIET,
    REFERENCE,
    bare,
    bound,
    bounded_cells,
    decimal_ticks,
    lines,
    order,
    pairs,
    plain_ticks,
    powers,
    show,
    style,
    subplots,
    whole_ticks,
)


def introduction(figure):
    drawing, axes = subplots(1, 2, size=(8, 3.6))
    for axis, name, title in [(axes[0], "uniform", "Fig. 1 a: uniform"), (axes[1], "polar", "Fig. 1 b: polar")]:
        t = figure.tables[name]
        axis.plot(t["x"], t["y"], ".", color=COLORS[0], ms=4)
        axis.set_title(title)
        bare(axis)
    places = drawing
    measured, curves = figure.tables["measured"], figure.tables["curves"]
    drawing, axis = subplots(size=(9, 3.2))
    for before, after in zip(measured["day"], measured["day"][1:]):
        if after - before > 2:
            axis.axvspan(before, after, color="#eef1f4", zorder=0)
    axis.plot(curves["day"], curves["truth"], color=REFERENCE, lw=3, label="truth")
    axis.plot(curves["day"], curves["fit"], color=COLORS[1], lw=1.2, label="fit")
    axis.plot(measured["day"], measured["brightness"], ".", color="black", ms=4.5, label="measured")
    style(axis, "day", "brightness", "Fig. 3; shaded: gaps of more than a day")
    axis.legend(ncol=3, loc="upper center", bbox_to_anchor=(0.5, -0.22))
    return [("-places", places), ("-gaps", drawing)]


def chapter_1(figure):
    drawing, axes = subplots(1, 3, size=(11, 3.4))
    t = figure.tables["global polynomial"]
    lines(axes[0], t["degree"], [("at the samples", t["RMSE at the samples"]), ("on [-1, 1]", t["RMSE"])])
    style(axes[0], "degree", "root mean square error", "Global polynomial of (3.5)")
    axes[0].set_ylim(bottom=0)
    axes[0].set_xticks(np.arange(4, 21, 4))
    t = figure.tables["band-limited"]
    lines(axes[1], t[0], [(None, t["largest error"])])
    style(axes[1], "values on either side of [0, 1]", "largest error", "Band-limited series (1.5)", y_log=True)
    t = figure.tables["frame iteration"]
    lines(axes[2], t["iteration"], [("error", t["error"]), (r"$((B-A)/(B+A))^n$", t["bound"])], markers=False)
    style(axes[2], "iteration n", "relative error", "Frame iteration (1.20)", y_log=True)
    return [("", drawing)]


def figure_1_1(figure):
    samples, curves = figure.tables["samples"], figure.tables["curves"]
    x = curves["x"]
    patches = (len(curves.columns) - 3) // 2
    drawing, axes = subplots(3, 1, size=(9, 7.2), sharex=True)
    for i in range(patches):
        color, dash = COLORS[i % 6], DASHES[i % 7]
        weight, local = curves[f"weight {i + 1}"], curves[f"f {i + 1}"]
        axes[0].plot(x, np.where(weight > 0, weight, np.nan), color=color, ls=dash)
        axes[1].plot(x, local, color=color, ls=dash, lw=1.2)
    axes[1].plot(samples["x"], samples["s"], ".", color="black", ms=4)
    axes[2].plot(x, curves["signal"], color=REFERENCE, lw=3, label="signal (3.5)")
    axes[2].plot(x, curves["f"], color=COLORS[1], lw=1.2, label="f")
    axes[2].plot(samples["x"], samples["s"], ".", color="black", ms=4, label="samples")
    axes[2].legend(ncol=3, loc="lower right")
    style(axes[0], "", "weight", "weights of the patches, which sum to 1")
    style(axes[1], "", "local functions", "local functions, each where its weight is positive")
    style(axes[2], "x", "f", "their blend (1.10)")
    axes[1].set_ylim(axes[2].get_ylim())
    line = drawing
    points, cells = figure.tables["points in the plane"], figure.tables["cells"]
    drawing, axes = subplots(1, 2, size=(9, 4.4))
    chosen = len(cells.rows) // 2
    for k, (px, py, width, height, growth) in enumerate(cells.rows):
        axes[0].add_patch(Rectangle((px, py), width, height, fill=False, ec=COLORS[0]))
        grown = ((px - 0.5 * (growth - 1) * width, py - 0.5 * (growth - 1) * height), growth * width, growth * height)
        if k == chosen:
            axes[1].add_patch(Rectangle(*grown, fc=COLORS[4], alpha=0.35, ec="none"))
        axes[1].add_patch(Rectangle(*grown, fill=False, ec=COLORS[1], lw=0.9))
    for axis, title in zip(axes, ["cells of the kd-tree", "supports: the cells grown by 1.7"]):
        axis.plot(points["x"], points["y"], ".", color="black", ms=2.5)
        axis.set_title(title)
        bare(axis)
        beyond = 0.02 if axis is axes[0] else 0.2
        axis.set_xlim(-beyond, 1 + beyond)
        axis.set_ylim(-beyond, 1 + beyond)
    return [("", line), ("-cover", drawing)]


def figure_1_2(figure):
    samples, curves = figure.tables["samples"], figure.tables["curves"]
    drawing, axis = subplots(size=(8, 3.8))
    for name in curves.columns[2:]:
        label = "basis functions" if name == "term 1" else None
        axis.plot(curves["x"], curves[name], color=COLORS[0], lw=1, label=label)
    axis.plot(curves["x"], curves["f"], color=COLORS[1], lw=2.2, ls="--", label="their sum f")
    axis.plot(samples["x"], samples["s"], "o", color="black", ms=5, label="samples")
    axis.axhline(0, color=QUIET, lw=0.8)
    style(axis, "x", "f")
    axis.legend(ncol=3, loc="upper center", bbox_to_anchor=(0.5, -0.18))
    return [("", drawing)]


def figure_2_1(figure):
    drawing, axes = subplots(1, 2, size=(10, 3.8))
    for axis, number in zip(axes, ["2.1", "2.2"]):
        t = figure.tables[f"Table {number}"]
        lines(axis, t["r"], [(powers(c), t[c]) for c in t.columns[1:]], markers=False)
        axis.axhline(0, color=QUIET, lw=0.8)
        style(axis, "r", r"$\varphi(r)$", f"Table {number}, Fig. {number}")
    tables = drawing
    drawing, axes = subplots(1, 4, size=(11, 3.4))
    for axis, name in zip(axes, [n for n in figure.tables if n.startswith("Table 2.3")] + ["misprint"]):
        t = figure.tables[name]
        lines(axis, t["r"], [(powers(c), t[c]) for c in t.columns[1:]], markers=False)
        style(axis, "r", r"$\varphi(r)$" if axis is axes[0] else "", name.replace("misprint", "d = 1, C4"))
    axes[3].set_ylim(top=1.55)
    return [("-global", tables), ("-surfaces", revolved(figure)), ("-wendland", drawing)]


def revolved(figure):
    """Figs. 2.1 b, d, 2.2 b, d and 2.3: the functions as surfaces over the plane."""
    chosen = [
        ("Table 2.1", "Gaussian"),
        ("Table 2.1", "inverse multiquadric"),
        ("Table 2.2", "multiquadric"),
        ("Table 2.2", "thin plate"),
        ("Table 2.3, d = 3", "C0"),
        ("Table 2.3, d = 3", "C2"),
        ("Table 2.3, d = 3", "C4"),
    ]
    drawing, axes = subplots(2, 4, size=(11, 5.4), subplot_kw={"projection": "3d"})
    axes[1, 3].set_axis_off()
    for axis, (name, column) in zip(axes.flat, chosen):
        t = figure.tables[name]
        end = min(t["r"][-1], 2) / np.sqrt(2)
        x, y = np.meshgrid(*2 * [np.linspace(-end, end, 61)])
        z = np.interp(np.hypot(x, y), t["r"], t[column])
        axis.plot_surface(x, y, z, cmap="cividis", rcount=61, ccount=61, linewidth=0, antialiased=False)
        axis.set_title(column if name != "Table 2.3, d = 3" else f"Wendland, d = 3, {column}")
        axis.tick_params(labelsize=8, pad=-2)
        axis.locator_params(nbins=4)
    return drawing


def figure_2_4(figure):
    t = figure.tables["curves"]
    drawing, axes = subplots(1, 3, size=(11, 3.2), sharey=True)
    for axis, name in zip(axes, t.columns[2:]):
        axis.plot(t["x"], t["signal"], color=REFERENCE, lw=3, label="signal (3.5)")
        axis.plot(t["x"], t[name], color=COLORS[0], lw=1.1, label="interpolant")
        style(axis, "x", "f" if axis is axes[0] else "", f"support {name}")
    axes[0].legend(loc="upper right")
    curves = drawing
    t = figure.tables["supports"]
    drawing, axes = subplots(1, 3, size=(11, 3.2))
    for axis, column, label, y_log in [
        (axes[0], "RMSE", "root mean square error", True),
        (axes[1], "density", "fraction of nonzero matrix entries", False),
        (axes[2], "condition", "condition number", True),
    ]:
        lines(axis, t[0], [(None, t[column])])
        style(axis, "support / sample distance", label, x_log=True, y_log=y_log)
    axes[1].set_ylim(0, 1.05)
    return [("-curves", curves), ("-supports", drawing)]


def table_2_4(figure):
    drawing, axes = subplots(1, 3, size=(11, 3.8))
    for axis, column, label in [
        (axes[0], "assembly [s]", "build the matrix [s]"),
        (axes[1], "solve [s]", "solve [s]"),
        (axes[2], "evaluation [us / point]", "evaluate at one point [µs]"),
    ]:
        kinds = [("compact", "compact support"), ("global", "global support"), ("fast", "global, fast sums")]
        for i, (name, text) in enumerate(kinds):
            t = figure.tables[name]
            text += f", $N^{{{order(t['samples'], t[column]):.1f}}}$"
            axis.plot(t["samples"], t[column], ls=DASHES[i], marker=MARKERS[i], color=COLORS[i], ms=4.5, label=text)
        style(axis, "samples N", label, x_log=True, y_log=True)
        axis.legend(loc="lower center", bbox_to_anchor=(0.5, 1))
    return [("", drawing)]


def figure_3_1(figure):
    levels = list(figure.tables.items())
    drawing, axes = subplots(2, 3, size=(10.5, 5))
    for axis, (name, t) in zip(axes.flat, levels):
        clusters = t["cluster"].astype(int)
        for k in range(clusters.max() + 1):
            of = t.rows[clusters == k]
            color = COLORS[k % 6]
            for x, y, _, cx, cy, _ in of:
                axis.plot([cx, x], [cy, y], color=color, lw=0.7)
            axis.plot(of[:, 0], of[:, 1], MARKERS[(k // 6) % 7], color=color, ms=4)
            axis.plot(of[0, 3], of[0, 4], "+", color="black", ms=8, mew=1.8)
        axis.set_title(f"{name}: {clusters.max() + 1} cluster{'s' if clusters.max() else ''}")
    t = levels[4][1]
    axis = axes.flat[5]
    axis.plot(t["x"], t["y"], ".", color=QUIET, ms=4)
    for cx, cy, support in np.unique(t.rows[:, 3:6], axis=0):
        axis.plot(cx, cy, "+", color="black", ms=8, mew=1.8)
        axis.add_patch(Circle((cx, cy), support, fill=False, ec=COLORS[1]))
    axis.set_title("supports of level 4 (Fig. 3.2)")
    for axis in axes.flat:
        bare(axis)
        axis.autoscale_view()
    return [("", drawing)]


def figure_3_4(figure):
    t, samples, errors = (figure.tables[name] for name in ["levels", "samples", "errors by level"])
    levels = t.columns[2:]
    shown = sorted({0, len(levels) // 3, 2 * len(levels) // 3, len(levels) - 1})
    drawing, axes = subplots(2, 2, size=(10, 5.6), sharex=True, sharey=True)
    for axis, level in zip(axes.flat, shown):
        axis.plot(t["x"], t["signal"], color=REFERENCE, lw=3, label="signal (3.5)")
        axis.plot(samples["x"], samples["s"], ".", color="black", ms=4, label="samples")
        axis.plot(t["x"], t[levels[level]], color=COLORS[1], lw=1.2, label="approximation")
        functions = int(errors["centers"][: level + 1].sum())
        title = f"{levels[level]}: {functions} functions, RMSE {errors['RMSE'][level]:.2g}"
        style(axis, "x" if level in shown[-2:] else "", "", title)
    axes.flat[0].legend(loc="upper right")
    first = drawing
    t, noisy = figure.tables["noisy curves"], figure.tables["noisy samples"]
    drawing, axes = subplots(1, 3, size=(11, 3.4), sharey=True)
    for axis, name in zip(axes, t.columns[2:]):
        axis.plot(t["x"], t["signal"], color=REFERENCE, lw=3, label="signal (3.5)")
        axis.plot(noisy["x"], noisy["s"], ".", color="black", ms=4, label="samples, 21 dB")
        axis.plot(t["x"], t[name], color=COLORS[1], lw=1.1, label="approximation")
        style(axis, "x", "", name)
    axes[0].legend(loc="upper right")
    noise = drawing
    t = figure.tables["thresholds"]
    drawing, axis = subplots(size=(7, 4.2))
    for i, name in enumerate(t.columns[1:]):
        axis.plot(t["threshold"], t[name], ls=DASHES[i], color=COLORS[i], label=name)
        best = np.argmin(t[name])
        axis.plot(t["threshold"][best], t[name][best], MARKERS[i], color=COLORS[i], ms=8)
    style(axis, "threshold", "root mean square error", "Fig. 3.6; markers: best threshold", x_log=True, y_log=True)
    decimal_ticks(axis)
    axis.legend(title="signal to noise")
    return [("", first), ("-noise", noise), ("-thresholds", drawing)]


def figure_3_9(figure):
    t = figure.tables["errors by level"]
    drawing, axis = subplots(size=(7, 3.8))
    lines(
        axis,
        t["level"],
        [("RMSE between the samples", t["RMSE"]), ("largest error at the samples", t["largest error at the samples"])],
    )
    bound(axis, 0.1, "bound", t["level"][0])
    style(axis, "level", "error", y_log=True)
    decimal_ticks(axis)
    whole_ticks(axis)
    pictures = pairs(
        figure.pictures, "cividis", limits=(-6.6, 8.1), signed=True, extent=(-3, 3, -3, 3), origin="lower"
    )
    return [("", pictures), ("-errors", drawing)]


def figure_3_10(figure):
    samples, centers = figure.tables["samples"], figure.tables["centers"]
    at = centers.rows[:, :2]
    places = samples.rows
    drawing, axes = subplots(1, 3, size=(11, 4.2))
    titles = ["Fig. 3.10: furthest points", "Fig. 3.11: bounded Voronoi cells", "Fig. 3.12: supports"]
    for axis, title in zip(axes, titles):
        axis.plot(places[:, 0], places[:, 1], ".", color=REFERENCE, ms=3)
        axis.plot(at[:, 0], at[:, 1], "s", color=COLORS[0], ms=4.5)
        axis.set_title(title)
    cells = bounded_cells(at, places.min(axis=0), places.max(axis=0))
    for cell in cells:
        axes[1].add_patch(Polygon(cell, fill=False, ec="black"))
        axes[2].add_patch(Polygon(cell, fill=False, ec="#c9d0d8"))
    for x, y, scale, _ in centers.rows:
        axes[2].add_patch(Circle((x, y), scale, fill=False, ec=COLORS[1], lw=0.9))
    for axis in axes:
        bare(axis)
        axis.set_xlim(-0.15, 1.15)
        axis.set_ylim(-0.15, 1.15)
    return [("", drawing)]


def figure_3_14(figure):
    t = figure.tables["errors"]
    drawing, axis = subplots(size=(7, 3.8))
    lines(axis, 100 * t[0], [("err, all pixels", t["err"]), (r"err$_P$, samples", t["err_P"])])
    style(axis, "functions / samples [%]", "relative error")
    axis.set_ylim(bottom=0)
    return [("", pairs(figure.pictures, "gray")), ("-errors", drawing)]


def figure_3_16(figure):
    t = figure.tables["levels"]
    drawing, axes = subplots(1, 2, size=(10, 3.6))
    lines(
        axes[0],
        t["level"],
        [
            ("largest error at the samples [% of the range]", 100 * t["largest error / range"]),
            ("samples above the bound [%]", 100 * t["samples above 2 %"]),
            ("RMSE of all pixels [% of the range]", 100 * t["RMSE / range"]),
        ],
    )
    axes[0].set_yscale("symlog", linthresh=0.1)
    axes[0].set_ylim(0, 400)
    axes[0].set_yticks([0, 0.1, 1, 10, 100], ["0", "0.1", "1", "10", "100"])
    bound(axes[0], 2, "bound 2 %", 0)
    style(axes[0], "level", "%")
    axes[1].bar(t["level"], t["functions"], color=COLORS[0])
    style(axes[1], "level", "functions added")
    axes[1].grid(axis="x", visible=False)
    for axis in axes:
        whole_ticks(axis)
    return [("", pairs(figure.pictures, "gray")), ("-levels", drawing)]


def k_space(figure):
    t = figure.tables["errors"]
    errors = np.column_stack([t["fit"], t["nearest sample"]]).ravel()
    reference = figure.pictures["exact grid"]
    drawing, axes = subplots(2, 5, size=(11.4, 4.9))
    axes[1, 0].axis("off")
    for column, (name, values) in enumerate(figure.pictures.items()):
        top = show(axes[0, column], values, name, cmap="gray", vmin=0, vmax=0.5)
        if column:
            title = f"|error|: {100 * errors[column - 1]:.2g} %"
            bottom = show(axes[1, column], np.abs(values - reference), title, cmap="magma", vmin=0, vmax=0.05)
    drawing.colorbar(top, ax=axes[0, :], shrink=0.8)
    drawing.colorbar(bottom, ax=axes[1, :], shrink=0.8, extend="max")
    return [("", drawing)]


def dimensions(figure):
    drawing, axes = subplots(1, len(figure.tables), size=(11, 3.8), sharey=True)
    for axis, (name, t) in zip(axes, figure.tables.items()):
        for i, method in enumerate(t.columns[1:]):
            axis.plot(t["samples"], t[method], ls=DASHES[i], marker=MARKERS[i], color=COLORS[i], ms=4.5, label=method)
        style(axis, "samples", "relative RMSE" if axis is axes[0] else "", name, x_log=True, y_log=True)
        plain_ticks(axis, t["samples"])
    drawing.legend(*axes[0].get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, 0), ncol=5)
    return [("", drawing)]


DRAW = {
    "introduction": introduction,
    "k-space": k_space,
    "chapter-1": chapter_1,
    "figure-1.1": figure_1_1,
    "figure-1.2": figure_1_2,
    "figure-2.1": figure_2_1,
    "figure-2.4": figure_2_4,
    "table-2.4": table_2_4,
    "figure-3.1": figure_3_1,
    "figure-3.4": figure_3_4,
    "figure-3.9": figure_3_9,
    "figure-3.10": figure_3_10,
    "figure-3.14": figure_3_14,
    "figure-3.16": figure_3_16,
    "dimensions": dimensions,
}
