"""Pages on which two algorithms are compared by counting."""

from __future__ import annotations

from isosite.writing import Pages


def write(pages: Pages) -> None:
    """Write them."""
