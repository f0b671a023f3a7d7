"""Draws the figures of the gallery and writes them to files."""

import os

from csrbf.thesis import level_sets, scattered_data, surfaces
from csrbf.thesis.drawing import RESOLUTION, STYLE, plt

# By name: a function of a Figure that returns a list of (suffix of the file, drawing). Other figures have only renders.
DRAW = {**scattered_data.DRAW, **surfaces.DRAW, **level_sets.DRAW}


def save(figure, folder):
    """Writes the pictures of a Figure: a list of (path, caption, inches per pixel), the last None for renders."""
    saved = []
    if figure.name in DRAW and not figure.missing:
        with plt.rc_context(STYLE):
            for suffix, drawing in DRAW[figure.name](figure):
                path = folder / f"{figure.name}{suffix}.png"
                replace(path, lambda part, drawing=drawing: drawing.savefig(part, format="png"))
                plt.close(drawing)
                saved.append((path, "", 1 / RESOLUTION))
    for i, (caption, image) in enumerate(figure.renders, 1):
        path = folder / f"{figure.name}-render-{i}.png"
        replace(path, lambda part, image=image: plt.imsave(part, image, format="png"))
        saved.append((path, caption, None))
    return saved


def replace(path, write):
    """Calls write(file) with a temporary file beside path, then renames it."""
    part = path.with_name(path.name + ".part")
    try:
        with open(part, "wb") as file:
            write(file)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
