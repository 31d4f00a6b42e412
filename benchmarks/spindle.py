"""Min's lifted spindle in five dimensions, cut whenever a line asks for it (`outside.py`).

``python benchmarks/spindle.py REFERENCE N`` uses the `isoref` in the folder REFERENCE, be it the
first version's, which had no `isoref.fast`. Nothing else of the project is imported here.
"""

from __future__ import annotations

import resource
import sys
import time
from math import pi

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, sys.argv[1])

from isoref.dyadic import Samples, SlopeBound
from isoref.field import Floats


def spindle(x: Floats) -> Floats:
    """Min, section 7.3: a surface of revolution with its two angles, in R^5."""
    theta, polar = x[:, 3], x[:, 4]
    across = 2 * np.cos(polar) ** 2 * np.sin(polar)
    surface = [across * np.cos(theta), across * np.sin(theta), 2 * np.cos(polar) ** 3]
    return np.asarray(x[:, :3] - np.stack(surface, axis=1))


def spindle_5d(N: int) -> tuple[Samples, SlopeBound]:
    """The lifted spindle on N cells a side, with slopes that bound it."""
    h = np.array([4 / N, 4 / N, 4 / N, 2 * pi / N, pi / N])
    samples = Samples.of_function(spindle, (N + 1,) * 5, list(h), [-2, -2, -2, 0, 0])
    slopes = np.array([[1, 0, 0, 0.77, 2], [0, 1, 0, 0.77, 2], [0, 0, 1, 0, 2.31]])
    return samples, SlopeBound(slopes * h)


def serve(N: int) -> None:
    """Answer each line with seconds, those of the processor, simplices, and the peak in bytes."""
    try:
        from isoref.fast.dyadic import extract_dyadic as cut
    except ImportError:  # The first version.
        from isoref.dyadic import extract_dyadic as cut  # type: ignore[assignment]
    made = spindle_5d(N)
    print("> ready", flush=True)
    for line in sys.stdin:
        if line.strip() == "end":
            break
        start, used = time.perf_counter(), time.process_time()
        count = len(cut(*made).simplices)
        spent = time.process_time() - used
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
        print(f"> {time.perf_counter() - start} {spent} {count} {peak}", flush=True)


if __name__ == "__main__":
    serve(int(sys.argv[2]))
