"""Exercise 8: tunnels. Two things in it are wrong.

Read lesson 8, mend this file, and ask: isograde exercise 8 exercise_8.py
"""

import numpy as np
from isoref import asymptotic_decider, trilinear_cubes
from isoref.fast.sweep import sweep
from isoref.field import Field
from isoref.rule import Rule
from isoref.trilinear_cubes import INSIDE_TUNNEL, OUTSIDE_TUNNEL, interpolate, quadratic

declaration = {"name": "exercise 8", "level": 4}


def tunnels(g):
    """For n cells, g (8, n): whether there is a tunnel, and whether inside corners go through."""
    c0, c1, c2 = quadratic(g, axis=0)
    there = (c1 * c1 > 4 * c0 * c2) & (c0 * c2 > 0) & (c0 * c1 < 0)
    middle = np.full((g.shape[1], 3), 0.5)
    return there, interpolate(g, middle) >= 0


def decisions(g):
    """The faces by the asymptotic decider, and two bits for tunnels."""
    there, inside = tunnels(g)
    bits = np.where(inside, INSIDE_TUNNEL, OUTSIDE_TUNNEL)
    return asymptotic_decider.decisions(g) | np.where(there, bits, 0)


MINE = Rule("mine", trilinear_cubes.RULE.tile, decisions, trilinear_cubes.RULE.asks, bits=8)


def extract(values, isovalue, spacing):
    """The surface by the tiles of the reference, and the decisions of this file."""
    mesh = sweep(MINE, Field.of(values, spacing), isovalue)
    return mesh.vertices, mesh.simplices
