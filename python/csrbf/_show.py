"""Objects show themselves: as a page in a notebook or a browser, and as a picture."""

from __future__ import annotations

import base64
import functools
import gzip
import html
import os
import pathlib
import struct
import tempfile
import webbrowser
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import Path
from csrbf._viewer import View

_FOLDER = pathlib.Path(__file__).parent / "page"
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
_IN_NOTEBOOK = """
body { max-width: none; padding: .4rem; } header { display: none; }
.facts div { padding: .35rem .7rem; } .facts dd { font-size: 1rem; } .facts dt { font-size: .8rem; }
.panels { margin-top: .6rem; gap: .8rem; grid-template-columns: minmax(0, 1fr); }
.surface .stage { height: 19rem; } .surface .hint { display: none; }
.panel > img { max-height: 24rem; }
"""
# What these make, in pixels.
_FACTS_IN_A_ROW, _FACT, _STAGE, _HIGHEST, _LINE, _MARGINS = 5, 56, 388, 384, 34, 26
# The script is packed: it is in every page of a notebook. Without DecompressionStream pages show still pictures.
_START = """
(async () => {
  const packed = Uint8Array.from(atob(document.getElementById("packed").textContent), (c) => c.charCodeAt(0));
  const text = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  document.body.append(Object.assign(document.createElement("script"), {textContent: text}));
})();
"""


@dataclass
class Panel:
    """A picture, or a view to turn with a picture that stands for it, and what they show."""

    picture: NDArray[np.uint8] | bytes  # (height, width, 3), or a PNG file
    caption: str = ""
    view: View | None = None


@dataclass
class Page:
    """What an object shows of itself."""

    title: str
    facts: dict[str, str]
    panels: list[Panel] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def height(self) -> int:
        """In a notebook, in pixels: of rows of facts and of panels, as _IN_NOTEBOOK lays them out."""
        rows = -(-len(self.facts) // _FACTS_IN_A_ROW)
        heights = [_STAGE if panel.view else min(_HIGHEST, height_of(panel.picture)) for panel in self.panels]
        captions = sum(_LINE for panel in self.panels if panel.caption)
        return _MARGINS + _FACT * rows + sum(heights) + captions + _LINE * len(self.notes)


def height_of(picture: NDArray[np.uint8] | bytes) -> int:
    """Of a picture or PNG file."""
    return int(struct.unpack(">I", picture[20:24])[0]) if isinstance(picture, bytes) else len(picture)


class Shown:
    """Base of classes that notebooks show. They have `_page`; most of them a picture."""

    def _page(self, large: bool) -> Page:
        """Content of the page: bounded in size, more so in a notebook than in a file."""
        raise NotImplementedError

    def _shown_page(self, large: bool) -> Page:
        """The page, of words alone where there is nothing to draw."""
        try:
            return self._page(large)
        except (ValueError, _csrbf.SolverFailure) as error:
            return Page(type(self).__name__, {"object": repr(self)}, notes=[f"There is nothing to draw: {error}"])

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        # One computation for both, of which a notebook shows one.
        page = self._shown_page(large=False)
        bundle: dict[str, Any] = {"text/plain": repr(self), "text/html": _in_notebook(page)}
        if page.panels:
            bundle["image/png"] = base64.b64encode(_png_of(page)).decode()
        return bundle

    def _repr_html_(self) -> str:
        return _in_notebook(self._shown_page(large=False))

    def _repr_png_(self) -> bytes | None:
        page = self._shown_page(large=False)
        return _png_of(page) if page.panels else None

    def show(self, path: Path | None = None) -> pathlib.Path:
        """Open a page about the object in the browser, with a view to turn where there is a surface.

        Parameters
        ----------
        path : str or path-like, optional
            .html file to write; a new one in the folder for temporary files when not given. It needs no other file and
            no network.

        Returns
        -------
        pathlib.Path
            The file.

        Examples
        --------
        >>> f = csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0])
        >>> f.show("parabola.html").name  # doctest: +SKIP
        'parabola.html'
        """
        text = document(self._shown_page(large=True))
        if path is None:
            handle, name = tempfile.mkstemp(prefix="csrbf_", suffix=".html")
            os.close(handle)
            file = pathlib.Path(name)
        else:
            file = pathlib.Path(path)
        file.write_text(text, encoding="utf-8")
        webbrowser.open(file.resolve().as_uri())
        return file


def document(page: Page, style: str = "") -> str:
    """The page as one HTML file that loads nothing."""
    title = html.escape(page.title)
    facts = "".join(
        f"<div><dd>{html.escape(value)}</dd><dt>{html.escape(name)}</dt></div>" for name, value in page.facts.items()
    )
    notes = "".join(f'<p class="caption">{html.escape(note)}</p>' for note in page.notes)
    still = sum(panel.view is None for panel in page.panels)
    panels = "".join(_panel(panel, wide=still < 2 or panel.view is not None) for panel in page.panels)
    script = ""
    if any(panel.view for panel in page.panels) and _packed_viewer():
        script = f'<script type="text/plain" id="packed">{_packed_viewer()}</script><script>{_START}</script>'
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="color-scheme" content="light dark">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        f"<title>{title}</title><style>{_style()}{style}</style></head><body><main>"
        f'<header><p class="command">csrbf</p><h1>{title}</h1></header><dl class="facts">{facts}</dl>{notes}<div class="panels">{panels}</div></main>{script}</body></html>\n'
    )


def png(picture: NDArray[np.uint8]) -> bytes:
    """A PNG file of a picture (height, width, 3)."""
    height, width, _ = picture.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), picture.reshape(height, 3 * width)], axis=1)

    def chunk(kind: bytes, content: bytes) -> bytes:
        checksum = zlib.crc32(kind + content)
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = (chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)), chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def side_by_side(pictures: list[NDArray[np.uint8]], gap: int = 8) -> NDArray[np.uint8]:
    """Pictures in a row, white around the lower ones."""
    height = max(picture.shape[0] for picture in pictures)
    columns = []
    for picture in pictures:
        filled = np.full((height, picture.shape[1] + gap, 3), 255, dtype=np.uint8)
        filled[: picture.shape[0], : picture.shape[1]] = picture
        columns.append(filled)
    return np.concatenate(columns, axis=1)[:, :-gap]


def _in_notebook(page: Page) -> str:
    """A frame that contains the whole page: styles and scripts of several do not meet."""
    content = html.escape(document(page, _IN_NOTEBOOK), quote=True)
    return (
        f'<iframe title="{html.escape(page.title)}" sandbox="allow-scripts" loading="lazy" width="100%" '
        f'height="{page.height()}" style="border: 0; max-width: 60rem" srcdoc="{content}"></iframe>'
    )


def _panel(panel: Panel, wide: bool) -> str:
    content, what = base64.b64encode(_file(panel)).decode(), html.escape(panel.caption)
    picture = f'<img src="data:image/png;base64,{content}" alt="{what}">'
    body = picture if panel.view is None else _view(picture, panel.view)
    caption = f'<p class="caption">{html.escape(panel.caption)}</p>' if panel.caption else ""
    return f'<div class="panel{" wide" if wide else ""}">{body}{caption}</div>'


def _view(picture: str, view: View) -> str:
    if not _packed_viewer():
        why = "A still picture: csrbf was built without three.js, which the interactive view needs."
        return f'<figure class="surface"><div class="stage">{picture}</div><p class="why-still">{why}</p></figure>'
    return (
        f'<figure class="surface"><div class="stage">{picture}</div><p class="hint">Drag to turn, drag with Shift or the '
        'right button to move, click and scroll to zoom.</p><p class="why-still"></p>'
        f'<script type="application/json" class="surface-data">{view.script()}</script></figure>'
    )


def _png_of(page: Page) -> bytes:
    return _file(page.panels[0])


def _file(panel: Panel) -> bytes:
    return panel.picture if isinstance(panel.picture, bytes) else png(panel.picture)


@functools.lru_cache(maxsize=None)
def _style() -> str:
    file = _FOLDER / "report.css"
    return file.read_text(encoding="utf-8") if file.exists() else ""


@functools.lru_cache(maxsize=None)
def _packed_viewer() -> str:
    """The script of the interactive view, packed; empty when csrbf was built without it."""
    file = _FOLDER / "viewer.js"
    return base64.b64encode(gzip.compress(file.read_bytes(), mtime=0)).decode() if file.exists() else ""
