"""The tables of the kits' marching cubes, written in every language from `isoref`.

Each of the 256 patterns of inside corners has the polygons of `isoref.cycles.cycles` that cut the
inside corners of every ambiguous face apart, each cut into a fan of triangles round a corner from
which no chord lies on a face of the cell, where the neighbouring cell may have another. Every
polygon has such a fan, and no two triangles of fans cross, wherever the surface crosses the edges;
the other triangulations of polygons with seven corners may (`tests/isograde/test_kits.py`).

A triangle is three letters, a for edge 0 to l for edge 11; corners and edges are numbered as in
`isoref.cube`.

``python validation/kits/tables.py`` writes the files; a test holds them to be current.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from textwrap import fill

from isoref.cube import EDGES
from isoref.cycles import ALL_SEPARATED, Polygon, Triangle, cycles, share_face

KITS = Path(__file__).parent
WIDTH = 99

SAID = (
    "Written by tables.py of isograde's kits from isoref: not to be edited.",
    "Edge e of a cell runs along axis e / 4 from corner LOWER[e]; corner c stands one step along",
    "axis a where bit a of c is set. TRIANGLES[signs], where bit c of signs says that corner c is",
    "inside, has three letters a triangle, a for edge 0 to l for edge 11.",
)

# By file: how a line of comment begins, and the program round the two tables.
LANGUAGES: Mapping[str, tuple[str, str]] = {
    "c/table.h": (
        "//",
        "static const int LOWER[12] = {{{lower}}};\n"
        "static const char *const TRIANGLES[256] = {{\n{triangles},\n}};\n",
    ),
    "cpp/table.hpp": (
        "//",
        "#pragma once\n"
        "inline constexpr int LOWER[12] = {{{lower}}};\n"
        "inline constexpr const char *TRIANGLES[256] = {{\n{triangles},\n}};\n",
    ),
    "rust/src/table.rs": (
        "//",
        "pub static LOWER: [usize; 12] = [{lower}];\n"
        "pub static TRIANGLES: [&str; 256] = [\n{triangles},\n];\n",
    ),
    "go/table.go": (
        "//",
        "package main\n\n"
        "var lower = [12]int{{{lower}}}\n\n"
        "var triangles = [256]string{{\n{triangles},\n}}\n",
    ),
    "java/Table.java": (
        "//",
        "final class Table {{\n"
        "    static final int[] LOWER = {{{lower}}};\n"
        "    static final String[] TRIANGLES = {{\n{triangles},\n    }};\n"
        "}}\n",
    ),
    "javascript/table.mjs": (
        "//",
        "export const LOWER = [{lower}];\nexport const TRIANGLES = [\n{triangles},\n];\n",
    ),
}


def fan(polygon: Polygon) -> Iterator[Triangle]:
    """The triangles of the polygon round its first corner from which no chord lies on a face.

    >>> list(fan((0, 1, 11, 9, 2, 6, 8)))
    [(1, 11, 9), (1, 9, 2), (1, 2, 6), (1, 6, 8), (1, 8, 0)]
    """
    turned = (polygon[i:] + polygon[:i] for i in range(len(polygon)))
    apex, *others = next(p for p in turned if not any(share_face(p[0], e) for e in p[2:-1]))
    return ((apex, a, b) for a, b in pairwise(others))


def triangles_of(signs: int) -> str:
    """The triangles of a cell with these signs, three letters each.

    >>> triangles_of(0b00000001), triangles_of(0b10000001)
    ('aei', 'aeidlh')
    """
    polygons = cycles(signs, ALL_SEPARATED)
    edges = (edge for polygon in polygons for triangle in fan(polygon) for edge in triangle)
    return "".join(chr(ord("a") + edge) for edge in edges)


def table(name: str) -> str:
    """The text of the file of this name.

    >>> print(table("java/Table.java").splitlines()[5])
        static final int[] LOWER = {0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3};
    """
    comment, program = LANGUAGES[name]
    indent = "\t" if name.endswith(".go") else "    "
    quoted = ", ".join(f'"{triangles_of(signs)}"' for signs in range(256))
    text = program.format(
        lower=", ".join(str(low) for low, _ in EDGES),
        triangles=fill(quoted, WIDTH - 4, initial_indent=indent, subsequent_indent=indent),
    )
    return "".join(f"{comment} {line}\n" for line in SAID) + text


def main() -> None:
    """Every table is written."""
    for name in LANGUAGES:
        (KITS / name).write_text(table(name), encoding="utf-8")


if __name__ == "__main__":
    main()
