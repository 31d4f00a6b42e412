"""A surface piece by piece is that of the whole, and no more is read or kept than is said."""

import tracemalloc
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

import isoref.fast.sweep
import numpy as np
import pytest
from isoref.fast.slabs import Slab, slabs
from isoref.fast.sweep import sweep
from isoref.field import Field, FieldError
from isoref.mesh import Mesh
from isoref.methods import RULES
from isoref.sweep import sweep as sweep_plain
from numpy.typing import NDArray

NOISE = np.random.default_rng(20).normal(size=(21, 9, 13))
SHEARED = [[0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [1.0, 0.0, 0.0]]


class Chunked:
    """An array in chunks, which counts how often each plane is read."""

    def __init__(self, values: NDArray[Any], depth: int) -> None:
        self.values, self.chunks = values, (depth, *values.shape[1:])
        self.shape, self.dtype = values.shape, values.dtype
        self.read = np.zeros(len(values), int)
        self.most = 0

    def __getitem__(self, planes: slice) -> NDArray[Any]:
        self.read[planes] += 1
        self.most = max(self.most, len(self.values[planes]))
        return self.values[planes]


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Slabs of two planes, and parts of one, so that little is much."""
    monkeypatch.setattr(isoref.fast.sweep, "SLAB_POINTS", 300)
    monkeypatch.setattr(isoref.fast.sweep, "PART_CELLS", 50)


def joined(pieces: Sequence[Slab]) -> Mesh:
    """One mesh of all pieces."""
    return Mesh(
        np.concatenate([piece.vertices for piece in pieces]),
        np.concatenate([piece.simplices for piece in pieces]),
    )


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_all_pieces_are_the_mesh_of_the_whole_bit_by_bit(rule: str, precision: Any) -> None:
    """Issue "Faster than every library": identical to the whole, for every rule."""
    field = Field.of(NOISE, (0.7, 1, 3), (5, 0.1, -2))
    whole = sweep(RULES[rule], field, 0.2, precision)
    pieces = list(
        slabs(NOISE, 0.2, field.spacing, field.origin, rule=RULES[rule], precision=precision)
    )
    assert len(pieces) > 10
    mesh = joined(pieces)
    assert mesh.vertices.dtype == whole.vertices.dtype
    assert mesh.vertices.tobytes() == whole.vertices.tobytes()
    assert mesh.simplices.tobytes() == whole.simplices.tobytes()
    assert [piece.first for piece in pieces] == np.cumsum(
        [0, *(len(piece.vertices) for piece in pieces[:-1])]
    ).tolist()


def test_pieces_stand_where_the_volume_stands() -> None:
    """With directions, left-handed too: triangles are turned over as those of the whole are."""
    field = Field.of(NOISE, 2, (1, 2, 3), directions=SHEARED)
    whole = sweep(RULES["trilinear-cubes"], field, 0.2)
    pieces = slabs(NOISE, 0.2, 2, (1, 2, 3), directions=SHEARED, rule=RULES["trilinear-cubes"])
    mesh = joined(list(pieces))
    assert field.handedness == -1
    assert np.array_equal(mesh.vertices, whole.vertices)
    assert np.array_equal(mesh.simplices, whole.simplices)


@pytest.mark.parametrize("depth", [1, 4, 5, 20, 21, 64])
def test_a_chunk_is_read_once(depth: int) -> None:
    """However slabs lie across the chunks of a file; and no more than a chunk at a time."""
    source = Chunked(NOISE, depth)
    mesh = joined(list(slabs(source, 0.2)))
    assert source.read.tolist() == [1] * 21
    assert source.most <= depth
    assert (
        mesh.vertices.tobytes()
        == sweep(RULES["asymptotic-decider"], Field.of(NOISE), 0.2).vertices.tobytes()
    )


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("kind", ["<f4", ">f4", "uint8"])
def test_a_file_that_is_mapped_is_not_read_at_once(tmp_path: Path, order: Any, kind: str) -> None:
    values = (NOISE * 40 + 100).astype(kind, order=order)
    np.save(tmp_path / "volume.npy", values)
    mapped = np.load(tmp_path / "volume.npy", mmap_mode="r")
    mesh = joined(list(slabs(mapped, 103.5)))
    whole = sweep(RULES["asymptotic-decider"], Field.of(values), 103.5)
    assert len(mesh.simplices) > 1000
    assert mesh.vertices.tobytes() == whole.vertices.tobytes()


def test_neither_the_volume_nor_the_mesh_has_to_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Issue "Faster than every library": bounded memory, whatever the mesh takes."""
    monkeypatch.undo()
    side = 200
    mapped = np.lib.format.open_memmap(
        tmp_path / "gyroid.npy", mode="w+", dtype=np.uint8, shape=(side,) * 3
    )
    wave = np.linspace(0, 40 * np.pi, side)
    sine, cosine = np.sin(wave), np.cos(wave)
    for i in range(side):
        plane = sine[i] * cosine[:, None] + np.outer(sine, cosine) + sine * cosine[i]
        mapped[i] = plane * 40 + 128
    tracemalloc.start()
    size = vertices = 0
    for piece in slabs(mapped, 127.5):
        size += piece.vertices.nbytes + piece.simplices.nbytes
        vertices += len(piece.vertices)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert vertices > 1_000_000
    assert size > 3 * peak


def test_a_sample_that_is_not_finite_is_named_when_its_plane_is_read() -> None:
    """The pieces before it came; which sample it is counts from the first of the volume."""
    values = NOISE.copy()
    values[17, 3, 4] = np.nan
    came = []
    with pytest.raises(FieldError, match=r"sample \(17, 3, 4\) is nan"):
        came += list(slabs(Chunked(values, 3), 0.2))
    pieces = slabs(values, 0.2)
    assert len(next(pieces).vertices)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.zeros((3, 3)), "three axes"),
        (np.zeros((3, 0, 3)), "no samples"),
        (np.zeros((3, 3, 3), complex), "real numbers"),
    ],
)
def test_what_is_no_volume_is_refused_at_once(values: NDArray[Any], said: str) -> None:
    with pytest.raises(FieldError, match=said):
        slabs(values, 0.5)
    with pytest.raises(FieldError, match="isovalue"):
        slabs(NOISE, float("nan"))
    with pytest.raises(FieldError, match="spacing"):
        slabs(NOISE, 0.5, (1, 2))


@pytest.mark.parametrize("shape", [(1, 4, 4), (4, 1, 4), (2, 2, 2), (1, 1, 1)])
def test_thin_volumes_have_the_pieces_they_have(shape: tuple[int, int, int]) -> None:
    values = np.arange(np.prod(shape), dtype=float).reshape(shape)
    pieces = list(slabs(values, 2.5))
    assert bool(pieces) == (min(shape) >= 2)


def test_surfaces_that_are_drawn_at_the_same_time_do_not_disturb_each_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Small volumes are swept in arrays that are kept between calls; each call has its own."""
    monkeypatch.setattr(isoref.fast.sweep, "PART_CELLS", 50)
    volumes = [np.random.default_rng(seed).normal(size=(9, 8, 7)) for seed in range(5)]
    apart = [list(slabs(volume, 0.1)) for volume in volumes]
    at_once = list(zip_longest(*(slabs(volume, 0.1) for volume in volumes)))
    assert len(at_once) > 3
    for volume, whole, pieces in zip(volumes, apart, zip(*at_once, strict=True), strict=True):
        for one, same in zip_longest(whole, filter(None, pieces)):
            assert np.array_equal(one.vertices, same.vertices)
            assert np.array_equal(one.simplices, same.simplices)
        plain = sweep_plain(RULES["asymptotic-decider"], Field.of(volume), 0.1)
        found = np.concatenate([piece.vertices for piece in whole])
        assert sorted(found.tolist()) == sorted(plain.vertices.tolist())
