"""Declarations: what an implementation says of itself, as JSON.

Every adapter reads the same object, whichever way it comes: a Python attribute, the answer of a
command to ``start``, a file beside meshes. All entries are optional, and what is left out is the
house's: level 2, the conventions of `isograde.model.Conventions`, nothing withheld::

    {"name": "mine", "version": "1.2", "level": 3,
     "conventions": {"tie": "outside", "normals": "to_high", "axes": "reversed",
                     "units": "index", "nan": "answers", "empty": "raises"},
     "without": ["linear-crossing"], "discipline": "surfaces", "notes": "reads float32 only"}

``connectivity`` ("disconnect", "connect" or "mixed") promises how every ambiguous face is resolved.
``identical`` ("nothing") promises that two surfaces which are the same have no curve in common.
``without`` names properties the implementation does not promise; a claim about one of them is
unsupported, neither held against it nor counted for it:

welded              faces share their vertices
manifold            one sheet of faces round each edge and each vertex
separates           samples on different sides are on different sides of the mesh
closed              the surface is open at the border of the volume only
border              the surface stays in the volume, and is not closed at its border
on-edges            vertices stand on crossed lattice edges, or inside cells that are crossed
linear-crossing     on a lattice edge, they stand where the linear interpolant crosses
spacing, layout, dtype      how the field is presented does not matter
symmetric-choices   ambiguous faces are decided alike wherever the cell stands
deterministic       the same question has the same answer
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from importlib.resources import files
from typing import Any

from isograde.model import AdapterError, Conventions, Declaration


def declaration_from(data: object, name: str) -> Declaration:
    """The declaration that `data` spells out, named `name` where it names nothing.

    Raises
    ------
    AdapterError
        for an entry that is unknown or out of range; the message says which and what is allowed.

    >>> declaration_from({"level": 3, "conventions": {"tie": "outside"}}, "mine").level
    3
    >>> declaration_from({"level": 7}, "mine")
    Traceback (most recent call last):
    isograde.model.AdapterError: the declaration of mine: level: 7 is greater than the maximum of 4
    """
    check_json(data, "declaration", f"the declaration of {name}")
    assert isinstance(data, Mapping), "the schema asks for an object"
    said = dict(data)
    conventions = Conventions(**said.pop("conventions", {}))
    without = frozenset(said.pop("without", ()))
    return Declaration(**{"name": name, **said, "conventions": conventions, "without": without})


def declaration_json(declaration: Declaration) -> dict[str, Any]:
    """The declaration as JSON; `declaration_from` reads it back.

    >>> declared = Declaration("mine", level=1, without=frozenset({"welded"}))
    >>> declaration_from(declaration_json(declared), "other") == declared
    True
    """
    return {**asdict(declaration), "without": sorted(declaration.without)}


def check_json(data: object, part: str, what: str) -> None:
    """Nothing, where `data` follows `part` of the protocol's schema; else raises `AdapterError`."""
    import jsonschema

    error = jsonschema.exceptions.best_match(_validator(part).iter_errors(data))
    if error is not None:
        where = "/".join(map(str, error.absolute_path))
        raise AdapterError(f"{what}: {where + ': ' if where else ''}{error.message}")


@cache
def _validator(part: str) -> Any:
    """A checker of one part of the protocol's schema."""
    import jsonschema

    definitions = protocol_schema()["$defs"]
    return jsonschema.Draft202012Validator({"$defs": definitions, "$ref": f"#/$defs/{part}"})


@cache
def protocol_schema() -> dict[str, Any]:
    """The JSON schema of every message that passes an adapter."""
    text = files("isograde.adapters").joinpath("protocol.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema
