"""Implementations that misbehave, one way each, and `sound`, which does not.

They misbehave where the isovalue is `BAD`; at any other isovalue they answer with one triangle, so
that a test can see the run go on.
"""

import ctypes
import os
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

BAD = 0.5
TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
Answer = Any
Function = Callable[[Any, float, Any], Answer]


def misbehaving(act: Callable[[Any], Answer]) -> Function:
    """An extractor that does `act(values)` at the isovalue `BAD`."""

    def extract(values: Any, isovalue: float, spacing: Any) -> Answer:
        return act(values) if isovalue == BAD else TRIANGLE

    return extract


def printed(words: bytes) -> Answer:
    """The triangle, with words on every way to standard output."""
    print(words)
    os.write(1, words)
    subprocess.run(["echo", words], check=True)
    ctypes.CDLL(None).puts(words)
    ctypes.CDLL(None).fflush(None)
    return TRIANGLE


def grown() -> Answer:
    """Nothing: holds more and more until it is stopped."""
    held = []
    while True:
        held.append(np.ones(1 << 20))


def offspring() -> Answer:
    """Nothing: a child process holds the memory, this one waits for it."""
    greedy = "import time; held = bytearray(b'x') * (1 << 29); time.sleep(60)"
    subprocess.run([sys.executable, "-c", greedy], check=True)


def overwritten(values: Any) -> Answer:
    """The triangle, after writing into the array that was given."""
    values[0] = 7
    return TRIANGLE


def raised(error: BaseException) -> Answer:
    """Nothing: raises the error."""
    raise error


def flooded() -> Answer:
    """Nothing: prints for ever."""
    while True:
        print("x" * (1 << 20))


def closed() -> Answer:
    """Nothing: closes every descriptor it can find, and goes on for ever."""
    os.closerange(3, 64)
    time.sleep(60)


def scribble() -> None:
    """Write to every descriptor there may be, the protocol's too."""
    for descriptor in range(3, 16):
        try:
            os.write(descriptor, b"\x10\0\0\0 this is no frame, but as long as one")
        except OSError:
            continue


def unhinged() -> Answer:
    """Nothing: breaks the protocol, and goes on for ever."""
    scribble()
    time.sleep(60)


def forked() -> Answer:
    """The triangle, and a little later the same once more: a child forgets to leave."""
    if os.fork() == 0:
        time.sleep(0.1)
    return TRIANGLE


class Contrary:
    """A sequence of two that fails when it is made an array."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("no array")


class FalseMesh:
    """A mesh in name only."""

    faces = TRIANGLE[1]

    @property
    def vertices(self) -> Any:
        """Nothing: raises."""
        raise RuntimeError("no vertices today")


class TrueMesh:
    """A mesh as libraries have them."""

    vertices, faces = TRIANGLE


SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


sound = misbehaving(lambda _: TRIANGLE)
exits = misbehaving(lambda _: sys.exit(3))
exits_at_once = misbehaving(lambda _: os._exit(4))
segfaults = misbehaving(lambda _: ctypes.string_at(0))
aborts = misbehaving(lambda _: os.abort())
hangs = misbehaving(lambda _: time.sleep(60))
hangs_in_c = misbehaving(lambda _: ctypes.CDLL(None).pause())
floods = misbehaving(lambda _: flooded())
eats_memory = misbehaving(lambda _: grown())
eats_memory_elsewhere = misbehaving(lambda _: offspring())
asks_too_much = misbehaving(lambda _: np.empty(1 << 50))
raises = misbehaving(lambda _: raised(ValueError("no such field")))
declines = misbehaving(lambda _: raised(NotImplementedError("cubes only")))
prints = misbehaving(lambda _: printed(b'{"status": "ok"}'))
closes = misbehaving(lambda _: closed())
breaks_protocol = misbehaving(lambda _: unhinged())
forks = misbehaving(lambda _: forked())
overwrites = misbehaving(overwritten)
returns_none = misbehaving(lambda _: None)
returns_string = misbehaving(lambda _: "done")
returns_strings = misbehaving(lambda _: (["a"], ["b"]))
returns_three = misbehaving(lambda _: (*TRIANGLE, None))
returns_ragged = misbehaving(lambda _: ([[0, 0, 0], [1, 0]], [[0, 1, 2]]))
returns_objects = misbehaving(lambda _: (Contrary(), Contrary()))
returns_complex = misbehaving(lambda _: (TRIANGLE[0] * 1j, TRIANGLE[1]))
returns_nan = misbehaving(lambda _: (TRIANGLE[0] * np.nan, TRIANGLE[1]))
returns_wrong_shape = misbehaving(lambda _: (TRIANGLE[0].ravel(), TRIANGLE[1]))
returns_floats = misbehaving(lambda _: (TRIANGLE[0], TRIANGLE[1] * 1.0))
returns_one_based = misbehaving(lambda _: (TRIANGLE[0], TRIANGLE[1] + 1))
returns_huge = misbehaving(lambda _: (np.broadcast_to(0.0, (1 << 40, 3)), TRIANGLE[1]))
returns_large = misbehaving(lambda _: (np.zeros((1 << 23, 3)), TRIANGLE[1]))
returns_list_of_three = misbehaving(lambda _: [[0, 1, 2], [0, 1, 2], [0, 1, 2]])
returns_junk_rows = misbehaving(lambda _: (SQUARE, [[0, 1, 2], ["a", 1, 2, 3]]))
returns_two_corners = misbehaving(lambda _: (SQUARE, [[0, 1, 2, 3], [0, 1]]))
returns_padding_inside = misbehaving(lambda _: (SQUARE, [[0, -1, 2, 3]]))
returns_float_rows = misbehaving(lambda _: (SQUARE, [[0.0, 1, 2, 3], [0, 1, 2]]))
returns_object_array = misbehaving(lambda _: (SQUARE.astype(object), TRIANGLE[1]))
returns_beyond_integers = misbehaving(lambda _: (SQUARE, [[0, 1, 1 << 70]]))
returns_beyond_in_rows = misbehaving(
    lambda _: (SQUARE, [np.array([0, 1, (1 << 64) - 1], np.uint64), [0, 1, 2, 3]])
)
returns_flat_soup = misbehaving(lambda _: np.zeros((4, 9)))
returns_false_mesh = misbehaving(lambda _: FalseMesh())
returns_quads = misbehaving(lambda _: (SQUARE, np.array([[0, 1, 2, 3]])))
returns_polygons = misbehaving(lambda _: (SQUARE, [[0, 1, 2], [0, 1, 2, 3]]))
returns_soup = misbehaving(lambda _: SQUARE[[[0, 1, 2], [0, 2, 3]]])
returns_object = misbehaving(lambda _: TrueMesh())
returns_huge_indices = misbehaving(lambda _: (SQUARE, np.array([[0, 1, (1 << 64) - 1]], np.uint64)))
returns_quads_out_of_range = misbehaving(lambda _: (SQUARE, [[0, 1, 2, 4]]))
returns_float_quads = misbehaving(lambda _: (SQUARE, [[0.0, 1.0, 2.0, 3.0]]))
