"""Draws what `docs/_ext/pictures` registers, and sets it beside the paragraph it explains."""

from __future__ import annotations

import hashlib
import importlib
import io
from pathlib import Path

import numpy as np
from matplotlib.image import imread, imsave

from isosite.evidence import PACKAGES, ROOT
from isosite.writing import Pages

FOLDER = "articles/pictures"
# Empty rows that are kept round a picture.
MARGIN = 9


def fingerprint() -> str:
    """A number for all that a picture may hang on: programs that draw, and the reference."""
    digest = hashlib.sha256()
    for folder in (ROOT / "docs" / "_ext" / "pictures", PACKAGES["isoref"]):
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.read_bytes())
    digest.update(Path(__file__).read_bytes())
    return digest.hexdigest()


def register() -> None:
    """Import the programs that draw: importing registers what they draw."""
    for path in sorted((ROOT / "docs" / "_ext" / "pictures").glob("[!_]*.py")):
        importlib.import_module(f"pictures.{path.stem}")


def draw_all(pages: Pages) -> dict[str, str]:
    """Every picture as reStructuredText, by the dotted name of what it stands beside.

    They are drawn again only when a program that draws or the reference has changed.
    """
    register()
    from pictures import REGISTERED

    mark = fingerprint()
    known = Path(pages.folder, f"{FOLDER}/fingerprint")
    fresh = known.is_file() and known.read_text(encoding="utf-8") == mark
    shown: dict[str, str] = {}
    for name, (beside, draw) in REGISTERED.items():
        png, txt = f"{FOLDER}/{name}.png", f"{FOLDER}/{name}.txt"
        if not (fresh and pages.has(png) and pages.has(txt)):
            picture = draw()
            data = io.BytesIO()
            picture.figure.savefig(
                data, format="png", dpi=150, bbox_inches="tight", pad_inches=0.06
            )
            pages.put(png, trimmed(data.getvalue()))
            pages.put(txt, picture.caption)
        caption = Path(pages.folder, txt).read_text(encoding="utf-8")
        shown[beside] = shown.get(beside, "") + figure(name, caption)
    pages.put(f"{FOLDER}/fingerprint", mark)
    return shown


def trimmed(png: bytes) -> bytes:
    """The picture without the empty rows above and below it, which axes in space leave.

    A picture that lets the page shine through is left alone.
    """
    pixels = imread(io.BytesIO(png))
    if pixels.shape[2] == 4 and (pixels[..., 3] < 1).any():
        return png
    filled = np.flatnonzero((pixels[..., :3] < 1).any(axis=(1, 2)))
    if not len(filled):
        return png
    out = io.BytesIO()
    low, high = max(filled[0] - MARGIN, 0), filled[-1] + 1 + MARGIN
    imsave(out, np.ascontiguousarray(pixels[low:high]), format="png")
    return out.getvalue()


def figure(name: str, caption: str) -> str:
    """A figure with its caption, which is also what stands for it where it is not seen."""
    return (
        f".. figure:: /{FOLDER}/{name}.png\n   :alt: {caption}\n   :class: drawn\n\n"
        f"   {caption}\n\n"
    )
