"""A fireball of our own: a temperature on t, r, z that splits in two (section III.C, Figs. 30-33).

The simulation of the paper is not published. This formula has what its Fig. 30 shows: one hot zone
that cools while it stretches along z, falls apart into two, and is cold in the last frame::

    T(t, r, z) = T0 exp(-t / tau) exp(-r^2 / 2 R(t)^2) (g(z - v t)^4 + g(z + v t)^4)^(1/4)
    g(z) = exp(-z^2 / 2 w^2),   R(t) = R0 + u t

Glossary
--------
t   frame, 0 .. 32, one a unit of time
r   radius, 0 .. 11.5 fm in steps of half a fm; there is nothing at r < 0
z   longitudinal direction, -15 .. 15 fm in steps of half a fm
"""

from __future__ import annotations

import numpy as np
from isoref.field import Field

FREEZE_OUT = 139.0  # MeV, the paper's
FRAMES, RADII, LENGTHS = 33, 24, 61
T0, TAU = 235.0, 60.0  # MeV, frames
WIDTH, SPEED = 6.0, 0.255  # fm, fm a frame
RADIUS, EXPANSION = 4.0, 0.05  # fm, fm a frame


def temperature(radii: int = RADII, lengths: int = LENGTHS, hottest: float = T0) -> Field:
    """The field T[t, r, z] in MeV, (33, 24, 61) as in Fig. 30, or with other sides.

    The paper's Table IV is of a "slightly larger 3D data set", 33 images of 241 x 81 pixels: more
    samples around the same fireball. `hottest` is the temperature in the middle of frame 0.
    """
    t = np.arange(FRAMES)[:, None, None]
    r = 0.5 * np.arange(radii)[:, None]
    z = 0.5 * (np.arange(lengths) - lengths // 2)
    ahead, behind = (np.exp(-4 * (z - s * SPEED * t) ** 2 / (2 * WIDTH**2)) for s in (1, -1))
    across = np.exp(-(r**2) / (2 * (RADIUS + EXPANSION * t) ** 2))
    values = hottest * np.exp(-t / TAU) * across * (ahead + behind) ** 0.25
    return Field.of(values, spacing=(1, 0.5, 0.5), origin=(0, 0, z[0]))


def hottest_with(active: int, radii: int, lengths: int) -> float:
    """The temperature of the middle of frame 0 at which so many voxels are active.

    The field is proportional to it, so the voxel of that rank decides.

    >>> field = temperature(24, 61, hottest_with(5000, 24, 61))
    >>> int((field.values >= FREEZE_OUT).sum())
    5000
    """
    ranked = np.sort(temperature(radii, lengths, 1.0).values, axis=None)[::-1]
    between = (ranked[active - 1] + ranked[active]) / 2
    # The field is symmetric in z: where voxels come in pairs, an odd number cannot be had.
    return float(FREEZE_OUT / between)
