"""Cases that are spelt out: the name holds every sample, so that a small failure needs no file.

::

    given/3x2x2/-1,1,0.5,-1,1,1,1,-1,-1,1,1,-1
    given/2x3/at=0.5/as=uint8/0,1,2,1,0,1
    given/2x2/at=0,1/by=1,2.5/-1,1,1,1,0,2,3,0

The shape comes first, then what is not as usual, then the samples in the array's order, component
by component: ``at`` the isovalues (one a component; 0), ``by`` the spacing (1 along each axis),
``as`` the number type (float64). Nothing is known of such a field but its samples.
"""

from __future__ import annotations

import re
from functools import partial
from math import prod

import numpy as np
from isoref.field import Field

from isograde.model import Case, Kind

NAME = re.compile(
    r"given/(?P<shape>\d+(x\d+)*)"
    r"(/at=(?P<at>[^/]+))?(/by=(?P<by>[^/]+))?(/as=(?P<as>[a-z]+\d+))?/(?P<values>[^/]+)"
)
# Judge what needs no more than the samples.
TAGS = frozenset({"given", "noise", "trilinear", "simplices"})
# Spell out so many numbers at most: a name is typed, or at least pasted.
MOST = 128
# Tell a longer name by its first samples.
LONG, FIRST = 64, 8


def name(field: Field, isovalues: tuple[float, ...]) -> str:
    """The name of the case that asks this field; it says nothing of the field's origin.

    >>> name(Field.of([[0.5, -1.0]]), (0.0,))
    'given/1x2/0.5,-1'
    """
    parts = ["given", "x".join(map(str, field.shape))]
    if any(isovalues) or len(isovalues) > 1:
        parts.append(f"at={_numbers(isovalues)}")
    if any(step != 1 for step in field.spacing):
        parts.append(f"by={_numbers(field.spacing)}")
    if field.values.dtype != np.float64:
        parts.append(f"as={field.values.dtype.name}")
    return "/".join([*parts, _numbers(field.values.ravel().tolist())])


def brief(name: str) -> str:
    """The name as a sentence tells it: of many samples the first; any other name as it is.

    >>> brief("given/2x2/-1,1,1,-1")
    'given/2x2/-1,1,1,-1'
    >>> brief("given/4x3x3/" + ",".join(["-1"] * 36))
    'given/4x3x3/-1,-1,-1,-1,-1,-1,-1,-1,..'
    """
    if len(name) <= LONG or not name.startswith("given/"):
        return name
    head, _, samples = name.rpartition("/")
    return f"{head}/{','.join(samples.split(',')[:FIRST])},.."


def _numbers(values: object) -> str:
    """Numbers with as few digits as name them."""
    return ",".join(repr(x).removesuffix(".0") for x in values)  # type: ignore[attr-defined]


def parse(text: str) -> Case | None:
    """The case that is spelt out; None where the text is no such name, or a wrong one."""
    found = NAME.fullmatch(text)
    if found is None:
        return None
    try:
        shape = tuple(int(n) for n in found["shape"].split("x"))
        levels = tuple(float(x) for x in (found["at"] or "0").split(","))
        spacing = tuple(float(x) for x in found["by"].split(",")) if found["by"] else None
        numbers = [float(x) for x in found["values"].split(",")]
        whole = (*([len(levels)] if len(levels) > 1 else []), *shape)
        values = np.array(numbers).astype(found["as"] or "float64").reshape(whole)
        field = Field.of(values, spacing, dimension=len(shape))
    except (TypeError, ValueError):
        return None
    kind = Kind(len(shape), len(levels))
    return Case(text, partial(_same, field), levels, prod(shape), TAGS, kind=kind)


def fault(text: str) -> str:
    """What is wrong with a name that spells no case out.

    >>> fault("given/2x2/1,2,3")
    'given/2x2/1,2,3 spells no case out: 3 samples, where 2x2 takes 4'
    """
    found = NAME.fullmatch(text)
    told = "a name is given/SHAPE/SAMPLES, as given/2x3/0,1,2,1,0,1"
    if found is not None:
        shape = [int(n) for n in found["shape"].split("x")]
        count = len(found["values"].split(","))
        wanted = prod(shape) * len((found["at"] or "0").split(","))
        told = "every sample, isovalue and spacing is a finite number, and the type one of NumPy's"
        if count != wanted:
            told = f"{count} samples, where {found['shape']} takes {wanted}"
    return f"{text} spells no case out: {told}"


def _same(field: Field) -> Field:
    """The field."""
    return field
