"""The vectorised sweep gives the mesh of the article, whatever the samples and their layout."""

import tracemalloc
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import isoref.fast.sweep
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isoref.fast._fans import BLOCK
from isoref.fast.sweep import sweep
from isoref.field import Array, Field, FieldError
from isoref.mesh import Mesh, number_types
from isoref.methods import RULES
from isoref.rule import Rule, Tile
from isoref.sweep import sweep as sweep_plain

Carry = Callable[[Rule, Field, float], Mesh]


def assert_same(a: Mesh, b: Mesh) -> None:
    """Both meshes are equal, number for number, up to the numbering of vertices."""
    a, b = a.canonical(), b.canonical()
    assert np.array_equal(a.vertices, b.vertices)
    assert np.array_equal(a.simplices, b.simplices)


def corners(mesh: Mesh) -> list[list[float]]:
    """The nine coordinates of each triangle's corners."""
    listed: list[list[float]] = mesh.vertices[mesh.simplices].reshape(-1, 9).tolist()
    return listed


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
@pytest.mark.parametrize("shape", [(2, 2, 2), (3, 2, 2), (5, 6, 7), (4, 9, 3)])
@pytest.mark.parametrize("slab_points", [10, 130, 1 << 20])
def test_both_sweeps_give_the_same_mesh_on_noise(
    rule: Rule, shape: tuple[int, int, int], slab_points: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every fast path has a plain twin; wherever slabs and blocks of cells are cut."""
    monkeypatch.setattr(isoref.fast.sweep, "SLAB_POINTS", slab_points)
    monkeypatch.setattr(isoref.fast.sweep, "PART_CELLS", min(slab_points, 1 << 14))
    values = np.random.default_rng(7).normal(size=shape)
    field = Field.of(values, spacing=(1, 2, 0.5), origin=(3, -1, 2))
    assert_same(sweep(rule, field, 0.1), sweep_plain(rule, field, 0.1))


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
@given(
    values=hnp.arrays(
        st.sampled_from([np.uint8, np.int16, np.float32]),
        st.tuples(*[st.integers(2, 4)] * 3),
        elements=st.integers(0, 3),
    ),
    isovalue=st.sampled_from([0, 1, 1.5, 2, 3, 4]),
)
@settings(max_examples=40)
def test_both_sweeps_put_every_triangle_in_place_with_ties(
    rule: Rule, values: Array, isovalue: float
) -> None:
    """Samples on the isovalue and integer types are no exception.

    Vertices may coincide there, so triangles are compared by their corners' positions.
    """
    field = Field.of(values)
    fast, plain = sweep(rule, field, isovalue), sweep_plain(rule, field, isovalue)
    assert len(fast.vertices) == len(plain.vertices)
    assert sorted(map(tuple, corners(fast))) == sorted(map(tuple, corners(plain)))


KINDS = ["f2", "f4", "f8", ">f4", "u1", "i2", "i8", "u8", "?"]


@settings(max_examples=80, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_both_sweeps_agree_on_any_volume(seed: int) -> None:
    """Any shape, type, layout, rule, slabs and parts; whole numbers past 2^53; ties everywhere."""
    rng = np.random.default_rng(seed)
    shape = rng.permutation([*rng.integers(1, 6, 2), rng.integers(1, 18)])
    kind = str(rng.choice(KINDS))
    values = (rng.normal(size=shape) if "f" in kind else rng.integers(0, 4, shape)).astype(kind)
    large = 2**53 if kind == "i8" and rng.random() < 0.5 else 0
    values = values + values.dtype.type(large) if large else values
    values = np.asfortranarray(values) if rng.random() < 0.3 else values
    values = values[::-1] if rng.random() < 0.3 else values
    field = Field.of(values, rng.choice([1, 0.5, 2], 3).tolist(), rng.choice([0, -3], 3).tolist())
    isovalue = float(large + rng.choice([0, 0.5, 1, 2, 3]))
    rule = RULES[str(rng.choice(list(RULES)))]
    with patch.multiple(
        isoref.fast.sweep,
        SLAB_POINTS=int(rng.choice([1, 50, 300, 1 << 20])),
        PART_CELLS=int(rng.choice([1, 20, 1 << 15])),
        CHUNK_POINTS=int(rng.choice([1, 64, 1 << 17])),
    ):
        fast = sweep(rule, field, isovalue, provenance=True)
        cells = fast.traced().cells
        free = sweep(rule, field, isovalue)
    plain = sweep_plain(rule, field, isovalue, provenance=True)
    same_cells = plain.traced().cells
    assert np.array_equal(cells, same_cells)
    assert len(fast.vertices) == len(free.vertices) == len(plain.vertices)
    assert sorted(corners(fast)) == sorted(corners(free)) == sorted(corners(plain))


@pytest.mark.parametrize("slab_points", [150, 1 << 20])
def test_layout_and_byte_order_make_no_difference(
    slab_points: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same samples give the same arrays, however they lie in memory."""
    monkeypatch.setattr(isoref.fast.sweep, "SLAB_POINTS", slab_points)
    plain = np.random.default_rng(11).normal(size=(7, 9, 10)).astype(np.float32)
    spread = np.zeros((14, 9, 20), np.float32)
    spread[::2, :, ::2] = plain
    rule = RULES["marching-vesta-mixed-H"]
    mesh = sweep(rule, Field.of(plain), 0.1)
    for same in (np.asfortranarray(plain), plain.astype(">f4"), spread[::2, :, ::2]):
        other = sweep(rule, Field.of(same), 0.1)
        assert np.array_equal(mesh.vertices, other.vertices)
        assert np.array_equal(mesh.simplices, other.simplices)


def test_a_part_may_end_at_any_plane(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the slabs and parts, one and the same mesh: nothing is lost or doubled between."""
    values = np.random.default_rng(5).normal(size=(13, 7, 9))
    field, rule = Field.of(values), RULES["marching-vesta-mixed-H"]
    whole = sweep(rule, field, 0.1)
    assert len(whole.simplices) > 1000
    for slab_points, part_cells in ((1, 1), (112, 1 << 20), (700, 40), (1 << 20, 1), (400, 100)):
        monkeypatch.setattr(isoref.fast.sweep, "SLAB_POINTS", slab_points)
        monkeypatch.setattr(isoref.fast.sweep, "PART_CELLS", part_cells)
        monkeypatch.setattr(isoref.fast.sweep, "CHUNK_POINTS", slab_points // 3)
        assert_same(sweep(rule, field, 0.1), whole)


@pytest.mark.parametrize("rows", [2, 7, 8, 9, 16, 63, 64, 65])
def test_rows_of_any_length_are_padded_to_bytes(rows: int) -> None:
    """Bits are packed eight at a time; the last ones of a row have no neighbour in the next."""
    values = np.random.default_rng(rows).normal(size=(3, 3, rows))
    rule = RULES["trilinear-cubes"]
    for shape in ((3, 3, rows), (3, rows, 3), (rows, 3, 3)):
        field = Field.of(values.reshape(shape))
        assert_same(sweep(rule, field, 0.1), sweep_plain(rule, field, 0.1))


def test_single_precision_is_the_mesh_rounded() -> None:
    """The same triangles, positions computed in double precision and rounded once."""
    field = Field.of(np.random.default_rng(5).normal(size=(6, 7, 9)), (0.1, 2, 3), (1, 2, 3))
    for name in ("asymptotic-decider", "marching-vesta-mixed-H", "trilinear-cubes"):
        double, single = (sweep(RULES[name], field, 0.1, p) for p in ("double", "single"))
        assert [str(a.dtype) for a in (single.vertices, single.simplices)] == ["float32", "int32"]
        assert np.array_equal(single.vertices, double.vertices.astype(np.float32))
        assert np.array_equal(single.simplices, double.simplices)
    with pytest.raises(FieldError, match="precision 'half' is not one of single, double"):
        sweep(RULES["lorensen-cline"], field, 0.1, "half")  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("at", [1 << 19, (1 << 19) + 60])
def test_a_volume_of_more_than_2_to_the_31_samples_is_right_where_numbers_are_large(
    at: int,
) -> None:
    """Issue 13: numbers of cells past 2^31. One plane, of a volume that takes no memory."""
    line = np.zeros((1 << 19) + 64, np.uint8)
    line[at + 1 :] = 4
    values = np.broadcast_to(line[:, None, None], (len(line), 64, 64))
    assert values.size > 1 << 31
    mesh = sweep(RULES["asymptotic-decider"], Field.of(values), 1.0, provenance=True)
    cells = mesh.traced().cells
    assert (len(mesh.vertices), len(mesh.simplices)) == (64 * 64, 2 * 63 * 63)
    assert (mesh.vertices[:, 0] == at + 0.25).all()
    assert np.array_equal(np.unique(mesh.vertices[:, 1:]), np.arange(64))
    assert np.array_equal(np.unique(cells), at * 63 * 63 + np.arange(63 * 63))


def test_the_numbers_of_vertices_may_pass_2_to_the_31(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slab numbers its vertices from the slab before on, so only the mesh has large numbers."""
    monkeypatch.setattr(isoref.fast.sweep, "SLAB_POINTS", 200)
    field, rule = Field.of(np.random.default_rng(5).normal(size=(9, 7, 8))), RULES["lorensen-cline"]
    made = isoref.fast.sweep._Sweep(rule, field, 0.1, "double", traced=False)
    made.mesh()
    assert made.vertex_of.dtype == np.int32
    assert made.offset > 0
    assert made.triangles.array.dtype == np.int64
    with pytest.raises(FieldError, match="vertices are too many for int32"):
        number_types("single", (1 << 31) + 1)


def test_a_mapped_volume_is_read_in_bounded_memory(tmp_path: Path) -> None:
    """A volume on disk: besides the mesh, no more than 25 MiB, and the same mesh."""
    place = tmp_path / "volume.raw"
    x = np.linspace(-1, 1, 300)
    ball = (x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None] ** 2) * 80
    ball.astype(np.uint8).tofile(place)
    mapped = np.memmap(place, np.uint8, "r", shape=(300, 300, 300))
    tracemalloc.start()
    mesh = sweep(RULES["asymptotic-decider"], Field.of(mapped), 40.0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(mesh.simplices) > 100_000
    # What is reserved counts here, written or not: at most half as much again as the mesh.
    assert peak < 2.5 * (mesh.vertices.nbytes + mesh.simplices.nbytes) + (25 << 20)
    same = sweep(RULES["asymptotic-decider"], Field.of(np.array(mapped)), 40.0)
    assert np.array_equal(mesh.vertices, same.vertices)
    assert np.array_equal(mesh.simplices, same.simplices)


def test_threads_may_sweep_and_learn_at_once() -> None:
    """A promise of the package: concurrent calls give the same answer."""
    fields = [Field.of(np.random.default_rng(n).normal(size=(6, 7, 8))) for n in range(12)]
    rule = replace(RULES["trilinear-cubes"], name="trilinear-cubes, not yet learned")
    with ThreadPoolExecutor(6) as pool:
        found = list(pool.map(lambda field: sweep(rule, field, 0.0), fields))
    for field, mesh in zip(fields, found, strict=True):
        same = sweep(RULES["trilinear-cubes"], field, 0.0)
        assert_same(mesh, same)


def test_tiles_are_asked_for_once() -> None:
    """What was learned of a rule is kept for the next call; a new rule is learned anew."""
    asked: list[int] = []

    def tile(signs: int, decisions: int) -> Tile:
        asked.append(signs)
        return RULES["lorensen-cline"].tile(signs, decisions)

    field = Field.of(np.random.default_rng(1).normal(size=(9, 9, 9)))
    rule = Rule("counting", tile)
    sweep(rule, field, 0.0)
    assert len(asked) == len(set(asked)) > 100
    before = len(asked)
    sweep(rule, field, 0.0)
    assert len(asked) == before


@pytest.mark.parametrize("name", ["asymptotic-decider", "marching-vesta-mixed-H"])
def test_more_fans_than_a_block_holds_are_drawn_all(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Fans of one kind are drawn block by block; in small parts no kind fills a block."""
    field = Field.of(np.random.default_rng(2).normal(size=(34, 35, 36)))
    whole = sweep(RULES[name], field, 0.1)
    assert len(whole.simplices) > 10 * BLOCK
    monkeypatch.setattr(isoref.fast.sweep, "PART_CELLS", BLOCK // 4)
    assert_same(sweep(RULES[name], field, 0.1), whole)


def test_the_arrays_do_not_depend_on_earlier_calls() -> None:
    """Tiles are learned in the order in which volumes come; rows stand in an order of their own."""
    first, second = (
        Field.of(np.random.default_rng(seed).normal(size=(7, 8, 9))) for seed in (1, 2)
    )
    for name in ("trilinear-cubes", "marching-vesta-mixed-H"):
        fresh, used = (replace(RULES[name], name=f"{name}, {which}") for which in ("a", "b"))
        sweep(used, first, 0.0)
        mesh, same = sweep(fresh, second, 0.0), sweep(used, second, 0.0)
        assert np.array_equal(mesh.vertices, same.vertices)
        assert np.array_equal(mesh.simplices, same.simplices)


def test_triangles_come_in_the_order_of_their_cells() -> None:
    """The provenance names for each triangle the cell that holds its vertices."""
    values = np.random.default_rng(3).normal(size=(5, 4, 6))
    mesh = sweep(RULES["asymptotic-decider"], Field.of(values), 0.0, provenance=True)
    cells = mesh.traced().cells
    assert len(cells) > 100
    assert np.all(np.diff(cells) >= 0)
    assert np.array_equal(
        cells,
        sweep_plain(RULES["asymptotic-decider"], Field.of(values), 0.0, provenance=True)
        .traced()
        .cells,
    )
    low = np.stack(np.unravel_index(cells, (4, 3, 5)), axis=1)[:, None]
    points = mesh.vertices[mesh.simplices]
    assert np.all((low <= points) & (points <= low + 1))


@pytest.mark.parametrize("isovalue", [-1e9, 1e9, 300])
def test_an_isovalue_out_of_range_gives_an_empty_mesh(isovalue: float) -> None:
    """Design: an isovalue outside the range is no error."""
    field = Field.of(np.arange(8, dtype=np.uint8).reshape(2, 2, 2))
    mesh = sweep(RULES["asymptotic-decider"], field, isovalue)
    assert mesh.vertices.shape == (0, 3)
    assert mesh.simplices.shape == (0, 3)


@pytest.mark.parametrize("shape", [(1, 5, 5), (5, 1, 5), (1, 1, 1)])
def test_a_lattice_one_sample_thick_has_no_cells(shape: tuple[int, int, int]) -> None:
    """No cell, no surface."""
    field = Field.of(np.random.default_rng(0).normal(size=shape))
    for make in (sweep, sweep_plain):
        assert len(make(RULES["asymptotic-decider"], field, 0).simplices) == 0


@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_a_field_that_is_no_volume_is_refused(carry: Carry) -> None:
    """Wrong rank: a clear error."""
    with pytest.raises(FieldError, match="3-D lattice"):
        carry(RULES["asymptotic-decider"], Field.of(np.zeros((3, 3))), 0)


@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_an_isovalue_that_is_no_number_is_refused(carry: Carry) -> None:
    """NaN: a clear error."""
    with pytest.raises(FieldError, match="not finite"):
        carry(RULES["asymptotic-decider"], Field.of(np.zeros((3, 3, 3))), float("nan"))


@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_one_component_may_have_an_axis_of_its_own(carry: Carry) -> None:
    """A scalar field may come as (1, N1, N2, N3): it is the same volume."""
    values = np.random.default_rng(3).normal(size=(3, 4, 5))
    rule = RULES["asymptotic-decider"]
    mesh, same = (
        carry(rule, Field.of(values), 0),
        carry(rule, Field.of(values[None], dimension=3), 0),
    )
    assert len(mesh.simplices) > 20
    assert_same(mesh, same)


def test_integers_beyond_what_a_float_holds_are_compared_exactly() -> None:
    """2^53 + 3 is below 2^53 + 4, though as a float it is not: outside, for both."""
    values = np.full((3, 3, 3), 2**53)
    values[1, 1, 1] = 2**53 + 3
    rule = RULES["asymptotic-decider"]
    for carry in (sweep, sweep_plain):
        assert len(carry(rule, Field.of(values), float(2**53 + 4)).simplices) == 0
    values[1, 1, 1] = 2**53 + 4
    values[1, 1, 2] = 2**53 + 3
    for carry in (sweep, sweep_plain):
        mesh = carry(rule, Field.of(values), float(2**53 + 4))
        assert len(mesh.simplices) == 8
        assert np.isfinite(mesh.vertices).all()
    values[1, 1, 1:] = 2**53 + 5, 2**53
    fast, plain = (
        carry(rule, Field.of(values), float(2**53 + 4)) for carry in (sweep, sweep_plain)
    )
    assert len(fast.simplices) == 8
    assert sorted(corners(fast)) == sorted(corners(plain))


@pytest.mark.parametrize("size", [1.7e308, 1e-300, 2.0**-1000])
@pytest.mark.parametrize("carry", [sweep, sweep_plain])
def test_vertices_do_not_move_where_values_are_huge_or_tiny(carry: Carry, size: float) -> None:
    """The difference of two samples may overflow: the crossing is still halfway to the sample."""
    values = np.where(np.indices((3, 4, 3)).sum(axis=0) % 3, -1.0, 1.0) * [1.0, 0.5, 0.25]
    rule = RULES["asymptotic-decider"]
    plain = carry(rule, Field.of(values), 0.0)
    scaled = carry(rule, Field.of(values * size), 0.0)
    assert len(plain.vertices) > 10
    assert np.allclose(scaled.vertices, plain.vertices, rtol=0, atol=1e-12)


def test_of_a_folded_slab_the_table_of_vertices_is_written_for_one_part_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Places of a part are counted from its own first plane: memory that is never written."""
    module = isoref.fast.sweep
    rooms = []

    class Room(module._Room):
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments)
            self.vertex_of[:] = -7
            rooms.append(self)

    monkeypatch.setattr(module, "_Room", Room)
    monkeypatch.setattr(module, "_rooms", deque(maxlen=4))
    monkeypatch.setattr(module, "PART_CELLS", 1)
    field = Field.of(np.random.default_rng(5).normal(size=(30, 8, 8)))
    mesh = sweep(RULES["asymptotic-decider"], field, 0.1)
    written = (rooms[0].vertex_of != -7).reshape(-1, 3 * 64).any(axis=1)
    assert len(mesh.vertices) > 1000
    assert written.tolist() == [True] * 2 + [False] * 28
