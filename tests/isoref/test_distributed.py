"""Blocks that know nothing of one another make the mesh of the whole."""

import os
import signal
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from isoref.distributed import blocks, extract, piece, start_of, welded
from isoref.field import Field, FieldError
from isoref.mesh import Mesh
from isoref.methods import RULES
from isoref.methods import extract as extract_whole

NOISE = np.random.default_rng(4).normal(size=(11, 9, 10))


def parts(n: int) -> st.SearchStrategy[tuple[int, ...]]:
    """The ways to cut an axis of n samples."""
    cuts = st.sets(st.integers(1, n - 1))
    return cuts.map(lambda found: tuple(b - a for a, b in pairwise([0, *sorted(found), n])))


def in_blocks(values: Any, isovalue: float, chunks: Any, method: str, **place: Any) -> Mesh:
    """The mesh of all blocks, each extracted from its own samples alone."""
    return welded(
        [
            piece(
                values[where].copy(),
                isovalue,
                values.shape,
                start_of(where),
                **place,
                method=method,
            )
            for where in blocks(values.shape, chunks)
        ]
    )


def assert_same(a: Mesh, b: Mesh) -> None:
    """Both are one mesh, bit by bit, up to the order of vertices and triangles."""
    a, b = a.canonical(), b.canonical()
    assert a.vertices.tobytes() == b.vertices.tobytes()
    assert a.simplices.tobytes() == b.simplices.tobytes()


@pytest.mark.parametrize("method", RULES)
@settings(max_examples=15, deadline=None, derandomize=True)
@given(chunks=st.tuples(parts(11), parts(9), parts(10)))
def test_blocks_make_the_mesh_of_the_whole_for_every_rule(method: str, chunks: Any) -> None:
    """Issue "Faster than every library": closed and identical, however the volume is cut."""
    place: dict[str, Any] = {"spacing": (0.7, 1.1, 3), "origin": (5, 0.1, -2)}
    whole = extract_whole(NOISE, 0.2, method=method, **place)
    assert_same(in_blocks(NOISE, 0.2, chunks, method, **place), whole)


@pytest.mark.parametrize("kind", ["uint8", "int64", ">i2", "float32"])
def test_ties_and_types_are_welded_alike(kind: str) -> None:
    """Samples on the isovalue give crossings at one place that are no one vertex."""
    values = np.random.default_rng(5).integers(0, 4, NOISE.shape).astype(kind)
    whole = extract_whole(values, 2)
    halves = ((5, 6), (4, 5), (3, 7))
    mesh = in_blocks(values, 2, halves, "asymptotic-decider")
    assert len(mesh.vertices) == len(whole.vertices)
    assert mesh.vertices[mesh.simplices].shape == whole.vertices[whole.simplices].shape
    came, right = (np.sort(m.vertices[m.simplices].reshape(-1, 9), axis=0) for m in (mesh, whole))
    assert np.array_equal(came, right)


def test_what_is_no_volume_in_chunks_is_refused() -> None:
    with pytest.raises(FieldError, match=r"chunks \(5, 5\) do not fill an axis of 11 samples"):
        blocks((11, 2, 2), ((5, 5), (2,), (2,)))
    assert blocks((1, 5, 5), ((1,), (5,), (5,))) == []
    assert len(welded([]).simplices) == 0


dask: Any = pytest.importorskip("dask")
arrays: Any = pytest.importorskip("dask.array")


@pytest.mark.parametrize("chunks", [(4, 5, 3), (11, 9, 10), (1, 2, 10)])
def test_a_dask_array_gives_the_mesh_of_its_samples(chunks: tuple[int, ...]) -> None:
    """Left-handed and oblique too."""
    directions = [[0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [1.0, 0.0, 0.0]]
    array = arrays.from_array(NOISE, chunks=chunks)
    field = Field.of(NOISE, 2, (1, 2, 3), directions=directions)
    assert field.handedness == -1
    mesh = extract(array, 0.3, 2, (1, 2, 3), directions=directions, method="trilinear-cubes")
    whole = extract_whole(NOISE, 0.3, 2, (1, 2, 3), directions=directions, method="trilinear-cubes")
    assert_same(mesh, whole)


def test_what_cannot_be_extracted_is_told_before_anything_is_computed() -> None:
    array = arrays.from_array(NOISE, chunks=4)
    with pytest.raises(ValueError, match="no cube rule 'surface-nets'"):
        extract(array, 0.3, method="surface-nets")
    with pytest.raises(FieldError, match="three axes"):
        extract(array[0], 0.3)
    with pytest.raises(FieldError, match="isovalue nan"):
        extract(array, float("nan"))
    with pytest.raises(FieldError, match="spacing"):
        extract(array, 0.3, -1)
    holed = NOISE.copy()
    holed[7, 3, 3] = np.inf
    with pytest.raises(FieldError, match=r"sample \(3, 3, 3\) is inf"):
        extract(arrays.from_array(holed, chunks=(4, 9, 10)), 0.3)


def killing(samples: Any, flag: str) -> Any:
    """The samples; the first who is asked for them after the flag was raised is killed."""
    try:
        os.unlink(flag)
    except FileNotFoundError:
        return samples
    os.kill(os.getpid(), signal.SIGKILL)
    return samples


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_worker_killed_in_the_middle_costs_nothing_but_time(client: Any, tmp_path: Any) -> None:
    """Issue "Faster than every library": its blocks are done by another."""
    flag = tmp_path / "kill one of you"
    flag.touch()
    array = arrays.from_array(NOISE, chunks=(3, 4, 5)).map_blocks(
        killing, str(flag), dtype=NOISE.dtype, meta=np.empty((0, 0, 0))
    )
    mesh = extract(array, 0.2)
    assert not flag.exists()
    assert_same(mesh, extract_whole(NOISE, 0.2))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_the_command_has_its_volume_extracted_by_a_cluster(client: Any, tmp_path: Any) -> None:
    """Workers read the chunks of a store; an address at which nobody answers is told."""
    runner: Any = pytest.importorskip("typer.testing")
    zarr: Any = pytest.importorskip("zarr")
    command: Any = pytest.importorskip("isograde.command")
    array = zarr.create_array(
        tmp_path / "volume.zarr", shape=NOISE.shape, chunks=(4, 4, 4), dtype=NOISE.dtype
    )
    array[:] = NOISE
    words = ["extract", str(tmp_path / "volume.zarr"), "--isovalue", "0.2"]
    out = ["-o", str(tmp_path / "mesh.npz")]
    address = client.scheduler.address
    done = runner.CliRunner().invoke(command.app, [*words, *out, "--dask", address])
    assert done.exit_code == 0, done.output
    whole = runner.CliRunner().invoke(command.app, [*words, "-o", str(tmp_path / "whole.npz")])
    assert whole.exit_code == 0
    with np.load(tmp_path / "mesh.npz") as came, np.load(tmp_path / "whole.npz") as right:
        assert_same(Mesh(came["vertices"], came["faces"]), Mesh(right["vertices"], right["faces"]))
    nobody = runner.CliRunner().invoke(command.app, [*words, *out, "--dask", "nowhere"])
    assert nobody.exit_code == 2
    assert "no dask scheduler answers at nowhere" in " ".join(nobody.output.split())
    capped = runner.CliRunner().invoke(command.app, [*words, "--cap", "--dask", address])
    assert "--dask takes isovalues" in " ".join(capped.output.split())
