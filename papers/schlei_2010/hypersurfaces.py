"""STEVE and CORNELIUS beside each other: freeze-out hypersurfaces in 3+1 dimensions, measured.

Run it from anywhere: ``python papers/schlei_2010/hypersurfaces.py``. It writes
reports/papers/schlei_2010/hypersurfaces.md. Neither program is in any registry: what is compared
are `isoref.hypersurface` and `isoref.cornelius`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from isograde.oracles.convergence import observed_order
from isograde.reproduction import Table, write_report
from isoref.cornelius import cornelius
from isoref.field import Field, Floats
from isoref.freeze_out import Elements
from isoref.hypersurface import hypersurface

HERE = Path(__file__).parent
SIDES = (9, 11, 13, 16)
# In MeV: a fireball that starts at 235 freezes out at the paper's 139.
HOT, FREEZE_OUT, TAU, WIDTH = 235.0, 139.0, 7.0, 2.0
OPENING = """Made by `papers/schlei_2010/hypersurfaces.py`. STEVE is `isoref.hypersurface`,
CORNELIUS `isoref.cornelius`; both in mixed mode, so that they cut the same lines. "expected" is
what must be true of any closed hypersurface, or of the known fireball.
"""


def by_both(field: Field, level: float) -> dict[str, Elements]:
    """The elements of each."""
    return {
        "STEVE": hypersurface(field, level).polyhedra,
        "CORNELIUS": cornelius(field, level),
    }


def noise(seed: int) -> Field:
    """Noise amid cold samples, in cells that are no cubes."""
    inner = np.random.default_rng(seed).normal(size=(4, 4, 4, 4))
    return Field.of(np.pad(inner, 1, constant_values=-1.0), (0.5, 1.0, 1.25, 0.75))


def fireball(n: int) -> Field:
    """log(T / T_f) of T = T0 exp(-t / tau - r^2 / 2 w^2), from the first frame until it is cold."""
    t, x = np.linspace(0, 1.3 * TAU * np.log(HOT / FREEZE_OUT), n), np.linspace(-3.2, 3.2, n)
    T, X, Y, Z = np.meshgrid(t, x, x, x, indexing="ij")
    values = np.log(HOT / FREEZE_OUT) - T / TAU - (X**2 + Y**2 + Z**2) / (2 * WIDTH**2)
    step = x[1] - x[0]
    return Field.of(values, [t[1], step, step, step], [0.0, -3.2, -3.2, -3.2])


def along_time(places: Floats) -> Floats:
    """The current whose flux is what was in the fireball at first."""
    return np.tile([1.0, 0.0, 0.0, 0.0], (len(places), 1))


def closing() -> Table:
    """What the normals of closed hypersurfaces sum to, and the volume as a flux."""
    table = Table("Closed hypersurfaces: noise of 4^4 samples amid cold ones, three fields")
    fields = [noise(seed) for seed in range(3)]
    exact = [hypersurface(field, 0.0).tetrahedra for field in fields]
    volume = sum(one.flux(lambda x: x / 4) for one in exact)
    note = "volume by the tetrahedra of STEVE, to which the flux of x / 4 is exact"
    table.add("volume", None, round(volume, 6), note=note)
    both = [by_both(field, 0.0) for field in fields]
    for name in ("STEVE", "CORNELIUS"):
        own = [one[name] for one in both]
        table.add(f"{name}: elements", None, sum(len(one.places) for one in own))
        size = sum(float(np.abs(one.normals).sum()) for one in own)
        total = max(float(np.abs(one.normals.sum(axis=0)).max()) for one in own)
        note = "largest component of the sum over a field; tolerance: a rounding of all sizes"
        table.add(f"{name}: sum of the normals", None, float(f"{total:.3g}"), expected=0,
                  tolerance=np.finfo(float).eps * size, note=note)  # fmt: skip
        flux = sum(one.flux(lambda x: x / 4) for one in own) / volume
        note = "at the places of the elements"
        table.add(f"{name}: flux of x / 4 over the volume", None, round(flux, 5), note=note)
    away = np.concatenate(
        [np.linalg.norm(one["STEVE"].normals - one["CORNELIUS"].normals, axis=1) for one in both]
    )
    large = np.concatenate([np.linalg.norm(one["STEVE"].normals, axis=1) for one in both])
    share = float((away > 1e-9 * large.mean()).mean())
    note = "polygons that are not flat are filled from their centre of mass, not their average"
    table.add("elements whose normals differ", None, f"{share:.1%}", note=note)
    places = np.concatenate(
        [np.linalg.norm(one["STEVE"].places - one["CORNELIUS"].places, axis=1) for one in both]
    )
    table.add("mean distance of their places", None, round(float(places.mean()), 4),
              note="average of points against centre of mass; in units in which a cell's sides are "
              "0.5 to 1.25")  # fmt: skip
    return table


def converging() -> Table:
    """The known fireball on finer and finer lattices: its content, and its volume in space-time.

    The current along time is constant, so that its flux is decided by the rim of the hypersurface
    alone, which both cut alike; the flux of x / 4 depends on where the elements stand.
    """
    table = Table("A known fireball: what leaves it was in it at first, and its volume")
    life = TAU * np.log(HOT / FREEZE_OUT)
    radius = WIDTH * np.sqrt(2 * np.log(HOT / FREEZE_OUT))
    content = 4 / 3 * np.pi * radius**3
    # The time at which a place turns cold, life (1 - r^2 / radius^2), over the ball.
    volume = content * life * 2 / 5
    asked = (("content", along_time, content), ("volume", lambda x: x / 4, volume))
    errors: dict[str, list[float]] = {}
    for n in SIDES:
        for name, elements in by_both(fireball(n), 0.0).items():
            for what, current, exact in asked:
                error = abs(elements.flux(current) / exact - 1)
                errors.setdefault(f"{name}, {what}", []).append(error)
                table.add(f"{name}, {what}, {n}^4 samples: error", None, f"{error:.3%}")
    for name, own in errors.items():
        order = observed_order(1 / (np.array(SIDES) - 1.0), own)
        half = round(order.high - order.value, 3)
        steps = np.log(np.array(SIDES[-2:]) - 1.0)
        last = np.log(own[-2] / own[-1]) / (steps[1] - steps[0])
        table.add(f"{name}: order", None, round(order.value, 3), expected=2, tolerance=half,
                  note=f"95 % interval ± {half:.3f}; of the two finest {last:.2f}")  # fmt: skip
    return table


def main() -> None:
    """The page, in reports/papers of this repository."""
    path = HERE.parents[1] / "reports" / "papers" / "schlei_2010" / "hypersurfaces.md"
    title = "Freeze-out hypersurfaces in 3+1 dimensions: STEVE and CORNELIUS"
    write_report(path, title, [OPENING, closing(), converging()])
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
