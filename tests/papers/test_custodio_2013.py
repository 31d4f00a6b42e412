"""The published verification set: how it is posed, and what must come out."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.cases.own import read as read_cases
from isograde.declaration import Declaration
from isograde.model import Adapter, Limits, Verdict
from isograde.oracles.complexes import Complex
from isograde.oracles.stratified_morse import euler
from isograde.oracles.trilinear import cells
from isograde.oracles.trilinear_grid import grid
from isoref.field import Field
from isoref.methods import METHODS

from tests.isograde.judging import verdicts
from tests.papers.loading import importer


@pytest.fixture(scope="module")
def posed() -> Any:
    """The module that poses the set."""
    return importer("custodio_2013")("custodio_posed")


@pytest.fixture(scope="module")
def reference() -> Iterator[Adapter]:
    """Trilinear cubes through its adapter."""
    adapter = open_adapter("isoref:trilinear-cubes")
    adapter.open(Limits(seconds=60))
    yield adapter
    adapter.close()


def surface(values: Any, method: str = "trilinear-cubes") -> Complex:
    """The method's surface, equal vertices made one."""
    mesh = METHODS[method](Field.of(values), 0.0)
    return Complex.of(mesh.vertices, mesh.simplices).welded()


def grids(number: int, seed: int = 0) -> Any:
    """Random grids of 5^3 samples, high all round."""
    inner = np.random.default_rng(seed).uniform(-1, 1, (number, 3, 3, 3))
    return np.pad(inner, [(0, 0)] + [(1, 1)] * 3, constant_values=1.0)


def test_euler_characteristics_of_posed_cells_are_those_of_the_oracle(posed: Any) -> None:
    """27 random cells at once: only the triangles of the cell itself count."""
    values = np.random.default_rng(1).uniform(-1, 1, (27, 2, 2, 2))
    field = posed.field_of(posed.padded(values), 3)
    found = posed.euler_of_cells(surface(field), 3)
    assert found.tolist() == cells(values).euler.tolist()
    assert len(set(found.tolist())) > 1


def test_pieces_and_handles_of_posed_grids_are_those_of_the_oracle(posed: Any) -> None:
    """27 random closed surfaces at once, among them some with handles."""
    values = grids(27)
    found = posed.betti_of_blocks(surface(posed.field_of(values, 3)), 5, 3)
    truths = [grid(one) for one in values]
    assert found.tolist() == [[t.components, t.components - t.euler // 2] for t in truths]
    assert found[:, 1].max() > 0


def test_a_surface_with_a_border_has_no_handles_to_compare(posed: Any) -> None:
    """The drawings of 1987 leave holes: such a grid is marked, and cannot be right by accident."""
    values = grids(64, 2)
    torn = posed.betti_of_blocks(surface(posed.field_of(values, 4), "lorensen-cline"), 5, 4)
    assert (torn[:, 1] == -1).any()
    assert (torn[:, 1] >= 0).any()


def test_lots_that_are_not_full_are_filled_and_cut(posed: Any, reference: Adapter) -> None:
    """30 grids in lots of 27: the filler is not counted."""
    values = grids(30)
    truths = [grid(one) for one in values]
    betti = np.array([[t.components, t.components - t.euler // 2] for t in truths])
    assert posed.right_grids(reference, values, betti, 3).all()
    wrong = betti + np.array([0, 1])
    assert not posed.right_grids(reference, values, wrong, 3).any()


def test_the_published_numbers_are_those_of_trilinear_cubes_and_the_oracle(
    posed: Any, reference: Adapter, data: Path
) -> None:
    """Every fifth cell and every fifth distinct grid; 2,580 of the 10,000 grids are distinct."""
    published = posed.Published.read(data)
    assert (len(published.grids), int(published.times.sum())) == (2580, 10_000)
    some = slice(None, None, 5)
    values, euler = published.cells[some], published.euler[some]
    assert posed.right_cells(reference, values, euler, 10).all()
    assert (cells(values).euler == euler).all()
    assert posed.right_grids(reference, published.grids[some], published.betti[some], 10).all()


@pytest.mark.parametrize(
    ("name", "by_cells"), [("isoref:trilinear-cubes", True), ("isoref:surface-nets", False)]
)
def test_an_implementation_is_asked_of_cells_where_its_vertices_allow(
    posed: Any, name: str, by_cells: bool
) -> None:
    """A row of the report, of a few cells and grids of ours."""
    reproduce = importer("custodio_2013")("reproduce")
    inner = np.random.default_rng(3).uniform(-1, 1, (8, 2, 2, 2))
    own = grids(8, seed=4)
    betti = np.array([[t.components, t.components - t.euler // 2] for t in map(grid, own)])
    few = posed.Published(inner, cells(inner).euler, own, np.ones(8, np.int64), betti)
    found = reproduce.agreed(name, few)
    assert (found.cells is not None) == by_cells
    if by_cells:
        assert (found.cells, found.distinct) == (8, 8)


def test_critical_points_give_the_published_handles_of_every_grid(posed: Any) -> None:
    """Etiene and others 2012: stratified Morse theory; the grids are high all round."""
    folder = Path(os.environ.get("ISOGRADE_DATA", ""))
    if not (folder / "custodio.npz").is_file():
        pytest.skip("the verification set is absent: set ISOGRADE_DATA to its folder")
    published = posed.Published.read(folder)
    assert len(published.grids) == 2580
    found = [euler(-one) for one in published.grids]
    assert found == (2 * published.betti[:, 0] - 2 * published.betti[:, 1]).tolist()


def as_published(folder: Path, files: Any, cells_: Any, grids_: Any) -> None:
    """A folder of fields and invariants as the set is published."""
    for kind, values, truths in (
        (files.CELLS, cells_, [[x] for x in cells(cells_).euler]),
        (
            files.GRIDS,
            grids_,
            [[t.components, t.components - t.euler // 2] for t in map(grid, grids_)],
        ),
    ):
        name, beside, what = kind
        (folder / name / "Grids").mkdir(parents=True)
        (folder / name / beside).mkdir()
        for number, (one, own) in enumerate(zip(values, truths, strict=True)):
            path = folder / name / "Grids" / f"{number}-scalar_field.iso"
            path.write_bytes(files.written(one))
            told = "\n".join(map(str, own)) + "\n"
            (folder / name / beside / f"{number}-{what}.txt").write_text(told, encoding="utf-8")


@pytest.fixture
def few(tmp_path: Path) -> tuple[Path, Any, Any, Any]:
    """A folder as the set is published, its module, and the cells and grids in it."""
    files = importer("custodio_2013")("custodio_files")
    inner = np.random.default_rng(5).uniform(-1, 1, (12, 2, 2, 2)).astype(np.float32)
    own = grids(3, seed=6).astype(np.float32).astype(np.float64)
    as_published(tmp_path, files, inner.astype(np.float64), own)
    return tmp_path, files, inner, own


def test_the_set_is_read_as_it_is_published(few: Any, posed: Any) -> None:
    """Fields with x fastest, invariants beside them, in the order of their numbers."""
    folder, files, inner, own = few
    assert files.is_set(folder)
    published = posed.Published.read(folder)
    assert (published.cells == inner).all()
    assert published.euler.tolist() == cells(inner.astype(np.float64)).euler.tolist()
    assert len(published.grids) == len(own)
    path = folder / "MarchingCubes_cases" / "Grids" / "3-scalar_field.iso"
    assert np.frombuffer(path.read_bytes(), "<f4")[9 + 1] == inner[3][1, 0, 0]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda p: p.write_bytes(p.read_bytes()[:-4]), "not those of"),
        (lambda p: p.write_bytes(b""), "header"),
        (lambda p: p.write_bytes(p.read_bytes()[:-4] + b"\xff" * 4), "not finite"),
        (lambda p: p.write_bytes(b"\xff" * 36), "not those of"),
    ],
)
def test_a_file_that_is_not_of_the_set_is_named(few: Any, spoil: Any, words: str) -> None:
    """Cut short, empty, no numbers, an absurd header."""
    folder, files, _, _ = few
    spoil(folder / "Closed_Surfaces" / "Grids" / "1-scalar_field.iso")
    with pytest.raises(files.SetError, match=rf"1-scalar_field\.iso.*{words}"):
        files.read_set(folder)


def test_an_invariant_that_is_missing_is_named(few: Any) -> None:
    """Of a grid, two numbers."""
    folder, files, _, _ = few
    told = folder / "Closed_Surfaces" / "InvariantsGrid" / "2-invariant_grid.txt"
    told.write_text("1", encoding="utf-8")
    with pytest.raises(files.SetError, match=r"2-invariant_grid\.txt: 1 whole numbers"):
        files.read_set(folder)
    told.unlink()
    with pytest.raises(files.SetError, match=r"2-invariant_grid\.txt"):
        files.read_set(folder)


def test_the_set_becomes_cases_of_the_grader(few: Any, tmp_path: Path) -> None:
    """`isograde grade --cases`: the same numbers, held to the trilinear topology."""
    _, files, inner, own = few
    path = tmp_path / "custodio.json"
    assert files.write_cases(path, inner[:2].astype(np.float64), own[:1]) == 3
    assert files.write_cases(path, inner[:2].astype(np.float64), own[:1]) == 0
    read = read_cases(path)
    assert [case.id for case in read][-1] == "own/custodio-grid-0"
    assert (read[1].build().values == inner[1]).all()

    def reference(values: Any, isovalue: float, spacing: Any) -> Any:
        mesh = METHODS["trilinear-cubes"](Field.of(values, spacing), isovalue)
        return mesh.vertices, mesh.simplices

    found = verdicts(reference, Declaration("here", level=4), read, "topology.trilinear")
    assert set(found["topology.trilinear"]) == {Verdict.PASS}


def test_meshlab_called_as_it_is_leaves_the_last_cells_out(posed: Any) -> None:
    """Of 27 blocks it draws 8; with two layers of samples more, what the mended call draws."""
    pytest.importorskip("pymeshlab")
    values = np.random.default_rng(7).uniform(-1, 1, (27, 2, 2, 2))
    truths = cells(values).euler
    assert (truths != 0).all()
    right = {}
    for name, margin in (("pymeshlab:raw", 0), ("pymeshlab:raw", 2), ("pymeshlab", 0)):
        adapter = open_adapter(name)
        adapter.open(Limits(seconds=60))
        try:
            found = posed.right_cells(adapter, values, truths, 3, margin)
        finally:
            adapter.close()
        right[name, margin] = found.reshape(3, 3, 3)
    bare = right["pymeshlab:raw", 0]
    assert bare[:2, :2, :2].all()
    assert bare.sum() == 8
    assert (right["pymeshlab:raw", 2] == right["pymeshlab", 0]).all()
    assert posed.MARGINS == {"pymeshlab:raw": 2}
