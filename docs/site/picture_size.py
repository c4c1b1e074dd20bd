"""Pictures of the manual: small files, so that the repository stays small."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

_WIDEST = 1100  # pixels
_COLOURS = 256


def keep(source: Path, target: Path) -> None:
    """Write a picture with a palette, no wider than a page."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with Image.open(source) as picture:
        plain = picture.convert("RGB")
        if plain.width > _WIDEST:
            height = round(plain.height * _WIDEST / plain.width)
            plain = plain.resize((_WIDEST, height), Image.Resampling.LANCZOS)
        plain.quantize(_COLOURS, dither=Image.Dither.NONE).save(target, optimize=True)
