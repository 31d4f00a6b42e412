"""Exercise 8: tunnels. Two things in it were wrong.

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
    there = np.ones(g.shape[1], bool)
    product, middle = np.ones(g.shape[1]), np.zeros((g.shape[1], 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        for axis in range(3):
            c0, c1, c2 = quadratic(g, axis)
            there &= (c1 * c1 > 4 * c0 * c2) & (c0 * c2 > 0) & (c0 * c1 < 0)
            product *= np.sign(c0)
            middle[:, axis] = (2 * c0 - c1) / (2 * (c0 - c1 + c2))
        return there & (product < 0), interpolate(g, middle) >= 0


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
