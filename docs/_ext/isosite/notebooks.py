"""Lessons and programs as notebooks."""

from __future__ import annotations

from sphinx.application import Sphinx


def write(app: Sphinx) -> None:
    """Lay the notebooks into the site."""


def setup(app: Sphinx) -> None:
    """Tell Sphinx of them."""
