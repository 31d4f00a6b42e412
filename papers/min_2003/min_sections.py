"""Sections counted: the bounds of section 4, Weigle and Banks' recursion, cubes by convex hulls."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from isograde.oracles import complexes as oracle
from isograde.reproduction import Table
from isoref import hypercubes, recursive_sections
from isoref.fast.simplicial import Complex, extract, most_pieces, section
from isoref.field import Field, Integers
from isoref.kuhn import permutations
from isoref.simplex_section import haiman_count, section_types

PRINTED_BOUNDS = (6, 6 * 3, 6 * 3 * 2)


def bounds(draws: int) -> Iterator[Table | str]:
    """Section 4: n_1 <= 6, n_2 <= 6 x 3, n_3 <= 6 x 3 x 2 for a 5-simplex and three hyperplanes."""
    table = Table("Section 4: the most simplices one 5-simplex leaves")
    for i, (printed, bound) in enumerate(zip(PRINTED_BOUNDS, most_pieces(5, 3), strict=True)):
        table.add(f"n_{i + 1}, bound by the tables", printed, bound)
    for rule in ("staircase", "printed"):
        for i, most in enumerate(reached(rule, draws)):
            note = f"{draws:,} simplices of random values; those that later cuts meet"
            table.add(f"n_{i + 1} reached, {rule}", None, most, note=note)
    yield table


def reached(rule: str, draws: int) -> list[int]:
    """The most pieces that one of so many random 5-simplices leaves after 1, 2 and 3 cuts."""
    chance = np.random.default_rng(0)
    most = [0, 0, 0]
    for start in range(0, draws, 20_000):
        count = min(20_000, draws - start)
        complex_ = apart(chance.normal(size=(count, 6, 3)))
        for i in range(3):
            complex_ = section(complex_, rule)
            most[i] = max(most[i], int(np.bincount(complex_.parents, minlength=1).max()))
    return most


def apart(values: np.ndarray) -> Complex:
    """Simplices (S, k, m) that share no vertex, with these values, as a complex."""
    count, k, m = values.shape
    numbers = np.arange(count * k, dtype=np.int64)
    return Complex(
        numbers[:, None],
        np.tile(np.eye(k)[:, 1:], (count, 1)),
        values.reshape(-1, m),
        numbers.reshape(count, k),
        np.ones(count, np.int64),
        np.arange(count, dtype=np.int64),
    )


def recursion() -> Iterator[Table | str]:
    """Section 1: explicit tables beside the recursion of Weigle and Banks."""
    lines = [
        "## Sections 1 and 3: tables beside the recursion of Weigle and Banks",
        "",
        "Simplices that one section of each type is cut into, and faces that are looked at for it: "
        "a table is looked up once. `isoref.recursive_sections` is our reading of their method.",
        "",
        "| n | type | simplices by table | by recursion | ratio | faces asked |",
        "| ---: | --- | ---: | ---: | ---: | ---: |",
    ]
    for n in range(2, 8):
        for p, q in section_types(n):
            few, many = haiman_count(p, q), recursive_sections.piece_count(p, q)
            faces = recursive_sections.asked(p, q)
            lines.append(f"| {n} | ({p}, {q}) | {few} | {many} | {many / few:.1f} | {faces} |")
    yield "\n".join(lines) + "\n"
    yield _on_fields()


def _on_fields() -> str:
    """Both ways on random samples."""
    lines = [
        "On random samples: simplices, and the measure of the set, which must be the same.",
        "",
        "| n | m | by tables | by recursion | ratio | measures differ by |",
        "| ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for shape, m in (((5, 5, 5), 1), ((5, 4, 4), 2), ((3, 3, 3, 3), 1), ((3, 3, 3, 2), 2)):
        values = np.random.default_rng(m).normal(size=(m, *shape))
        field = Field.of(values, dimension=len(shape))
        meshes = [extract(field), recursive_sections.extract(field)]
        few, many = (len(mesh.simplices) for mesh in meshes)
        one, other = (oracle.Complex(x.vertices, x.simplices).measure for x in meshes)
        apart_by = f"{abs(one - other) / one:.1e}"
        lines.append(f"| {len(shape)} | {m} | {few:,} | {many:,} | {many / few:.1f} | {apart_by} |")
    return "\n".join(lines) + "\n"


def cubes() -> Iterator[Table | str]:
    """Section 1: case classes of cubes, and cubes by convex hulls beside simplices."""
    table = Table("Section 1: types of isosurfaces on a cube")
    for n, printed in ((3, 14), (4, 222)):
        note = "signs under the symmetries of the cube and the exchange, by Burnside's lemma"
        table.add(f"n = {n}", printed, hypercubes.classes(n), note=note)
    for n in (3, 4, 5):
        printed = {3: 2, 4: 2, 5: None}[n]
        table.add(f"types on a {n}-simplex", printed, len(section_types(n)))
    yield table
    lines = [
        "Bhaniramka, Wenger and Crawfis' cubes (`isoref.hypercubes`) beside the simplices of "
        "Kuhn's triangulation, on random samples amid low ones. A facet with one simplex would be "
        "a hole.",
        "",
        "| n | cells | simplices a cube is cut into | simplices by cubes | by simplices | ratio "
        "| facets of cubes with one simplex |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for shape in ((6, 6), (6, 6, 6), (4, 4, 4, 3)):
        n = len(shape)
        inner = np.random.default_rng(n).normal(size=shape)
        field = Field.of(np.pad(inner, 1, constant_values=-1.0))
        by_cubes, by_simplices = hypercubes.extract(field), extract(field)
        few, many = len(by_cubes.simplices), len(by_simplices.simplices)
        alone = int((oracle.Complex(by_cubes.vertices, by_cubes.simplices).facets.uses == 1).sum())
        cells = int(np.prod([N + 1 for N in shape]))
        lines.append(
            f"| {n} | {cells:,} | {len(permutations(n))} | {few:,} | {many:,} | {many / few:.2f} "
            f"| {alone} |"
        )
    yield "\n".join(lines) + "\n"


def flat_rows(points: np.ndarray, simplices: Integers) -> int:
    """How many simplices have no area, or next to none: less than 1e-12 of the largest."""
    sizes = oracle.Complex(points, simplices).measures
    return int((sizes <= 1e-12 * sizes.max(initial=0.0)).sum())
