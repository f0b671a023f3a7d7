"""pip makes a wheel of a checkout and installs it, without a network: with the module of this build."""

import base64
import email
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import unittest
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = os.environ.get("CSRBF_BUILD_DIR", "")


def has(*module):
    command = [sys.executable, "-m", *module, "--help"]
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0


if not BUILD or not has("pip") or not has("venv"):
    print("skipped: needs CSRBF_BUILD_DIR, pip and venv (Debian: python3-pip python3-venv)")
    sys.exit(77)


def run(*command, **keywords):
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PIP_"))}
    # Nothing that a package could come from.
    environment |= {"PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_CONFIG_FILE": os.devnull}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment, **keywords)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        options = ["--no-deps", "--config-settings", f"build-dir={BUILD}", "--wheel-dir", cls.folder.name]
        run(sys.executable, "-m", "pip", "wheel", *options, SOURCE)
        (cls.wheel,) = pathlib.Path(cls.folder.name).glob("*.whl")
        cls.version = re.search(r"VERSION (\d+\.\d+\.\d+)", (SOURCE / "CMakeLists.txt").read_text())[1]

    def test_a_build_without_the_libraries_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "CMakeCache.txt").write_text("CSRBF_BUNDLE_LIBRARIES:BOOL=OFF\n")
            command = f"import build_backend; build_backend.build_wheel({folder!r}, {{'build-dir': {folder!r}}})"
            with self.assertRaisesRegex(AssertionError, "cmake -DCSRBF_BUNDLE_LIBRARIES=ON"):
                run(sys.executable, "-c", command, cwd=SOURCE / "python")
            self.assertEqual(os.listdir(folder), ["CMakeCache.txt"])

    def test_the_name_says_version_interpreter_and_platform(self):
        python = f"cp{sys.version_info.major}{sys.version_info.minor}"
        platform = re.sub("[-.]", "_", sysconfig.get_platform())
        self.assertEqual(self.wheel.name, f"csrbf-{self.version}-{python}-{python}-{platform}.whl")

    def test_it_holds_module_types_licence_and_right_checksums(self):
        info = f"csrbf-{self.version}.dist-info"
        with zipfile.ZipFile(self.wheel) as archive:
            names = archive.namelist()
            listed = [line.rsplit(",", 2) for line in archive.read(f"{info}/RECORD").decode().splitlines()]
            metadata = email.message_from_bytes(archive.read(f"{info}/METADATA"))
            for name, checksum, size in listed[:-1]:
                data = archive.read(name)
                digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
                self.assertEqual((checksum, int(size)), (f"sha256={digest}", len(data)), name)
        self.assertEqual(sorted(names), sorted(name for name, _, _ in listed))
        self.assertEqual(len(set(names)), len(names))
        extension = sysconfig.get_config_var("EXT_SUFFIX")
        for name in ("__init__.py", "py.typed", "_csrbf.pyi", "sklearn.py", "thesis/__main__.py", f"_csrbf{extension}"):
            self.assertIn(f"csrbf/{name}", names)
        self.assertFalse([name for name in names if "__pycache__" in name or "libcsrbf" in name])
        self.assertIn(f"{info}/LICENSE", names)
        self.assertEqual((metadata["Name"], metadata["Version"]), ("csrbf", self.version))
        self.assertEqual(metadata["License"], "MIT")
        (numpy,) = [name for name in metadata.get_all("Requires-Dist") if name.startswith("numpy")]
        pybind11 = re.search(r"pybind11_DIR:PATH=(.*)", pathlib.Path(BUILD, "CMakeCache.txt").read_text())[1]
        made_by = pathlib.Path(pybind11, "pybind11ConfigVersion.cmake").read_text()
        major, minor = re.search(r'PACKAGE_VERSION "(\d+)\.(\d+)', made_by).groups()
        self.assertEqual(numpy.endswith("<2"), (int(major), int(minor)) < (2, 12), numpy)
        self.assertIn("csrbf turns scattered data", metadata.get_payload())

    def test_it_works_where_pip_installs_it(self):
        environment = pathlib.Path(self.folder.name, "venv")
        run(sys.executable, "-m", "venv", "--system-site-packages", environment)
        python = environment / "bin" / "python"
        run(python, "-m", "pip", "install", self.wheel)
        script = "import csrbf as c; print(c.__version__, c.__file__, c.fit([[0], [1], [2]], [0, 1, 2])([[1]]).shape)"
        version, path, shape = run(python, "-c", script, cwd=self.folder.name).split(maxsplit=2)
        self.assertEqual((version, shape.strip()), (self.version, "(1,)"))
        self.assertTrue(path.startswith(str(environment)), path)
        self.assertIn(self.version, run(python, "-m", "pip", "show", "csrbf"))
        run(python, "-m", "pip", "uninstall", "-y", "csrbf")
        self.assertEqual(list(environment.rglob("csrbf")), [])

    def test_it_brings_all_libraries_but_those_of_c_and_cpp(self):
        cache = pathlib.Path(BUILD, "CMakeCache.txt").read_text()
        if "CSRBF_BUNDLE_LIBRARIES:BOOL=ON" not in cache or not shutil.which("ldd"):
            self.skipTest("needs a build with CSRBF_BUNDLE_LIBRARIES, and ldd")
        folder = pathlib.Path(self.folder.name, "unpacked")
        with zipfile.ZipFile(self.wheel) as archive:
            archive.extractall(folder)
        runtime = re.compile(r"(linux-vdso|ld-linux.*|libc|libm|libgcc_s|libstdc\+\+|lib[aut]san|libdl|libpthread)\.so")
        for module in folder.rglob("_*.so"):
            for line in run("ldd", module).splitlines():
                name = line.strip().removeprefix("/lib64/")
                if not runtime.match(name):
                    self.assertIn(str(folder), line, module.name)

    def test_sources_are_packed_when_git_knows_them(self):
        if not (SOURCE / ".git").exists():
            self.skipTest("not a checkout")
        script = f"import build_backend; print(build_backend.build_sdist({self.folder.name!r}))"
        name = run(sys.executable, "-c", script, cwd=SOURCE / "python").strip()
        self.assertEqual(name, f"csrbf-{self.version}.tar.gz")
        self.assertGreater(pathlib.Path(self.folder.name, name).stat().st_size, 100_000)


if __name__ == "__main__":
    unittest.main()
