"""Surfaces whose area, volume and topology are known in closed form.

Each field is smooth where its surface runs, is sampled far enough from any border that the surface
is closed (the gyroid and the Marschner-Lobb signal excepted), and stands off the lattice, so that
no sample is exactly at the isovalue.

Glossary
--------
h       spacing
kappa   largest curvature of the surface
facts   "area" and "volume" with their tolerances, "euler", "components"

How far from the truth a sound extractor may be
-----------------------------------------------
A vertex at the linear crossing of an edge is off by at most ``h**2 kappa / 8`` to leading order,
and a triangle within a cell leaves a surface of curvature kappa by its sagitta, at most
``3 h**2 kappa / 8`` for a diagonal of ``sqrt(3) h``. Together that is a shell of half
``h**2 kappa``. Twice that is the tolerance: area times ``h**2 kappa`` for the volume, and area
times ``(h kappa)**2`` for the area, which shrinks by kappa times the shell on either side. Where
two spheres meet in a crease, curvature says nothing: a strip of width h along it is added.

Numbers that pass through sine, cosine or exponential are rounded to multiples of ``2 ** -20``, so
that the last bit of a mathematical library does not change a vector.

References
----------
[1] S. R. Marschner, R. J. Lobb. An Evaluation of Reconstruction Filters for Volume Rendering.
    Visualization '94, section 4: the test signal with f_M = 6, alpha = 0.25.
[2] A. H. Schoen. Infinite Periodic Minimal Surfaces without Self-Intersections. NASA TN D-5541,
    1970: the gyroid, here by its first Fourier terms.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from math import pi, sqrt
from typing import Any

import numpy as np
from isoref.field import Field, Floats

from isograde.model import Case

# Off-centre, so that no sample falls on a surface and no symmetry hides a fault.
OFFSET = (0.0371, -0.0213, 0.0117)


@dataclass(frozen=True)
class Lattice:
    """`shape` samples of these spacings, with the origin of coordinates near the middle."""

    shape: tuple[int, int, int]
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(np.prod(self.shape))

    def coordinates(self, offset: tuple[float, float, float] = OFFSET) -> list[Floats]:
        """x, y, z of the samples, the middle at minus `offset`."""
        axes = [
            (np.arange(n) - (n - 1) / 2) * h - o
            for n, h, o in zip(self.shape, self.spacing, offset, strict=True)
        ]
        return list(np.meshgrid(*axes, indexing="ij", sparse=True))

    def field(self, values: Floats) -> Field:
        """The field of these values."""
        return Field.of(np.broadcast_to(values, self.shape).copy(), self.spacing, self.origin)


def cube(n: int, side: float = 2.0) -> Lattice:
    """N samples along each side of a cube."""
    return Lattice((n, n, n), (side / (n - 1),) * 3)


def known(
    lattice: Lattice,
    curvature: float,
    *,
    area: float,
    volume: float,
    euler: int,
    components: int = 1,
    crease: float = 0.0,
) -> Mapping[str, Any]:
    """The facts, with the tolerances that spacing, curvature and length of crease allow."""
    h = max(lattice.spacing)
    return {
        "area": area,
        "area_tolerance": area * (h * curvature) ** 2 + crease * h,
        "volume": volume,
        "volume_tolerance": area * h**2 * curvature + crease * h**2,
        "euler": euler,
        "components": components,
    }


def rounded(values: Floats) -> Floats:
    """Multiples of ``2 ** -20``."""
    return np.asarray(np.rint(values * 2.0**20) * 2.0**-20)


def sphere(lattice: Lattice, radius: float) -> Field:
    """``radius**2 - |x|**2``."""
    x, y, z = lattice.coordinates()
    return lattice.field(radius**2 - (x * x + y * y + z * z))


def torus(lattice: Lattice, ring: float, tube: float) -> Field:
    """``tube`` minus the distance from a circle of radius `ring` in the plane z = 0."""
    x, y, z = lattice.coordinates()
    return lattice.field(tube - np.sqrt((np.sqrt(x * x + y * y) - ring) ** 2 + z * z))


def handlebody(lattice: Lattice, genus: int) -> Field:
    """A thickened ellipse with `genus` holes in a row: ``P(x, y) - (z / t)**2``.

    P is the product of an ellipse and the outsides of discs that do not meet, so its gradient
    does not vanish where P does, and the surface is the double of the holed ellipse.
    """
    x, y, z = lattice.coordinates()
    P = 1 - (x / (0.75 * genus + 0.25)) ** 2 - (y / 1.05) ** 2
    for hole in range(genus):
        centre = 1.4 * (hole - (genus - 1) / 2)
        away = (x - centre) ** 2 + y * y
        P = P * (away - 0.42**2) / (away + 0.42**2)
    return lattice.field(P - (z / 0.5) ** 2)


def gyroid(lattice: Lattice) -> Field:
    """The gyroid's first Fourier terms [2]; one period is 2 pi."""
    x, y, z = lattice.coordinates()
    wave = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    return lattice.field(rounded(wave))


def marschner_lobb(lattice: Lattice) -> Field:
    """The test signal of Marschner and Lobb [1] on the cube from -1 to 1."""
    x, y, z = lattice.coordinates((0.0, 0.0, 0.0))
    radial = np.cos(2 * pi * 6 * np.cos(pi * np.sqrt(x * x + y * y) / 2))
    signal = (1 - np.sin(pi * z / 2) + 0.25 * (1 + radial)) / (2 * 1.25)
    return lattice.field(rounded(signal))


def plate(lattice: Lattice, radius: float, half: float) -> Field:
    """An ellipsoid of revolution, `half` thinner than a spacing: one layer of inside samples."""
    x, y, z = lattice.coordinates((OFFSET[0], OFFSET[1], 0.0))
    return lattice.field(1 - (x * x + y * y) / radius**2 - (z / half) ** 2)


def tilted_plate(lattice: Lattice, radius: float, half: float) -> Field:
    """A round plate across the lattice, thinner than a spacing: its samples are an archipelago."""
    x, y, z = lattice.coordinates()
    across = np.abs(2 * x + 3 * y + 6 * z) / 7
    return lattice.field(np.minimum(half - across, radius - np.sqrt(x * x + y * y + z * z)))


def two_spheres(lattice: Lattice, radius: float, distance: float) -> Field:
    """The union of two equal spheres, their centres this far apart along x."""
    x, y, z = lattice.coordinates()
    around = y * y + z * z
    left = radius - np.sqrt((x + distance / 2) ** 2 + around)
    right = radius - np.sqrt((x - distance / 2) ** 2 + around)
    return lattice.field(np.maximum(left, right))


def sphere_facts(lattice: Lattice, r: float) -> Mapping[str, Any]:
    """A sphere of radius r."""
    return known(lattice, 1 / r, area=4 * pi * r**2, volume=4 / 3 * pi * r**3, euler=2)


def torus_facts(lattice: Lattice, R: float, r: float) -> Mapping[str, Any]:
    """A torus of radii R and r."""
    return known(lattice, 1 / r, area=4 * pi**2 * R * r, volume=2 * pi**2 * R * r**2, euler=0)


def two_spheres_facts(lattice: Lattice, r: float, d: float) -> Mapping[str, Any]:
    """Two spheres of radius r at distance d; each loses a cap where they overlap."""
    height = max(r - d / 2, 0.0)
    area = 2 * (4 * pi * r**2 - 2 * pi * r * height)
    volume = 2 * (4 / 3 * pi * r**3 - pi * height**2 * (r - height / 3))
    crease = 2 * pi * sqrt(max(r**2 - d**2 / 4, 0.0))
    parts = 1 if height else 2
    return known(
        lattice, 1 / r, area=area, volume=volume, euler=2 * parts, components=parts, crease=crease
    )


def _case(
    name: str,
    lattice: Lattice,
    build: Callable[..., Field],
    *parameters: float,
    facts: Mapping[str, Any] | None = None,
    tags: str = "closed",
    isovalue: float = 0.0,
) -> Case:
    """The case of this name; `tags` are separated by spaces."""
    labels = frozenset({"analytic", *tags.split()})
    made = partial(build, lattice, *parameters)
    return Case(f"analytic/{name}", made, (isovalue,), lattice.samples, labels, facts or {})


def cases(seed: int = 0) -> list[Case]:
    """All analytic cases; they do not depend on the seed."""
    del seed
    return [*_round(), *_thin(), *_open()]


def _round() -> list[Case]:
    """Spheres, tori and handlebodies."""
    made = []
    for n, tags in ((9, "closed posed"), (24, "closed"), (64, "closed full"), (128, "closed full")):
        made.append(
            _case(f"sphere-{n}", cube(n), sphere, 0.7, facts=sphere_facts(cube(n), 0.7), tags=tags)
        )
    uneven = Lattice((16, 22, 28), (0.13, 0.095, 0.07), (5.0, -3.0, 0.25))
    facts = sphere_facts(uneven, 0.7)
    made.append(_case("sphere-uneven", uneven, sphere, 0.7, facts=facts, tags="closed posed"))
    ring = Lattice((30, 30, 14), (0.08, 0.08, 0.08))
    facts = torus_facts(ring, 0.7, 0.3)
    made.append(_case("torus", ring, torus, 0.7, 0.3, facts=facts))
    for genus in (2, 3):
        long = Lattice((20 * genus + 8, 32, 16), (0.08, 0.08, 0.08))
        facts = {"euler": 2 - 2 * genus, "components": 1}
        made.append(_case(f"genus-{genus}", long, handlebody, genus, facts=facts))
    return made


def _thin() -> list[Case]:
    """Plates thinner than a spacing, and spheres that nearly or just touch."""
    flat = Lattice((21, 21, 7), (0.1, 0.1, 0.1))
    whole = {"euler": 2, "components": 1}
    made = [
        _case("plate", flat, plate, 0.8, 0.07, facts=whole),
        _case("plate-tilted", cube(21), tilted_plate, 0.8, 0.03),
    ]
    pair = Lattice((40, 20, 20), (0.075, 0.075, 0.075))
    for name, distance in (("apart", 1.35), ("touching", 1.2), ("merged", 1.0)):
        facts = dict(two_spheres_facts(pair, 0.6, distance))
        if name == "touching":
            # Drop what a point of contact leaves open: one part or two.
            facts = {key: value for key, value in facts.items() if key not in _TOPOLOGY}
        made.append(_case(f"spheres-{name}", pair, two_spheres, 0.6, distance, facts=facts))
    return made


_TOPOLOGY = ("euler", "components")


def _open() -> list[Case]:
    """Surfaces that end at the border of the volume."""
    made = []
    for n, tags in ((24, ""), (96, "full")):
        made.append(_case(f"gyroid-{n}", cube(n, 4 * pi), gyroid, tags=tags))
    for n, tags in ((25, ""), (41, "full")):
        made.append(_case(f"marschner-lobb-{n}", cube(n), marschner_lobb, tags=tags, isovalue=0.5))
    return made
