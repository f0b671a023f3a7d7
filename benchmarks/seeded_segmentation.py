"""Tables of segmentation.py: one region from seeds, with csrbf and its peers, and three tissues of a head."""

import gzip
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from scipy import ndimage as ndi

HEADER = ["image", "tool", "Dice", "part of the disc kept", "CPU s"]
TISSUE_HEADER = ["tool", "fluid", "grey matter", "white matter"]
HEAD = Path("/usr/share/mricron/templates/ch2bet.nii.gz")  # Debian: mricron-data

LEGEND = """\
All start from the same disc inside; what marks the background has the border of the image besides. Fixed parameters for
all images: the level set of ITK (ThresholdSegmentation) grows within 2.5 standard deviations of the mean of the disc,
with curvature 1; the geodesic active contour of scikit-image (morphological) has a balloon force of 1; random walker and
watershed of scikit-image, the latter of the gradient after a Gaussian of one pixel, know the disc and the border.
*dumbbell*: two discs joined by a bridge of 8 pixels, of which the border is marked in the bridge, too; *blob_-5dB*: a
flower in noise of 1.8 times the contrast; *head*: the brain in a T1 slice of Colin27; *tumour*, *lung*: a slice of MR and
of CT.
"""
TISSUES = """\
A T1 slice of Colin27 without skull, with Gaussian noise of 9 % of the brightest tissue. The truth is what three means make
of the slice without noise. Mean Dice over three seeds of noise.
"""


def dice(a, b):
    return 2 * np.count_nonzero(a & b) / max(1, np.count_nonzero(a) + np.count_nonzero(b))


def disc(shape, x, y, radius):
    v, u = np.mgrid[0:shape[0], 0:shape[1]]
    return np.hypot(u - x, v - y) <= radius


def images(data):
    """Name, image, mask, place and radius of the disc, further voxels of the background."""
    n = 161
    y, x = np.mgrid[0:n, 0:n] - n // 2
    rng = np.random.default_rng(5)
    left = np.hypot(x + 40, y) < 34
    shape = left | (np.hypot(x - 40, y) < 34) | ((abs(y) < 4) & (abs(x) < 40))
    image = ndi.gaussian_filter(shape.astype(float), 1) + 0.15 * rng.standard_normal(shape.shape)
    yield "dumbbell", image, left | ((abs(y) < 4) & (x < 0) & (x > -40)), (40, 80, 8), (abs(x) < 2) & (abs(y) < 8)
    y, x = np.mgrid[0:256, 0:256] - 128
    blob = np.hypot(y, x) < 70 + 18 * np.cos(5 * np.arctan2(y, x))
    yield "blob_-5dB", blob + 10**0.25 * rng.standard_normal(blob.shape), blob, (128, 128, 30), None
    if data is None:
        return
    if (data / "mr_ch2_slice.npz").exists():
        arrays = np.load(data / "mr_ch2_slice.npz")
        yield "head", arrays["img"], arrays["gt"] != 0, (108, 90, 20), None
    if (data / "brain1_image.nrrd").exists():
        image, mask = (read_nrrd(data / f"brain1_{part}.nrrd") for part in ("image", "label"))
        yield "tumour", image[16], mask[16] != 0, (183, 102, 12), None
    if (data / "example_ct_sm.nii.gz").exists():
        image, organs = (read_nifti(data / f"example_{part}.nii.gz")[27] for part in ("ct_sm", "seg"))
        lung = np.isin(organs, [k for k in np.unique(organs) if k and image[organs == k].mean() < -500])
        parts, _ = ndi.label(lung)
        yield "lung", image, parts == parts[24, 82], (82, 24, 4), None


def read_nrrd(path):
    head, _, body = path.read_bytes().partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    types = {"short": "i2", "unsigned char": "u1", "uint8": "u1", "float": "f4", "int": "i4", "uint16": "u2",
             "unsigned short": "u2", "int16": "i2", "double": "f8"}
    body = gzip.decompress(body) if fields["encoding"] in ("gzip", "gz") else body
    size = [int(n) for n in fields["sizes"].split()]
    order = ">" if fields.get("endian") == "big" else "<"
    return np.frombuffer(body, order + types[fields["type"]]).reshape(size[::-1]).astype(np.float32)


def read_nifti(path):
    bytes_ = gzip.decompress(path.read_bytes())
    size = np.frombuffer(bytes_, "<i2", 8, 40)[1:4]
    kind = {2: "u1", 4: "<i2", 8: "<i4", 16: "<f4", 64: "<f8", 512: "<u2"}[int(np.frombuffer(bytes_, "<i2", 1, 70)[0])]
    start = int(np.frombuffer(bytes_, "<f4", 1, 108)[0])
    slope, intercept = np.frombuffer(bytes_, "<f4", 2, 112)
    values = np.frombuffer(bytes_, kind, int(np.prod(size)), start).reshape(size[::-1]).astype(np.float32)
    return values * slope + intercept if slope not in (0, 1) or intercept != 0 else values


def frame(shape):
    border = np.zeros(shape, bool)
    border[[0, -1]] = border[:, [0, -1]] = True
    return border


class Runner:
    """Segments one image with each tool from a disc and marks of the background."""

    def __init__(self, program, work, image, place, background):
        self.program, self.work, self.place = program, work, place
        self.image = image.astype(np.float32)
        self.start = disc(image.shape, *place)
        self.marks = np.where(self.start, 2, 0).astype(np.uint8)
        self.marks[frame(image.shape) & ~self.start] = 1
        if background is not None:
            self.marks[background] = 1
        np.save(work / "seeded.npy", self.image)
        np.save(work / "marks.npy", self.marks)

    def csrbf(self, *flags):
        import resource

        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        out = self.work / "seeded_labels.npy"
        subprocess.run([str(a) for a in (self.program, "segment", self.work / "seeded.npy", "-o", out, *flags)],
                       check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return np.load(out) != 0, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def itk(self):
        program = self.program.parent / "itk_threshold_level_set"
        if not program.exists():
            return None
        inside = self.image[self.start]
        reach = 2.5 * inside.std()
        names = [self.work / name for name in ("itk_image", "itk_start", "itk_labels", "itk_cost.json")]
        self.image.tofile(names[0])
        distance = ndi.distance_transform_edt(~self.start) - ndi.distance_transform_edt(self.start)
        distance.astype(np.float32).tofile(names[1])
        rows, columns = self.image.shape
        subprocess.run([str(a) for a in (program, *names, columns, rows, 1, inside.mean() - reach,
                                         inside.mean() + reach, 1)], check=True, stderr=subprocess.DEVNULL)
        labels = np.fromfile(names[2], np.float32).reshape(self.image.shape) > 0
        return labels, json.loads(names[3].read_text())["cpu"]

    def timed(self, function):
        start = time.process_time()
        return function(), time.process_time() - start

    def contour(self):
        from skimage.segmentation import inverse_gaussian_gradient, morphological_geodesic_active_contour

        scaled = (self.image - self.image.min()) / np.ptp(self.image)
        return self.timed(lambda: morphological_geodesic_active_contour(
            inverse_gaussian_gradient(scaled), 300, init_level_set=self.start, smoothing=1, balloon=1) != 0)

    def walker(self):
        from skimage.segmentation import random_walker

        scaled = (self.image - self.image.min()) / np.ptp(self.image)
        return self.timed(lambda: random_walker(scaled, self.marks.astype(int), mode="cg_j") == 2)

    def watershed(self):
        from skimage.segmentation import watershed

        return self.timed(lambda: watershed(ndi.gaussian_gradient_magnitude(self.image, 1),
                                            self.marks.astype(int)) == 2)

    def tools(self, peers):
        x, y, radius = self.place
        marks = self.work / "marks.npy"
        yield "csrbf --mode local --init", self.csrbf("--mode", "local", "--init", f"sphere:{x},{y},{radius}")
        yield "csrbf --mode local --seeds", self.csrbf("--mode", "local", "--seeds", marks)
        yield "csrbf --seeds", self.csrbf("--seeds", marks)
        itk = self.itk()
        if itk is not None:
            yield "ITK threshold level set", itk
        if peers:
            yield "geodesic active contour", self.contour()
            yield "random walker", self.walker()
            yield "watershed", self.watershed()


def seeded_rows(program, work, data, peers):
    for name, image, mask, place, background in images(data):
        print(name, file=sys.stderr)
        runner = Runner(program, work, image, place, background)
        for tool, (labels, cpu) in runner.tools(peers):
            kept = np.count_nonzero(labels & runner.start) / np.count_nonzero(runner.start)
            yield [name, tool, f"{dice(labels, mask):.4f}", f"{kept:.3f}", f"{cpu:.2f}"]


def means_of(values, count):
    """Thresholds between that many means."""
    means = np.quantile(values, (np.arange(count) + 0.5) / count)
    for _ in range(200):
        labels = np.abs(values[:, None] - means).argmin(1)
        means = np.array([values[labels == k].mean() for k in range(count)])
    return np.sort(means)


def classes(image, brain):
    means = means_of(image[brain], 3)
    return np.abs(image[..., None] - means).argmin(-1)


def tissue_rows(program, work, height=90):
    """Dice of fluid, grey and white matter in a slice of the head."""
    if not HEAD.exists():
        print(f"tissues: left out, {HEAD} is not there", file=sys.stderr)
        return
    image = read_nifti(HEAD)[height]
    brain = image > 0
    truth = classes(image, brain)
    sigma = 0.09 * image[brain & (truth == 2)].mean()
    np.save(work / "brain.npy", brain.astype(np.uint8))
    scores = {"csrbf --regions 3": [], "Gaussian of one voxel and three means": [], "three means": []}
    for seed in range(3):
        noisy = image + sigma * np.random.default_rng(seed).standard_normal(image.shape)
        np.save(work / "seeded.npy", noisy.astype(np.float32))
        out = work / "seeded_labels.npy"
        subprocess.run([str(a) for a in (program, "segment", work / "seeded.npy", "-o", out, "--regions", 3, "--mask",
                                         work / "brain.npy")], check=True, stdout=subprocess.DEVNULL)
        weight = ndi.gaussian_filter(brain.astype(float), 1)
        smooth = ndi.gaussian_filter(np.where(brain, noisy, 0), 1) / np.maximum(weight, 1e-9)
        for labels, name in zip((np.load(out), classes(smooth, brain), classes(noisy, brain)), scores):
            scores[name].append([dice((labels == k) & brain, (truth == k) & brain) for k in range(3)])
    for name, each in scores.items():
        yield [name, *(f"{score:.3f}" for score in np.mean(each, 0))]
