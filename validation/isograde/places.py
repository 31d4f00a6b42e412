"""Where real volumes stand on this machine; known without reading any, and without NumPy."""

from __future__ import annotations

import os
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

# The folder in which a package keeps the volumes that it ships.
PACKAGED = {"nibabel": ("tests", "data")}


def find(file: str, package: str | None) -> Path | None:
    """Where the file of a volume is, or None."""
    return next((place for folder in folders(package) if (place := folder / file).is_file()), None)


def folders(package: str | None) -> Iterator[Path]:
    """The folders that may hold volumes: ISOGRADE_DATA, the package that ships it, the cache."""
    if os.environ.get("ISOGRADE_DATA"):
        yield Path(os.environ["ISOGRADE_DATA"])
    # The package is an extra: without it, its volumes are absent.
    spec = find_spec(package) if package in PACKAGED else None
    if spec is not None and spec.submodule_search_locations:
        yield Path(spec.submodule_search_locations[0], *PACKAGED[str(package)])
    yield cache_folder()


def cache_folder() -> Path:
    """Where downloads are kept: XDG_CACHE_HOME/isograde, or ~/.cache/isograde."""
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "isograde"
