"""Fields of the plan that are too large to print, as the lines of Python that make them.

A snippet is read and run without the grader, so it makes the samples of a known case by its
formula: `values`, `isovalue` and `spacing`, with `origin`, the place of the first sample, and what
is known of the answer. A test runs the lines of each case and compares what they make with the
case itself, number for number up to rounding.

Of curves there are the two functions, `first` and `second`, and `known`, dense polylines on which
both vanish. Of manifolds there is `phi`, which gives (P, m) values of (P, n) points.
"""

from __future__ import annotations

from math import prod

import numpy as np

from isograde.cases.accuracy import QUALITY, TUBE, Body, row
from isograde.cases.cost import PASSES, SHAPES
from isograde.model import Case
from isograde.oracles.known_manifolds import Manifold

# --- curves in space -----------------------------------------------------------------------------

SAMPLED = """
shape, half, isovalue = (24, 27, 25), {half}, {isovalue}
axes = [np.linspace(-half, half, count) for count in shape]
x, y, z = np.meshgrid(*axes, indexing="ij")
values = np.stack([first(x, y, z) + isovalue[0], second(x, y, z) + isovalue[1]])
spacing, origin = tuple(2 * half / (count - 1) for count in shape), (-half,) * 3
"""
ONCE_ROUND = "t = np.linspace(0, 2 * np.pi, 1001)"
CYLINDERS = """
# A thin cylinder along z through a thicker one along x: two closed curves, above and below.
r, wide, x0, y0, z0 = 0.6, 0.9, 0.011, 0.017, 0.023


def first(x, y, z):
    return r**2 - (x - x0) ** 2 - (y - y0) ** 2


def second(x, y, z):
    return wide**2 - (y - y0) ** 2 - (z - z0) ** 2


t = np.linspace(0, 2 * np.pi, 1001)
height = np.sqrt(wide**2 - (r * np.sin(t)) ** 2)
known = [np.stack([x0 + r * np.cos(t), y0 + r * np.sin(t), z0 + side * height], axis=1)
         for side in (1, -1)]
"""
# A knot or link by a complex polynomial in two coordinates of the three-sphere.
TORUS_LINK = """
# u^2 - v^{n} vanishes on {what}; u and v by stereographic projection, turned and shifted.
about_z = np.array([[np.cos(0.3), -np.sin(0.3), 0], [np.sin(0.3), np.cos(0.3), 0], [0, 0, 1]])
about_x = np.array([[1, 0, 0], [0, np.cos(0.7), -np.sin(0.7)], [0, np.sin(0.7), np.cos(0.7)]])
turn, shift = about_x @ about_z, np.array([0.021, -0.034, 0.012])


def wave(x, y, z):
    p = np.tensordot(turn.T, np.stack([x - shift[0], y - shift[1], z - shift[2]]), axes=1)
    r2 = (p**2).sum(axis=0)
    u, v = (r2 - 1 + 2j * p[2]) / (r2 + 1), 2 * (p[0] + 1j * p[1]) / (r2 + 1)
    return u**2 - v**{n}


def first(x, y, z):
    return wave(x, y, z).real


def second(x, y, z):
    return wave(x, y, z).imag


# There |v| is beta, where beta^{n} + beta^2 = 1, and u = v^({n} / 2).
beta = {beta}
t, known = np.linspace(0, 2 * np.pi, 1001), []
for v_angle, u_angle in {strands}:
    u, v = beta ** ({n} / 2) * np.exp(1j * u_angle), beta * np.exp(1j * v_angle)
    known.append((turn @ (np.stack([v.real, v.imag, u.imag]) / (1 - u.real))).T + shift)
"""
CURVES = {
    "two-spheres": """
# Two unit spheres that meet in a circle.
centre, shift = np.array([0.013, 0.027, -0.019]), 0.31


def first(x, y, z):
    return 1 - (x - centre[0] + shift) ** 2 - (y - centre[1]) ** 2 - (z - centre[2]) ** 2


def second(x, y, z):
    return 1 - (x - centre[0] - shift) ** 2 - (y - centre[1]) ** 2 - (z - centre[2]) ** 2


t, radius = np.linspace(0, 2 * np.pi, 1001), np.sqrt(1 - shift**2)
known = [centre + radius * np.stack([0 * t, np.cos(t), np.sin(t)], axis=1)]
"""
    + SAMPLED.format(half=1.5, isovalue=(0.0, 0.0)),
    "two-cylinders": CYLINDERS + SAMPLED.format(half=1.4, isovalue=(0.0, 0.0)),
    "two-isovalues": CYLINDERS + SAMPLED.format(half=1.4, isovalue=(0.7, -1.3)),
    "villarceau": """
# A torus and a plane that touches it twice: two circles that cross where they touch.
big, small = 1.0, 0.45
sine = small / big
cosine = np.sqrt(1 - sine**2)


def first(x, y, z):
    return 4 * big**2 * (x**2 + y**2) - (x**2 + y**2 + z**2 + big**2 - small**2) ** 2


def second(x, y, z):
    return cosine * z - sine * x


t = np.linspace(0, 2 * np.pi, 1001)
known = [np.stack([cosine * big * np.sin(t), side * small + big * np.cos(t),
                   sine * big * np.sin(t)], axis=1) for side in (-1, 1)]
"""
    + SAMPLED.format(half=1.7, isovalue=(0.0, 0.0)),
    "hydrogen-ring": """
# A superposition of states of hydrogen, n = 2: it vanishes on a ring.
def first(x, y, z):
    r = np.sqrt(x**2 + y**2 + z**2)
    return (2 - r) * np.exp(-r / 2)


def second(x, y, z):
    return 0.8 * (z - 0.02) * np.exp(-np.sqrt(x**2 + y**2 + z**2) / 2)


t, height = np.linspace(0, 2 * np.pi, 1001), 0.02
radius = np.sqrt(4 - height**2)
known = [np.stack([radius * np.cos(t), radius * np.sin(t), 0 * t + height], axis=1)]
"""
    + SAMPLED.format(half=3.0, isovalue=(0.0, 0.0)),
    "hydrogen-axis": """
# A superposition of states of hydrogen, n = 3: it vanishes on an axis and on a ring around it.
x0, y0, z0 = 0.013, -0.007, 0.011


def wave(x, y, z):
    x, y, z = x - x0, y - y0, z - z0
    r = np.sqrt(x**2 + y**2 + z**2)
    return (x + 1j * y) * (1 - r + 0.9j * z) * np.exp(-r)


def first(x, y, z):
    return wave(x, y, z).real


def second(x, y, z):
    return wave(x, y, z).imag


t, along = np.linspace(0, 2 * np.pi, 1001), np.linspace(-1.6, 1.6, 1001)
known = [np.stack([x0 + np.cos(t), y0 + np.sin(t), 0 * t + z0], axis=1),
         np.stack([0 * t + x0, 0 * t + y0, along], axis=1)]
"""
    + SAMPLED.format(half=1.6, isovalue=(0.0, 0.0)),
    "hopf-link": TORUS_LINK.format(
        n=2,
        what="two circles, each through the other",
        beta="np.sqrt(0.5)",
        strands="((t, t), (t, t + np.pi))",
    )
    + SAMPLED.format(half=3.0, isovalue=(0.0, 0.0)),
    "trefoil": TORUS_LINK.format(
        n=3,
        what="the trefoil knot",
        beta="np.sqrt(max(b.real for b in np.roots([1, -1, 2, -1]) if abs(b.imag) < 1e-9))",
        strands="((2 * t, 3 * t),)",
    )
    + SAMPLED.format(half=3.2, isovalue=(0.0, 0.0)),
}

# --- contours in the plane -----------------------------------------------------------------------

PLANE = """
x, y = np.meshgrid(0.3 * (np.arange(25) - 12), 0.3 * (np.arange(29) - 14), indexing="ij")
"""
CONTOURS = {
    "disc": "values = 2.5 - np.hypot(x - 0.031, y + 0.017)\n",
    "annulus": "values = 0.9 - abs(np.hypot(x - 0.031, y + 0.017) - 2.3)\n",
    "two-discs": "one, other = np.hypot(x - 0.7, y - 2.11), np.hypot(x + 0.6, y + 1.97)\n"
    "values = 1.5 - np.minimum(one, other)\n",
    "border": "values = 1.03 - abs(x + 0.2 * np.sin(y))\n",
}
DRAWN = {
    "winding": """
# A comb: every second line of samples is inside, and all are joined at one end.
values = -np.ones((271, 271))
values[1:-1:2, 1:-1] = 1
values[1:-1, 1] = 1
""",
    "specks": """
# Whole numbers that depend on the name of the case alone; every second sample is high.
key = sha256(b"contours/specks#{seed}").digest()[:16]
words = np.random.Philox(key=int.from_bytes(key, "little")).random_raw(41 * 41) >> np.uint64(32)
numbers = ((words * np.uint64(511)) >> np.uint64(32)).astype(int).reshape(41, 41) - 255
values = -(1 + numbers / 1024)
values[1::2, 1::2] *= -1
""",
}
PLACED = "isovalue, spacing, origin = (0.0,), {spacing}, (0.0, 0.0)\n"

# --- manifolds in two to five dimensions ---------------------------------------------------------

PHI = """

def phi(x):
    return np.stack([{components}], axis=1)


count, half = {count}, {half}
axis = np.linspace(-half, half, count)
places = np.stack(np.meshgrid(*[axis] * {n}, indexing="ij"), axis=-1)
values = phi(places.reshape(-1, {n})).T.reshape({m}*[count] * {n})
isovalue, spacing, origin = (0.0,) * {levels}, (2 * half / (count - 1),) * {n}, (-half,) * {n}
"""
BALL = "1 - (x**2).sum(axis=1)"
COMPLEX = "(x[:, 0] + 1j * x[:, 1]) ** 2 + (x[:, 2] + 1j * x[:, 3]) ** 2 - 1"
MANIFOLDS = {
    "circle": BALL,
    "sphere": BALL,
    "torus": "0.25 - (np.hypot(x[:, 0], x[:, 1]) - 1) ** 2 - x[:, 2] ** 2",
    "three-sphere": BALL,
    "tube": "0.25 - (np.linalg.norm(x[:, :3], axis=1) - 1) ** 2 - x[:, 3] ** 2",
    "circle-in-space": f"{BALL}, x[:, 2] - 0.5",
    "two-circles": f"{BALL}, x[:, 2] ** 2 - 0.25",
    "two-spheres-meeting": "1 - ((x - [0, 0, 0, 0.5]) ** 2).sum(axis=1),\n"
    "                     1 - ((x + [0, 0, 0, 0.5]) ** 2).sum(axis=1)",
    "clifford-torus": "1 - (x[:, :2] ** 2).sum(axis=1), 1 - (x[:, 2:] ** 2).sum(axis=1)",
    "complex-circle": f"({COMPLEX}).real,\n                     ({COMPLEX}).imag",
    "torus-in-R5": "1 - (x[:, :2] ** 2).sum(axis=1), 1 - (x[:, 2:4] ** 2).sum(axis=1),\n"
    "                     x[:, 4] - 0.1 * x[:, 0]",
}

# --- bodies of one shape in a row ----------------------------------------------------------------

BODIES = """
# {what} of several sizes, in cells, in a row: h = 1 / scale.
scales = np.array({scales})
middles = np.array({middles})


def signed(points, i):  # From body i{uncut}, positive outside.
    away = points - middles[i]
    return {signed}

{cut}
places = np.stack(np.meshgrid(*map(np.arange, {shape}), indexing="ij"), axis=-1).astype(float)
nearest = -np.min([signed(places, i) for i in range(len(scales))], axis=0)
values = np.rint({values} * 2.0**20) / 2.0**20
isovalue, spacing, origin = (0.0,) * {m}, (1.0,) * {n}, (0.0,) * {n}
"""
SPHERE = "np.linalg.norm(away, axis=-1) - scales[i]"
TORUS = (
    f"np.hypot(np.hypot(away[..., 0], away[..., 1]) - scales[i], away[..., 2]) - {TUBE} * scales[i]"
)
WHOLE = """
distance = signed
"""
CUT = """
across = np.array({across})  # Unit vectors of the planes through the middles that cut them.


def heights(points):
    return (points - middles[0]) @ across.T


def distance(points, i):
    return np.hypot(signed(points - heights(points) @ across, i),
                    np.linalg.norm(heights(points), axis=-1))

"""

# --- a field of some size ------------------------------------------------------------------------

COST = """
# Whole numbers that depend on the name of the case alone, blurred by 1 2 1 twice along each axis.
key = sha256(b"{name}#{seed}").digest()[:16]
words = np.random.Philox(key=int.from_bytes(key, "little")).random_raw({count}) >> np.uint64(32)
numbers = ((words * np.uint64(2048)) >> np.uint64(32)).astype(int).reshape({shape}) - 1024
for axis in {axes} * {passes}:
    along = np.moveaxis(numbers, axis, 0)
    numbers = np.moveaxis(along[:-2] + 2 * along[1:-1] + along[2:], 0, axis)
values = (2 * numbers + 1) / 2.0**{bits}
isovalue, spacing, origin = (0.0,) * {m}, (1.0,) * {n}, (0.0,) * {n}
"""


def of_case(case: Case, seed: int = 0) -> str | None:
    """The lines that make the samples of this case, and what is known of them; None for others."""
    family, _, name = case.id.partition("/")
    if family == "curves" and name in CURVES:
        return CURVES[name]
    if family == "contours" and name in CONTOURS:
        spacing = (0.5, 2.0) if name == "border" else (0.3, 0.3)
        return PLANE + CONTOURS[name] + PLACED.format(spacing=spacing)
    if family == "contours" and name in DRAWN:
        return DRAWN[name].format(seed=seed) + PLACED.format(spacing=(1.0, 1.0))
    if family == "accuracy":
        return _row(case.facts.get("row", QUALITY))
    if family == "cost":
        return _noise(case, seed)
    known = case.facts.get("manifold")
    return _manifold(known, case) if isinstance(known, Manifold) else None


def _manifold(known: Manifold, case: Case) -> str:
    """The lines of a known manifold; of a flat one its equations are read off."""
    components, n, m = MANIFOLDS.get(known.name), known.n, known.m
    if components is None:
        constant = known.phi(np.zeros((1, n)))[0]
        slopes = known.phi(np.eye(n)) - constant
        components = ",\n                     ".join(
            f"x @ {slope} + {b}"
            for slope, b in zip(slopes.T.tolist(), constant.tolist(), strict=True)
        )
    count = round(case.samples ** (1 / n))
    first = "" if m == 1 else f"{m}, "
    return PHI.format(components=components, count=count, half=known.half, n=n, m=first, levels=m)


def _row(name: str) -> str:
    """The lines of a row of bodies."""
    bodies, shape = row(name)
    first, n = bodies[0], len(shape)
    m, sphere = 1 + len(first.across), first.shape == "sphere"
    stacked = "nearest" if m == 1 else "np.stack([nearest, *np.moveaxis(heights(places), -1, 0)])"
    tori = f"Tori, the tube {TUBE} of the ring,"
    middles = str([list(body.middle) for body in bodies])
    return BODIES.format(
        what=("Spheres" if n > 2 else "Circles") if sphere else tori,
        scales=[body.scale for body in bodies],
        middles=middles.replace("], [", "],\n                    ["),
        signed=SPHERE if sphere else TORUS,
        uncut=", not cut" if m > 1 else "",
        cut=CUT.format(across=[list(one) for one in first.across]) if m > 1 else WHOLE,
        shape=shape, values=stacked, m=m, n=n,
    )  # fmt: skip


def measures(bodies: list[Body]) -> dict[str, list[float]]:
    """Length or area of the bodies of a row and, of those with one, the rest that is known."""
    whole = not bodies[0].across
    surface = whole and len(bodies[0].middle) == 3
    return {
        "measure": [body.measure for body in bodies],
        "volume": [body.volume for body in bodies] if whole else [],
        "curvature": [body.bend for body in bodies] if surface else [],
    }


def _noise(case: Case, seed: int) -> str:
    """The lines of the noise on which calls are asked."""
    n, m = case.kind
    whole = [size + 2 * PASSES for size in SHAPES[case.kind]]
    return COST.format(
        name=case.id,
        seed=seed,
        count=m * prod(whole),
        shape=tuple(whole if m == 1 else [m, *whole]),
        axes=list(range(n)) if m == 1 else list(range(1, n + 1)),
        passes=PASSES,
        bits=10 + 2 * PASSES * n,
        m=m,
        n=n,
    )
