"""Drawings of Part IV."""

import numpy as np

from csrbf.thesis.drawing import COLORS, DASHES, MARKERS, bare, decimal_ticks, lines, plain_ticks, style, subplots


def figure_8_1(figure):
    drawing, axes = subplots(1, 2, size=(8.4, 4.2))
    for axis, (name, t), letter in zip(axes, figure.tables.items(), "ab"):
        axis.plot(t["x"], t["y"], "o", color=COLORS[0], ms=4)
        axis.set_title(f"{letter}: {name}")
        bare(axis)
    return [("", drawing)]


def figure_8_2(figure):
    drawing, axes = subplots(1, 2, size=(10, 3.6))
    t = figure.tables["noise"]
    places = np.arange(len(t["SNR [dB]"]))
    for i, name in enumerate(["collocation", "segment()"]):
        missed = 1 - t[f"Dice, {name}"]
        axes[0].plot(places, missed, ls=DASHES[i], marker=MARKERS[i], color=COLORS[i], ms=5, label=name)
    style(axes[0], "signal to noise", "1 - Dice", "Fig. 8.2, mean of the seeds")
    axes[0].set_xticks(places, ["no noise" if snr == 99 else f"{snr:.0f} dB" for snr in t["SNR [dB]"]])
    axes[0].set_ylim(bottom=0)
    axes[0].legend()
    t = figure.tables["supports"]
    lines(axes[1], t["rho"], [(None, t["length [pixels]"])])
    style(axes[1], r"support $\rho$ [fill distances]", "length of the contour [pixels]", "Fig. 8.3, 20 dB", x_log=True)
    plain_ticks(axes[1], t["rho"])
    axes[1].set_ylim(0, 1.2 * t["length [pixels]"].max())
    return [("", drawing)]


def figure_8_4(figure):
    t = figure.tables["iterations"]
    drawing, axes = subplots(2, 2, size=(9.5, 5.8), sharex=True)
    for column, name in enumerate(["without", "with"]):
        lines(axes[0, column], t["iteration"], [(None, t[f"change {name}"])])
        lines(axes[1, column], t["iteration"], [(None, t[f"energy {name}"])])
        style(axes[0, column], "", "largest change of a coefficient" if column == 0 else "", f"{name} normalisation")
        style(axes[1, column], "iteration", "energy" if column == 0 else "")
        for axis in axes[:, column]:
            axis.set_ylim(bottom=0)
    return [("", drawing)]


def figure_8_6(figure):
    t = figure.tables["centres"]
    drawing, axis = subplots(size=(7, 4))
    squares, triangles, along = (t["kind"] == kind for kind in range(3))
    for i, (chosen, column, name) in enumerate(
        [
            (squares, "Dice, collocation", "lattice, collocation"),
            (along, "Dice, collocation", "along the shape, collocation"),
            (triangles, "Dice, collocation", "triangles, collocation"),
            (squares, "Dice, segment()", "lattice, segment()"),
        ]
    ):
        axis.plot(
            t["centers"][chosen],
            1 - t[column][chosen],
            ls=DASHES[i],
            marker=MARKERS[i],
            color=COLORS[i],
            ms=5,
            label=name,
        )
    axis.legend()
    style(axis, "centres", "1 - Dice", x_log=True, y_log=True)
    decimal_ticks(axis)
    plain_ticks(axis, [400, 1600, 5000, 10000, 22500])
    return [("", drawing)]


def table_8_1(figure):
    t = figure.tables["times"]
    drawing, axis = subplots(size=(8, 3.8))
    places = np.arange(len(t.labels))
    for i, (column, name) in enumerate(
        [("published total [s]", "published (2006)"), ("total [s]", "collocation"), ("segment() [s]", "segment()")]
    ):
        axis.plot(places, t[column], MARKERS[i], color=COLORS[i], ms=8, label=name)
        for x, y in zip(places, t[column]):
            text, shift = f"{y:,.0f}" if y >= 100 else f"{y:.2g}", (4, 0, -4)[i]
            axis.annotate(text, (x, y), xytext=(9, shift), textcoords="offset points", va="center", fontsize=9)
    axis.set_xticks(places, t.labels)
    axis.set_xlim(-0.4, len(places) - 0.3)
    axis.grid(axis="x", visible=False)
    axis.legend(loc="upper left")
    style(axis, "", "seconds", y_log=True)
    return [("", drawing)]


DRAW = {
    "figure-8.1": figure_8_1,
    "figure-8.2": figure_8_2,
    "figure-8.4": figure_8_4,
    "figure-8.6": figure_8_6,
    "table-8.1": table_8_1,
}
