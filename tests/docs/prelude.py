"""What the Python blocks of the pages take for granted: arrays of the reader's own."""

import numpy

import csrbf  # noqa: F401

generator = numpy.random.default_rng(0)
points = numpy.loadtxt("scan.xyz")  # (n, 3), of a surface
values = numpy.sin(points).sum(axis=1)
x = points[:5]

# A bright ball in the dark, [z, y, x] with voxels of 1 x 1 x 2, and a slice of it with a hole.
z, y, w = numpy.meshgrid(2.0 * numpy.arange(30), numpy.arange(84.0), numpy.arange(72.0), indexing="ij")
image = numpy.where((w - 40) ** 2 + (y - 50) ** 2 + (z - 30) ** 2 < 15**2, 10.0, 0.0)
image += generator.normal(size=image.shape)
mask = numpy.zeros(image.shape)
mask[15, 40:44, 30:34] = 1

# A disc that shrinks, [t, y, x].
v, u = numpy.mgrid[:128, :128]
frames = [numpy.where((u - 64) ** 2 + (v - 64) ** 2 < (30 - 2 * t) ** 2, 10.0, 0.0) for t in range(5)]
frames = numpy.array(frames) + generator.normal(size=(5, 128, 128))

# Three contours on slices.
angle = numpy.linspace(0, 2 * numpy.pi, 40, endpoint=False)
first, second, third = (
    numpy.column_stack([r * numpy.cos(angle), r * numpy.sin(angle), numpy.full(40, h)])
    for r, h in ((1.0, 0.0), (1.2, 0.5), (0.9, 1.0))
)
