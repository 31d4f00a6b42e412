"""Exercise 7: a rule with two faults that few fields show. Two things in it were wrong.

Read lesson 7, mend this file, and ask: isograde exercise 7 exercise_7.py
"""

import numpy as np
from isoref.asymptotic_decider import RULE
from isoref.cube import FACE_CORNERS, ambiguous_faces
from isoref.fast.sweep import sweep
from isoref.field import Field
from isoref.rule import Rule

declaration = {"name": "exercise 7", "level": 3}


def asks(signs):
    """Whether a cell with these inside corners is asked for decisions; if not, they are 0."""
    return len(ambiguous_faces(signs)) > 0


def separated(a, b, c, d):
    """Whether a face cuts off each of its inside corners: arrays of values minus the isovalue.

    The four stand round the face, so a and c are opposite, and b and d.
    """
    return np.where(a >= 0, a * c < b * d, b * d < a * c)


def decisions(g):
    """A bit for each of six faces: it is ambiguous, and its inside corners are separated."""
    bits = np.zeros(g.shape[1], np.int64)
    for face, corners in enumerate(FACE_CORNERS):
        a, b, c, d = g[list(corners)]
        ambiguous = ((a >= 0) == (c >= 0)) & ((b >= 0) == (d >= 0)) & ((a >= 0) != (b >= 0))
        bits |= (ambiguous & separated(a, b, c, d)).astype(np.int64) << face
    return bits


MINE = Rule("mine", RULE.tile, decisions, asks, bits=6)


def extract(values, isovalue, spacing):
    """The surface by the tiles of the reference, and the decisions of this file."""
    mesh = sweep(MINE, Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices
