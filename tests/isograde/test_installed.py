"""Versions by folders: those that the metadata says."""

from importlib import metadata

import isograde
import pytest
from isograde.installed import version_of


@pytest.mark.parametrize(
    "name", ["numpy", "SciPy", "scikit-image", "PyMCubes", "pymeshlab", "vtk", "rich"]
)
def test_a_version_is_that_of_the_metadata(name: str) -> None:
    """Whatever the spelling of the name."""
    try:
        said: str | None = metadata.version(name)
    except metadata.PackageNotFoundError:
        said = None
    for spelling in (name, name.upper(), name.replace("-", "_"), name.replace("-", ".")):
        assert version_of(spelling) == said


def test_a_checkout_that_is_not_installed_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.path", [])
    assert isograde.__version__ == "source"
