import os

import numpy as np

from csrbf import _csrbf
from csrbf._function import Function
from csrbf._surface import Mesh, Surface


class Segmentation:
    """The regions of an image, with smooth boundaries.

    labels: array of uint8 like the image, 0 outside.
    field: the level set as a Function of x, y (and z), positive inside; of more than two regions one value each, of
        which one is positive at every place.
    energy: list, after each step.
    report: dict with what was chosen and found: iterations, converged, regions (label, voxels, volume, mean, sd),
        components, noise, options, warnings.
    """

    def __init__(self, segments):
        self._segments = segments
        self.labels = segments.labels
        self.report = segments.report
        self.field = Function(segments.function())

    @property
    def energy(self):
        return self.report["energy"]

    def contour(self, label=1, *, resolution=None):
        """The contour of a region, cut off at the border of the image, in physical coordinates: of a volume a Mesh, of
        an image in the plane a list of closed lines, each an array (n, 2) with the inside on its left."""
        contour, _ = self._segments.contour(label, 0 if resolution is None else int(resolution))
        return contour if isinstance(contour, list) else Mesh(*contour)

    def measure(self, label=1, *, resolution=None):
        """dict with length and area of the contour of a region, in a volume area and volume, and estimates of their
        errors: area_error and so on."""
        return self._segments.contour(label, 0 if resolution is None else int(resolution))[1]

    def save(self, path):
        """Writes the labels as an image, or the level set to a .csrbf file, whichever the name ends with."""
        path = os.fspath(path)
        if path.endswith(".csrbf"):
            self.field.save(path)
        else:
            self._segments.save_labels(path)

    def __repr__(self):
        shape = " x ".join(map(str, self.labels.shape))
        return f"<csrbf.Segmentation of {shape} voxels, {len(self.report['regions'])} regions>"


def _image(image, voxel_size):
    if isinstance(image, (str, os.PathLike)):
        if voxel_size is not None:
            raise ValueError("voxel_size: the file says it; read the array to give another one")
        return _csrbf.Image.read(os.fspath(image))
    array = np.asarray(image)
    if np.iscomplexobj(array):
        raise ValueError("image: must be real numbers")
    size = np.atleast_1d(np.asarray(1.0 if voxel_size is None else voxel_size, dtype=float)).ravel()
    if len(size) == 1:
        size = np.repeat(size, array.ndim)
    return _csrbf.Image(np.ascontiguousarray(array, dtype=np.float32), size.tolist())


def _voxels(given, image, name):
    if given is None:
        return None
    if isinstance(given, (str, os.PathLike)):
        given = _csrbf.Image.read(os.fspath(given)).values
    given = np.asarray(given)
    if list(given.shape) != list(image.shape):
        raise ValueError(f"{name}: has shape {given.shape}; the image has {tuple(image.shape)}")
    return (np.nan_to_num(given) != 0).astype(np.uint8)


def _seed(init, image):
    """Voxels that are inside at the start, or None."""
    if isinstance(init, (Function, Surface)):
        return _inside(init, image)
    if not isinstance(init, (str, os.PathLike)):
        return _voxels(init, image, "init")
    init = os.fspath(init)
    form, _, rest = init.partition(":")
    d = image.dimension
    if init == "auto":
        return None
    if init.endswith(".csrbf"):
        from csrbf import load

        return _inside(load(init), image)
    if form == "mask":
        return _voxels(rest, image, "init")
    if form in ("sphere", "box"):
        try:
            numbers = np.array([float(word) for word in rest.split(",")])
        except ValueError:
            numbers = np.array([])
        if form == "sphere" and len(numbers) == d + 1:
            return _covering(image.seed_ball(numbers[:d], numbers[d]), init)
        if form == "box" and len(numbers) == 2 * d:
            return _covering(image.seed_box(numbers[:d], numbers[d:]), init)
    raise ValueError(
        f'init: "{init}": expected "auto", "sphere:X,Y[,Z],R", "box:X,Y[,Z],X,Y[,Z]", "mask:FILE", "MODEL.csrbf", an '
        "array like the image, a Function or a Surface"
    )


def _inside(f, image):
    values = f(image.centers())
    return _covering((values > 0).astype(np.uint8).reshape(image.shape), "the function")


def _covering(seed, what):
    if not seed.any():
        raise ValueError(f"init: {what} covers no voxel of the image")
    return seed


def segment(
    image,
    voxel_size=None,
    init="auto",
    energy="chan-vese",
    regions=2,
    *,
    mode="global",
    method="variational",
    mask=None,
    center_spacing=None,
    support=None,
    kernel="wendland-c2",
    smoothness="auto",
    window=None,
    shading="auto",
    balloon=0.0,
    fill_holes=None,
    force=None,
    iterations=100,
):
    """The parts of an image by level sets: a Segmentation.

    image: array [y, x] or [z, y, x], or a file name. voxel_size: of an array, one number or (x, y[, z]); the first
        voxel is at 0.
    init: where to start, which is also what is inside: "auto", "sphere:X,Y[,Z],R", "box:X,Y[,Z],X,Y[,Z]" in physical
        units, "mask:FILE", "MODEL.csrbf", an array like the image (not 0 inside), a Function or a Surface (positive
        inside).
    energy: "chan-vese", "gaussian", "generalized-gaussian", "rayleigh", "gamma" or "edge".
    regions: labels 0 to regions - 1.
    mode: "global", or "local": the contour moves from where it starts.
    mask: array like the image or a file name, 0 where voxels take no part.
    center_spacing, support, kernel: of the radial functions; the spacing in voxels, the support in spacings.
    smoothness: weight of the length of the contour, in voxels.
    force: instead of an energy a function of the labels (an array like the image, 1 inside) that returns what each
        voxel costs inside instead of outside, in an array of the same shape: negative where it wants to be inside.
    The others are those of `csrbf segment --help`.
    """
    image = _image(image, voxel_size)
    if force is not None and not callable(force):
        raise ValueError("force: must be a function of the labels")
    options = _options(energy=energy, regions=regions, mode=mode, method=method, kernel=kernel, shading=shading,
                       balloon=float(balloon), iterations=int(iterations), smoothness=smoothness,
                       center_spacing=center_spacing, support=support, window=window, fill_holes=fill_holes)
    return Segmentation(_csrbf.segment(image, _seed(init, image), _voxels(mask, image, "mask"), options, force))


def _options(**given):
    """What was given of it; the rest is automatic."""
    options = {"energy": "chan-vese", "regions": 2, "mode": "global", "method": "variational", "shading": "auto"}
    smoothness = given.pop("smoothness", None)
    if smoothness is not None and not (isinstance(smoothness, str) and smoothness == "auto"):
        options["smoothness"] = float(smoothness)
    options.update((name, value) for name, value in given.items() if value is not None)
    return options


class Tracking(list):
    """The Segmentations of the frames of a sequence, in their order.

    measures: for each frame a list of dicts, one per region but 0: label, voxels, volume (in the plane: area) and area
        (length) of the level set, mean.
    warnings: list of texts.
    """

    def __init__(self, frames, warnings):
        super().__init__(Segmentation(segments) for segments, _ in frames)
        self.measures = [regions for _, regions in frames]
        self.warnings = warnings

    def volumes(self, label=1):
        """The volume (area) of a region in each frame."""
        return np.array([next(r["volume"] for r in regions if r["label"] == label) for regions in self.measures])


_TRACK_OPTIONS = ("mode", "method", "center_spacing", "support", "kernel", "smoothness", "window", "shading", "balloon",
                  "fill_holes", "iterations")


def track(
    frames,
    voxel_size=None,
    init="auto",
    energy="chan-vese",
    regions=2,
    *,
    mask=None,
    persistence=1.0,
    motion=None,
    sweeps=2,
    **options,
):
    """A segmentation carried through a sequence: a Tracking, the list of the Segmentations of its frames.

    frames: array [t, y, x] or [t, z, y, x], a list of images as segment() takes them, or the name of a file with a time
        axis.
    init: of the first frame; what is inside there stays inside.
    persistence: weight of the memory of the contour; 0: every frame by itself.
    motion: how far the contour may move between frames, in voxels.
    sweeps: 1 goes forward only; 2 and more smooth over time in both directions.
    The others, by keyword too, are those of segment().
    """
    unknown = sorted(set(options) - set(_TRACK_OPTIONS))
    if unknown:
        raise TypeError(f"track() got an unexpected keyword argument '{unknown[0]}'")
    if isinstance(frames, (str, os.PathLike)):
        sequence = _image(frames, voxel_size)
        images = [sequence.frame(t) for t in range(sequence.frames)]
    else:
        images = [_image(frame, voxel_size) for frame in frames]
    if not images:
        raise ValueError("frames: there are none")
    given = _options(energy=energy, regions=regions, **options)
    seed, voxels = _seed(init, images[0]), _voxels(mask, images[0], "mask")
    return Tracking(*_csrbf.track(images, seed, voxels, given, float(persistence), motion, int(sweeps)))
