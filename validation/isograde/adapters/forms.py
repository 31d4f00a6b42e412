"""Answers in the forms people write them, as vertices and simplices.

Of a kind (n, m) an answer has simplices of dimension k = n - m in n dimensions. It may be

a pair            ``(vertices, simplices)``, a tuple: (V, n) numbers and (S, k + 1) 0-based indices
with normals      for k = 2, ``(vertices, simplices, normals)``, and whatever comes after: a
                  normal for each vertex, as scikit-image returns them
with directions   for k = 1, ``(vertices, simplices, directions)``: at each vertex along the curve,
                  as long as the confidence in it, 0 to 1
polygons          for k = 2, the pair with rows of p > 3 corners, those with fewer filled up with
                  -1 at their end, or a list of rows of different lengths
polylines         for k = 1, a list of (N, n) arrays; a closed one repeats its first point
a soup            one array (S, k + 1, n): each simplex with corners of its own
points            for k = 0, one array (V, n)
an object         with ``vertices`` and ``simplices`` or ``faces``, as trimesh's and our meshes

Polygons are cut into triangles from their first corner: (a, b, c, d) into (a, b, c) and (a, c, d).

What belongs to a form is checked here, and a fault of it names the part and its number. What can be
said of every mesh (shapes, types, range of the indices) is left for the claims to judge: arrays of
numbers pass as they came.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from isograde.model import Kind, Status

Arrays = tuple[NDArray[Any], NDArray[Any]]

# Fill a row of a polygon with fewer corners than the others.
NO_CORNER = -1
LARGEST = np.iinfo(np.int64).max


class AnswerError(ValueError):
    """The answer cannot be judged; `status` says whether it is garbage or too large."""

    def __init__(self, detail: str, status: Status = Status.GARBAGE):
        super().__init__(detail)
        self.status = status


def arrays_from(answer: object, kind: Kind) -> Arrays:
    """Vertices and simplices of an answer in any form; raises `AnswerError`.

    >>> arrays_from(([[0, 0, 0]] * 4, [[0, 1, 2, 3]]), Kind(3, 1))[1].tolist()
    [[0, 1, 2], [0, 2, 3]]
    >>> arrays_from([[[0, 0], [1, 0], [0, 1], [0, 0]]], Kind(2, 1))[1].tolist()
    [[0, 1], [1, 2], [2, 0]]
    >>> arrays_from("done", Kind(3, 1))
    Traceback (most recent call last):
    isograde.adapters.forms.AnswerError: returned str, not vertices and simplices
    """
    parts = tried("the answer", lambda: _parts(answer))
    if parts is None and normals_in(answer, kind) is not None:
        assert isinstance(answer, tuple)
        parts = answer[0], answer[1]
    if parts is not None:
        return from_pair(parts[0], parts[1], kind)
    if isinstance(answer, list | tuple):
        if len(answer) == 2 and (isinstance(answer, tuple) or kind.k != 1):
            return from_pair(answer[0], answer[1], kind)
        if kind.k == 1:
            return tried("the answer", lambda: from_polylines(answer, kind))  # type: ignore[no-any-return]
        return from_array(_numbers("the answer", answer), kind, f"a {_told(answer)}")
    if isinstance(answer, np.ndarray):
        return from_array(_numbers("the answer", answer), kind, "an array")
    raise AnswerError(f"returned {_told(answer)}, not vertices and simplices")


def normals_in(answer: object, kind: Kind) -> NDArray[Any] | None:
    """(V, n) the normals, or the directions of curves, beside vertices and simplices; else None.

    >>> normals_in((np.zeros((3, 3)), np.array([[0, 1, 2]]), np.ones((3, 3))), Kind(3, 1)).shape
    (3, 3)
    >>> normals_in((np.zeros((3, 3)), np.zeros((3, 3)), np.ones((3, 3))), Kind(3, 1)) is None
    True
    """
    if not isinstance(answer, tuple) or len(answer) < 3 or kind.k not in (1, 2):
        return None
    try:
        points, rows, normals = (np.asarray(part) for part in answer[:3])
    except Exception:  # noqa: BLE001 - what is no array is told of where the answer is read
        return None
    shaped = points.ndim == rows.ndim == 2 and normals.shape == points.shape
    # Three triangles with corners of their own are no normals.
    typed = points.dtype.kind == normals.dtype.kind == "f" and rows.dtype.kind in "iu"
    return normals if shaped and typed else None


def _parts(answer: Any) -> tuple[Any, Any] | None:
    """The vertices and simplices of an object that has such attributes; None for any other."""
    for name in ("simplices", "faces"):
        if hasattr(answer, "vertices") and hasattr(answer, name):
            return answer.vertices, getattr(answer, name)
    return None


def _told(answer: object) -> str:
    """The type of an answer, with its length where that matters."""
    sized = isinstance(answer, list | tuple)
    return type(answer).__name__ + (f" of {len(answer)}" if sized else "")  # type: ignore[arg-type]


def from_pair(vertices: object, simplices: object, kind: Kind) -> Arrays:
    """A pair with its polygons, if any, cut into triangles; raises `AnswerError`."""
    places = _numbers("vertices", vertices)
    rows = _rows(simplices, kind)
    # A list without rows cannot say how long its rows are.
    if isinstance(vertices, Sequence) and not len(vertices):
        places = np.empty((0, kind.n))
    if isinstance(simplices, Sequence) and not len(simplices):
        rows = np.empty((0, kind.k + 1), np.int64)
    return places, rows


def _rows(simplices: object, kind: Kind) -> NDArray[Any]:
    """The simplices, polygons cut into triangles; raises `AnswerError`."""
    if kind.k == 2 and _ragged(simplices):
        return tried("simplices", lambda: _of_ragged(simplices))  # type: ignore[arg-type, no-any-return]
    rows = _numbers("simplices", simplices)
    if kind.k == 2 and rows.ndim == 2 and rows.shape[1] > 3:
        return tried("simplices", lambda: triangles(rows))  # type: ignore[no-any-return]
    return rows


def _ragged(rows: object) -> bool:
    """Whether these are rows, not all of one length."""
    if isinstance(rows, np.ndarray):
        rows = list(rows) if rows.dtype == object and rows.ndim == 1 else []
    sized = isinstance(rows, list | tuple) and all(hasattr(row, "__len__") for row in rows)
    return sized and len({len(row) for row in rows}) > 1  # type: ignore[attr-defined]


def _of_ragged(rows: Sequence[Any]) -> NDArray[Any]:
    """Triangles of polygons of different lengths; raises `AnswerError`."""
    each = [_numbers(f"polygon {number}", row) for number, row in enumerate(rows)]
    for number, row in enumerate(each):
        if row.ndim != 1 or row.dtype.kind not in "iu":
            raise AnswerError(
                f"polygon {number} has shape {row.shape} of {row.dtype}, not a row of indices"
            )
        if row.size and int(row.max()) > LARGEST:
            raise AnswerError(f"polygon {number} has the index {int(row.max())}")
    flat = np.concatenate(each, dtype=np.int64, casting="unsafe")
    return _fans(flat, np.array([len(row) for row in each]))


def triangles(rows: NDArray[Any]) -> NDArray[Any]:
    """Triangles of polygons, a fan from the first corner of each; raises `AnswerError`.

    >>> triangles(np.array([[4, 5, 6, 7], [0, 1, 2, -1]])).tolist()
    [[4, 5, 6], [4, 6, 7], [0, 1, 2]]
    >>> triangles(np.array([[0, 1, 2, 3], [0, 1, -1, -1]]))
    Traceback (most recent call last):
    isograde.adapters.forms.AnswerError: polygon 1 has 2 corners: [0, 1]
    """
    there = rows != NO_CORNER
    broken = (there[:, 1:] & ~there[:, :-1]).any(axis=1)
    _first(broken, lambda n: f"polygon {n} has a -1 before its last corner: {rows[n].tolist()}")
    return _fans(rows[there], there.sum(axis=1))


def _fans(flat: NDArray[Any], lengths: NDArray[Any]) -> NDArray[Any]:
    """Triangles of polygons of these lengths, whose corners come one after the other."""
    starts = np.cumsum(lengths) - lengths
    _first(
        lengths < 3,
        lambda n: (
            f"polygon {n} has {lengths[n]} corners: {flat[starts[n] :][: lengths[n]].tolist()}"
        ),
    )
    # Keep the order of the polygons, and that of the triangles in each.
    count = lengths - 2
    step = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    first = np.repeat(starts, count)
    cut: NDArray[Any] = flat[np.stack([first, first + step + 1, first + step + 2], axis=1)]
    return cut


def _first(wrong: NDArray[Any], tell: Callable[[int], str]) -> None:
    """Raise `AnswerError` with what is told of the first row that is wrong, if any is."""
    if wrong.any():
        raise AnswerError(tell(int(wrong.argmax())))


def from_polylines(lines: Sequence[Any], kind: Kind) -> Arrays:
    """Points and segments of polylines; raises `AnswerError`.

    >>> from_polylines([[[0, 0], [1, 0]], [[5, 5], [6, 6]]], Kind(2, 1))[1].tolist()
    [[0, 1], [2, 3]]
    """
    points: list[NDArray[Any]] = [np.empty((0, kind.n))]
    segments: list[NDArray[Any]] = [np.empty((0, 2), np.int64)]
    start = 0
    for number, given in enumerate(lines):
        line = _polyline(given, number, kind)
        # Let the last point of a closed polyline be its first.
        closed = len(line) > 2 and bool((line[0] == line[-1]).all())
        count = len(line) - closed
        step = np.arange(len(line) - 1)  # None where there is but one point.
        segments.append(start + np.stack([step, (step + 1) % count], axis=1))
        points.append(line[:count])
        start += count
    return np.concatenate(points), np.concatenate(segments)


def _polyline(given: object, number: int, kind: Kind) -> NDArray[Any]:
    """One polyline as an array (N, n); raises `AnswerError`."""
    line = _numbers(f"polyline {number}", given)
    if line.ndim != 2 or line.shape[1] != kind.n:
        hint = "; vertices and segments are a tuple" if line.dtype.kind in "iu" else ""
        raise AnswerError(f"polyline {number} has shape {line.shape}, not (N, {kind.n}){hint}")
    if not len(line):
        raise AnswerError(f"polyline {number} has no points")
    return line


def from_array(array: NDArray[Any], kind: Kind, what: str) -> Arrays:
    """The simplices of a soup, or points; `what` names the array in an `AnswerError`.

    >>> from_array(np.zeros((2, 3, 3)), Kind(3, 1), "an array")[1].tolist()
    [[0, 1, 2], [3, 4, 5]]
    """
    corners = kind.k + 1
    if kind.k == 0 and array.ndim == 2:
        array = array[:, None]
    if array.shape == (0,):
        array = np.empty((0, corners, kind.n))
    if array.ndim != 3 or array.shape[1:] != (corners, kind.n):
        raise AnswerError(
            f"returned {what} of shape {array.shape}: neither a pair of vertices and simplices, "
            f"nor a soup (S, {corners}, {kind.n})"
        )
    rows = np.arange(len(array) * corners).reshape(-1, corners)
    return array.reshape(-1, kind.n), rows


def _numbers(name: str, part: object) -> NDArray[Any]:
    """The part as a contiguous array of real numbers; raises `AnswerError`."""
    array: NDArray[Any] = tried(name, lambda: np.asarray(part))
    if array.dtype.kind not in "biuf":
        raise AnswerError(f"{name} ({type(part).__name__}) are not real numbers: {array.dtype}")
    solid: NDArray[Any] = tried(name, lambda: np.ascontiguousarray(array))
    return solid


def tried(name: str, make: Callable[[], Any]) -> Any:
    """What `make` returns; raises `AnswerError` for whatever it raises."""
    try:
        return make()
    except AnswerError:
        raise
    except MemoryError as error:
        raise AnswerError(f"an absurd mesh: {name}: {error}", Status.MEMORY) from error
    except Exception as error:
        raise AnswerError(f"{name} cannot be made an array: {error}") from error
