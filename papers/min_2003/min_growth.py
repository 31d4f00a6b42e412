"""How counts grow with N: a power alone, or a power times the logarithm.

Section 6 gives a dyadic grid the size O(N^(n-m)), and O(N^(n-m) log N) with "optional spaces" for
its tree. Times of small runs cannot tell these apart; counts can. Divided by N^p, p = n - m, a
count tends to a constant under the first law, with a correction that dies away as 1 / N, and rises
by the same amount at every doubling under the second. Both are fitted with two numbers each::

    count / N^p = a + b / N          a power
    count / N^p = a + b log2 N       a power times the logarithm
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from isograde.reproduction import Table
from scipy import stats


@dataclass(frozen=True)
class Growth:
    """Both fits of one count.

    power, logarithm : (a, b) of each law
    errors : root mean square of what each law leaves, relative to the mean of count / N^p
    """

    power: tuple[float, float]
    logarithm: tuple[float, float]
    errors: tuple[float, float]

    @property
    def supported(self) -> str:
        """The law that leaves less."""
        return "N^p" if self.errors[0] < self.errors[1] else "N^p log N"


def growth(sizes: Sequence[int], counts: Sequence[float], p: int) -> Growth:
    """Both laws fitted by least squares. Raises ValueError for fewer than three sizes.

    >>> growth([8, 16, 32, 64], [64 + 8, 256 + 16, 1024 + 32, 4096 + 64], 2).supported
    'N^p'
    >>> growth([8, 16, 32, 64], [3 * 64, 4 * 256, 5 * 1024, 6 * 4096], 2).supported
    'N^p log N'
    """
    if len(sizes) < 3:
        raise ValueError(f"two numbers are fitted: give at least three sizes, not {len(sizes)}")
    N = np.array(sizes, float)
    share = np.array(counts, float) / N**p
    fits, errors = [], []
    for column in (1 / N, np.log2(N)):
        design = np.stack([np.ones_like(N), column], axis=1)
        found = np.linalg.lstsq(design, share)[0]
        fits.append((float(found[0]), float(found[1])))
        left = float(np.sqrt(np.mean((design @ found - share) ** 2)) / share.mean())
        # Below rounding every fit is perfect, and none better than another.
        errors.append(max(left, float(np.finfo(float).eps)))
    return Growth(fits[0], fits[1], (errors[0], errors[1]))


def slope(sizes: Sequence[int], numbers: Sequence[float]) -> tuple[float, float]:
    """The exponent of a plain power through all sizes, and half its 95 % interval.

    >>> slope([1, 2, 4], [3, 12, 48])
    (2.0, 0.0)
    """
    fit = stats.linregress(np.log2(sizes), np.log2(numbers))
    half = stats.t.ppf(0.975, len(sizes) - 2) * fit.stderr
    return round(float(fit.slope), 9), round(float(half), 9)


def add_slope(
    table: Table, what: str, sizes: Sequence[int], numbers: Sequence[float], p: float | None
) -> None:
    """A row with the exponent of a plain power beside p, within the interval of the fit.

    Without p it is measured only: a time has a fixed cost too, so that it is no plain power.
    """
    found, half = slope(sizes, numbers)
    note = f"N from {sizes[0]:,} to {sizes[-1]:,}; 95 % interval of the fit ± {half:.2g}"
    table.add(what, None, found, expected=p, tolerance=half, note=note)


def laws(title: str, sizes: Sequence[int], counted: dict[str, Sequence[float]], p: int) -> str:
    """A table of both laws for each count, and which is supported."""
    lines = [
        f"## {title}",
        "",
        "| count | N | a + b / N leaves | a + b log2 N leaves | supported | slope, two largest N |",
        "| --- | --- | ---: | ---: | --- | ---: |",
    ]
    for name, counts in counted.items():
        found = growth(sizes, counts, p)
        last = float(np.log2(counts[-1] / counts[-2]) / np.log2(sizes[-1] / sizes[-2]))
        left = " | ".join(f"{error:.2%}" for error in found.errors)
        span = f"{sizes[0]:,} to {sizes[-1]:,}"
        lines.append(f"| {name} | {span} | {left} | {found.supported} | {last:.3f} |")
    lines += ["", f"Counts divided by N^p, p = {p}, fitted by both laws (`min_growth.py`)."]
    return "\n".join(lines) + "\n"
