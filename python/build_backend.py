"""Builds the wheel of csrbf with CMake, for pip (PEP 517). Needs CMake, a compiler and the requirements in README.md,
but no other Python package, so `pip install .` works without a network.

Option of pip: `--config-settings build-dir=DIR` takes the module from an existing CMake build, whose option
CSRBF_BUNDLE_LIBRARIES is ON. The environment variable CMAKE_ARGS adds arguments for CMake.
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import time
import tomllib
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent
EARLIEST = 315532800  # 1980, the earliest time that zip files can store


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds the module and packs it; returns the name of the wheel."""
    given = (config_settings or {}).get("build-dir")
    build = pathlib.Path(given) if given else SOURCE / "build" / f"wheel-{_tag()}"
    if not (given and (build / "CMakeCache.txt").exists()):
        _configure(build)
    elif not re.search(r"^CSRBF_BUNDLE_LIBRARIES:BOOL=(ON|1|TRUE)$", (build / "CMakeCache.txt").read_text(), re.M):
        raise SystemExit(f"csrbf: build-dir={given} lacks the libraries that the module needs elsewhere; "
                         f"run cmake -DCSRBF_BUNDLE_LIBRARIES=ON {given} first")
    _run("--build", str(build), "--config", "Release", "--target", "python-package", "--parallel", str(os.cpu_count()))
    with tempfile.TemporaryDirectory() as staging:
        _run("--install", str(build), "--config", "Release", "--component", "python", "--strip", "--prefix", staging)
        package = next(pathlib.Path(staging).rglob("csrbf/__init__.py")).parent
        # A library is found by the name of a symbolic link to it, and a wheel has no links.
        linked = {path.resolve() for path in package.rglob("*") if path.is_symlink()}
        paths = sorted(path for path in package.rglob("*") if path.is_file() and path not in linked)
        files = {f"csrbf/{path.relative_to(package)}": path for path in paths}
        return _pack(pathlib.Path(wheel_directory), files, _metadata(build))


def build_sdist(sdist_directory, config_settings=None):
    """Packs the source files tracked by git; returns the name of the archive."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=SOURCE, check=True, capture_output=True, text=True)
    top = f"csrbf-{_version()}"
    with tarfile.open(pathlib.Path(sdist_directory, f"{top}.tar.gz"), "w:gz") as archive:
        for name in filter(None, listed.stdout.split("\0")):
            archive.add(SOURCE / name, f"{top}/{name}")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "PKG-INFO")
            path.write_text(_metadata()["METADATA"])
            archive.add(path, f"{top}/PKG-INFO")
    return f"{top}.tar.gz"


def _configure(build):
    options = {
        "CMAKE_BUILD_TYPE": "Release",
        "BUILD_SHARED_LIBS": "OFF",
        "CSRBF_BUILD_APP": "OFF",
        "CSRBF_BUILD_EXAMPLES": "ON",  # the figures of csrbf.thesis
        "CSRBF_BUILD_TESTS": "OFF",
        "CSRBF_BUILD_PYTHON": "ON",
        "CSRBF_BUNDLE_LIBRARIES": "ON",
        "Python3_EXECUTABLE": sys.executable,
    }
    generator = ["-G", "Ninja"] if shutil.which("ninja") and not (build / "CMakeCache.txt").exists() else []
    defined = [f"-D{name}={value}" for name, value in options.items()]
    _run("-S", str(SOURCE), "-B", str(build), *generator, *defined, *shlex.split(os.environ.get("CMAKE_ARGS", "")))


def _run(*arguments):
    if shutil.which("cmake") is None:
        raise SystemExit("csrbf: cmake is not installed; README.md lists the requirements")
    subprocess.run(["cmake", *arguments], check=True, stdout=sys.stderr)


def _pack(folder, files, metadata):
    """A wheel of the files, the metadata and their checksums."""
    contents = {name: path.read_bytes() for name, path in files.items()}
    contents |= {f"{_info()}/{name}": text.encode() for name, text in metadata.items()}
    record = "".join(f"{name},{_checksum(data)},{len(data)}\n" for name, data in contents.items())
    contents[f"{_info()}/RECORD"] = f"{record}{_info()}/RECORD,,\n".encode()
    wheel = folder / f"csrbf-{_version()}-{_tag()}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in contents.items():
            entry = zipfile.ZipInfo(name, _time())
            entry.external_attr = (0o755 if ".so" in name else 0o644) << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return wheel.name


def _metadata(build=None):
    """The files of the dist-info folder, except the list of all files, for what a CMake build has made."""
    project = tomllib.loads((SOURCE / "pyproject.toml").read_text())["project"]
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {_version()}",
        f"Summary: {project['description']}",
        f"License: {project['license']['text']}",
        "License-File: LICENSE",
        f"Keywords: {','.join(project['keywords'])}",
        f"Requires-Python: {project['requires-python']}",
        *(f"Classifier: {name}" for name in project["classifiers"]),
        *(f"Requires-Dist: {name}{_limit(name, build)}" for name in project["dependencies"]),
    ]
    for extra, packages in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f'Requires-Dist: {name}; extra == "{extra}"' for name in packages)]
    lines += ["Description-Content-Type: text/markdown", "", (SOURCE / project["readme"]).read_text()]
    wheel = ["Wheel-Version: 1.0", "Generator: csrbf", "Root-Is-Purelib: false", f"Tag: {_tag()}", ""]
    return {"METADATA": "\n".join(lines), "WHEEL": "\n".join(wheel), "LICENSE": (SOURCE / "LICENSE").read_text()}


def _limit(dependency, build):
    """",<2" for NumPy when pybind11 is older than 2.12, which knows version 1 only."""
    if build is None or not dependency.startswith("numpy"):
        return ""
    cache = (build / "CMakeCache.txt").read_text()
    major, minor = re.search(r"^CSRBF_PYBIND11_VERSION:INTERNAL=(\d+)\.(\d+)", cache, re.M).groups()
    return ",<2" if (int(major), int(minor)) < (2, 12) else ""


def _version():
    return re.search(r"VERSION (\d+\.\d+\.\d+)", (SOURCE / "CMakeLists.txt").read_text())[1]


def _info():
    return f"csrbf-{_version()}.dist-info"


def _tag():
    """Interpreter, its binary interface and the platform."""
    interpreter = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{interpreter}-{interpreter}{sys.abiflags}-{platform}"


def _checksum(data):
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def _time():
    return time.gmtime(max(EARLIEST, int(os.environ.get("SOURCE_DATE_EPOCH", EARLIEST))))[:6]
