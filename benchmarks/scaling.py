#!/usr/bin/python3
"""Measures work in tiles: CPU time and memory against all at once, shared by processes, whether meshes are the same and
functions as accurate; large images slice by slice; and plans a billion points from what was measured. Writes a page.

usage: scaling.py [--program CSRBF] [--points N,...] [--tile-points N] [--processes P[xTHREADS],...] [--weak N]
                  [--samples N,...] [--image EDGE,...] [--large POINTS,SAMPLES] [--large-memory SIZE] [--mpirun] [--python COMMAND] [--folder DIR]
                  [--page FILE]
       scaling.py --merge NEWER [--only WORDS] --page FILE

Runs with one thread per process, but for the large ones. Processes share the cores of this machine, so judge CPU seconds:
those of the busiest process stand for the time on as many cores as processes. They are started here, or by mpirun. Strong
runs use the last number of --points, weak runs N points for each process. Points are made by make_cloud.py, samples are
of a smooth function in space, images are gyroids with noise. --large: so many points and samples once, with --memory;
files and folders of 0.3 kB per point. --merge: no runs, but sections of a newer page instead of those of the same name.
"""

import argparse
import datetime
import filecmp
import gzip
import hashlib
import json
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import time

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))


def timed(name):
    """What writes to a file what a program took."""
    return ["/usr/bin/time", "-o", name, "-f", "%U %S %M %O"]


class Run:
    """Some processes that do one command together."""

    def __init__(self, commands):
        begin = time.monotonic()
        self.cpu, self.memory, self.written = [], [], 0
        # By way of a small process, for the memory of the one that starts another counts as that of the other.
        with tempfile.TemporaryDirectory() as folder:
            names = [os.path.join(folder, str(k)) for k in range(len(commands))]
            processes = [subprocess.Popen([*timed(name), *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                         for name, command in zip(names, commands)]
            for process, name in zip(processes, names):
                message = process.communicate()[1]
                if process.returncode != 0:
                    sys.exit(message.decode())
                self.add(name)
        self.wall = time.monotonic() - begin

    def add(self, name):
        with open(name) as file:
            user, system, memory, blocks = (float(word) for word in file.read().split()[-4:])
        self.cpu.append(user + system)
        self.memory.append(memory / 1024)
        self.written += 512 * blocks


class MpiRun(Run):
    """The same by mpirun."""

    def __init__(self, command, processes, folder):
        name = os.path.join(folder, "rank")
        script = 'exec /usr/bin/time -o "$0.$OMPI_COMM_WORLD_RANK" -f "%U %S %M %O" "$@"'
        mpirun = ["mpirun", "-n", str(processes), "--oversubscribe", "--quiet", "--bind-to", "none"]
        if os.geteuid() == 0:
            mpirun.append("--allow-run-as-root")
        begin = time.monotonic()
        done = subprocess.run([*mpirun, "sh", "-c", script, name, *command, "--tile-share", "auto"],
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.wall = time.monotonic() - begin
        if done.returncode != 0:
            sys.exit(done.stderr)
        self.cpu, self.memory, self.written = [], [], 0
        for rank in range(processes):
            self.add(f"{name}.{rank}")


class Bench:
    def __init__(self, arguments):
        self.program, self.folder = arguments.program, arguments.folder
        self.tile, self.mpirun = arguments.tile_points, arguments.mpirun
        os.makedirs(self.folder, exist_ok=True)

    def cloud(self, n):
        path = os.path.join(self.folder, f"cloud{n}.ply")
        if not os.path.exists(path):
            subprocess.run([sys.executable, os.path.join(HERE, "make_cloud.py"), str(n), path], check=True)
        return path

    def command(self, n, mesh, *flags, threads=1):
        return [self.program, "reconstruct", self.cloud(n), "-o", mesh, "--threads", str(threads), *flags]

    def whole(self, n):
        mesh = os.path.join(self.folder, "whole.ply")
        return Run([self.command(n, mesh)])

    def tiled(self, n, processes, name, threads=1):
        mesh = os.path.join(self.folder, name)
        flags = ["--tile-points", str(self.tile)]
        report = os.path.join(self.folder, "report.json")
        if self.mpirun and processes > 1:
            run = MpiRun(self.command(n, mesh, *flags, "--report", report), processes, self.folder)
        else:
            commands = [self.command(n, mesh, *flags, "--tile-share", f"{k}/{processes}", threads=threads)
                        for k in range(1, processes + 1)]
            commands[0] += ["--report", report]
            run = Run(commands)
        with open(report) as file:
            run.result = json.load(file)["result"]
        run.mesh = mesh
        return run


class FunctionBench:
    """Fits of samples in space, and their errors at other places."""

    def __init__(self, arguments):
        self.program, self.folder, self.tile = arguments.program, arguments.folder, arguments.tile_points
        os.makedirs(self.folder, exist_ok=True)
        self.places = np.random.default_rng(7).random((200000, 3))
        np.save(os.path.join(self.folder, "places.npy"), self.places)

    @staticmethod
    def truth(x):
        return np.sin(5 * x[:, 0]) * np.cos(4 * x[:, 1]) + np.exp(-10 * ((x - 0.5) ** 2).sum(axis=1))

    def samples(self, n, noise):
        path = os.path.join(self.folder, f"samples{n}_{noise}.npy")
        if os.path.exists(path):
            return path
        random = np.random.default_rng(1)
        rows = np.lib.format.open_memmap(path, "w+", "f8", (n, 4))
        for begin in range(0, n, 1_000_000):
            x = random.random((min(1_000_000, n - begin), 3))
            rows[begin:begin + len(x)] = np.column_stack([x, self.truth(x) + noise * random.normal(size=len(x))])
        return path

    def fit(self, n, noise, *flags):
        model = os.path.join(self.folder, "model.csrbf")
        run = Run([[self.program, "fit", self.samples(n, noise), "-o", model, "--threads", "1", *flags]])
        values = os.path.join(self.folder, "values.npy")
        places = os.path.join(self.folder, "places.npy")
        run.evaluation = Run([[self.program, "evaluate", model, "--points", places, "-o", values, "--threads", "1"]])
        run.error = np.sqrt(np.mean((np.load(values).ravel() - self.truth(self.places)) ** 2))
        return run


class ImageBench:
    """Gyroids of 8-bit voxels with noise, slice by slice and, where they are small enough, whole."""

    def __init__(self, arguments):
        self.program, self.folder = arguments.program, arguments.folder
        os.makedirs(self.folder, exist_ok=True)

    def image(self, edge):
        """A .nii file and the labels that were drawn, packed in bits."""
        path = os.path.join(self.folder, f"gyroid{edge}.nii")
        if os.path.exists(path):
            return path
        header = bytearray(352)
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, 3, edge, edge, edge, 1, 1, 1, 1)
        struct.pack_into("<hh", header, 70, 2, 8)
        struct.pack_into("<8f", header, 76, *[1] * 8)
        struct.pack_into("<f", header, 108, 352)
        header[344:348] = b"n+1\0"
        random = np.random.default_rng(1)
        angle = np.arange(edge, dtype=np.float32) * (16 * np.pi / edge)
        s, c = np.sin(angle), np.cos(angle)
        with open(path, "wb") as file, open(path + ".truth", "wb") as truth:
            file.write(header)
            for z in range(edge):
                inside = s[None, :] * c[:, None] + s[:, None] * c[z] + s[z] * c[None, :] > 0
                truth.write(np.packbits(inside).tobytes())
                noise = 7 * random.standard_normal((edge, edge), dtype=np.float32)
                file.write(np.clip(np.rint(np.where(inside, 160, 90) + noise), 0, 255).astype(np.uint8).tobytes())
        return path

    def compressed(self, edge):
        image = self.image(edge)
        if not os.path.exists(image + ".gz"):
            with open(image, "rb") as file, gzip.open(image + ".gz", "wb", compresslevel=3) as packed:
                shutil.copyfileobj(file, packed, 1 << 22)
        return image + ".gz"

    def labels(self, edge, name):
        packed = name.endswith(".gz")
        image, labels = self.compressed(edge) if packed else self.image(edge), os.path.join(self.folder, name)
        run = Run([[self.program, "segment", image, "-o", labels, "--threads", "1"]])
        content = gzip.open(labels) if packed else open(labels, "rb")
        both = total = inside = 0
        run.hash = hashlib.sha256()
        with content as file, open(self.image(edge) + ".truth", "rb") as truth:
            # The samples of a .mha are the last bytes; a .nii has 352 before them.
            file.seek(352 if ".nii" in name else os.path.getsize(labels) - edge**3)
            for _ in range(edge):
                found = np.frombuffer(file.read(edge * edge), np.uint8) == 1
                true = np.unpackbits(np.frombuffer(truth.read(edge * edge // 8), np.uint8)).astype(bool)
                both += 2 * np.count_nonzero(found & true)
                total += np.count_nonzero(found) + np.count_nonzero(true)
                inside += np.count_nonzero(found)
                run.hash.update(found.tobytes())
        # Either side of a gyroid may be label 1.
        run.dice = max(both / total, (2 * inside - both) / (inside + edge**3 - (total - inside)))
        os.remove(labels)
        return run


def row(*cells):
    return "| " + " | ".join(str(c) for c in cells) + " |\n"


def image_table(arguments):
    """Images slice by slice and whole."""
    edges = [int(e) for e in arguments.image.split(",") if e]
    if not edges:
        return ""
    bench = ImageBench(arguments)
    page = "\n## Images slice by slice\n\n"
    page += ("Gyroids of 8-bit voxels whose noise is a tenth of the contrast. Written as .mha, labels are made from the "
             "whole image. Compressed: image and labels are .nii.gz.\n\n")
    page += row("edge", "CPU s by slices", "compressed", "whole", "MB by slices", "compressed", "whole", "Dice by slices", "whole",
                "same labels")
    page += row(*["---:"] * 10)
    for edge in edges:
        slices, packed = bench.labels(edge, "labels.nii"), bench.labels(edge, "labels.nii.gz")
        cells = [f"{edge:,}", f"{slices.cpu[0]:.1f}", f"{packed.cpu[0]:.1f}", "", f"{slices.memory[0]:.0f}",
                 f"{packed.memory[0]:.0f}", "", f"{slices.dice:.4f}", "", ""]
        runs = [packed]
        if edge <= 512:
            whole = bench.labels(edge, "labels.mha")
            cells[3:9:3] = [f"{whole.cpu[0]:.1f}", f"{whole.memory[0]:.0f}"]
            cells[8] = f"{whole.dice:.4f}"
            runs.append(whole)
        cells[9] = "yes" if all(slices.hash.digest() == run.hash.digest() for run in runs) else "NO"
        page += row(*cells)
        print(page.splitlines()[-1], flush=True)
    return page


def large_table(arguments):
    """One run each with many points and samples."""
    if not arguments.large:
        return ""
    points, samples = (int(n) for n in arguments.large.split(","))
    page = ""
    head = row("work", "CPU min", "wall min", "peak MB", "result") + row("---", *["---:"] * 3, "---")
    folder, program = arguments.folder, arguments.program
    bench, functions = Bench(arguments), FunctionBench(arguments)

    def measure(name, command):
        report = os.path.join(folder, "report.json")
        run = Run([[program, *command, "--report", report]])
        with open(report) as file:
            content = json.load(file)
        result = content["result"]
        keys = ("tiles", "vertices", "components") if "vertices" in result else ("tiles",)
        text = [f"{result[key]:,} {key}" for key in keys if isinstance(result.get(key), int)]
        text += ["watertight"] if result.get("watertight") else []
        line = row(name, f"{run.cpu[0] / 60:.1f}", f"{run.wall / 60:.1f}", f"{run.memory[0]:.0f}", ", ".join(text))
        print(line, flush=True)
        return line

    memory = ["--memory", arguments.large_memory]
    if samples > 0:
        page += f"\n## Samples beyond memory, with `--memory {arguments.large_memory}`\n\n" + head
        table, model = functions.samples(samples, 0.01), os.path.join(folder, "large.csrbf")
        page += measure(f"fit {samples:,} samples", ["fit", table, "-o", model, *memory])
        os.remove(table)
        places = os.path.join(folder, "many.npy")
        np.save(places, np.random.default_rng(8).random((10_000_000, 3)))
        page += measure("evaluate 10,000,000 of its values",
                        ["evaluate", model, "--points", places, "-o", os.path.join(folder, "values.npy")])
        os.remove(model)
    if points > 0:
        page += f"\n## Points beyond memory, with `--memory {arguments.large_memory}`\n\n" + head
        cloud, mesh = bench.cloud(points), os.path.join(folder, "large.ply")
        page += measure(f"reconstruct {points:,} points", ["reconstruct", cloud, "-o", mesh, *memory])
        os.remove(cloud)
        os.remove(mesh)
    return page


CORES, NETWORK, DISKS = 16, 1e9, 10e9  # of a node: cores, bytes/s; bytes/s of the shared folder
RATIO = 4  # threads of one process on a tile against one thread: measured gains are near the number of threads up to here


def plan(weak):
    """What a billion points need, by the costs of a tile."""
    largest = weak[-1]
    points = np.array([WEAK_POINTS[0] * len(run.cpu) for run in weak], float)
    others = [(sum(run.cpu) - run.cpu[0]) / (len(run.cpu) - 1) if len(run.cpu) > 1 else run.cpu[0] for run in weak]
    per_point = others[-1] * len(largest.cpu) / points[-1]
    # What the first process does alone grows with the points, but not from 0.
    extra = np.array([run.cpu[0] - other for run, other in zip(weak, others)])
    several = [k for k, run in enumerate(weak) if len(run.cpu) > 1]
    serial, constant = np.polyfit(points[several], extra[several], 1) if len(several) > 1 else (extra[-1] / points[-1], 0)
    serial, constant = max(serial, 0.0), max(constant, 0.0)
    traffic = largest.written / points[-1]
    page = "\n## A plan for 1,000,000,000 points\n\n"
    page += (f"From the weak run with {len(largest.cpu)} processes, to a mesh of {largest.vertices / points[-1]:.2f} "
             f"vertices per point: {per_point * 1e6:.1f} us of CPU time per point in any process, {constant:.1f} s and "
             f"{serial * 1e6:.2f} us per point in the first one alone, which plans the tiles and numbers the vertices, and "
             f"{traffic:.0f} bytes per point to the folder and as many from it. A node has {CORES} cores and "
             f"{NETWORK / 1e9:.0f} GB/s of network, the shared folder {DISKS / 1e9:.0f} GB/s; processes of {RATIO} threads "
             f"each hold a tile of 1,000,000 points (1.6 GB).\n\n")
    page += row("nodes", "GB per node", "CPU minutes of a core", "first process, minutes", "folder, minutes", "minutes in all")
    page += row(*["---:"] * 6)
    for nodes in (16, 64, 256):
        work = per_point * 1e9 / (nodes * CORES) / 60
        first = (constant + serial * 1e9) / 60
        folder = 2 * traffic * 1e9 / min(nodes * NETWORK, DISKS) / 60
        page += row(nodes, f"{1.6 * CORES / RATIO:.1f}", f"{work:.1f}", f"{first:.1f}", f"{folder:.1f}",
                    f"{work + first + folder:.1f}")
    page += ("\nDistributed screened Poisson reconstruction (Kazhdan and Hoppe 2023) takes under 20 minutes for such a cloud on "
             "65 nodes of at most 45 GB.\n")
    return page


WEAK_POINTS = [0]
POINT_REACH, SAMPLE_REACH = 14, 9  # spacings that tiles see of others: of a surface, of samples in space


def copied_per_second():
    """Bytes that one core writes to files in the page cache, or reads from there."""
    piece = bytes(64 << 20)
    with tempfile.NamedTemporaryFile() as file:
        begin = time.process_time()
        for _ in range(4):
            file.write(piece)
        file.flush()
        return 4 * len(piece) / (time.process_time() - begin)


def floors(what, dimension, reach, count, tiles, written, whole, tiled):
    """What tiles cost at least: points around them are worked on again, and all steps go through files."""
    side = (count / tiles) ** (1 / dimension)
    faces = min(2 * dimension, int(np.ceil(np.log2(tiles))))
    again = (1 + reach / side) ** faces
    speed = copied_per_second()
    files = 2 * written * count / speed
    return (f"\nFloor of tiles for {what}: tiles of {side:.0f}{'²' if dimension == 2 else '³'} points see {reach} spacings "
            f"beyond up to {faces} faces, {again:.2f} times their points, so arithmetic takes {again:.2f} times as long; "
            f"{written:.0f} bytes per point are written and read again, at {speed / 1e9:.1f} GB/s of one core in "
            f"{files:.1f} s. Together {again + files / whole:.2f} times at once; {tiled / whole:.2f} were measured.\n")


def point_tables(arguments, sizes, counts):
    """Meshes at once, in tiles, and by several processes."""
    bench = Bench(arguments)
    page = "## All at once and in tiles\n\n"
    page += row("points", "CPU s at once", "in tiles", "ratio", "MB at once", "in tiles", "tiles", "watertight")
    page += row(*["---:"] * 8)
    for n in sizes:
        whole, tiled = bench.whole(n), bench.tiled(n, 1, "mesh1.ply")
        page += row(f"{n:,}", f"{whole.cpu[0]:.1f}", f"{tiled.cpu[0]:.1f}", f"{tiled.cpu[0] / whole.cpu[0]:.2f}",
                    f"{whole.memory[0]:.0f}", f"{tiled.memory[0]:.0f}", tiled.result["tiles"],
                    "yes" if tiled.result["watertight"] else "NO")
        print(page.splitlines()[-1], flush=True)

    page += floors(f"{sizes[-1]:,} points", 2, POINT_REACH, sizes[-1], tiled.result["tiles"], tiled.written / sizes[-1],
                   whole.cpu[0], tiled.cpu[0])
    if counts == [(1, 1)]:
        return page
    page += f"\n## {sizes[-1]:,} points by several processes\n\n"
    page += ("**at once** is the time of one process without tiles, **share** the time of the busiest process against an equal "
             "part of the time of one process in the same tiles.\n\n")
    page += row("processes", "threads", "busiest s", "share", "sum s", "sum / alone", "sum / at once", "peak MB", "same bytes")
    page += row(*["---:"] * 9)
    alone = tiled
    for count, threads in counts:
        run = alone if (count, threads) == (1, 1) else bench.tiled(sizes[-1], count, "mesh2.ply", threads)
        same = filecmp.cmp(alone.mesh, run.mesh, shallow=False)
        busiest, total, one = max(run.cpu), sum(run.cpu), sum(alone.cpu)
        page += row(count, threads, f"{busiest:.1f}", f"{busiest * count / one:.2f}", f"{total:.1f}", f"{total / one:.2f}",
                    f"{total / whole.cpu[0]:.2f}", f"{max(run.memory):.0f}", "yes" if same else "NO")
        print(page.splitlines()[-1], flush=True)

    return page + dask_line(arguments, bench, sizes[-1], alone)


def dask_line(arguments, bench, n, alone):
    """The same by two workers of Dask, in a process with the Python module and Dask."""
    if not arguments.python:
        return ""
    mesh, folder = os.path.join(bench.folder, "dask.ply"), os.path.join(bench.folder, "dask.tiles")
    done = subprocess.run([*shlex.split(arguments.python), os.path.join(HERE, "scaling_dask.py"), bench.cloud(n), mesh, folder,
                           str(arguments.tile_points)], stdout=subprocess.PIPE, text=True, check=True)
    used = float(done.stdout)
    same = "the same bytes" if filecmp.cmp(alone.mesh, mesh, shallow=False) else "OTHER BYTES"
    line = (f"\nTwo workers of a Dask LocalCluster take {used:.1f} s of CPU time, {used / sum(alone.cpu):.2f} times that of one "
            f"process in the same tiles, to {same}.\n")
    print(line, flush=True)
    return line


def weak_table(arguments, counts):
    """The same number of points for each process; and the runs."""
    bench, weak = Bench(arguments), []
    page = f"\n## {arguments.weak:,} points for each process\n\n"
    page += row("processes", "points", "busiest s", "against one", "peak MB")
    page += row(*["---:"] * 5)
    first = None
    for count, threads in counts:
        run = bench.tiled(arguments.weak * count, count, "weak.ply", threads)
        with open(run.mesh, "rb") as file:
            run.vertices = int(file.read(300).split(b"element vertex ")[1].split()[0])
        weak.append(run)
        first = first or max(run.cpu)
        page += row(count, f"{arguments.weak * count:,}", f"{max(run.cpu):.1f}", f"{max(run.cpu) / first:.2f}",
                    f"{max(run.memory):.0f}")
        print(page.splitlines()[-1], flush=True)
    return page, weak


def function_table(arguments):
    """Functions at once and in tiles."""
    samples = [int(n) for n in arguments.samples.split(",") if n]
    if not samples:
        return ""
    page = "\n## Functions, at once and in tiles\n\n"
    page += "Errors and times of evaluation are those at 200,000 other places in the cube of the samples.\n\n"
    page += row("samples", "noise", "CPU s at once", "in tiles", "ratio", "MB at once", "in tiles", "rms error at once",
                "in tiles", "evaluation s at once", "in tiles")
    page += row(*["---:"] * 11)
    functions = FunctionBench(arguments)
    for n in samples:
        for noise in (0, 0.01):
            whole = functions.fit(n, noise)
            tiled = functions.fit(n, noise, "--tile-points", str(arguments.tile_points))
            page += row(f"{n:,}", noise, f"{whole.cpu[0]:.1f}", f"{tiled.cpu[0]:.1f}",
                        f"{tiled.cpu[0] / whole.cpu[0]:.2f}", f"{whole.memory[0]:.0f}", f"{tiled.memory[0]:.0f}",
                        f"{whole.error:.2e}", f"{tiled.error:.2e}", f"{whole.evaluation.cpu[0]:.1f}",
                        f"{tiled.evaluation.cpu[0]:.1f}")
            print(page.splitlines()[-1], flush=True)
    return page + floors(f"{n:,} samples", 3, SAMPLE_REACH, n, -(-n // arguments.tile_points), tiled.written / n,
                         whole.cpu[0], tiled.cpu[0])


def merged(page, newer, only):
    """The page with the sections of a newer one, each of which says when and how it was measured."""
    head, *sections = newer.split("\n## ")
    told = "\n".join([line for line in head.splitlines() if line.startswith("* ")][:1] + ["", head[head.index("```"):].strip()])
    parts = page.split("\n## ")
    for section in sections:
        title, rest = section.split("\n", 1)
        if only not in title:
            continue
        part = f"{title}\n\n{told}\n{rest.rstrip()}\n"
        same = [k for k, old in enumerate(parts) if k > 0 and old.split("\n", 1)[0] == title]
        parts[same[0] if same else len(parts):(same[0] + 1) if same else len(parts)] = [part]
    return "\n## ".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="csrbf")
    parser.add_argument("--points", default="1000000,4000000")
    parser.add_argument("--tile-points", type=int, default=250000)
    parser.add_argument("--processes", default="1,2,3,8")
    parser.add_argument("--weak", type=int, default=500000)
    parser.add_argument("--samples", default="1000000,4000000")
    parser.add_argument("--image", default="256,512,1024")
    parser.add_argument("--large", default="")
    parser.add_argument("--large-memory", default="4GB")
    parser.add_argument("--mpirun", action="store_true")
    parser.add_argument("--python", default="", help="Python with the module and Dask, for instance env PYTHONPATH=... python3")
    parser.add_argument("--folder", default="tiles-benchmark")
    parser.add_argument("--page")
    parser.add_argument("--merge")
    parser.add_argument("--only", default="", help="words in the titles of the sections that are merged")
    arguments = parser.parse_args()
    if arguments.merge:
        with open(arguments.page) as file, open(arguments.merge) as newer:
            page = merged(file.read(), newer.read(), arguments.only)
        with open(arguments.page, "w") as file:
            file.write(page)
        return
    WEAK_POINTS[0] = arguments.weak
    sizes = [int(n) for n in arguments.points.split(",") if n]
    counts = [(int(p), int(t or 1)) for p, _, t in (pair.partition("x") for pair in arguments.processes.split(","))]

    page = "# Beyond memory and one machine\n\n"
    threads = "all threads" if arguments.large and not sizes else "one thread per process"
    page += f"* {datetime.date.today()}, load {os.getloadavg()[0]:.1f} at the start, {threads}\n"
    page += f"* Tiles of up to {arguments.tile_points:,} points. **busiest s** is the CPU time of the busiest process.\n\n"
    words = sys.argv[1:]
    for flag in ("--program", "--folder", "--page", "--python"):
        if flag in words:
            del words[words.index(flag):words.index(flag) + 2]
    page += "```sh\nbenchmarks/scaling.py " + shlex.join(words) + "\n```\n\n"
    weak = []
    if sizes:
        page += point_tables(arguments, sizes, counts)
    if arguments.weak:
        table, weak = weak_table(arguments, counts)
        page += table
    page += function_table(arguments)
    page += image_table(arguments)
    page += large_table(arguments)
    if weak:
        page += plan(weak)
    if arguments.page:
        with open(arguments.page, "w") as file:
            file.write(page)
    else:
        print(page)


if __name__ == "__main__":
    main()
