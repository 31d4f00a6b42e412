"""The vectors are what they say, and stay the same for ever."""

import hashlib
import itertools
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import trimesh
from isograde.cases import FAMILIES, all_cases, analytic, cells, noise, pairs, ties, volumes
from isograde.cases.frozen import digest, integers
from isograde.formats.reading import VolumeError
from isograde.model import Case, Kind
from isograde.oracles.bodies import KINDS
from numpy.typing import NDArray
from skimage.measure import marching_cubes


@pytest.mark.parametrize(
    ("family", "expected"),
    [
        ("cells", "85c017c55cc4c8ea07796a0aa2bb0111c413d8944ae59213956faaa91af07ea9"),
        ("pairs", "cdc4b243b834ea9650e0ce8fc1b4e4ef5f1809acfeecf6793277cbec8815b166"),
        ("ties", "4b98a86a7cd31f793c7043e689b4c5932041bcd411eb0181e6930cc9fcb49c31"),
        ("noise", "2f631a6fcfe2e25250ef188ad85a3d52e3ee92837ee6ce3b69c1ed5ebc91ab69"),
        ("analytic", "0bf50ecab66e95e5ce507a998b663ae0e737797ec496f569fd8dec207bf05ec2"),
    ],
)
def test_vectors_are_frozen(family: str, expected: str) -> None:
    """Same seed, same numbers, same ids: a change here makes every old report incomparable."""
    listed = FAMILIES[family].cases(0)
    if family == "pairs":
        listed = listed[::16]
    assert digest(listed) == expected


def _values(case: Case) -> NDArray[np.float64]:
    """The samples of a case."""
    return np.asarray(case.build().values, np.float64)


def test_another_seed_gives_other_numbers_under_the_same_ids() -> None:
    first, second = cells.cases(0)[1], cells.cases(1)[1]
    assert first.id == second.id
    assert not np.array_equal(first.build().values, second.build().values)


def test_integers_keep_their_range_and_reach_both_ends() -> None:
    drawn = integers("range", 0, (2000,), -3, 4)
    assert set(drawn.tolist()) == set(range(-3, 4))


def test_ids_are_unique_and_name_their_family() -> None:
    listed = [case for family in FAMILIES.values() for case in family.cases(0)]
    assert len({case.id for case in listed}) == len(listed)
    for name, family in FAMILIES.items():
        assert all(case.id.startswith(f"{name}/") for case in family.cases(0))


def test_cells_show_each_configuration_in_both_borders() -> None:
    """Bit c is corner (c & 1, c >> 1 & 1, c >> 2 & 1); counted with a triple loop."""
    for border, configuration in itertools.product((False, True), (0, 1, 77, 105, 254)):
        case = cells.cases(0)[256 * border + configuration]
        inside = _values(case) >= case.isovalues[0]
        for i, j, k in itertools.product((0, 1), repeat=3):
            corner = i + 2 * j + 4 * k
            assert inside[1 + i, 1 + j, 1 + k] == bool(configuration & 1 << corner)
        outer = inside.copy()
        outer[1:3, 1:3, 1:3] = border
        assert (outer == border).all()


def test_cells_stand_clear_of_ties_of_samples_and_saddles() -> None:
    """Whoever fails a cell cannot plead a tie."""
    assert len(cells.cases(0)) >= 256
    for case in cells.cases(0):
        values = _values(case) - case.isovalues[0]
        assert np.abs(values).min() >= 1 / 16
        for axis in range(3):
            face = np.moveaxis(values, axis, 0)
            products = face[:, 1:, 1:] * face[:, :-1, :-1] - face[:, 1:, :-1] * face[:, :-1, 1:]
            assert (products != 0).all()


def test_values_are_exact_in_half_precision() -> None:
    for case in [*cells.cases(0)[::37], *noise.cases(0)[:3]]:
        values = _values(case)
        assert np.array_equal(values.astype(np.float16).astype(np.float64), values)


def test_pairs_are_all_the_patterns_of_twelve_signs() -> None:
    seen = set()
    for case in pairs.cases(0):
        if "full" not in case.tags:
            inside = _values(case) >= case.isovalues[0]
            assert inside.shape == (3, 2, 2)
            middle = inside[1]
            assert middle[0, 0] == middle[1, 1] != middle[0, 1] == middle[1, 0]
            seen.add(inside.tobytes())
    assert len(seen) == 512
    assert len(pairs.cases(0)) == 4096


def test_ties_have_samples_or_saddles_at_the_isovalue() -> None:
    assert any("/saddle/" in case.id for case in ties.cases(0))
    for case in ties.cases(0):
        values = _values(case) - case.isovalues[0]
        if "/saddle/" in case.id:
            assert set(np.unique(values)) <= {-1.0, 1.0}
        elif case.id not in {"ties/low/000", "ties/high/000"}:
            assert (values == 0).any(), case.id


@pytest.mark.parametrize("case", analytic.cases(0), ids=lambda case: case.id)
def test_analytic_facts_hold_for_an_independent_extractor(case: Case) -> None:
    """scikit-image's mesh, measured by trimesh, is within the tolerance of every fact."""
    field = case.build()
    vertices, faces, *_ = marching_cubes(field.values, case.isovalues[0], spacing=field.spacing)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    facts = case.facts
    assert len(faces) > 100
    if "area" in facts:
        assert abs(mesh.area - facts["area"]) < facts["area_tolerance"]
        assert abs(abs(mesh.volume) - facts["volume"]) < facts["volume_tolerance"]
    if "euler" in facts:
        assert mesh.euler_number == facts["euler"]
        assert mesh.body_count == facts["components"]
    if "closed" in case.tags:
        assert mesh.is_watertight


def test_analytic_tolerances_shrink_with_the_square_of_the_spacing() -> None:
    coarse = analytic.sphere_facts(analytic.cube(33), 0.7)
    fine = analytic.sphere_facts(analytic.cube(65), 0.7)
    for key in ("area_tolerance", "volume_tolerance"):
        assert fine[key] == pytest.approx(coarse[key] / 4)


def test_the_mri_that_comes_with_nibabel_is_read() -> None:
    pytest.importorskip("nibabel")
    volume = volumes.REGISTRY["nibabel-anatomical"]
    field = volumes.load(volume.name)
    assert field.shape == volume.shape
    assert field.spacing == (2.0, 2.0, 2.0)
    assert field.values.dtype == np.dtype(volume.dtype)
    listed = [case for case in volumes.cases() if "full" not in case.tags]
    assert any(case.id.startswith("real/nibabel-anatomical") for case in listed)
    # The steps of the header, and not the lengths of the affine's columns: cases are frozen.
    assert volumes.load("nibabel-example4d").spacing == (2.0, 2.0, 2.1999990940093994)


def test_the_volumes_of_the_data_folder_are_what_the_registry_says(data: Path) -> None:
    steps = {"headsq": (1.5, 3.2, 3.2)}
    for name in ("headsq", "tooth", "stroke", "carotid", "fiberform", "aneurism"):
        volume = volumes.REGISTRY[name]
        assert volumes.load(name).spacing == steps.get(name, (1.0, 1.0, 1.0))
        assert volumes.find(volume) == data / volume.file
        field = volumes.load(name)
        assert field.shape == volume.shape
        assert field.values.dtype == np.dtype(volume.dtype)
        assert all(field.values.min() < iso <= field.values.max() for iso in volume.isovalues)


def test_every_default_real_case_has_a_surface() -> None:
    listed = [case for case in volumes.cases() if "full" not in case.tags]
    if not listed:
        pytest.skip("no real volume is here: install nibabel or set ISOGRADE_DATA")
    for case in listed:
        values = _values(case)
        assert values.min() < case.isovalues[0] <= values.max(), case.id


def test_absent_volumes_make_no_case(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("ISOGRADE_DATA", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert not any("/bunny" in case.id or "/fuel" in case.id for case in volumes.cases())


def test_a_downloaded_raw_volume_is_found_and_read(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    volume = volumes.REGISTRY["fuel"]
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "isograde").mkdir()
    samples = np.arange(64**3, dtype=np.uint32).astype(np.uint8)
    samples.tofile(tmp_path / "isograde" / volume.file)
    place = volumes.find(volume)
    assert place is not None
    read = volumes.read(place, volume=volume)
    assert np.array_equal(read.values, samples.reshape(64, 64, 64))
    samples[:-1].tofile(place)
    with pytest.raises(VolumeError, match="holds 262143 samples"):
        volumes.read(place, volume=volume)


@pytest.mark.parametrize("ending", [".npy", ".npz", ".nrrd", ".nii", ".nii.gz", ".tif", ".vti"])
def test_each_format_gives_back_what_its_library_wrote(ending: str, tmp_path: Path) -> None:
    values = np.arange(4 * 5 * 6, dtype=np.int16).reshape(4, 5, 6)
    spacing = (1.0, 2.0, 3.0)
    path = tmp_path / f"volume{ending}"
    _write(path, values, spacing)
    field = volumes.read(path)
    assert np.array_equal(field.values, values)
    if ending not in {".npy", ".tif"}:
        assert field.spacing == spacing


def _write(path: Path, values: NDArray[np.int16], spacing: tuple[float, ...]) -> None:
    """The file, written by the library of its format."""
    if path.name.endswith(".npy"):
        np.save(path, values)
    elif path.name.endswith(".npz"):
        np.savez(path, values=values, spacing=np.array(spacing))
    elif path.name.endswith(".nrrd"):
        import nrrd

        nrrd.write(str(path), values, {"spacings": list(spacing)})
    elif ".nii" in path.name:
        nibabel = pytest.importorskip("nibabel")
        nibabel.save(nibabel.Nifti1Image(values, np.diag([*spacing, 1.0])), path)
    elif path.name.endswith(".tif"):
        pytest.importorskip("tifffile").imwrite(path, values, photometric="minisblack")
    else:
        pyvista = pytest.importorskip("pyvista")
        grid = pyvista.ImageData(dimensions=values.shape[::-1], spacing=spacing[::-1])
        grid.point_data["values"] = values.ravel()
        grid.save(path)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("volume.nrrd", b"rubbish", "cannot be read"),
        ("volume.tif", b"rubbish", "cannot be read"),
        ("volume.npz", b"rubbish", "cannot be read"),
        ("absent.npy", None, "is not a file"),
        ("volume.xyz", b"", "ends in none of"),
        ("volume.npy", b"rubbish", "cannot be read"),
        ("volume.nii", b"rubbish", "cannot be read"),
    ],
)
def test_a_bad_file_is_named_with_its_fault(
    name: str, content: bytes | None, message: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(VolumeError, match=message):
        volumes.read(path)


def test_a_volume_without_an_address_says_where_to_get_it() -> None:
    volume = volumes.Volume("x", "", "x.npy", (1, 1, 1), "uint8", (), "", "the archive")
    with pytest.raises(VolumeError, match="get it from the archive"):
        volumes.fetch(volume)


TINY = volumes.Volume(
    "tiny", "", "tiny.raw", (2, 2, 2), "uint8", (), "", "the archive", "https://h.invalid/tiny.raw"
)


def _given(monkeypatch: pytest.MonkeyPatch, folder: Path, retrieve: Callable[..., Any]) -> None:
    """Downloads go into the folder by `retrieve`, in the place of pooch's."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    monkeypatch.delenv("ISOGRADE_DATA", raising=False)
    monkeypatch.setitem(sys.modules, "pooch", SimpleNamespace(retrieve=retrieve))


def test_without_a_network_it_is_said_what_to_do(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def fails(*_: Any, **__: Any) -> Any:
        raise ConnectionError("no route to host")

    _given(monkeypatch, tmp_path, fails)
    with pytest.raises(VolumeError) as told:
        volumes.fetch(TINY)
    for words in ("ConnectionError", "the archive", "tiny.raw", str(tmp_path), "ISOGRADE_DATA"):
        assert words in str(told.value)
    assert not list(tmp_path.rglob("*.raw"))


@pytest.mark.parametrize("size", [8, 7])
def test_a_download_that_nothing_vouches_for_is_said_to_be_unverified(
    size: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What has the wrong size is not kept."""

    def writes(url: str, known: str | None, fname: str, path: Path) -> str:
        assert known is None
        path.mkdir(parents=True)
        (path / fname).write_bytes(bytes(size))
        return str(path / fname)

    _given(monkeypatch, tmp_path, writes)
    if size == 8:
        assert volumes.read(volumes.fetch(TINY), volume=TINY).shape == (2, 2, 2)
        told = capsys.readouterr().err
        assert "unverified" in told
        assert hashlib.sha256(bytes(8)).hexdigest() in told
    else:
        with pytest.raises(VolumeError, match="7 bytes, where tiny has 8"):
            volumes.fetch(TINY)
        assert not list(tmp_path.rglob("*.raw"))


def test_all_cases_hold_every_family() -> None:
    listed = all_cases(0)
    assert {name.split("/")[0] for name in listed} >= set(FAMILIES) - {"real"}


def test_every_fact_about_an_analytic_case_is_stated_of_some() -> None:
    """What is compared with an independent extractor is there to be compared."""
    listed = analytic.cases(0)
    for fact in ("area", "volume", "euler", "components"):
        assert sum(fact in case.facts for case in listed) >= 3, fact
    assert sum("closed" in case.tags for case in listed) >= 3


# Cases of every kind, whose numbers never change; where one is added, its kind is graded again.
FROZEN = {
    "contours": "34e88546cb0d",
    "curves": "489c2e7cf962",
    "simplices": "f144c34ceb62",
    "accuracy": "5c9e4b939926",
}


@pytest.mark.parametrize("name", FROZEN)
def test_the_numbers_of_every_kind_are_frozen(name: str) -> None:
    """A checksum of the samples, spacings, origins and isovalues, rounded to 1e-6."""
    hashed = hashlib.sha256()
    listed = FAMILIES[name].cases(0)
    assert len(listed) > 4
    for case in listed:
        if case.samples > 40_000:
            continue
        field = case.build()
        assert Kind(field.dimension, field.components) == case.kind
        assert len(case.isovalues) == case.kind.m
        assert int(np.prod(field.shape)) == case.samples
        numbers = [field.values, field.spacing, field.origin, case.isovalues]
        for part in numbers:
            hashed.update(np.rint(np.asarray(part, float) * 1e6).astype("<i8").tobytes())
    assert hashed.hexdigest()[:12] == FROZEN[name]


def test_every_kind_is_posed_in_every_way_on_a_few_small_cases() -> None:
    """Each costs up to sixty calls."""
    posed: dict[Kind, list[Case]] = {}
    for case in all_cases(0).values():
        if "posed" in case.tags and not {"full", "cost"} & case.tags:
            posed.setdefault(case.kind, []).append(case)
    assert {(2, 1), (3, 1), (3, 2), (4, 1), (4, 2), (5, 3)} <= set(posed)
    for kind, listed in posed.items():
        assert len(listed) >= 2, kind
        assert kind == (3, 1) or sum(case.samples for case in listed) < 4000, kind


def test_bodies_are_a_family_of_the_catalogue() -> None:
    """Their kinds have few cases by default."""
    kinds = {case.kind for case in FAMILIES["bodies"].cases(0)}
    assert kinds == {Kind(*kind) for kind in KINDS}
    for kind in kinds:
        listed = [case for case in FAMILIES["bodies"].cases(0) if case.kind == kind]
        default = sum("full" not in case.tags for case in listed)
        assert 8 <= default <= 9 if kind.n <= 3 else default == 2, kind
