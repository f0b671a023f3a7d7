"""The command that writes the gallery; see csrbf.thesis."""

import argparse
import os
import pathlib
import signal
import sys
import time

from csrbf import thesis
from csrbf.thesis.coverage import published_in


def main(arguments=None):
    """Writes the gallery; returns the exit status: 0, 1 for unreadable data, 2 for invalid usage."""
    options = parse(arguments)
    if options.list:
        for name in thesis.names():
            print(f"{name:<14}{', '.join(entry.number for entry in published_in(name))}")
        return 0
    # Ctrl-C ends the run at once; files are renamed when they are complete.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        write_gallery(options)
    except OSError as error:
        print(f"csrbf.thesis: {error}", file=sys.stderr)
        return 1
    return 0


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="python3 -m csrbf.thesis",
        description="Reproduces the figures and tables of the thesis and writes them as pictures (.png) and as one "
        "page, index.html, with the claims of the thesis, our results, and the errata.",
        epilog="example: python3 -m csrbf.thesis --out gallery figure-2.4 figure-8.2",
    )
    parser.add_argument("figures", nargs="*", metavar="FIGURE", help="names of figures (see --list); default: all")
    parser.add_argument("--out", metavar="DIR", type=pathlib.Path, help="folder to write to; created when missing")
    parser.add_argument("--list", action="store_true", help="list the names of all figures and what they cover")
    parser.add_argument("--threads", metavar="N", type=int, default=0, help="threads; default: all cores")
    parser.add_argument("--ultrasound", metavar="FILE", default="", help="2D image, segmented in figure-8.10")
    parser.add_argument("--bone", metavar="FILE", default="", help="3D image, segmented in figure-8.8")
    options = parser.parse_args(arguments)
    known = thesis.names()
    for name in options.figures:
        if name not in known:
            parser.error(f"figure {name}: there is none of this name; there are {', '.join(known)}")
    if options.threads < 0:
        parser.error(f"--threads {options.threads}: must not be negative; 0 takes all cores")
    for path in (options.ultrasound, options.bone):
        if path and not os.path.exists(path):
            parser.error(f"{path}: there is no such file")
    if not options.list and options.out is None:
        parser.error("--out DIR: say where to write")
    return options


def write_gallery(options):
    try:
        from csrbf.thesis import page, plots
    except ImportError as error:
        sys.exit(f"csrbf.thesis: {error}; install matplotlib (Debian: python3-matplotlib)")
    thesis._figures.set_thread_count(options.threads)
    options.out.mkdir(parents=True, exist_ok=True)
    wanted = [name for name in thesis.names() if not options.figures or name in options.figures]
    start = time.perf_counter()
    figures, images = [], {}
    for i, name in enumerate(wanted, 1):
        print(f"[{i}/{len(wanted)}] {name} ", end="", flush=True)
        figure = thesis.compute(name, options.ultrasound, options.bone)
        images[name] = plots.save(figure, options.out)
        figures.append(figure)
        found = f"left out: {figure.missing}" if figure.missing else f"{figure.seconds:.1f} s: {page.counts([figure])}"
        print(found, flush=True)
    path = options.out / "index.html"
    page.write(path, figures, images, time.perf_counter() - start)
    print(f"{path}: {page.counts(figures)}, {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    sys.exit(main())
