"""Progress of long computations."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, Union

Listener = Callable[[str, float], object]
Progress = Union[bool, Listener, None]


@contextlib.contextmanager
def listening(progress: Progress) -> Iterator[Listener | None]:
    """What the compiled module calls: nothing, a bar for True, or the given function."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        with _display() as show:
            yield show
    elif callable(progress):
        yield progress
    else:
        raise ValueError("progress: must be True, False or a function of stage and fraction")


def _display() -> contextlib.AbstractContextManager[Listener]:
    try:
        from tqdm import tqdm
    except ImportError:
        return _lines()
    return _bar(tqdm)


@contextlib.contextmanager
def _bar(tqdm: Any) -> Iterator[Listener]:
    """A tqdm bar, which restarts with every stage."""
    with tqdm(total=100, leave=False, bar_format="{desc:<16}{percentage:3.0f} %|{bar}| {elapsed} < {remaining}") as bar:

        def show(stage: str, fraction: float) -> None:
            if bar.desc != stage:
                bar.reset(total=100)
                bar.set_description_str(stage, refresh=False)
            bar.update(100 * fraction - bar.n)

        yield show


@contextlib.contextmanager
def _lines(interval: float = 2.0) -> Iterator[Listener]:
    """A line on standard error for every stage and every two seconds."""
    shown, last = "", 0.0

    def show(stage: str, fraction: float) -> None:
        nonlocal shown, last
        now = time.monotonic()
        if stage == shown and now - last < interval:
            return
        shown, last = stage, now
        print(f"{stage} {100 * fraction:.0f} %", file=sys.stderr)

    yield show
