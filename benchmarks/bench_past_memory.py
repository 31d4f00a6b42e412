"""A surface larger than memory: 2048 x 2048 x 2048 samples that are made when they are read.

A file of 8 GB would only say how fast the disk is. The volume here is an object with a shape and a
type that computes the planes which are asked for, so reading one costs what computing it costs, and
no more than the planes in use are ever in memory. Three things are run in turn, each in a process
of its own: reading every plane; reading and comparing with the isovalue; extracting by slabs, whose
pieces are counted and let go. Counts are checked against the whole's identities: a closed surface
of triangles has three edges for two triangles, so 2 V - F = 4 for a ball.

Keeps the table in `reports/benchmarks/past_memory.md`.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
from isoref.fast.slabs import slabs
from isoref.field import Array
from pages import Page

ISOVALUE = 127.5
GIGABYTE = 1e9
MOST = 1.5


class Ball:
    """A ball in bytes, in side^3 samples, whose planes are computed when they are read."""

    def __init__(self, side: int) -> None:
        self.shape, self.dtype = (side,) * 3, np.dtype(np.uint8)
        self.squares = (np.linspace(-1, 1, side) ** 2).astype("f4")
        # A tenth of the side lies between black and white.
        self.plane = 128 + 640 * (np.float32(0.49) - self.squares[:, None] - self.squares)

    def __getitem__(self, planes: slice) -> Array:
        start, stop, _ = planes.indices(self.shape[0])
        made = np.empty((stop - start, *self.shape[1:]), self.dtype)
        room = np.empty_like(self.plane)
        for plane, square in zip(made, self.squares[start:stop], strict=True):
            np.subtract(self.plane, np.float32(640) * square, out=room)
            np.clip(room, 0, 255, out=room)
            plane[:] = room
        return made


class Found(NamedTuple):
    """What a run took, and what it counted."""

    seconds: float
    processor: float
    gigabytes: float
    vertices: int = 0
    triangles: int = 0


def read(side: int) -> tuple[int, int]:
    """Every plane is read, as the slabs read them."""
    ball = Ball(side)
    for first in range(side):
        ball[first : first + 1]
    return 0, 0


def compare(side: int) -> tuple[int, int]:
    """Every plane is read, and compared with the isovalue."""
    ball = Ball(side)
    for first in range(side):
        ball[first : first + 1] >= 128  # noqa: B015 - the pass itself is what is timed
    return 0, 0


def extract(side: int) -> tuple[int, int]:
    """Vertices and triangles of the surface, piece by piece."""
    vertices = triangles = 0
    for slab in slabs(Ball(side), ISOVALUE):
        vertices += len(slab.vertices)
        triangles += len(slab.simplices)
    return vertices, triangles


RUNS: dict[str, Callable[[int], tuple[int, int]]] = {
    "reading": read,
    "reading, and one threshold pass": compare,
    "extracting by slabs": extract,
}


def measured(name: str, side: int) -> Found:
    """What a run takes in this process, which has done nothing else."""
    start, used = time.perf_counter(), time.process_time()
    counts = RUNS[name](side)
    spent = time.perf_counter() - start, time.process_time() - used
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / GIGABYTE
    return Found(*spent, peak, *counts)


def main() -> None:
    """Run the table and write it down; status 1 where a count or the memory is not as it should."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=2048)
    parser.add_argument("--out", type=Path, default=Path("reports/benchmarks/past_memory.md"))
    arguments = parser.parse_args()
    page = Page(
        f"Past memory: {arguments.side}^3 bytes",
        "one run each, in a process of its own; planes are computed when they are read, so no disk "
        "is timed. Ratios are of processor time.",
    )
    found = {}
    for name in RUNS:
        with ProcessPoolExecutor(1, get_context("spawn")) as pool:
            found[name] = pool.submit(measured, name, arguments.side).result()
        print(name, found[name], flush=True)
    reading, threshold, surface = found.values()
    page.table(
        ["", "seconds", "of the processor", "over reading", "peak of the process, GB"],
        [
            [
                name,
                f"{one.seconds:.1f}",
                f"{one.processor:.1f}",
                f"{one.processor / reading.processor:.2f}",
                f"{one.gigabytes:.2f}",
            ]
            for name, one in found.items()
        ],
    )
    passes = (surface.processor - reading.processor) / max(
        threshold.processor - reading.processor, 1e-9
    )
    identity = 2 * surface.vertices - surface.triangles
    volume = arguments.side**3 / GIGABYTE
    mesh = (24 * surface.vertices + 24 * surface.triangles) / GIGABYTE
    page.add(
        f"The volume is {volume:.2f} GB, the mesh of {surface.vertices:,} vertices and "
        f"{surface.triangles:,} triangles {mesh:.2f} GB in double precision; neither was ever "
        f"whole in memory. Without the reading, extraction takes {passes:.1f} times one threshold "
        f"pass. 2 V - F is {identity}, and 4 for a closed surface without handles in one piece."
    )
    peak = (surface.gigabytes,) * 3
    what = f"peak of the process that extracts from {arguments.side}^3 bytes, GB"
    page.ask("past-memory", what, peak, MOST, most=True)
    other = f"beside it, reading alone takes {reading.gigabytes:.2f} GB"
    page.explain(what, other)
    page.show_goals()
    page.write(arguments.out)
    if identity != 4 or surface.gigabytes > MOST:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
