"""The sentences of the report that say what came out, each written from the results it is given."""

from __future__ import annotations

from collections.abc import Mapping


def one_field(printed: Mapping[str, int], implied: Mapping[str, int]) -> str:
    """Whether the captions of Figure 1 and the rows of Table 1 can be of one field."""
    apart = [name for name in printed if printed[name] != implied[name]]
    if not apart:
        return "Table 1 and Figure 1 may be of the same data"
    return "Table 1 and Figure 1 are not of the same data"


def of_which_waves(printed: Mapping[str, int], implied: Mapping[str, int]) -> str:
    """Which of the two shows the field of smaller wave number, by its triangles."""
    said = "Both are said to be of a 128^3 cube of random waves. "
    surfaces = [name for name in printed if "triangles" in name]
    fewer = [printed[name] < implied[name] for name in surfaces]
    if all(fewer):
        which = "The figure must show a field of smaller wave\nnumber"
    elif not any(fewer):
        which = "The table must be of a field of smaller wave\nnumber, or of the same"
    else:
        return f"{said}Neither has fewer triangles throughout."
    return f"{said}{which}: a wave number is found for each below."


def beyond(mean: float, least: float, most: float) -> str:
    """How far a number is from a range that is printed."""
    apart = max(mean - most, 0.0) or min(mean - least, 0.0)
    return f"{apart:+.2f} beyond the range" if apart else "in the range"


def bound(most: int, printed: int) -> str:
    """Whether the largest number found keeps to a bound that is printed."""
    return f'"a maximum of {printed}": a bound, {"kept" if most <= printed else "broken"}'
