"""Cases of the user's own, in a file: what `isograde search` found, or what anybody wrote.

The frozen plan never changes; what it does not contain is kept beside it. ``isograde grade --cases
FILE`` adds the file's cases to the plan, and judges every claim on them, in every way.

The file is JSON, so that it can be read, written and put under version control::

    {"format": "isograde-cases-1",
     "cases": [{"id": "own/topology.closed-3f2a91c0", "kind": [3, 1], "type": "<f8",
                "shape": [2, 2, 2], "values": [1, -1, ..], "isovalues": [0.5],
                "spacing": [1, 1, 1], "breaks": "topology.closed", "by": "skimage:lewiner",
                "says": "4 edges inside the domain belong to one simplex only"}]}

Values are listed last axis fastest, those of several components one after the other; they are
written so that they are read as the same numbers. What a case once broke, and whose answer it was
(`breaks`, `by`, `says`), is for the reader and decides nothing.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from isoref.field import Field, FieldError

from isograde.model import Case, Kind

FORMAT = "isograde-cases-1"
PREFIX = "own/"
#: As a family of thousands would be judged: every claim, in every way.
TAGS = frozenset({"own", "posed", "noise"})
NAME = re.compile(r"own/[A-Za-z0-9_.+-]{1,120}")
# Of more than a name, or of a number, NumPy makes a type of several fields, or a syntax error.
TYPE = re.compile(r"[<>=|]?[A-Za-z][A-Za-z0-9]{0,15}")
#: No file of cases has more bytes, and no case more samples.
MOST_BYTES, MOST_SAMPLES = 1 << 26, 1 << 20

Entry = Mapping[str, Any]


class OwnCasesError(ValueError):
    """A file of cases that cannot be read; the message says which entry, and what to do."""


def entry_of(field: Field, isovalues: Iterable[float], breaks: str, by: str, says: str) -> Entry:
    """The entry of a case, named after what it breaks and what it holds."""
    values = np.ascontiguousarray(field.values)
    body = {
        "kind": [field.dimension, field.components],
        "type": values.dtype.str,
        "shape": list(field.shape),
        "values": values.ravel().tolist(),
        "isovalues": [float(level) for level in isovalues],
        "spacing": [float(step) for step in field.spacing],
    }
    digest = hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()[:8]
    name = f"{PREFIX}{breaks}-{digest}"
    return {"id": name, **body, "breaks": breaks, "by": by, "says": says}


def case_of(entry: Entry) -> Case:
    """The case of an entry. Raises `OwnCasesError`."""
    name = entry.get("id")
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise OwnCasesError(
            f"id {name!r:.200} is not 'own/' and letters, digits, or any of _ . + -"
        )
    try:
        field = _field(entry)
        kind = Kind(*(int(n) for n in entry["kind"]))
        levels = tuple(float(level) for level in entry["isovalues"])
    except KeyError as error:
        raise OwnCasesError(f"{name} has no {error.args[0]!r}") from None
    except (TypeError, ValueError, OverflowError) as error:
        raise OwnCasesError(f"{name}: {error!s:.300}") from None
    if kind != (field.dimension, field.components):
        has = f"({field.dimension}, {field.components})"
        raise OwnCasesError(
            f"{name} says that it is of kind {tuple(kind)} and its values are {has}"
        )
    if len(levels) != kind.m or not np.isfinite(levels).all():
        raise OwnCasesError(f"{name} needs {kind.m} finite isovalues, and has {list(levels)}")
    samples = int(np.prod(field.shape))
    return Case(name, partial(_field, dict(entry)), levels, samples, TAGS, kind=kind)


def _field(entry: Entry) -> Field:
    """The field of an entry. Raises `KeyError`, `TypeError` or `ValueError`."""
    shape = [int(n) for n in entry["shape"]]
    n, m = (int(x) for x in entry["kind"])
    if len(shape) != n or not 1 <= n <= 6 or not 1 <= m <= n or min(shape) < 1:
        raise ValueError(f"shape {shape} is none of a lattice of {n} axes")
    if np.prod(shape, dtype=object) * m > MOST_SAMPLES:
        raise ValueError(f"shape {shape} has more than {MOST_SAMPLES:,} samples")
    named = str(entry["type"])
    kind = np.dtype(named if TYPE.fullmatch(named) else object)
    if kind.kind not in "biuf" or kind.itemsize > 8:
        raise ValueError(f"type {named!r:.200} is not one of real numbers")
    listed = np.array(entry["values"], object).ravel()
    whole = [*([m] if m > 1 else []), *shape]
    if len(listed) != np.prod(whole):
        raise ValueError(f"{len(listed)} values do not fill shape {whole}")
    values = listed.astype(kind).reshape(whole)
    if any(a != b for a, b in zip(values.ravel().tolist(), listed.tolist(), strict=True)):
        raise ValueError(f"a value is no number of type {kind}")
    try:
        return Field.of(values, [float(s) for s in entry["spacing"]], dimension=n)
    except FieldError as error:
        raise ValueError(str(error)) from None


def read(path: Path) -> list[Case]:
    """The cases of a file. Raises `OwnCasesError`."""
    return [case_of(entry) for entry in entries(path)]


def entries(path: Path) -> list[Entry]:
    """The entries of a file, each of which is a case. Raises `OwnCasesError`."""
    try:
        large = path.stat().st_size > MOST_BYTES
        held = None if large else json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise OwnCasesError(f"{path} cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError) as error:  # A number of 5,000 digits is a ValueError.
        raise OwnCasesError(f"{path} is no JSON: {error!s:.300}") from None
    if large:
        raise OwnCasesError(f"{path} is larger than {MOST_BYTES >> 20} MB: no file of cases")
    if not isinstance(held, dict) or held.get("format") != FORMAT:
        raise OwnCasesError(f'{path} is no file of cases: it does not say "format": "{FORMAT}"')
    listed = held.get("cases")
    if not isinstance(listed, list) or not all(isinstance(one, dict) for one in listed):
        raise OwnCasesError(f'{path}: "cases" is no list of cases')
    for name, number in Counter(case_of(one).id for one in listed).items():
        if number > 1:
            raise OwnCasesError(f"{path} has two cases with the id {name}")
    return listed


def add(path: Path, found: Iterable[Entry]) -> list[Entry]:
    """The entries that the file did not have yet; it has them now. Raises `OwnCasesError`."""
    kept = entries(path) if path.exists() else []
    known = {one["id"] for one in kept}
    new = [one for one in found if one["id"] not in known]
    if new or not path.exists():
        lines = ",\n  ".join(json.dumps(one) for one in [*kept, *new])
        text = f'{{"format": "{FORMAT}",\n "cases": [\n  {lines}\n ]}}\n'
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_name(f"unfinished-{path.name}")
        draft.write_text(text, encoding="utf-8")
        draft.replace(path)
    return new
