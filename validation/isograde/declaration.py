"""What an implementation says of itself: four words, conventions, limits, and what it promises.

Everything is optional; what is left out is the house's. As JSON::

    {"name": "mine", "version": "1.2", "level": 3, "given": "samples",
     "interpolant": "multilinear", "vertices": "edges", "domain": "open", "mesh": "indexed",
     "conventions": {"tie": "outside", "normals": "to_high", "axes": "reversed", "units": "index",
                     "nan": "answers", "empty": "raises"},
     "limits": {"kinds": [[3, 1]], "types": ["uint8", "float32"], "least": 2, "greatest": 256},
     "not_promised": ["robustness.dtype"], "promised": ["cells.separate"],
     "notes": "reads float32 only"}

The four words
--------------
interpolant   whose level set it draws, so what "right" means inside a cell: ``"multilinear"``; a
              split of the cells into simplices, ``"kuhn"`` or ``{"tetrahedra": [..]}`` with
              simplices over a block of one or two cells an axis, each a list of n + 1 corners;
              ``"labels"``, where only inside and outside are seen and crossings stand halfway
vertices      where vertices may be: ``"edges"``, on crossed lattice edges (of the split) and inside
              active cells; ``"cells"``, in active cells, as dual methods place them; ``{"own":
              reach}``, on a lattice of its own, where reach is the largest distance between its
              samples, in cells of the field, at most 3
domain        where the surface ends: a word for all axes or one an axis: ``"open"``, ``"closed"``
              (capped), ``"periodic"``, or ``{"inset": x, "end": word}`` with x the distance of the
              end from the first and last samples, in cells: 1/2 inside, -1/2 outside, 1 at most
mesh          ``"indexed"``, judged as given; ``{"soup": tolerance}``, where vertices that are
              within the tolerance (in cells) count as one

Conventions and limits
----------------------
given         what it is called with: samples, or a function that it samples itself; the vertices of
              the latter are its own (`isograde.adapters.interpolants`)
tie           side on which a sample equal to the isovalue counts: inside, outside
normals       where right-hand normals point, in the implementation's own coordinates: to_low,
              to_high; "none" where triangles are not oriented
axes          coordinates in the order of the array's axes (array), or reversed
units         vertices scaled by the spacing (world), or counted in samples (index)
nan           what a sample that is not a number does: raises, answers
empty         what a field without a surface gives: an empty mesh (mesh), or an error (raises)
kinds         the (n, m) it takes: [[3, 1]] unless said
types         NumPy's names of the number types it takes; every type unless said
least, greatest   samples along each axis; ``samples``, in all; ``cubes``: equal along all axes
directions    true where it takes the directions of the axes in the world, as a keyword
              ``directions``: n rows, for each axis of the array the unit vector along which it
              runs; false unless said, and then every axis runs along one of the world's
negative      true where it takes spacings below zero: an axis that runs backwards in the world

A field of another type is posed in one that is taken, and filled up to a cube, where that leaves
its level set in its place (`isograde.within`); what else is outside the limits is not sent.

Promises
--------
level         claims above it are judged and shown, and not held against the implementation; 2
              unless said, and never above what its family can reach
not_promised  ids of claims (or globs) that are judged and shown, and not held against it; a level
              with such a claim is not reached
promised      ids of claims of choice, such as ``cells.separate``, that it does promise
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase
from itertools import permutations
from math import prod
from typing import Any, Literal

import numpy as np

Corner = tuple[int, ...]
Simplex = tuple[Corner, ...]

WORDS = ("multilinear", "tetrahedra", "labels")
LARGEST_REACH = 3.0


class DeclarationError(ValueError):
    """A declaration that says something unknown or out of range; the message says what to write."""


@dataclass(frozen=True)
class Split:
    """Simplices that fill a block of one or two cells along each axis.

    simplices : each n + 1 corners, lattice points 0 .. 2 of the block; empty for Kuhn's split of
        one cell, in any dimension
    """

    simplices: tuple[Simplex, ...] = ()

    def over(self, n: int) -> tuple[Simplex, ...]:
        """The simplices in n dimensions.

        >>> len(Split().over(3)), Split().over(2)[0]
        (6, ((0, 0), (1, 0), (1, 1)))
        """
        if self.simplices:
            return self.simplices
        return tuple(_kuhn_path(order) for order in permutations(range(n)))

    def period(self, n: int) -> tuple[int, ...]:
        """Cells along each axis after which the split repeats."""
        if not self.simplices:
            return (1,) * n
        return tuple(int(x) for x in np.max(self.simplices, axis=(0, 1)))


def _kuhn_path(order: Sequence[int]) -> Simplex:
    """The corners of a cell from the lowest to the highest, axis after axis in this order."""
    corner = [0] * len(order)
    path = [tuple(corner)]
    for axis in order:
        corner[axis] = 1
        path.append(tuple(corner))
    return tuple(path)


@dataclass(frozen=True)
class End:
    """How the surface ends along one axis.

    inset : distance of the end from the first and the last sample, in cells; below 0 outside
    end : "open" (facets in the end's plane belong to one simplex), "closed" (capped there),
        "periodic" (the last plane is the first)
    """

    inset: float = 0.0
    end: Literal["open", "closed", "periodic"] = "open"


@dataclass(frozen=True)
class Conventions:
    """How an implementation differs from the house's conventions; the defaults are the house's."""

    tie: Literal["inside", "outside"] = "inside"
    normals: Literal["to_low", "to_high", "none"] = "to_low"
    axes: Literal["array", "reversed"] = "array"
    units: Literal["world", "index"] = "world"
    nan: Literal["raises", "answers"] = "raises"
    empty: Literal["mesh", "raises"] = "mesh"


@dataclass(frozen=True)
class Scope:
    """The fields an implementation takes; the entry ``limits`` of a declaration.

    kinds : the (n, m)
    types : names of number types; empty for every type
    least, greatest : samples along each axis; greatest 0 for no limit
    samples : samples in all; 0 for no limit
    cubes : as many samples along each axis
    directions, negative : axes that run elsewhere in the world than they do in the array, told by
        directions or by a negative spacing
    """

    kinds: tuple[tuple[int, int], ...] = ((3, 1),)
    types: tuple[str, ...] = ()
    least: int = 1
    greatest: int = 0
    samples: int = 0
    cubes: bool = False
    directions: bool = False
    negative: bool = False

    def refusal(self, kind: tuple[int, int], shape: Sequence[int], dtype: np.dtype[Any]) -> str:
        """Why a field of this kind, shape and type is outside the limits; nothing where it is not.

        >>> Scope(least=2).refusal((3, 1), (1, 5, 5), np.dtype("float64"))
        'outside its limits: fewer than 2 samples along an axis'
        """
        said = self._unfit(tuple(kind), shape, dtype)
        return f"outside its limits: {said}" if said else ""

    def _unfit(self, kind: tuple[int, ...], shape: Sequence[int], dtype: np.dtype[Any]) -> str:
        """The first of the limits that is broken; nothing where none is."""
        if kind not in self.kinds:
            return f"(n, m) = {kind}"
        if self.types and dtype.name not in self.types:
            return f"samples of type {dtype.name}"
        if min(shape, default=0) < self.least:
            return f"fewer than {self.least} samples along an axis"
        if 0 < self.greatest < max(shape, default=0):
            return f"more than {self.greatest} samples along an axis"
        if 0 < self.samples < prod(shape):
            return f"more than {self.samples:,} samples"
        return "axes of different lengths" if self.cubes and len(set(shape)) > 1 else ""


@dataclass(frozen=True)
class Declaration:
    """What an implementation says of itself; see the module for each entry.

    reach : of vertices on a lattice of its own, in cells; 0 for any other
    soup : tolerance within which vertices count as one, in cells; None for an indexed mesh
    domain : one `End` for all axes, or one an axis
    """

    name: str
    version: str = ""
    level: int = 2
    interpolant: Literal["multilinear", "tetrahedra", "labels"] = "multilinear"
    split: Split = Split()
    vertices: Literal["edges", "cells", "own"] = "edges"
    reach: float = 0.0
    domain: tuple[End, ...] = (End(),)
    soup: float | None = None
    given: Literal["samples", "function"] = "samples"
    conventions: Conventions = Conventions()
    limits: Scope = Scope()
    promised: frozenset[str] = frozenset()
    not_promised: frozenset[str] = frozenset()
    notes: str = ""

    @property
    def top(self) -> int:
        """The highest level that its family can reach."""
        return 4 if self.interpolant == "multilinear" and self.vertices == "edges" else 2

    def ends(self, n: int) -> tuple[End, ...]:
        """One `End` for each of n axes."""
        return self.domain if len(self.domain) == n else self.domain[:1] * n

    def promises(self, claim: str, level: int | None, usual: bool) -> bool:
        """Whether the claim of this id and level is promised; `usual` where nothing is said."""
        if any(fnmatchcase(claim, glob) for glob in self.not_promised):
            return False
        if any(fnmatchcase(claim, glob) for glob in self.promised):
            return True
        return usual and (level is None or level <= self.level)


def declaration_from(data: object, name: str) -> Declaration:
    """The declaration that `data` spells out, named `name` where it names nothing.

    Raises
    ------
    DeclarationError
        for an entry that is unknown or out of range; the message says which and what is allowed.

    >>> declaration_from({"level": 1, "vertices": {"own": 1.5}}, "mine").reach
    1.5
    >>> declaration_from({"interpolant": "trilinear"}, "mine")
    Traceback (most recent call last):
    isograde.declaration.DeclarationError: the declaration of mine: interpolant: there is no \
'trilinear'; did you mean 'multilinear'? There are multilinear, kuhn, labels, {"tetrahedra": [..]}
    """
    what = f"the declaration of {name}"
    if not isinstance(data, Mapping):
        raise DeclarationError(f"{what} is {type(data).__name__}, not an object")
    said = {"name": name, **data}
    _known(said, ENTRIES, what)
    fields: dict[str, Any] = {key: said[key] for key in ("name", "version", "notes") if key in said}
    for key, value in fields.items():
        _check(isinstance(value, str), f"{what}: {key}: {value!r} is not a text")
    try:
        fields |= _words(said)
        fields |= {
            key: _globs(said[key], key) for key in ("promised", "not_promised") if key in said
        }
        if "level" in said:
            fields["level"] = _whole(said["level"], "level", 0, 4)
        if "given" in said:
            fields["given"] = _one_of(said["given"], ("samples", "function"), "given")
        if "conventions" in said:
            fields["conventions"] = _conventions(said["conventions"])
        if "limits" in said:
            fields["limits"] = _scope(said["limits"])
    except DeclarationError as error:
        raise DeclarationError(f"{what}: {error}") from None
    declared = Declaration(**fields)
    if declared.given == "function" and declared.vertices != "own":
        raise DeclarationError(
            f"{what}: given: a function is sampled on a lattice of one's own; declare vertices "
            '{"own": reach}'
        )
    turned = declared.limits.directions or declared.limits.negative
    apart = (declared.conventions.units, declared.conventions.axes, declared.given)
    if turned and apart != ("world", "array", "samples"):
        raise DeclarationError(
            f"{what}: limits: directions and negative spacings are for who is given samples and "
            "answers in the world's units, in the order of the array's axes"
        )
    if declared.level > declared.top and "level" in said:
        family = f"{declared.interpolant}, vertices on {declared.vertices}"
        raise DeclarationError(
            f"{what}: level {declared.level} is above {declared.top}, the top for {family}"
        )
    return declared


ENTRIES = (
    "name", "version", "level", "interpolant", "vertices", "domain", "mesh", "given",
    "conventions", "limits", "promised", "not_promised", "notes",
)  # fmt: skip


def _check(right: bool, told: str) -> None:
    """Raise `DeclarationError` with these words unless it is right."""
    if not right:
        raise DeclarationError(told)


def _known(said: Mapping[str, Any], known: Sequence[str], what: str) -> None:
    """Raise `DeclarationError` for an entry that is not known, with a suggestion."""
    for key in said:
        if key not in known:
            raise DeclarationError(f"{what}: there is no {key!r}; {_suggest(str(key), known)}")


def _suggest(word: str, known: Sequence[str]) -> str:
    """What may have been meant."""
    close = get_close_matches(word, known, n=1, cutoff=0.5)
    hint = f"did you mean {close[0]!r}? There are" if close else "there are"
    return f"{hint} {', '.join(known)}"


def _one_of(value: object, known: Sequence[str], what: str, more: str = "") -> str:
    """The value, where it is one of these words."""
    if isinstance(value, str) and value in known:
        return value
    told = f"{what}: there is no {value!r}; {_suggest(str(value), known)}"
    raise DeclarationError(told + more)


def _number(value: Any, what: str, low: float, high: float) -> float:
    """The value as a number between these."""
    right = isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high
    _check(right, f"{what}: {value!r} is no number from {low:g} to {high:g}")
    return float(value)


def _whole(value: Any, what: str, low: int, high: int) -> int:
    """The value as a whole number between these."""
    right = isinstance(value, int) and not isinstance(value, bool) and low <= value <= high
    _check(right, f"{what}: {value!r} is no whole number from {low} to {high}")
    return int(value)


def _only(value: object, key: str, what: str) -> Any:
    """What an object of one entry, this one, holds."""
    if isinstance(value, Mapping) and set(value) == {key}:
        return value[key]
    raise DeclarationError(f"{what}: {value!r} is not understood; write {{{key!r}: ..}}")


def _words(said: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of the four words."""
    fields: dict[str, Any] = {}
    if "interpolant" in said:
        fields |= _interpolant(said["interpolant"])
    if "vertices" in said:
        fields |= _vertices(said["vertices"])
    if "domain" in said:
        value = said["domain"]
        each = value if isinstance(value, Sequence) and not isinstance(value, str) else [value]
        _check(bool(each), "domain: an empty list; write one word, or one for each axis")
        fields["domain"] = tuple(_end(one) for one in each)
    if said.get("mesh", "indexed") != "indexed":
        if isinstance(said["mesh"], str):
            _one_of(said["mesh"], ("indexed",), "mesh", ', {"soup": tolerance}')
        fields["soup"] = _number(_only(said["mesh"], "soup", "mesh"), "mesh: soup", 0, 0.1)
    return fields


def _interpolant(value: object) -> dict[str, Any]:
    """The entries that this word makes."""
    if isinstance(value, str):
        word = _one_of(
            value, ("multilinear", "kuhn", "labels"), "interpolant", ', {"tetrahedra": [..]}'
        )
        return {"interpolant": "tetrahedra" if word == "kuhn" else word}
    rows = _only(value, "tetrahedra", "interpolant")
    return {"interpolant": "tetrahedra", "split": _split(rows)}


def _split(rows: object) -> Split:
    """The split with these simplices, checked to fill a block of one or two cells an axis."""
    try:
        corners = np.asarray(rows, np.int64)
        whole = bool((corners == np.asarray(rows)).all())
    except (TypeError, ValueError, OverflowError):
        raise DeclarationError("interpolant: tetrahedra are lists of corners, all alike") from None
    shaped = corners.ndim == 3 and corners.size > 0 and corners.shape[1] == corners.shape[2] + 1
    _check(shaped and whole, "interpolant: each simplex has n + 1 corners of n whole numbers")
    _check(
        0 <= corners.min() and corners.max() <= 2, "interpolant: a block has 1 or 2 cells an axis"
    )
    n = corners.shape[2]
    sizes = np.abs(np.linalg.det((corners[:, 1:] - corners[:, :1]).astype(np.float64)))
    factorial = float(np.prod(np.arange(1, n + 1)))
    block = float(np.prod(corners.max(axis=(0, 1))))
    filled = float(sizes.sum()) / factorial
    _check(
        bool((sizes > 0.5).all()) and abs(filled - block) < 1e-6,
        f"interpolant: the simplices fill {filled:g} of the block's {block:g} cells",
    )
    return Split(tuple(tuple(tuple(map(int, corner)) for corner in simplex) for simplex in corners))


def _vertices(value: object) -> dict[str, Any]:
    """The entries that this word makes."""
    if isinstance(value, str):
        word = _one_of(value, ("edges", "cells"), "vertices", ', {"own": reach}')
        return {"vertices": word}
    reach = _number(_only(value, "own", "vertices"), "vertices: own", 0, LARGEST_REACH)
    return {"vertices": "own", "reach": reach}


def _end(value: object) -> End:
    """The end that this word or object describes."""
    words = ("open", "closed", "periodic")
    if isinstance(value, Mapping):
        _known(value, ("inset", "end"), "domain")
        inset = _number(value.get("inset", 0.0), "domain: inset", -1, 1)
        return End(inset, _one_of(value.get("end", "open"), words, "domain: end"))  # type: ignore[arg-type]
    return End(0.0, _one_of(value, words, "domain", ', {"inset": x, "end": word}'))  # type: ignore[arg-type]


def _globs(value: Any, what: str) -> frozenset[str]:
    """A set of texts."""
    listed = isinstance(value, Sequence | set | frozenset) and not isinstance(value, str)
    right = listed and all(isinstance(one, str) for one in value)
    _check(right, f"{what}: {value!r} is no list of claims")
    return frozenset(value)


CHOICES: Mapping[str, tuple[str, ...]] = {
    "tie": ("inside", "outside"),
    "normals": ("to_low", "to_high", "none"),
    "axes": ("array", "reversed"),
    "units": ("world", "index"),
    "nan": ("raises", "answers"),
    "empty": ("mesh", "raises"),
}


def _conventions(value: object) -> Conventions:
    """The conventions that an object holds."""
    _check(isinstance(value, Mapping), f"conventions: {value!r} is no object")
    assert isinstance(value, Mapping)
    _known(value, tuple(CHOICES), "conventions")
    words = {key: _one_of(one, CHOICES[key], f"conventions: {key}") for key, one in value.items()}
    return Conventions(**words)  # type: ignore[arg-type]


def _scope(value: object) -> Scope:
    """The limits that an object holds."""
    _check(isinstance(value, Mapping), f"limits: {value!r} is no object")
    assert isinstance(value, Mapping)
    _known(value, tuple(asdict(Scope())), "limits")
    fields: dict[str, Any] = {}
    if "kinds" in value:
        fields["kinds"] = _pairs(value["kinds"])
        _check(all(n >= m >= 1 for n, m in fields["kinds"]), "limits: kinds have n >= m >= 1")
    if "types" in value:
        listed = isinstance(value["types"], Sequence) and not isinstance(value["types"], str)
        _check(listed, f"limits: types: {value['types']!r} is no list of types")
        fields["types"] = tuple(sorted({_type_name(one) for one in value["types"]}))
    for key in ("least", "greatest", "samples"):
        if key in value:
            fields[key] = _whole(value[key], f"limits: {key}", 0, 1 << 62)
    for key in ("cubes", "directions", "negative"):
        if key in value:
            told = f"limits: {key}: {value[key]!r} is not true or false"
            _check(isinstance(value[key], bool), told)
            fields[key] = value[key]
    return Scope(**fields)


def _pairs(value: Any) -> tuple[tuple[int, int], ...]:
    """Pairs [n, m]."""
    try:
        rows = np.asarray(value)
    except ValueError:  # Of different lengths.
        rows = np.empty(0)
    right = rows.ndim == 2 and rows.shape[1] == 2 and rows.dtype.kind in "iu"
    _check(right, "limits: kinds are pairs [n, m]")
    return tuple((int(n), int(m)) for n, m in rows)


def _type_name(value: object) -> str:
    """NumPy's name of a type of real numbers."""
    try:
        dtype = np.dtype(str(value))
    except (TypeError, ValueError, SyntaxError):  # NumPy reads a text as an expression of types.
        raise DeclarationError(f"limits: types: {value!r} is no type of NumPy's") from None
    _check(dtype.kind in "biuf", f"limits: types: {value!r} is no type of real numbers")
    return dtype.name


def declaration_json(declaration: Declaration) -> dict[str, Any]:
    """The declaration as JSON; `declaration_from` reads it back.

    >>> declared = Declaration("mine", level=1, vertices="own", reach=2.0, soup=1e-6)
    >>> declaration_from(declaration_json(declared), "other") == declared
    True
    """
    interpolant: Any = declaration.interpolant
    if interpolant == "tetrahedra":
        rows = declaration.split.simplices
        interpolant = {"tetrahedra": [list(map(list, one)) for one in rows]} if rows else "kuhn"
    return {
        "name": declaration.name,
        "version": declaration.version,
        "level": declaration.level,
        "interpolant": interpolant,
        "vertices": {"own": declaration.reach}
        if declaration.vertices == "own"
        else declaration.vertices,
        "domain": [asdict(end) for end in declaration.domain],
        "mesh": "indexed" if declaration.soup is None else {"soup": declaration.soup},
        "given": declaration.given,
        "conventions": asdict(declaration.conventions),
        "limits": {
            **asdict(declaration.limits),
            "kinds": [list(kind) for kind in declaration.limits.kinds],
            "types": list(declaration.limits.types),
        },
        "promised": sorted(declaration.promised),
        "not_promised": sorted(declaration.not_promised),
        "notes": declaration.notes,
    }
