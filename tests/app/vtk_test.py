"""Exchanges files with VTK, in both directions. Exit status 77 without VTK.

usage: vtk_test.py PROGRAM [unittest options]
"""

import os
import sys
import unittest

try:
    from vtkmodules.vtkCommonDataModel import vtkImageData
except ImportError:
    print("skipped: VTK is not installed (Debian: python3-vtk9)")
    sys.exit(77)

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter, vtkXMLPolyDataReader, vtkXMLPolyDataWriter

import command_line_test
from command_line_test import ply
from segment_test import Segment, fibonacci


def read(reader, path):
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def arrays(data):
    names = [data.GetPointData().GetArrayName(i) for i in range(data.GetPointData().GetNumberOfArrays())]
    return {name: vtk_to_numpy(data.GetPointData().GetArray(name)) for name in names}


class WrittenByCsrbf(Segment):
    def test_mesh_with_curvatures_and_lines(self):
        cloud = self.write("cloud.xyz", "".join("%r %r %r\n" % p for p in fibonacci(2000, 1, (0, 0, 0))))
        self.succeed("reconstruct", cloud, "-o", self.path("mesh.vtp"), "--model", self.path("s.csrbf"), "--resolution", "20")
        mesh = read(vtkXMLPolyDataReader(), self.path("mesh.vtp"))
        self.assertEqual(mesh.GetNumberOfPoints() - mesh.GetNumberOfPolys() // 2, 2)
        vertices, normals = vtk_to_numpy(mesh.GetPoints().GetData()), vtk_to_numpy(mesh.GetPointData().GetNormals())
        self.assertLess(np.abs(np.linalg.norm(vertices, axis=1) - 1).max(), 0.01)
        self.assertGreater(np.einsum("ij,ij->i", vertices, normals).min(), 0.9)
        self.succeed("curvature", self.path("s.csrbf"), "-o", self.path("c.vtp"), "--ridges", self.path("r.vtp"),
                     "--resolution", "20")
        curved = arrays(read(vtkXMLPolyDataReader(), self.path("c.vtp")))
        self.assertEqual(curved["d1"].shape[1], 3)
        self.assertLess(abs(np.median(curved["mean_curvature"]) - 1), 0.1)
        self.assertIn("kind", arrays(read(vtkXMLPolyDataReader(), self.path("r.vtp"))))

    def test_points_with_normals_and_colors(self):
        self.succeed("estimate-normals", self.write("c.ply", ply(fibonacci(50, 1, (0, 0, 0)), colored=True)), "-o",
                     self.path("c.vtp"))
        data = read(vtkXMLPolyDataReader(), self.path("c.vtp"))
        self.assertEqual(data.GetNumberOfVerts(), 50)
        z = vtk_to_numpy(data.GetPoints().GetData())[:, 2]
        np.testing.assert_array_equal(arrays(data)["RGB"], np.where(z[:, None] > 0, [255, 0, 0], [0, 0, 255]))
        self.assertIsNotNone(data.GetPointData().GetNormals())

    def test_grid_with_gradient(self):
        rows = "".join("%g,%g,%g\n" % (x, y, 2 * x - y) for x in range(10) for y in range(10))
        self.succeed("fit", self.write("s.csv", "x,y,depth\n" + rows), "-o", self.path("f.csrbf"))
        self.succeed("evaluate", self.path("f.csrbf"), "-o", self.path("g.vti"), "--grid", "5,3", "--bounds", "1:5,2:4",
                     "--gradient", "--hessian")
        image = read(vtkXMLImageDataReader(), self.path("g.vti"))
        self.assertEqual(image.GetDimensions(), (5, 3, 1))
        found = arrays(image)
        nodes = np.array([image.GetPoint(i) for i in range(15)])
        np.testing.assert_allclose(found["depth"], 2 * nodes[:, 0] - nodes[:, 1], atol=1e-6)
        np.testing.assert_allclose(found["depth_gradient"], np.tile([2.0, -1, 0], (15, 1)), atol=1e-5)
        self.assertIn("depth_x_y", found)

    def test_labels_and_contour_lie_upon_each_other(self):
        self.succeed("segment", self.ball(), "-o", self.path("labels.vti"), "--contour", self.path("contour.vtp"))
        image = read(vtkXMLImageDataReader(), self.path("labels.vti"))
        self.assertEqual(image.GetSpacing(), (1.5, 1.5, 2.0))
        points = np.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
        inside = np.linalg.norm(points - (10, 20, 30), axis=1) < 12
        self.assertGreater((inside == (arrays(image)["values"] > 0)).mean(), 0.99)
        contour = vtk_to_numpy(read(vtkXMLPolyDataReader(), self.path("contour.vtp")).GetPoints().GetData())
        self.assertLess(np.abs(np.linalg.norm(contour - (10, 20, 30), axis=1) - 12).mean(), 0.5)

    def test_oblique_axes(self):
        head = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 2 3\n"
        head += "ElementSpacing = 1 2 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
        self.write_bytes("a.mha", head.encode() + bytes(range(8)))
        self.succeed("inpaint", self.path("a.mha"), "-o", self.path("a.vti"), "--missing", "99")
        image = read(vtkXMLImageDataReader(), self.path("a.vti"))
        np.testing.assert_allclose([image.GetPoint(i) for i in (0, 1, 2, 4)], [(1, 2, 3), (1, 3, 3), (-1, 2, 3), (1, 2, 6)])
        np.testing.assert_array_equal(arrays(image)["values"], range(8))


class WrittenByVtk(Segment):
    def every_encoding(self, writer, data, extension):
        """Writes the data in each way that VTK knows, with zlib and without compression."""
        writer.SetInputData(data)
        for mode in ("Ascii", "Binary", "Appended"):
            for compressor in ("None", "ZLib"):
                for encode in (True, False) if mode == "Appended" else (True,):
                    for header in ("UInt32", "UInt64"):
                        getattr(writer, f"SetDataModeTo{mode}")()
                        getattr(writer, f"SetCompressorTypeTo{compressor}")()
                        getattr(writer, f"SetHeaderTypeTo{header}")()
                        writer.SetEncodeAppendedData(encode)
                        writer.SetBlockSize(4096)
                        writer.SetFileName(self.path(f"{mode}{compressor}{encode}{header}{extension}"))
                        self.assertEqual(writer.Write(), 1)
                        yield writer.GetFileName()

    def test_meshes(self):
        source = vtkSphereSource()
        source.SetThetaResolution(40)
        source.SetPhiResolution(40)
        source.Update()
        for path in self.every_encoding(vtkXMLPolyDataWriter(), source.GetOutput(), ".vtp"):
            with self.subTest(os.path.basename(path)):
                self.succeed("info", path, "--report", self.path("info.json"))
                found = self.report("info.json")["result"]
                self.assertEqual(found["vertices"], source.GetOutput().GetNumberOfPoints())
                self.assertEqual(found["triangles"], source.GetOutput().GetNumberOfPolys())
                self.assertTrue(found["watertight"] and found["normals"])

    def test_images(self):
        image = vtkImageData()
        image.SetExtent(2, 21, 0, 14, 1, 9)
        image.SetSpacing(0.5, 1, 2)
        values = np.random.default_rng(3).integers(-1000, 1000, 20 * 15 * 9).astype(np.int16)
        array = numpy_to_vtk(values, deep=True)
        array.SetName("intensity")
        image.GetPointData().SetScalars(array)
        for path in self.every_encoding(vtkXMLImageDataWriter(), image, ".vti"):
            with self.subTest(os.path.basename(path)):
                self.succeed("info", path, "--report", self.path("info.json"))
                found = self.report("info.json")["result"]
                self.assertEqual(found["size"], [20, 15, 9])
                self.assertEqual(found["origin"], [1, 0, 2])
                self.assertEqual((found["min"], found["max"]), (values.min(), values.max()))
                self.assertEqual(found["type"], "int16")


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
