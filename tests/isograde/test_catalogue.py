"""The file that `isograde list` reads holds what the registries hold."""

from pathlib import Path

import pytest
from isograde import catalogue, cataloguing, places


def test_the_file_is_that_of_the_registries() -> None:
    """After a change of claims, cases or implementations: make catalogue."""
    found, built = catalogue.read(), cataloguing.build()
    assert found.keys() == built.keys()
    assert len(found["claims"]) > 40
    for name, rows in built.items():
        assert found[name] == rows, f"{name} changed: make catalogue"


def test_the_volumes_a_package_ships_are_found_without_importing_it() -> None:
    """Nibabel says itself where its volumes are."""
    testing = pytest.importorskip("nibabel.testing")
    assert Path(testing.data_path) in list(places.folders("nibabel"))


def test_a_volume_in_the_folder_of_data_is_found_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ISOGRADE_DATA", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert places.find("ball.npy", None) is None
    (tmp_path / "cache" / "isograde").mkdir(parents=True)
    (tmp_path / "cache" / "isograde" / "ball.npy").touch()
    assert places.find("ball.npy", None) == tmp_path / "cache" / "isograde" / "ball.npy"
    (tmp_path / "ball.npy").touch()
    assert places.find("ball.npy", None) == tmp_path / "ball.npy"
