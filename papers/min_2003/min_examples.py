"""The fields of Min's sections 6 and 7, as functions of positions with slopes that bound them.

Each example says where it stands in the paper and where the print had to be read otherwise. A
slope is per unit of length, a row a component, a column an axis; `steps` turns slopes into the
bound per sample step that `isoref.dyadic` takes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np
from isoref.dyadic import LipschitzBound, Samples, SlopeBound
from isoref.field import Field, Floats


@dataclass(frozen=True, eq=False)
class Example:
    """A function on a box, with bounds on its slopes.

    Attributes
    ----------
    phi : positions (P, n) to values (P, m)
    low, high : corners of the box, n numbers each
    slopes : (m, n) bounds on the partial derivatives
    """

    phi: Callable[[Floats], Floats]
    low: Floats
    high: Floats
    slopes: Floats

    def spacing(self, cells: int) -> Floats:
        """Sample steps with this many cells along each axis."""
        return (self.high - self.low) / cells

    def samples(self, cells: int) -> Samples:
        """The lattice of cells + 1 samples a side, none computed yet."""
        shape = (cells + 1,) * len(self.low)
        return Samples.of_function(self.phi, shape, list(self.spacing(cells)), list(self.low))

    def field(self, cells: int) -> Field:
        """All samples of that lattice."""
        lattice = self.samples(cells)
        numbers = np.array_split(
            np.arange(np.prod(lattice.shape)), 1 + (cells ** len(self.low) >> 20)
        )
        values = np.concatenate([lattice.at(part).T for part in numbers], axis=1)
        return Field.of(
            values.reshape(-1, *lattice.shape),
            lattice.spacing,
            lattice.origin,
            dimension=len(self.low),
        )

    def bound(self, cells: int) -> SlopeBound:
        """The tighter bound: slopes by component and axis."""
        return SlopeBound(self.slopes * self.spacing(cells))

    def paper_bound(self, cells: int, constant: float | None = None) -> LipschitzBound:
        """The paper's bound: one constant per unit of length in the maximum norm, and its box.

        Without a constant it is the sum of the slopes, which is safe. The longest sample step
        stands for all, as the longest edge of a box does in section 6.
        """
        L = float(self.slopes.sum(axis=1).max()) if constant is None else constant
        return LipschitzBound(L * float(self.spacing(cells).max()))


def cone() -> Example:
    """Figure 3: max(|x|, |y|) on [-1, 1]^2, which is 0 at one point only."""
    return Example(
        lambda x: abs(x).max(axis=1, keepdims=True), -np.ones(2), np.ones(2), np.ones((1, 2))
    )


def helix() -> Example:
    """Section 7.1: x = cos(pi t), y = sin(pi t), one turn of a helix, n = 3, m = 2.

    The print has x_i = (i - N) / N on 0 .. N, which ends at 0; the domain it names is [-1, 1].
    """

    def phi(x: Floats) -> Floats:
        return x[:, :2] - np.stack([np.cos(pi * x[:, 2]), np.sin(pi * x[:, 2])], axis=1)

    return Example(phi, -np.ones(3), np.ones(3), np.array([[1, 0, pi], [0, 1, pi]]))


def leaf_radius(angle: Floats) -> Floats:
    """Section 7.2: r = 1 + sin(7 theta)."""
    return np.asarray(1 + np.sin(7 * angle))


def leaf(half: float) -> Example:
    """Section 7.2, the singular curve as a level set in the plane, n = 2, m = 1.

    Inside is where r < 1 + sin(7 theta) here, so that the leaves are inside. The print takes
    arctan(y / x), which knows half of the angles; the whole angle is meant. It also takes
    [-1, 1]^2, which cuts the leaves off at 1 of 2; `half` is half the side of the square. No
    slope bounds this function at the origin.
    """

    def psi(x: Floats) -> Floats:
        angle = np.arctan2(x[:, 1], x[:, 0])
        return (leaf_radius(angle) - np.hypot(x[:, 0], x[:, 1]))[:, None]

    ends = np.full(2, half)
    return Example(psi, -ends, ends, np.full((1, 2), np.inf))


def printed_angle(x: Floats) -> Floats:
    """arctan(y / x), as sections 7.2 and 7.3 print it: half of all angles; 0 where both are 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(np.arctan(x[:, 1] / x[:, 0]), nan=0.0)


def printed_leaf(N: int) -> Example:
    """Section 7.2 letter for letter: a_i = -1 + 2 i / N for i in 1 .. N, psi by arctan(y / x).

    Its lattice has N samples a side, N - 1 cells.
    """

    def psi(x: Floats) -> Floats:
        return (np.hypot(x[:, 0], x[:, 1]) - leaf_radius(printed_angle(x)))[:, None]

    return Example(psi, np.full(2, -1 + 2 / N), np.ones(2), np.full((1, 2), np.inf))


def on_printed_lattice(example: Example, N: int) -> Example:
    """The same function on the lattice that section 7.2 prints: 1 .. N, not 0 .. N.

    Its lattice has N samples a side, N - 1 cells.
    """
    low = np.array([-1 + 2 / N, -1 + 2 / N, 2 * pi / N])[: len(example.low)]
    high = np.array([1.0, 1.0, 2 * pi])[: len(example.low)]
    return Example(example.phi, low, high, example.slopes)


def lifted_leaf(half: float) -> Example:
    """Section 7.2, the same curve with its angle as a third coordinate, n = 3, m = 2."""

    def phi(x: Floats) -> Floats:
        angle = x[:, 2]
        r = leaf_radius(angle)
        return x[:, :2] - np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)

    # |d/dt r cos t| <= |r'| + r <= 7 + 2.
    low, high = np.array([-half, -half, 0.0]), np.array([half, half, 2 * pi])
    return Example(phi, low, high, np.array([[1, 0, 9.0], [0, 1, 9.0]]))


def spindle() -> Example:
    """Section 7.3, the singular surface as a level set in space, n = 3, m = 1.

    The print takes cos(2 arctan(y / x)) for cos(2 phi), the angle about the z-axis for the angle
    from it; cos(2 phi) = (z^2 - x^2 - y^2) / r^2 is meant.
    """

    def psi(x: Floats) -> Floats:
        r = np.linalg.norm(x, axis=1)
        cos = np.divide(2 * x[:, 2] ** 2, r**2, out=np.ones_like(r), where=r > 0)
        return (cos - r)[:, None]

    ends = np.full(3, 2.0) * 1.05
    return Example(psi, -ends, ends, np.full((1, 3), np.inf))


def printed_spindle(N: int, letter: bool) -> Example:
    """Section 7.3 on its printed lattice, a_i = -2 + 4 i / N for i in 1 .. N: psi by arctan(y / x).

    letter : whether psi is taken letter for letter; else by the angle from the axis
    """

    def psi(x: Floats) -> Floats:
        r = np.linalg.norm(x, axis=1)
        return (r - 1 - np.cos(2 * printed_angle(x)))[:, None]

    low, high = np.full(3, -2 + 4 / N), np.full(3, 2.0)
    return Example(psi if letter else spindle().phi, low, high, np.full((1, 3), np.inf))


def lifted_spindle() -> Example:
    """Section 7.3: the surface with both its angles as coordinates, n = 5, m = 3.

    The print writes phi into R^2 and lists three equations. With r = 2 cos^2 phi the slopes along
    phi are those of 2 cos^2 phi sin phi and 2 cos^3 phi: at most 2 and 4 cos^2 sin <= 2.31.
    """

    def phi(x: Floats) -> Floats:
        theta, polar = x[:, 3], x[:, 4]
        across = 2 * np.cos(polar) ** 2 * np.sin(polar)
        surface = [across * np.cos(theta), across * np.sin(theta), 2 * np.cos(polar) ** 3]
        return x[:, :3] - np.stack(surface, axis=1)

    # The largest cos^2 sin is 2 / (3 sqrt 3), where sin^2 = 1/3.
    peak = 2 / 3**1.5
    low, high = np.array([-2.0, -2, -2, 0, 0]), np.array([2, 2, 2, 2 * pi, pi])
    slopes = np.array(
        [[1, 0, 0, 2 * peak, 2], [0, 1, 0, 2 * peak, 2], [0, 0, 1, 0, 6 * peak]], float
    )
    return Example(phi, low, high, slopes)


def spindle_constants(places: int = 100_001) -> Floats:
    """(3,) the largest sum of slopes at one place of each equation of the lifted spindle.

    By its formula on so many values of the angle from the axis; the worst angle about the axis is
    known: ``|a cos t| + |b sin t|`` is at most the root of a^2 + b^2.
    """
    polar = np.linspace(0, pi, places)
    cos, sin = np.cos(polar), np.sin(polar)
    turn = 2 * cos**2 * sin
    rise = 2 * cos**3 - 4 * cos * sin**2
    about = 1 + np.hypot(turn, rise).max()
    return np.array([about, about, 1 + np.abs(6 * cos**2 * sin).max()])


def complex_circle(half: float = 1.5) -> Example:
    """Section 7.4: z1^2 + z2^2 = 1 in C^2 = R^4 with coordinates x, y, p, q; m = 2.

    The print names no domain; [-half, half]^4 is ours.
    """

    def phi(x: Floats) -> Floats:
        f = (x[:, 0] + 1j * x[:, 1]) ** 2 + (x[:, 2] + 1j * x[:, 3]) ** 2 - 1
        return np.stack([f.real, f.imag], axis=1)

    ends = np.full(4, half)
    return Example(phi, -ends, ends, np.full((2, 4), 2 * half))


def two_spheres(half: float = 1.3) -> Example:
    """Section 7.5: unit spheres of R^4 about (0, 0, 0, -1/2) and (0, 0, 0, 1/2); m = 2.

    They meet in the sphere x^2 + y^2 + z^2 = 3/4, w = 0.
    """

    def phi(x: Floats) -> Floats:
        across = (x[:, :3] ** 2).sum(axis=1) - 1
        return np.stack([across + (x[:, 3] - 0.5) ** 2, across + (x[:, 3] + 0.5) ** 2], axis=1)

    ends = np.full(4, half)
    along = 2 * half + 1
    slopes = np.array([[2 * half] * 3 + [along]] * 2)
    return Example(phi, -ends, ends, slopes)
