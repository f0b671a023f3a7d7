"""Runs the filters for ParaView in VTK alone. Exit status 77 without VTK."""

import importlib.util
import os
import pathlib
import sys
import types
import unittest

try:
    from vtkmodules.vtkCommonCore import vtkPoints
except ImportError:
    print("skipped: VTK is not installed (Debian: python3-vtk9)")
    sys.exit(77)

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData

PLUGIN = pathlib.Path(__file__).parent.parent / "plugins" / "csrbf_paraview.py"


def load_plugin():
    """The module, with decorators that leave everything as it is where ParaView does not give its own."""

    class Nothing:
        def __getattr__(self, name):
            return lambda *arguments, **options: lambda thing: thing

    decorators = types.ModuleType("paraview.util.vtkAlgorithm")
    for name in ("smdomain", "smhint", "smproperty", "smproxy"):
        setattr(decorators, name, Nothing())
    for name in ("paraview", "paraview.util"):
        sys.modules[name] = types.ModuleType(name)
    sys.modules["paraview.util.vtkAlgorithm"] = decorators
    spec = importlib.util.spec_from_file_location("csrbf_paraview", PLUGIN)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


plugin = load_plugin()


def cloud(points, **arrays):
    data = vtkPolyData()
    coordinates = vtkPoints()
    coordinates.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    data.SetPoints(coordinates)
    for name, values in arrays.items():
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def sphere(n=2000, radius=2.0, center=(5, 6, 7)):
    """Points spread evenly over a sphere."""
    z = 1 - (2 * np.arange(n) + 1) / n
    angle = np.pi * (1 + 5**0.5) * np.arange(n)
    ring = np.sqrt(1 - z * z)
    return radius * np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1) + center


class Filters(unittest.TestCase):
    def run_filter(self, algorithm, data, **properties):
        for name, value in properties.items():
            setter = getattr(algorithm, "Set" + name)
            setter(*value) if isinstance(value, tuple) else setter(value)
        algorithm.SetInputDataObject(0, data)
        algorithm.Update()
        return algorithm.GetOutputDataObject(0)

    def test_reconstruct_makes_a_closed_mesh_with_curvatures(self):
        mesh = self.run_filter(plugin.Reconstruct(), cloud(sphere()), Resolution=32, Curvature=1)
        vertices = vtk_to_numpy(mesh.GetPoints().GetData())
        distance = np.abs(np.linalg.norm(vertices - (5, 6, 7), axis=1) - 2)
        self.assertLess(distance.max(), 0.02)
        self.assertEqual(mesh.GetNumberOfPoints() - mesh.GetNumberOfPolys() // 2, 2)  # Euler's formula on a sphere
        normals = vtk_to_numpy(mesh.GetPointData().GetNormals())
        self.assertGreater(np.einsum("ij,ij->i", normals, vertices - (5, 6, 7)).min(), 0)
        self.assertLess(np.abs(vtk_to_numpy(mesh.GetPointData().GetArray("mean_curvature")) - 0.5).max(), 0.2)

    def test_reconstruct_uses_the_normals_of_the_points(self):
        points = sphere()
        data = cloud(points)
        normals = numpy_to_vtk((points - (5, 6, 7)) / 2, deep=True)
        data.GetPointData().SetNormals(normals)
        self.assertGreater(self.run_filter(plugin.Reconstruct(), data, Resolution=16).GetNumberOfPolys(), 100)

    def test_fit_samples_a_function_of_space_with_its_gradient(self):
        x = np.random.default_rng(1).uniform((0, 0, 0), (2, 1, 1), (3000, 3))
        image = self.run_filter(plugin.Fit(), cloud(x, u=2 * x[:, 0] - x[:, 2]), Array="u", Nodes=21)
        self.assertEqual(image.GetDimensions()[0], 21)
        nodes = np.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
        u = vtk_to_numpy(image.GetPointData().GetScalars())
        np.testing.assert_allclose(u, 2 * nodes[:, 0] - nodes[:, 2], atol=1e-3)
        gradient = vtk_to_numpy(image.GetPointData().GetArray("u_gradient"))
        np.testing.assert_allclose(gradient, np.tile([2.0, 0, -1], (len(u), 1)), atol=2e-2)

    def test_fit_of_points_in_a_plane_makes_a_plane_image(self):
        x = np.random.default_rng(2).uniform(0, 1, (800, 3))
        x[:, 1] = 4
        image = self.run_filter(plugin.Fit(), cloud(x, depth=x[:, 0] * x[:, 2]), Nodes=11)
        self.assertEqual(image.GetDimensions()[1], 1)
        nodes = np.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
        self.assertTrue((nodes[:, 1] == 4).all())
        depth = vtk_to_numpy(image.GetPointData().GetArray("depth"))
        np.testing.assert_allclose(depth, nodes[:, 0] * nodes[:, 2], atol=1e-2)

    def image_of_a_ball(self, size, center, radius):
        image = vtkImageData()
        image.SetDimensions(*size)
        image.SetSpacing(0.5, 0.5, 1.0)
        image.SetOrigin(10, 20, 30)
        image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
        points = np.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
        inside = np.linalg.norm(points - center, axis=1) < radius
        array = numpy_to_vtk(np.where(inside, 100.0, 20.0), deep=True)
        array.SetName("intensity")
        image.GetPointData().SetScalars(array)
        return image, inside

    def test_segment_finds_a_ball_where_the_image_is(self):
        center, radius = np.array([2.0, 26.0, 40.0]), 5.0
        image, inside = self.image_of_a_ball((30, 32, 20), center, radius)
        algorithm = plugin.Segment()
        labels = self.run_filter(algorithm, image, SeedCenter=tuple(center), SeedRadius=2.0, Local=1)
        found = vtk_to_numpy(labels.GetPointData().GetArray("labels")) > 0
        self.assertGreater(2 * (found & inside).sum() / (found.sum() + inside.sum()), 0.95)
        contour = vtk_to_numpy(algorithm.GetOutputDataObject(1).GetPoints().GetData())
        self.assertLess(np.abs(np.linalg.norm(contour - center, axis=1) - radius).mean(), 0.3)

    def test_segment_of_a_plane_image_gives_lines(self):
        center, radius = np.array([2.0, 26.0, 30.0]), 5.0
        image, _ = self.image_of_a_ball((30, 32, 1), center, radius)
        algorithm = plugin.Segment()
        self.run_filter(algorithm, image)
        contour = algorithm.GetOutputDataObject(1)
        self.assertEqual(contour.GetNumberOfLines(), 1)
        points = vtk_to_numpy(contour.GetPoints().GetData())
        self.assertLess(np.abs(np.linalg.norm(points - center, axis=1) - radius).mean(), 0.3)


if __name__ == "__main__":
    unittest.main()
