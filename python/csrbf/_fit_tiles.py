from __future__ import annotations

import os
from typing import Any

from csrbf import _csrbf
from csrbf._arrays import Path, smoothing_or_none
from csrbf._options import Extrapolation, FitMethod, Kernel, Loss, Smoothing
from csrbf._progress import Progress, listening


def fit_tiles(
    samples: Path,
    model: Path,
    tile_points: int = 2_000_000,
    *,
    memory: float | None = None,
    folder: Path | None = None,
    share: tuple[int, int] = (0, 1),
    coordinates: str = "",
    values: str = "",
    weights: str = "",
    method: FitMethod = "auto",
    kernel: Kernel = "auto",
    kernel_parameter: float | None = None,
    smoothing: Smoothing = "auto",
    tolerance: float | None = None,
    degree: int | None = None,
    loss: Loss = "auto",
    missing: float | None = None,
    extrapolation: Extrapolation = "auto",
    standard_deviation: bool = False,
    progress: Progress = None,
) -> dict[str, Any]:
    """A function of more samples than memory, tile by tile, from file to file.

    `load` reads the model; its tiles are read when they are evaluated. Steps and processes are as in
    `reconstruct_tiles`.

    Parameters
    ----------
    samples : file name
        One sample per row; .npy is read in pieces.
    model : file name
        A .csrbf file, written by the first process.
    tile_points : int
        Samples per tile, about; memory grows with it: some 0.3 GB for a million.
    memory : float, optional
        Bytes for each process, such as 4e9, from which the size of tiles follows instead.
    folder : file name, optional
        For finished steps; emptied at the end. Default: that of the model with ".tiles" behind it.
    share : (int, int)
        Number of this process, from 0, and of all of them.
    coordinates, values, weights : str
        Names or numbers (from 1) of columns, separated by commas. Default: the last column is the value, the others are
        coordinates.
    method, kernel, kernel_parameter, smoothing, tolerance, degree, loss, missing, extrapolation
        See `fit`.
    standard_deviation : bool
        See `fit`: a second fit of each tile, where the method has none.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    dict
        What was found, chosen and measured in all tiles.

    Raises
    ------
    IoError
        For files that cannot be read or written.
    ValueError
        For unknown options, and when the folder has steps of other work.
    SolverFailure
        When another process failed.

    Examples
    --------
    >>> x = np.random.default_rng(0).uniform(size=(20000, 2))
    >>> np.save("samples.npy", np.column_stack([x, np.sin(3 * x[:, 0]) * x[:, 1]]))
    >>> report = csrbf.fit_tiles("samples.npy", "wave.csrbf", tile_points=5000)
    >>> report["tiles"], report["samples"]
    (4, 20000)
    >>> print(f"{csrbf.load('wave.csrbf')([0.5, 0.5]):.3f}")
    0.499
    """
    target = os.fspath(model)
    options = {
        "tile_points": int(tile_points),
        "memory": memory,
        "method": method,
        "kernel": kernel,
        "kernel_parameter": kernel_parameter,
        "smoothing": smoothing_or_none(smoothing),
        "tolerance": tolerance,
        "degree": degree,
        "loss": loss,
        "missing": missing,
        "extrapolation": extrapolation,
        "standard_deviation": standard_deviation,
    }
    with listening(progress) as listener:
        return _csrbf.fit_tiles(
            os.fspath(samples),
            target,
            f"{target}.tiles" if folder is None else os.fspath(folder),
            int(share[0]),
            int(share[1]),
            [coordinates, values, weights],
            {name: value for name, value in options.items() if value is not None},
            listener,
        )
