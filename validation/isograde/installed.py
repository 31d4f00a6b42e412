"""Versions of installed distributions, by the names of their folders.

`importlib.metadata` parses the whole of a distribution's metadata, with the parser of mail: its
import alone takes a fifth of what NumPy's takes. For a list of names and versions the folders say
enough: ``scikit_image-0.26.0.dist-info``.
"""

from __future__ import annotations

import os
import sys
from functools import cache


def version_of(distribution: str) -> str | None:
    """The version of the first distribution of this name on the path; None where there is none.

    >>> version_of("NumPy") is not None, version_of("no-such-thing")
    (True, None)
    """
    return _versions(tuple(sys.path)).get(_normal(distribution))


@cache
def _versions(path: tuple[str, ...]) -> dict[str, str]:
    """The versions of all that is installed in these folders, by normal names."""
    found: dict[str, str] = {}
    for folder in path:
        try:
            names = os.listdir(folder or ".")
        except OSError:
            continue
        for name in names:
            if name.endswith(".dist-info"):
                distribution, _, version = name.removesuffix(".dist-info").partition("-")
                found.setdefault(_normal(distribution), version)
    return found


def _normal(name: str) -> str:
    """The name as all its spellings have it.

    >>> _normal("Scikit_Image"), _normal("scikit.image")
    ('scikit-image', 'scikit-image')
    """
    return name.lower().replace("_", "-").replace(".", "-")
