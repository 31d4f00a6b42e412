"""The register of faults: each an extractor that is broken on purpose, and what must say so."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Extract = Callable[..., Any]


@dataclass(frozen=True)
class Fault:
    """One extractor that is broken on purpose.

    name : of the fault
    extract : the function under test; made anew by `make`, so that none keeps another's state
    first : the claim that must catch it before any other
    report : where the public saw its like, or nothing
    blind : written from the README and `isograde explain` alone
    declares : what it says of itself
    says : what is wrong, in a sentence
    module : the last name of the module it stands in
    """

    name: str
    make: Callable[[], Extract]
    first: str
    report: str
    blind: bool
    says: str
    module: str
    declares: Mapping[str, Any] = field(default_factory=dict)


FAULTS: dict[str, Fault] = {}

#: Those that no case of the default plan was seen to catch, and what would.
SURVIVORS: dict[str, str] = {
    "half-as-many-vertices": "`topology.sides` on specks in 47 x 47 x 47 samples, 73,002 vertices "
    "of 97,336 triangles; `shapes/many` and `shapes/dense` have as many as half their triangles",
    "halfway-for-safety": "`range.scale` on a field that changes by 2^-11 a cell; the fields that "
    "are posed at 2^-30 are noise of about 1, and `magnitudes/small` is not posed so",
    "missing-filled-in-place": "`robustness.input_unmodified`, were it judged last: it looks at "
    "the calls made until then, and the variant `nan` is asked after it",
    "normals-of-nothing": "a claim that normals are finite; `structure.finite` looks at vertices, "
    "and the two claims on normals at known bodies and planes, where no gradient vanishes",
    "single-where-large": "`topology.sides` on `shapes/fine`, doubles about 2^30, in full "
    "runs; by default no field of more than a million samples needs double precision",
    "slabs-of-four-million": "`topology.closed` on `shapes/column-0`, 4.4 million samples, in "
    "full runs; of so many, `shapes/deep` alone is asked by default, and it has one layer of cells",
    "summed-coordinates": "`topology.sides` on `shapes/long` at a spacing of 0.7; long fields are "
    "posed at a spacing of one, which single precision sums without an error",
    "there-and-back": "`topology.closed` on noise beyond the 1024th of 2048 x 4 x 4 samples; at "
    "65,536 single precision is so coarse that both ends round alike",
    "thousand-on-each-axis": "`topology.closed` on 2 x 2 x 1006 samples of noise: the lengths "
    "that are posed are about 256, and 65,542, where 1e3 j and k do not meet",
    "ties-lifted": "`geometry.crossing` on whole numbers times 2^-40: every field with ties has "
    "values of about 1, and beside ties `range.scale` compares nothing",
}


def kebab(name: str) -> str:
    """The name of a class or function with hyphens.

    >>> kebab("LastLayer"), kebab("last_layer")
    ('last-layer', 'last-layer')
    """
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", name).replace("_", "-").lower()


def fault(
    first: str, report: str = "", *, blind: bool = False, **declares: Any
) -> Callable[[Any], Any]:
    """A decorator that registers a class of extractors, or a function, as a fault."""

    def register(broken: Any) -> Any:
        name = kebab(broken.__name__)
        module = broken.__module__.rpartition(".")[2]
        # pytest executes a module twice where it looks for doctests.
        known = FAULTS.get(name)
        assert known is None or known.module == module, f"two faults are named {name}"
        assert broken.__doc__, f"{name} says nothing of what is wrong"
        make = broken if isinstance(broken, type) else lambda: broken
        FAULTS[name] = Fault(
            name, make, first, report, blind, broken.__doc__.split("\n")[0], module, declares
        )
        return broken

    return register
