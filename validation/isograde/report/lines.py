"""The file a report is: one JSON object a line, each checked against the schema when it is read.

`schema.json` beside this module describes every line. A file whose name ends in .gz is compressed.
"""

from __future__ import annotations

import gzip
import io
import json
import math
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, TextIO

import fastjsonschema
import jsonschema
import numpy as np

from isograde.adapters.strict import NotJSON, parse
from isograde.adapters.texts import clean

FORMAT = 2
# What is quoted of a fault in a line.
LONGEST_FAULT = 400
RECORDS = ("header", "claim", "case", "result", "evidence", "footer")
JSON = dict[str, Any]
AS_IT_IS = (str, int, bool, type(None))


class ReportError(ValueError):
    """A file is no report; the message says which line and why."""


@contextmanager
def open_text(path: Path, mode: str) -> Iterator[TextIO]:
    """The file, open for "r" or "w" as UTF-8; compressed where its name ends in .gz."""
    with ExitStack() as stack:
        raw = stack.enter_context(path.open("rb" if mode == "r" else "wb"))
        binary: Any = raw
        if path.suffix == ".gz":
            # Leave name and time out of the archive, so that the same report is the same file.
            archive = gzip.GzipFile("", "rb" if mode == "r" else "wb", fileobj=raw, mtime=0)
            binary = stack.enter_context(archive)
        yield stack.enter_context(io.TextIOWrapper(binary, encoding="utf-8", newline="\n"))


def write_line(file: TextIO, record: Mapping[str, Any]) -> JSON:
    """The record as written: one more line of the file."""
    made: JSON = plain(record)
    file.write(_spelt(made))
    return made


def line_of(record: Mapping[str, Any]) -> str:
    """The record as a line."""
    return _spelt(plain(record))


def _spelt(made: JSON) -> str:
    """A record that is plain, as a line."""
    return json.dumps(made, separators=(",", ":"), allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """The value with NumPy's types made Python's, and numbers that are not finite made text."""
    if type(value) in AS_IT_IS:
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset | np.ndarray):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def write_lines(records: Iterable[Mapping[str, Any]], path: Path) -> None:
    """The file holds these lines, whole; until then what was there before stays."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.tmp{path.suffix if path.suffix == '.gz' else ''}")
    try:
        with open_text(draft, "w") as file:
            for one in records:
                write_line(file, one)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


@cache
def schema() -> JSON:
    """The JSON Schema of a line."""
    text = files("isograde.report").joinpath("schema.json").read_text(encoding="utf-8")
    parsed: JSON = json.loads(text)
    return parsed


def lines(path: Path) -> Iterator[JSON]:
    """The records of a file, each checked against the schema. Raises `ReportError`."""
    try:
        with open_text(path, "r") as file:
            for number, line in enumerate(file, 1):
                yield checked(line, f"{path}:{number}")
    except (OSError, UnicodeDecodeError, EOFError, zlib.error) as error:
        raise ReportError(f"{path} cannot be read: {error}") from error


def checked(line: str, place: str) -> JSON:
    """The record on a line."""
    try:
        record: JSON = parse(line)
    except NotJSON as error:
        raise ReportError(f"{place} is {error}") from error
    name = record.get("record") if isinstance(record, dict) else None
    if name not in RECORDS:
        raise ReportError(f"{place} is no record of a report: record {name!r:.80}")
    try:
        _compiled(name)(record)
    except fastjsonschema.JsonSchemaValueException:
        fault = jsonschema.exceptions.best_match(_validator(name).iter_errors(record))
        if fault is not None:
            told = clean(f"{fault.json_path} {fault.message}", LONGEST_FAULT)
            raise ReportError(f"{place} is no {name} record: {told}") from None
    return record


def _schema_of(name: str) -> JSON:
    """The schema of one kind of line."""
    definitions = schema()["$defs"]
    return {**definitions[name], "$defs": definitions}


@cache
def _compiled(name: str) -> Callable[[Any], object]:
    """The schema of one kind of line as a function, which raises where a record does not fit.

    It is a twentieth of the work of `_validator`, whose sentences are better.
    """
    compiled: Callable[[Any], object] = fastjsonschema.compile(_schema_of(name), use_default=False)
    return compiled


@cache
def _validator(name: str) -> Any:
    """The same, for what is wrong with a record."""
    return jsonschema.Draft202012Validator(_schema_of(name))
