"""ParaView filters that call csrbf: Reconstruct, Fit and Segment.

Load this file with Tools > Manage Plugins > Load New, or in pvpython with LoadPlugin(path, ns=globals()). ParaView's
Python must find the module csrbf.
"""

import numpy as np
from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject

import csrbf


def _array(values, name):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def _points_of(data):
    if data.GetNumberOfPoints() == 0:
        raise ValueError("csrbf: the input has no points")
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def _fill(output, vertices, faces, normals):
    """Sets a vtkPolyData to the mesh."""
    points = vtkPoints()
    points.SetData(_array(vertices, "Points"))
    cells = vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces, dtype=np.int64).ravel(), deep=True))
    output.SetPoints(points)
    output.SetPolys(cells)
    if normals is not None and len(normals):
        output.GetPointData().SetNormals(_array(normals, "Normals"))


def _number_or_none(value):
    """0 lets csrbf choose."""
    return value if value > 0 else None


@smproxy.filter(name="csrbfReconstruct", label="csrbf Reconstruct")
@smhint.xml('<ShowInMenu category="csrbf"/>')
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkPointSet"], composite_data_supported=False)
class Reconstruct(VTKPythonAlgorithmBase):
    """A watertight mesh from points, using their normals if they have any."""

    def __init__(self):
        super().__init__(nInputPorts=1, nOutputPorts=1, inputType="vtkPointSet", outputType="vtkPolyData")
        self._centers, self._resolution, self._curvature = 0, 0, False

    @smproperty.intvector(name="Resolution", default_values=0)
    def SetResolution(self, cells):
        """Cells of the mesh along the longest side; 0: from the sampling."""
        self._resolution = cells
        self.Modified()

    @smproperty.intvector(name="Centers", default_values=0)
    def SetCenters(self, centers):
        """Budget of RBF centres; 0: from the data."""
        self._centers = centers
        self.Modified()

    @smproperty.intvector(name="Curvature", default_values=0)
    @smdomain.xml('<BooleanDomain name="bool"/>')
    def SetCurvature(self, wanted):
        """Adds mean_curvature and gaussian_curvature."""
        self._curvature = bool(wanted)
        self.Modified()

    def RequestData(self, request, inputs, outputs):
        cloud, output = vtkDataObject.GetData(inputs[0], 0), vtkDataObject.GetData(outputs, 0)
        normals = cloud.GetPointData().GetNormals()
        surface = csrbf.reconstruct(_points_of(cloud), None if normals is None else vtk_to_numpy(normals).astype(float),
                                    centers=_number_or_none(self._centers))
        mesh = surface.polygonize(_number_or_none(self._resolution))
        _fill(output, mesh.vertices, mesh.faces, mesh.normals)
        if self._curvature:
            curvature = surface.curvature(mesh.vertices)
            output.GetPointData().AddArray(_array(curvature.mean, "mean_curvature"))
            output.GetPointData().AddArray(_array(curvature.gaussian, "gaussian_curvature"))
        return 1


@smproxy.filter(name="csrbfFit", label="csrbf Fit")
@smhint.xml('<ShowInMenu category="csrbf"/>')
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkPointSet"], composite_data_supported=False)
class Fit(VTKPythonAlgorithmBase):
    """A smooth function through values at points, sampled on an image, with its gradient."""

    def __init__(self):
        super().__init__(nInputPorts=1, nOutputPorts=1, inputType="vtkPointSet", outputType="vtkImageData")
        self._array, self._nodes, self._tolerance, self._smoothing = "", 64, 0.0, -1.0

    @smproperty.stringvector(name="Array", default_values="")
    def SetArray(self, name):
        """Array of the points to fit; the active scalars when empty."""
        self._array = name or ""
        self.Modified()

    @smproperty.intvector(name="Nodes", default_values=64)
    @smdomain.intrange(min=2, max=1024)
    def SetNodes(self, nodes):
        """Nodes of the image along its longest side."""
        self._nodes = nodes
        self.Modified()

    @smproperty.doublevector(name="Tolerance", default_values=0.0)
    def SetTolerance(self, tolerance):
        """Largest error allowed at any point, in the unit of the values; 0: none."""
        self._tolerance = tolerance
        self.Modified()

    @smproperty.doublevector(name="Smoothing", default_values=-1.0)
    def SetSmoothing(self, smoothing):
        """How much noise to smooth away: 0 nothing, larger is smoother; below 0: from the data."""
        self._smoothing = smoothing
        self.Modified()

    def RequestInformation(self, request, inputs, outputs):
        # The size of the image follows from the points, which are not available yet.
        source = self.GetInputAlgorithm(0, 0)
        source.Update()
        size = self._image(source.GetOutputDataObject(self.GetInputConnection(0, 0).GetIndex()))[0]
        extent = [0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1]
        outputs.GetInformationObject(0).Set(self.GetExecutive().WHOLE_EXTENT(), extent, 6)
        return 1

    def RequestData(self, request, inputs, outputs):
        data, output = vtkDataObject.GetData(inputs[0], 0), vtkDataObject.GetData(outputs, 0)
        name, values = self._values(data)
        size, origin, spacing = self._image(data)
        axes = [a for a in range(3) if size[a] > 1]  # points in a plane make a 2D image
        f = csrbf.fit(np.ascontiguousarray(_points_of(data)[:, axes]), values, tolerance=_number_or_none(self._tolerance),
                      smoothing="auto" if self._smoothing < 0 else self._smoothing)
        output.SetDimensions(*(int(n) for n in size))
        output.SetOrigin(*origin)
        output.SetSpacing(*spacing)
        nodes = np.meshgrid(*(origin[a] + spacing[a] * np.arange(size[a]) for a in reversed(axes)), indexing="ij")
        x = np.stack([node.ravel() for node in reversed(nodes)], axis=1)
        output.GetPointData().SetScalars(_array(f(x), name))
        if values.ndim == 1:
            gradient = np.zeros((len(x), 3))
            gradient[:, axes] = f.gradient(x)
            output.GetPointData().AddArray(_array(gradient, name + "_gradient"))
        return 1

    def _values(self, data):
        arrays = data.GetPointData()
        array = arrays.GetArray(self._array) if self._array else arrays.GetScalars() or arrays.GetArray(0)
        if array is None:
            names = ", ".join(arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays())) or "none"
            raise ValueError(f"csrbf Fit: the points have no array {self._array!r}; there are: {names}")
        return array.GetName() or "values", vtk_to_numpy(array).astype(float)

    def _image(self, data):
        """Nodes along each axis, origin and spacing of an image over the box of the points."""
        lo, hi = np.array(data.GetBounds()).reshape(3, 2).T
        longest = (hi - lo).max()
        if not longest > 0:
            raise ValueError("csrbf Fit: all points coincide")
        spacing = longest / (self._nodes - 1)
        size = np.where(hi - lo > 1e-9 * longest, np.ceil((hi - lo) / spacing - 1e-9).astype(int) + 1, 1)
        return size, lo, np.where(size > 1, (hi - lo) / np.maximum(size - 1, 1), spacing)


@smproxy.filter(name="csrbfSegment", label="csrbf Segment")
@smhint.xml('<ShowInMenu category="csrbf"/>')
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkImageData"], composite_data_supported=False)
@smproperty.xml('<OutputPort name="Labels" index="0"/><OutputPort name="Contour" index="1"/>')
class Segment(VTKPythonAlgorithmBase):
    """The regions of an image: labels (first output) and the contour of the inside (second)."""

    _energies = ["auto", "chan-vese", "gaussian", "generalized-gaussian", "rayleigh", "gamma", "edge"]

    def __init__(self):
        super().__init__(nInputPorts=1, nOutputPorts=2, inputType="vtkImageData", outputType="vtkImageData")
        self._center, self._radius, self._energy, self._local = (0.0, 0.0, 0.0), 0.0, "auto", False

    def FillOutputPortInformation(self, port, info):
        info.Set(vtkDataObject.DATA_TYPE_NAME(), "vtkImageData" if port == 0 else "vtkPolyData")
        return 1

    @smproperty.doublevector(name="SeedCenter", default_values=[0.0, 0.0, 0.0])
    def SetSeedCenter(self, x, y, z):
        """Centre of the ball to start from."""
        self._center = (x, y, z)
        self.Modified()

    @smproperty.doublevector(name="SeedRadius", default_values=0.0)
    def SetSeedRadius(self, radius):
        """Its radius; 0: start without a seed."""
        self._radius = radius
        self.Modified()

    @smproperty.stringvector(name="Energy", default_values="auto")
    @smdomain.xml('<StringListDomain name="list">' + "".join(f'<String value="{e}"/>' for e in _energies) +
                  "</StringListDomain>")
    def SetEnergy(self, energy):
        """What distinguishes regions."""
        self._energy = energy
        self.Modified()

    @smproperty.intvector(name="Local", default_values=0)
    @smdomain.xml('<BooleanDomain name="bool"/>')
    def SetLocal(self, local):
        """The contour evolves from its start, instead of appearing wherever it fits."""
        self._local = bool(local)
        self.Modified()

    def RequestData(self, request, inputs, outputs):
        image = vtkDataObject.GetData(inputs[0], 0)
        scalars = image.GetPointData().GetScalars() or image.GetPointData().GetArray(0)
        if scalars is None or scalars.GetNumberOfComponents() != 1:
            raise ValueError("csrbf Segment: the image needs one value per point")
        size, spacing = image.GetDimensions(), image.GetSpacing()
        if size[2] == 1 and min(size[:2]) > 1:
            shape, voxel = (size[1], size[0]), spacing[:2]
        else:
            shape, voxel = size[::-1], spacing
        place = self._place(image)
        seed = "auto" if not self._radius > 0 else self._ball(image, place).reshape(shape)
        found = csrbf.segment(vtk_to_numpy(scalars).astype(float).reshape(shape), voxel, seed, self._energy,
                              mode="local" if self._local else "global")
        labels = vtkDataObject.GetData(outputs, 0)
        labels.ShallowCopy(image)
        labels.GetPointData().SetScalars(_array(np.asarray(found.labels, dtype=np.uint8).ravel(), "labels"))
        self._write_contour(found.contour(), place, vtkDataObject.GetData(outputs, 1))
        return 1

    @staticmethod
    def _place(image):
        """Maps lengths along the axes from the first voxel (n, 3) to points in space."""
        matrix = image.GetDirectionMatrix()
        rows = np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)])
        spacing, extent = np.array(image.GetSpacing()), image.GetExtent()
        origin = np.array(image.GetOrigin()) + rows @ (spacing * extent[::2])
        return lambda x: x @ rows.T + origin

    def _ball(self, image, place):
        """1 at the points of the image that are in the ball to start from, x fastest."""
        steps = [n * np.arange(count) for n, count in zip(image.GetSpacing(), image.GetDimensions())]
        z, y, x = np.meshgrid(*reversed(steps), indexing="ij")
        points = place(np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1))
        return (np.linalg.norm(points - np.array(self._center), axis=1) < self._radius).astype(np.uint8)

    @staticmethod
    def _write_contour(contour, place, output):
        if not isinstance(contour, list):
            _fill(output, place(contour.vertices), contour.faces, [])
            return
        points, lines = vtkPoints(), vtkCellArray()
        for line in contour:
            first = points.GetNumberOfPoints()
            for point in place(np.column_stack([line, np.zeros(len(line))])):
                points.InsertNextPoint(point)
            lines.InsertNextCell(len(line) + 1)
            for i in range(len(line) + 1):
                lines.InsertCellPoint(first + i % len(line))
        output.SetPoints(points)
        output.SetLines(lines)
