"""What csrbf says about itself: one version everywhere, a citation file that is valid, a complete bill of materials.

usage: metadata_test.py SOURCES BUILD [unittest options]
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(2) if len(sys.argv) > 2 else ".")
SOURCES = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else ".")

# Licences that allow csrbf to be under the MIT licence and its binaries to be passed on.
COMPATIBLE = {"MIT", "BSD-2-Clause", "BSD-3-Clause", "MPL-2.0", "Zlib", "libpng-2.0", "libtiff", "Qhull", "Apache-2.0",
              "Python-2.0.1", "IJG"}


def text(name):
    return (SOURCES / name).read_text(encoding="utf-8")


def project_version():
    return re.search(r"project\([^)]*VERSION ([0-9.]+)", text("CMakeLists.txt"))[1]


class Recipes(unittest.TestCase):
    """Those for package managers, which cannot be run here."""

    def test_they_have_the_version_of_the_project(self):
        conda = text("packaging/conda-forge/recipe.yaml")
        self.assertEqual(re.search(r'^  version: "([^"]*)"', conda, re.M)[1], project_version())
        self.assertEqual(json.loads(text("packaging/vcpkg/vcpkg.json"))["version"], project_version())

    def test_every_option_of_cmake_that_they_set_exists(self):
        defined = set()
        for path in [SOURCES / "CMakeLists.txt", *SOURCES.glob("*/CMakeLists.txt"), *SOURCES.glob("cmake/*.cmake")]:
            defined |= set(re.findall(r"(?:option|set)\((CSRBF_\w+)", path.read_text(encoding="utf-8")))
        for name in ("packaging/conda-forge/recipe.yaml", "packaging/vcpkg/portfile.cmake"):
            used = set(re.findall(r"CSRBF_[A-Z0-9_]+", text(name)))
            self.assertTrue(used)
            self.assertLessEqual(used, defined, name)

    def test_vcpkg_finds_the_files_that_the_port_moves(self):
        """The port, with functions of vcpkg that only note their arguments, on what this build installs."""
        functions = ["vcpkg_check_features", "vcpkg_cmake_configure", "vcpkg_cmake_install", "vcpkg_cmake_config_fixup",
                     "vcpkg_fixup_pkgconfig", "vcpkg_copy_tools", "vcpkg_install_copyright"]
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder, "port.cmake")
            script.write_text("cmake_minimum_required(VERSION 3.25)\n" + "".join(
                f'function({name})\n  list(JOIN ARGN " " text)\n  message("{name} ${{text}}")\nendfunction()\n'
                for name in functions) + f"""
set(CURRENT_PORT_DIR "{SOURCES.resolve()}/packaging/vcpkg")
set(CURRENT_PACKAGES_DIR "{folder}/packages")
set(FEATURES core tools)
include("${{CURRENT_PORT_DIR}}/portfile.cmake")
message("copyright ${{SOURCE_PATH}}/LICENSE")
""", encoding="utf-8")
            done = subprocess.run(["cmake", "-P", script], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            calls = dict(line.split(" ", 1) for line in done.stderr.splitlines() if " " in line)
            self.assertIn("tools CSRBF_BUILD_APP", calls["vcpkg_check_features"])
            self.assertTrue(pathlib.Path(calls["copyright"]).exists())
            install = text("cmake/install.cmake")
            place = re.search(r"CONFIG_PATH (\S+)", calls["vcpkg_cmake_config_fixup"])[1]
            self.assertEqual(place, "lib/cmake/csrbf")
            self.assertIn("${CMAKE_INSTALL_LIBDIR}/cmake/csrbf", install)
            self.assertIn("${CMAKE_INSTALL_LIBDIR}/pkgconfig", install)

    def test_they_name_every_library_that_the_build_needs(self):
        needed = {"eigen", "nanoflann", "libpng", "tiff", "zlib", "qhull"}
        required = set(re.findall(r"find_package\((\w+)[^)]*REQUIRED", text("src/CMakeLists.txt"))) - {"Threads"}
        self.assertEqual(len(required), len(needed))
        port = json.loads(text("packaging/vcpkg/vcpkg.json"))
        named = {d if isinstance(d, str) else d["name"] for d in port["dependencies"]}
        tools = {d if isinstance(d, str) else d["name"] for d in port["features"]["tools"]["dependencies"]}
        self.assertLessEqual({n.replace("eigen", "eigen3") for n in needed}, named)
        self.assertLessEqual({"cli11", "nlohmann-json"}, tools)
        conda = text("packaging/conda-forge/recipe.yaml")
        for name in needed - {"tiff"} | {"libtiff", "cli11", "nlohmann_json", "cpp-httplib", "pybind11", "numpy", "python"}:
            self.assertRegex(conda, rf"(?m)^    - {name}( |$)", name)

    def test_what_was_not_run_says_so_in_its_first_line(self):
        for path in [*SOURCES.glob(".github/workflows/*.yml"), SOURCES / "packaging/conda-forge/recipe.yaml",
                     SOURCES / "packaging/vcpkg/portfile.cmake"]:
            self.assertRegex(path.read_text(encoding="utf-8").splitlines()[0], r"^# Not (run|built) yet: ", path)

    def test_yaml_is_valid(self):
        try:
            import yaml
        except ImportError:
            self.skipTest("needs PyYAML")
        for path in [*SOURCES.glob("packaging/**/*.yaml"), *SOURCES.glob(".github/workflows/*.yml")]:
            self.assertIsInstance(yaml.safe_load(path.read_text(encoding="utf-8")), dict, path)


class PkgConfig(unittest.TestCase):
    """What install.cmake writes for a library of either type, which is not built here."""

    def requirements(self, library_type):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "CMakeLists.txt").write_text(f"""
cmake_minimum_required(VERSION 3.25)
project(csrbf VERSION 0.1.0 DESCRIPTION "of a test" LANGUAGES NONE)
set_property(GLOBAL PROPERTY TARGET_SUPPORTS_SHARED_LIBS TRUE)
add_library(csrbf {library_type} IMPORTED)
function(install)
endfunction()
set(CMAKE_INSTALL_LIBDIR lib)
set(CMAKE_INSTALL_INCLUDEDIR include)
include("{SOURCES.resolve()}/cmake/install.cmake")
""", encoding="utf-8")
            subprocess.run(["cmake", "-S", folder, "-B", folder], check=True, capture_output=True)
            lines = pathlib.Path(folder, "csrbf.pc").read_text(encoding="utf-8").splitlines()
        return " ".join(line.split(":", 1)[1] for line in lines if line.startswith("Requires")).split()

    def test_programs_with_the_shared_library_need_the_development_files_of_eigen_only(self):
        self.assertEqual(self.requirements("SHARED"), ["eigen3", ">=", "3.4"])
        self.assertLessEqual({"eigen3", "libpng", "libtiff-4", "zlib", "qhull_r"}, set(self.requirements("STATIC")))


class DebianPackage(unittest.TestCase):
    def test_files_lie_where_debian_looks(self):
        """What CPack runs on the files that it packs."""
        with tempfile.TemporaryDirectory() as folder:
            share = pathlib.Path(folder, "usr/share")
            for name in ("doc/csrbf/LICENSE", "man/man1/csrbf.1", "zsh/site-functions/_csrbf"):
                (share / name).parent.mkdir(parents=True)
                (share / name).write_text("text", encoding="utf-8")
            settings = {"TEMPORARY_INSTALL_DIRECTORY": folder, "PACKAGING_INSTALL_PREFIX": "/usr", "PACKAGE_VERSION": "1"}
            subprocess.run(["cmake", *(f"-DCPACK_{name}={value}" for name, value in settings.items()),
                            "-P", SOURCES / "cmake/package_debian.cmake"], check=True)
            files = {path.relative_to(share).as_posix() for path in share.rglob("*") if path.is_file()}
        self.assertEqual(files, {"doc/csrbf/copyright", "doc/csrbf/changelog.gz", "man/man1/csrbf.1.gz",
                                 "lintian/overrides/csrbf", "zsh/vendor-completions/_csrbf"})


class Version(unittest.TestCase):
    def test_citation_has_the_version_of_the_project(self):
        self.assertEqual(re.search("^version: (.*)$", text("CITATION.cff"), re.M)[1], project_version())

    def test_python_package_has_the_version_of_the_project(self):
        path = SOURCES / "pyproject.toml"
        if not path.exists():
            self.skipTest("there is no pyproject.toml")
        given = re.search(r'^version *= *"([^"]*)"', path.read_text(encoding="utf-8"), re.M)
        if given is None:
            self.assertRegex(path.read_text(encoding="utf-8"), r'dynamic *= *\[[^\]]*"version"')
        else:
            self.assertEqual(given[1], project_version())

    def test_changelog_names_no_later_version(self):
        headings = re.findall(r"^## \[(.*?)\]", text("CHANGELOG.md"), re.M)
        self.assertTrue(headings)
        number = lambda version: tuple(map(int, version.split(".")))
        for released in headings:
            if released != "Unreleased":
                self.assertLessEqual(number(released), number(project_version()))
        self.assertTrue("Unreleased" in headings or project_version() in headings)


class Citation(unittest.TestCase):
    def setUp(self):
        try:
            import yaml
        except ImportError:
            self.skipTest("the module yaml is not installed (Debian: python3-yaml)")
        self.citation = yaml.safe_load(text("CITATION.cff"))

    def check_people(self, people):
        self.assertTrue(people)
        for person in people:
            self.assertTrue(set(person) == {"name"} or set(person) == {"family-names", "given-names"}, person)

    def test_has_what_the_format_requires(self):
        c = self.citation
        self.assertEqual(c["cff-version"], "1.2.0")
        self.assertEqual((c["type"], c["license"]), ("software", "MIT"))
        self.assertTrue(c["message"] and c["title"] and c["abstract"])
        self.check_people(c["authors"])
        allowed = {"cff-version", "message", "title", "abstract", "type", "version", "license", "authors", "keywords",
                   "references", "date-released", "repository-code", "url", "doi", "preferred-citation"}
        self.assertLessEqual(set(c), allowed)

    def test_references_are_those_of_the_bibliography(self):
        plain = lambda s: re.sub(r"[^a-z0-9]", "", re.sub(r"[{}`'\\]", "", s).lower())
        titles = [plain(t) for t in re.findall(r"title\s*=\s*\{(.*?)\}[,\n]", text("docs/references.bib"))]
        self.assertIn("thesis", [r["type"] for r in self.citation["references"]])
        for reference in self.citation["references"]:
            self.check_people(reference["authors"])
            self.assertIsInstance(reference["year"], int)
            self.assertIn(plain(reference["title"]), titles)


class BillOfMaterials(unittest.TestCase):
    def setUp(self):
        self.sbom = json.loads((BUILD / "csrbf.spdx.json").read_text(encoding="utf-8"))
        self.packages = {p["name"]: p for p in self.sbom["packages"]}

    def test_has_what_the_format_requires(self):
        self.assertEqual(self.sbom["spdxVersion"], "SPDX-2.3")
        self.assertEqual(self.packages["csrbf"]["versionInfo"], project_version())
        ids = {p["SPDXID"] for p in self.packages.values()}
        self.assertEqual(len(ids), len(self.sbom["packages"]))
        for identifier in ids:
            self.assertRegex(identifier, "^SPDXRef-[A-Za-z0-9.-]+$")
        for relationship in self.sbom["relationships"]:
            self.assertIn(relationship["spdxElementId"], ids | {"SPDXRef-DOCUMENT"})
            self.assertIn(relationship["relatedSpdxElement"], ids)
        self.assertRegex(self.sbom["creationInfo"]["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")

    def test_lists_every_package_that_the_build_looks_for(self):
        listed = set(re.findall(r"sbom_dependency\((\w+)", text("cmake/sbom.cmake")))
        files = [*SOURCES.glob("*/CMakeLists.txt"), *SOURCES.glob("examples/*/CMakeLists.txt"), *SOURCES.glob("cmake/*.cmake")]
        sought = set()
        for file in files:
            code = re.sub("#.*", "", file.read_text(encoding="utf-8"))
            sought |= set(re.findall(r"find_package\((\w+)", code))
        self.assertGreater(len(sought), 10)
        self.assertLessEqual(sought, listed)

    def test_names_what_this_build_uses_with_its_version(self):
        for name in ("Eigen3", "nanoflann", "PNG", "TIFF", "ZLIB", "Qhull"):
            self.assertRegex(self.packages[name]["versionInfo"], r"^\d+(\.\d+)+", name)

    def test_licences_are_compatible(self):
        for name, package in self.packages.items():
            if name != "Threads":  # of the system's C library
                self.assertIn(package["licenseConcluded"], COMPATIBLE, name)

    def test_optional_packages_are_flagged(self):
        kinds = {r["spdxElementId"]: r["relationshipType"] for r in self.sbom["relationships"]}
        for name in ("GDCM", "pybind11", "Python3"):
            if name in self.packages:
                self.assertEqual(kinds[self.packages[name]["SPDXID"]], "OPTIONAL_DEPENDENCY_OF")


if __name__ == "__main__":
    unittest.main()
