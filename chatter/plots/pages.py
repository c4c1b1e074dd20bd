"""Pages of PDF with text that can be selected: paragraphs, tables and pictures from the top."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from typing import BinaryIO

import matplotlib as mpl
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from PIL import Image

from chatter.plots.style import any_letters

#: inch
_WIDTH, _HEIGHT, _MARGIN = 8.27, 11.69, 0.75
_LINE = 1.35
_POINT = 1.0 / 72.0
_TEXT, _SMALL, _HEAD, _TITLE = 9.5, 7.5, 12.0, 16.0
#: mean width of a character of DejaVu Sans over its size, on the safe side
_CHARACTER = 0.58
#: of DejaVu Sans Mono
_MONO = 0.605


class Pages:
    """Pages that are filled from the top."""

    def __init__(self, pdf: PdfPages) -> None:
        self._pdf, self._figure, self._down = pdf, Figure(figsize=(_WIDTH, _HEIGHT)), _MARGIN

    def space(self, height: float) -> None:
        """Begin a page where less than a height is left."""
        if self._down + height > _HEIGHT - _MARGIN:
            self.break_page()

    def break_page(self) -> None:
        """Write this page and begin the next."""
        self._pdf.savefig(self._figure)
        self._figure, self._down = Figure(figsize=(_WIDTH, _HEIGHT)), _MARGIN

    def skip(self, height: float) -> None:
        """Leave a height free."""
        self._down += height

    def line(self, text: str, size: float, **look: object) -> None:
        """Write one line as it stands."""
        height = size * _POINT * _LINE
        self.space(height)
        self._figure.text(
            _MARGIN / _WIDTH, 1.0 - self._down / _HEIGHT, text, va="top", fontsize=size,
            parse_math=False, **look,
        )  # fmt: skip
        self._down += height

    def text(self, text: str, size: float = _TEXT, **look: object) -> None:
        """Write a paragraph."""
        across = int((_WIDTH - 2.0 * _MARGIN) / (_CHARACTER * size * _POINT))
        for line in textwrap.wrap(_printable(text), across) or [""]:
            self.line(line, size, **look)
        self.skip(0.4 * size * _POINT)

    def title(self, text: str) -> None:
        """Write the title."""
        self.text(text, _TITLE, weight="bold")

    def code(self, text: str) -> None:
        """Write what was typed."""
        self.text(text, _SMALL, family="DejaVu Sans Mono")

    def heading(self, text: str, size: float = _HEAD) -> None:
        """Write a heading that stays with what follows."""
        self.space(6.0 * size * _POINT)
        self.skip(0.6 * size * _POINT)
        self.text(text, size, weight="bold")

    def table(self, headers: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Write a table; long cells are broken, long tables go on over the page."""
        widths = _column_widths([headers, *rows])
        self._row(headers, widths, weight="bold")
        for row in rows:
            self._row(row, widths)
        self.skip(0.12)

    def _row(self, cells: Sequence[str], widths: Sequence[int], **look: object) -> None:
        broken = [
            textwrap.wrap(_printable(cell), width) or [""]
            for cell, width in zip(cells, widths, strict=True)
        ]
        for i in range(max(map(len, broken))):
            texts = [one[i] if i < len(one) else "" for one in broken]
            line = "  ".join(text.ljust(width) for text, width in zip(texts, widths, strict=True))
            self.line(line, _SMALL, family="DejaVu Sans Mono", **look)

    def picture(self, png: bytes) -> None:
        """Place a picture, as wide as the page allows."""
        with Image.open(BytesIO(png)) as opened:
            image = opened.convert("RGB")
        width, tall = _WIDTH - 2.0 * _MARGIN, 0.6 * _HEIGHT
        height = width * image.height / image.width
        if height > tall:
            width, height = width * tall / height, tall
        self.space(height)
        bottom = 1.0 - (self._down + height) / _HEIGHT
        axes = self._figure.add_axes((_MARGIN / _WIDTH, bottom, width / _WIDTH, height / _HEIGHT))
        axes.imshow(image, aspect="auto", interpolation="none")
        axes.set_axis_off()
        self.skip(height + 0.15)


@contextmanager
def pages_of(file: BinaryIO, title: str) -> Iterator[Pages]:
    """Pages that are written to a file when all is on them."""
    with (
        mpl.rc_context({"pdf.fonttype": 42}),
        any_letters(),
        PdfPages(file, metadata={"Title": _printable(title)}) as pdf,
    ):
        pages = Pages(pdf)
        yield pages
        pages.break_page()


def _column_widths(rows: Sequence[Sequence[str]]) -> list[int]:
    """Characters of each column: what it needs, the widest narrowed until all fit."""
    room = int((_WIDTH - 2.0 * _MARGIN) / (_MONO * _SMALL * _POINT))
    widths = [max(1, *map(len, column)) for column in zip(*rows, strict=True)]
    room -= 2 * (len(widths) - 1)
    while sum(widths) > room and max(widths) > 1:
        widths[widths.index(max(widths))] -= 1
    return widths


def _printable(text: str) -> str:
    """Text without characters that a page cannot hold."""
    return "".join(one if one.isprintable() else " " for one in text)
