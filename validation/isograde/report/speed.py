"""What implementations cost beside one peer, measured in turn; the numbers that a page shows.

A record of a method has for each field the seconds of both, round by round, of the clock and of the
processor, the memory of one call of each, and the load of the machine before and after
(``validation/league/speed.py`` measures). A ratio is of the same round, of the processor's seconds,
and over rounds its median and quartiles are told.
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from isograde.stopwatch import quartiles

# A machine with more load than this on each processor is busy.
BUSY = 0.75


@dataclass(frozen=True)
class Cost:
    """What a method costs on one field.

    Attributes
    ----------
    field : the field's name
    ratio, low, high : processor's seconds over the peer's: median and quartiles over the rounds
    seconds, clock : median seconds of the processor and of the clock
    memory : megabytes over the peer's, None where the system does not count them
    megabytes : of the method and of the peer
    rounds : how often each was asked
    """

    field: str
    ratio: float
    low: float
    high: float
    seconds: float
    clock: float
    memory: float | None
    megabytes: tuple[float, float]
    rounds: int


@dataclass(frozen=True)
class Measured:
    """What a method costs on every field, and how it was measured.

    load : the highest load of the machine meanwhile, on each processor
    """

    name: str
    version: str
    date: str
    peer: str
    load: float
    costs: tuple[Cost, ...]

    @property
    def busy(self) -> bool:
        """Others worked on the machine: the ratios are rough."""
        return self.load > BUSY

    @property
    def ratio(self) -> float:
        """The geometric mean of the ratios over the fields."""
        return statistics.geometric_mean(cost.ratio for cost in self.costs)

    @property
    def memory(self) -> float | None:
        """The same of memory; None where a field has none."""
        found = [cost.memory for cost in self.costs]
        known = [one for one in found if one is not None]
        return statistics.geometric_mean(known) if known and len(known) == len(found) else None


def measured(record: Mapping[str, Any], name: str, peer: str) -> Measured | None:
    """What a record tells; None where it has no costs."""
    if not record.get("fields"):
        return None
    processors = record["machine"]["processors"]
    return Measured(
        name,
        record["version"],
        record["date"],
        peer,
        max(record["loads"]) / processors,
        tuple(_cost(field, said) for field, said in record["fields"].items()),
    )


def _cost(field: str, said: Mapping[str, Any]) -> Cost:
    """The cost on one field."""
    own, peer = said["own"], said["peer"]
    middle, low, high = quartiles([a[1] / b[1] for a, b in zip(own, peer, strict=True)])
    megabytes = (float(said["megabytes"][0]), float(said["megabytes"][1]))
    return Cost(
        field,
        middle,
        low,
        high,
        statistics.median(one[1] for one in own),
        statistics.median(one[0] for one in own),
        megabytes[0] / megabytes[1] if min(megabytes) > 0 else None,
        megabytes,
        len(own),
    )
