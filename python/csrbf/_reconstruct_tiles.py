from __future__ import annotations

import os
from typing import Any

from csrbf import _csrbf
from csrbf._arrays import Path, smoothing_or_none
from csrbf._options import NormalsFrom, Smoothing
from csrbf._progress import Progress, listening


def reconstruct_tiles(
    points: Path,
    mesh: Path,
    tile_points: int = 1_000_000,
    *,
    memory: float | None = None,
    folder: Path | None = None,
    share: tuple[int, int] = (0, 1),
    normals: NormalsFrom = "auto",
    smoothing: Smoothing = "auto",
    resolution: int | None = None,
    sharp: bool | None = None,
    model: Path | None = None,
    progress: Progress = None,
) -> dict[str, Any]:
    """A mesh of more points than memory, tile by tile, from file to file.

    Finished steps are files in `folder`, from which an interrupted call goes on. Several processes that see it share
    the work: call this in each of them, with its own `share`, and it returns when the work is done. So with Dask:
    ``client.gather([client.submit(csrbf.reconstruct_tiles, points, mesh, folder=folder, share=(k, n), pure=False) for k
    in range(n)])`` on n workers. The mesh is the same for any number of processes.

    Parameters
    ----------
    points : file name
        Points with or without normals; binary .ply and .npy are read in pieces.
    mesh : file name
        Written by the first process. With a slash at its end a folder: each tile gets a file tile_NNNN.ply.
    tile_points : int
        Points per tile, about; memory grows with it: about 1.8 GB for a million.
    memory : float, optional
        Bytes for each process, such as 4e9, from which the size of tiles follows instead.
    folder : file name, optional
        For finished steps; emptied at the end. Default: that of the mesh with ".tiles" behind it.
    share : (int, int)
        Number of this process, from 0, and of all of them.
    normals : "auto", "file" or "estimate"
        Those of the file, corrected where they have errors; as they are; or estimated.
    smoothing : "auto", "none" or float
        See `reconstruct`.
    resolution : int, optional
        Cells of the mesh along the longest side. Default: from the data.
    sharp : bool, optional
        Vertices on sharp edges and corners (dual contouring), or edges cut off (marching cubes). Default: sharp for
        points without noise.
    model : file name, optional
        For the surface itself, as `Surface.save` writes it; `load_surface` reads it tile by tile.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    dict
        What was found, chosen and measured; in the first process also the size and topology of the mesh.

    Raises
    ------
    IoError
        For files that cannot be read or written.
    ValueError
        For unknown options, and when the folder has steps of other work.
    SolverFailure
        When no surface results, or another process failed.

    Examples
    --------
    >>> x = np.random.default_rng(0).normal(size=(6000, 3))
    >>> np.save("points.npy", x / np.linalg.norm(x, axis=1, keepdims=True))
    >>> report = csrbf.reconstruct_tiles("points.npy", "ball.ply", tile_points=1200)
    >>> report["tiles"], report["watertight"], report["euler"]
    (5, True, 2)
    """
    options = {
        "tile_points": int(tile_points),
        "memory": memory,
        "normals": None if normals == "auto" else normals,
        "smoothing": smoothing_or_none(smoothing),
        "resolution": resolution,
        "sharp": sharp,
        "model": None if model is None else os.fspath(model),
    }
    target = os.fspath(mesh)
    work = f"{target.rstrip('/')}.tiles" if folder is None else os.fspath(folder)
    with listening(progress) as listener:
        return _csrbf.reconstruct_tiles(
            os.fspath(points),
            target,
            work,
            int(share[0]),
            int(share[1]),
            {name: value for name, value in options.items() if value is not None},
            listener,
        )
