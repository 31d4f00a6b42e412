"""Section 6: curves of higher order from the tangents, and the confidence in a tangent, measured.

The order of the cubics is that of points and tangents that are exact: a helix. What they are worth
on points of Marching Faces, which are of second order themselves, two spheres show, whose surfaces
meet in a circle. The confidence is held against the angle by which tangents err: as the spheres'
angle shrinks, tangents get worse, and the confidence says by how much.
"""

from __future__ import annotations

import numpy as np
from isograde.oracles.convergence import observed_order
from isograde.reproduction import Table
from isoref.fast.marching_faces import intersection_curves, marching_faces
from isoref.field import Field, Floats
from isoref.hermite import hermite, smooth_curves

SEGMENTS = (12, 24, 48, 96)
# Angles between two spheres where they meet, in degrees, and the radius of the second.
ANGLES, SECOND = (60, 30, 10, 3), 1.6
SIDE = 25
# Central differences err by h^2 / 6 of the third derivatives, interpolation on a face by h^2 / 8
# along either axis; those of a distance r are at most 3 / r^2.
TOLERANCE = (3 / (SIDE - 1)) ** 2 * (1 / 6 + 2 / 8) * (3 + 3 / SECOND**2)
# The centres are on this line, askew to the lattice, so that the errors of the two do not cancel.
ALONG = np.array([1.0, 2.0, 3.0]) / np.sqrt(14)


def helix(t: Floats) -> tuple[Floats, Floats]:
    """Points and unit tangents of a helix."""
    points = np.stack([np.cos(t), np.sin(t), t / 3], axis=1)
    tangents = np.stack([-np.sin(t), np.cos(t), np.full_like(t, 1 / 3)], axis=1)
    return points, tangents / np.linalg.norm(tangents, axis=1, keepdims=True)


def off_helix(samples: Floats) -> float:
    """The largest distance of samples from the helix, in the planes of their heights."""
    return float(np.linalg.norm(samples - helix(3 * samples[:, 2])[0], axis=1).max())


def spheres(angle: float) -> tuple[tuple[Field, Field], float]:
    """A unit sphere and a larger one that meet at this angle, as distances; where they meet.

    The circle's height above the unit sphere's centre, along `ALONG`.
    """
    apart = np.sqrt(1 + SECOND**2 - 2 * SECOND * np.cos(np.radians(angle)))
    axis = np.linspace(-1.5, 1.5, SIDE)
    places = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    one, two = (
        Field.of(radius - np.linalg.norm(places - centre, axis=-1), axis[1] - axis[0], [-1.5] * 3)
        for radius, centre in ((1.0, 0 * ALONG), (SECOND, apart * ALONG))
    )
    return (one, two), float((apart**2 + 1 - SECOND**2) / (2 * apart))


def report() -> Table:
    """Orders on a helix, distances from a circle, and angles times confidences."""
    table = Table("Section 6: curves of higher order, and the confidence in a tangent")
    cubics, chords = [], []
    for n in SEGMENTS:
        points, tangents = helix(np.linspace(0, 2 * np.pi, n + 1))
        cubics.append(off_helix(hermite(points, tangents, False, 8)))
        chords.append(off_helix((points[1:] + points[:-1]) / 2))
    for what, errors, formal in (("cubics", cubics, 4), ("chords", chords, 2)):
        order = observed_order(1 / np.array(SEGMENTS), errors)
        note = f"a helix of {SEGMENTS[0]} to {SEGMENTS[-1]} segments, exact points and tangents"
        half = round(max(order.high - order.value, 1e-4), 4)
        table.add(f"order of the {what}", None, round(order.value, 4), expected=formal,
                  tolerance=half, note=f"{note}; 95 % interval ± {half:.4f}")  # fmt: skip
    table.rows += _on_spheres().rows
    return table


def _on_spheres() -> Table:
    """What cubics and confidences are worth on points of Marching Faces."""
    table = Table("")
    for asked in ANGLES:
        pair, height = spheres(asked)
        chords, smooth = intersection_curves(*pair), smooth_curves(*pair, parts=4)
        middles = [(c.points + np.roll(c.points, -1, axis=0))[:-1] / 2 for c in chords]
        samples = np.concatenate([curve.points[2::4] for curve in smooth])
        ratio = _off_circle(samples, height) / _off_circle(np.concatenate(middles), height)
        what = f"spheres at {asked}°"
        note = "mean distance from the circle, middles of cubics over middles of chords"
        table.add(f"{what}: cubics / chords", None, round(ratio, 2), note=note)
        points = marching_faces(*pair)
        angle, confidence = _angles(points.positions, points.tangents), points.confidence
        worst = np.degrees((angle.max(), (angle * confidence).max()))
        note = "degrees between tangent and circle, the largest; the same times the confidence"
        shown = f"{worst[0]:.2f}; {worst[1]:.2f}"
        table.add(f"{what}: error of tangents", None, shown, note=note)
        expected = float(np.sin(np.radians(asked)))
        mean, tolerance = round(float(confidence.mean()), 3), round(TOLERANCE, 3)
        note = "the sine of the angle; tolerance: what both gradients may err by"
        table.add(f"{what}: mean confidence", None, mean, expected=round(expected, 3),
                  tolerance=tolerance, note=note)  # fmt: skip
    return table


def _off_circle(samples: Floats, height: float) -> float:
    """The mean distance of samples from the circle in which the spheres meet."""
    across = np.linalg.norm(np.cross(samples, ALONG), axis=1) - np.sqrt(1 - height**2)
    return float(np.hypot(across, samples @ ALONG - height).mean())


def _angles(places: Floats, tangents: Floats) -> Floats:
    """(P,) between each tangent and the circle's, either way."""
    right = np.cross(ALONG, places)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    return np.asarray(np.arccos(np.clip(np.abs((tangents * right).sum(axis=1)), 0, 1)))
