"""The schema of every message that passes an adapter, and declarations as adapters read them.

``protocol.schema.json`` beside this file is published for those who write an adapter in another
language. What a declaration may say is decided by `isograde.declaration`, whose errors suggest the
right word; the schema knows the same words.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from isograde.adapters.texts import clean, clean_name
from isograde.declaration import Declaration, DeclarationError, declaration_from
from isograde.model import AdapterError


def declared(data: object, name: str) -> Declaration:
    """The declaration that `data` spells out, named `name` where it names nothing.

    Raises
    ------
    AdapterError
        for an entry that is unknown or out of range; the message says which and what is allowed.

    >>> declared({"level": 3, "conventions": {"tie": "outside"}}, "mine").level
    3
    """
    if isinstance(data, Mapping):
        # Cut names, and spell out what no report can hold.
        cleaned = {"name": clean_name, "version": clean_name, "notes": clean}
        data = {
            key: cleaned[key](one) if key in cleaned and isinstance(one, str) else one
            for key, one in data.items()
        }
    try:
        return declaration_from(data, clean_name(name))
    except DeclarationError as error:
        raise AdapterError(clean(error)) from None


# The key that tells the form of an answer, and the part of the schema for that form.
FORMS = {
    "simplices": "arrays", "faces": "faces", "polylines": "polylines", "mesh": "mesh",
    "answer": "file", "error": "error", "unsupported": "unsupported",
}  # fmt: skip


def form_of(answer: object) -> str:
    """The part of the schema for an answer of this form; for all answers where no key tells it.

    To ask the one form is several times as fast as to try them all, which allow each its own keys.

    >>> form_of({"id": 1, "mesh": "a.ply"}), form_of({"mesh": "a.ply", "error": ""}), form_of([])
    ('mesh', 'answer', 'answer')
    """
    keys = answer.keys() & FORMS.keys() if isinstance(answer, dict) else set()
    return FORMS[keys.pop()] if len(keys) == 1 else "answer"


def check_json(data: object, part: str, what: str) -> None:
    """Raise `AdapterError` unless `data` follows `part` of the protocol's schema."""
    import jsonschema

    error = jsonschema.exceptions.best_match(_validator(part).iter_errors(data))
    if error is not None:
        where = "/".join(map(str, error.absolute_path))
        raise AdapterError(clean(f"{what}: {where + ': ' if where else ''}{error.message}"))


@cache
def _validator(part: str) -> Any:
    """A checker of one part of the protocol's schema."""
    import jsonschema

    definitions = protocol_schema()["$defs"]
    return jsonschema.Draft202012Validator({"$defs": definitions, "$ref": f"#/$defs/{part}"})


@cache
def protocol_schema() -> dict[str, Any]:
    """The JSON schema of every message that passes an adapter."""
    schema: dict[str, Any] = json.loads(protocol_text())
    return schema


def protocol_text() -> str:
    """The schema as it is published."""
    return files("isograde.adapters").joinpath("protocol.schema.json").read_text(encoding="utf-8")
