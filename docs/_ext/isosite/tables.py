"""Cells that hold much text are marked, so that a narrow page does not set a word a line.

A table wider than the page scrolls in itself (`site.css`). A browser would rather make every column
as narrow as its longest word, and a page of a telephone many times as long.
"""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx

# At least so many characters, and the class.
SIZES = ((60, "long-cell"), (16, "middling-cell"))


def mark(app: Sphinx, document: nodes.document) -> None:
    """Give each cell of more than a few words the class of its length."""
    for cell in document.findall(nodes.entry):
        length = len(" ".join(cell.astext().split()))
        for least, name in SIZES:
            if length >= least:
                cell["classes"].append(name)
                break
