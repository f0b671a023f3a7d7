from __future__ import annotations

import os
import warnings
from typing import Any

from csrbf import _csrbf
from csrbf._arrays import Path
from csrbf._fit import fit_options
from csrbf._options import Extrapolation, FitMethod, Kernel, Smoothing
from csrbf._progress import Progress, listening


def inpaint_slices(
    image: Path,
    output: Path,
    memory: float = 2e9,
    mask: Path | None = None,
    missing: float | None = None,
    *,
    method: FitMethod = "auto",
    tolerance: float | None = None,
    centers: int | None = None,
    smoothing: Smoothing = "auto",
    kernel: Kernel = "auto",
    kernel_parameter: float | None = None,
    degree: int | None = None,
    extrapolation: Extrapolation = "constant",
    blocks: int | None = None,
    progress: Progress = None,
) -> dict[str, Any]:
    """A volume larger than memory with its missing values filled in, from file to file, by blocks of slices.

    The block with the most missing values chooses for all. An image that fits in the memory is filled as by `inpaint`.

    Parameters
    ----------
    image, output : file name
        .nii, .nii.gz or .npy, of one value per voxel.
    memory : float
        Bytes, from which the size of the blocks follows.
    mask : file name, optional
        Of an image of the same size, nonzero where values are to be replaced.
    missing, method, tolerance, centers, smoothing, kernel, kernel_parameter, degree, extrapolation, blocks, progress
        See `inpaint`.

    Returns
    -------
    dict
        The numbers of missing and known values and of blocks of slices, and what the fit did.

    Raises
    ------
    IoError
        For files that cannot be read by slices, or written.
    ValueError
        When the memory is too little, nothing is known, or the mask has another size.

    Examples
    --------
    >>> z, y, x = np.mgrid[:24, :16, :16]
    >>> image = np.sin(0.2 * x) + 0.1 * y + 0.05 * z
    >>> image[10:13, 7:9, 7:9] = np.nan
    >>> np.save("image.npy", image)
    >>> report = csrbf.inpaint_slices("image.npy", "filled.npy")
    >>> report["missing"], report["slice_blocks"], bool(np.isfinite(np.load("filled.npy")).all())
    (12, 1, True)
    """
    options = fit_options(method, tolerance, centers, smoothing, kernel, kernel_parameter, degree, extrapolation)
    with listening(progress) as listener:
        report: dict[str, Any] = _csrbf.inpaint_slices(
            os.fspath(image),
            os.fspath(output),
            float(memory),
            "" if mask is None else os.fspath(mask),
            missing,
            options,
            blocks,
            listener,
        )
    if report["missing"] == 0:
        warnings.warn("inpaint_slices: nothing is missing; give mask or missing", stacklevel=2)
    return report
