"""Runs the command-line modules for 3D Slicer as Slicer would: asks each for its description, makes an argument for
every parameter in it, and runs it.

usage: slicer_test.py PROGRAM FOLDER-OF-MODULES [unittest options]
"""

import os
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from fit_test import npy_bytes
from segment_test import Segment, fibonacci

MODULES = os.path.abspath(sys.argv.pop(2))
SIMPLE = {"integer": int, "double": float, "string-enumeration": str}


def describe(module):
    """The description that a module prints."""
    run = subprocess.run([os.path.join(MODULES, module), "--xml"], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0 and not run.stderr, run.stderr
    assert run.stdout.startswith("<?xml"), "Slicer looks for the XML at the beginning of the output"
    return ElementTree.fromstring(run.stdout)


def parameters(description):
    """Every parameter: its tag and a dict of its elements."""
    for group in description.findall("parameters"):
        for element in group:
            if element.tag not in ("label", "description"):
                yield element.tag, {child.tag: (child.text or "") for child in element}, element


class Slicer(Segment):
    def arguments(self, description, files, **values):
        """The command line that Slicer makes: simple values always, texts and files when they are not empty, files that
        have an index at the end."""
        flags, places = [], []
        for tag, known, _ in parameters(description):
            value = values.get(known["name"], files.get(known["name"], known.get("default", "")))
            if "index" in known:
                places.append((int(known["index"]), value))
            elif tag in SIMPLE or value:
                flags += ["--" + known["longflag"], str(value)]
        return flags + [value for _, value in sorted(places)]

    def run_module(self, module, arguments):
        run = subprocess.run([os.path.join(MODULES, module), *arguments], capture_output=True, text=True, timeout=300)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout

    def check_description(self, module):
        description = describe(module)
        self.assertEqual(description.tag, "executable")
        # The order of Slicer's schema, ModuleDescription.xsd, in which constraints have three parts.
        head = ["category", "title", "description", "version", "documentation-url", "license", "contributor"]
        self.assertEqual([element.tag for element in description], [*head, "parameters", "parameters"])
        for tag in head:
            self.assertTrue(description.find(tag).text, tag)
        names = []
        for tag, known, element in parameters(description):
            self.assertIn(tag, {*SIMPLE, "string", "image", "geometry", "file"})
            self.assertRegex(known["name"], "^[a-z_]+$")
            self.assertTrue(known["label"] and known["description"])
            self.assertTrue("index" in known or re.fullmatch("[a-z-]+", known["longflag"]))
            if tag in ("image", "geometry", "file"):
                self.assertIn(known["channel"], ("input", "output"))
                self.assertTrue(element.get("fileExtensions"))
            if tag in SIMPLE:
                SIMPLE[tag](known["default"])
            if tag == "string-enumeration":
                self.assertIn(known["default"], [e.text for e in element.findall("element")])
            limits = element.find("constraints")
            if limits is not None:
                self.assertEqual([limit.tag for limit in limits], ["minimum", "maximum", "step"])
                self.assertLessEqual(float(limits.find("minimum").text), float(known["default"]))
                self.assertGreaterEqual(float(limits.find("maximum").text), float(known["default"]))
            names.append(known["name"])
        self.assertEqual(len(names), len(set(names)))
        return description

    def test_segment_runs_with_every_file_and_tells_its_progress(self):
        description = self.check_description("csrbf-segment")
        mask = self.write_bytes("mask.npy", npy_bytes((20, 26, 28), [1] * (28 * 26 * 20), "|u1"))
        files = {"image": self.ball(), "output": self.path("labels.nrrd"), "contour": self.path("contour.vtp"),
                 "model": self.path("levels.csrbf"), "preview": self.path("preview.png"), "mask": mask}
        arguments = self.arguments(description, files, init="sphere:10,20,30,6", mode="local")
        output = self.run_module("csrbf-segment", arguments)
        for name in ("labels.nrrd", "contour.vtp", "levels.csrbf", "preview.png"):
            self.assertTrue(os.path.getsize(self.path(name)), name)
        starts = re.findall("<filter-start>\n<filter-name>(.*)</filter-name>", output)
        ends = re.findall("<filter-end>\n<filter-name>(.*)</filter-name>\n<filter-time>[0-9.]+</filter-time>", output)
        self.assertEqual(starts, ends)
        self.assertIn("evolve", starts)
        progress = [float(p) for p in re.findall("<filter-progress>(.*)</filter-progress>", output)]
        self.assertTrue(progress and min(progress) >= 0 and max(progress) <= 1)

    def test_segment_takes_every_value_that_its_description_offers(self):
        description = describe("csrbf-segment")
        image = self.disc(width=24, height=20, cx=12, cy=10, r=6)
        files = {"image": image, "output": self.path("labels.npy")}
        for tag, known, element in parameters(description):
            if tag == "string-enumeration":
                for value in element.findall("element"):
                    options = {"init": "sphere:12,10,4", known["name"]: value.text}
                    self.run_module("csrbf-segment", self.arguments(description, files, **options))

    def test_reconstruct_makes_a_model_of_a_model(self):
        description = self.check_description("csrbf-reconstruct")
        cloud = self.write("cloud.xyz", "".join("%r %r %r\n" % p for p in fibonacci(1500, 3, (1, 2, 3))))
        points = self.path("points.vtp")
        self.succeed("estimate-normals", cloud, "-o", points)
        files = {"points": points, "output": self.path("mesh.vtp"), "model": self.path("mesh.csrbf")}
        self.run_module("csrbf-reconstruct", self.arguments(description, files, resolution="24"))
        self.succeed("compare", self.path("mesh.vtp"), points, "--report", self.path("compare.json"))
        self.assertTrue(self.report("compare.json")["result"]["watertight"])

    def test_inpaint_fills_an_image(self):
        description = self.check_description("csrbf-inpaint")
        files = {"image": self.disc(), "output": self.path("filled.nrrd")}
        self.run_module("csrbf-inpaint", self.arguments(description, files, missing="10"))
        self.assertTrue(os.path.getsize(self.path("filled.nrrd")))

    def test_only_its_commands_describe_themselves(self):
        self.fail_with(2, "--xml", "fit", "a.csv", "-o", "b.csrbf", "--xml")


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
