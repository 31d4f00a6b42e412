"""Writes the tiles of a certificate as a Coq file that checks them: a table, and one computation.

    python export.py CERTIFICATE.json > Rule.v

Nothing here has to be trusted for the theorem in the written file: whatever the table says, Coq
checks it. That the table is the rule's is what the certificate says, and `make proof` writes the
certificates anew from the rules.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator
from itertools import product
from typing import Any

Edge = tuple[int, int]
Kind = tuple[int, int]

# Nodes 4 a + k stand on edges along axis a; the bits of k are the other two coordinates.
NODES = [
    (*(bits[:axis]), 1, *(bits[axis:]))
    for axis in range(3)
    for bits in ((0, 0), (2, 0), (0, 2), (2, 2))
]
CORNERS = [[c for c in range(8) if c >> axis & 1 == side] for axis in range(3) for side in (0, 1)]


def signs_of(signs: int, face: int) -> list[int]:
    """The bits of a face's corners."""
    return [signs >> c & 1 for c in CORNERS[face]]


def is_ambiguous(signs: int, face: int) -> bool:
    """Whether the corners of the face change their side all the way round."""
    a, b, c, d = signs_of(signs, face)
    return a == d and b == c and a != b


def lowered(node: int, axis: int) -> int:
    """The node's number as the cell above the face across the axis has it."""
    place = list(NODES[node])
    place[axis] = 0
    return NODES.index(tuple(place))


def on_face(edges: Iterable[Edge], face: int) -> Iterator[Edge]:
    """The edges on a face, in the numbers of the cell above."""
    axis, side = divmod(face, 2)
    for p, q in edges:
        if p < 12 and q < 12 and NODES[p][axis] == NODES[q][axis] == 2 * side:
            yield lowered(p, axis), lowered(q, axis)


def cells(content: Any) -> Iterator[tuple[int, int, list[list[int]]]]:
    """Signs, decisions of faces, and triangles of every cell that can occur."""
    tiles = {(signs, decision): triangles for signs, decision, _, triangles in content["tiles"]}
    bits, asked = content["bits"], set(content["asked"])
    for signs in range(256):
        options = [(0, 1) if is_ambiguous(signs, face) else (0,) for face in range(6)]
        for chosen, own in product(product(*options), range(1 << max(bits - 6, 0))):
            faces = sum(bit << face for face, bit in enumerate(chosen))
            seen = (faces & ((1 << bits) - 1)) + 64 * own if signs in asked else 0
            yield signs, faces, tiles[signs, seen]


def interface(content: Any) -> tuple[list[list[Edge]], list[list[Edge]], list[list[Edge]]]:
    """Segments, and chords below and above, of each axis and kind of face."""
    segments: list[list[Edge] | None] = [None] * 96
    below: list[set[Edge]] = [set() for _ in range(96)]
    above: list[set[Edge]] = [set() for _ in range(96)]
    for signs, faces, triangles in cells(content):
        directed = [(t[i], t[(i + 1) % 3]) for t in triangles for i in range(3)]
        border = [(p, q) for p, q in directed if (q, p) not in directed]
        inner = [(p, q) for p, q in directed if (q, p) in directed]
        for face in range(6):
            corners = sum(bit << n for n, bit in enumerate(signs_of(signs, face)))
            kind = corners + 16 * (faces >> face & 1) + 32 * (face // 2)
            if face % 2:
                if segments[kind] is None:
                    segments[kind] = sorted(on_face(border, face))
                below[kind].update(on_face(inner, face))
            else:
                above[kind].update(on_face(inner, face))
    return [one or [] for one in segments], [sorted(s) for s in below], [sorted(s) for s in above]


def in_coq(value: Any) -> str:
    """Lists and tuples of numbers as Coq writes them."""
    if isinstance(value, list):
        return "[" + "; ".join(map(in_coq, value)) + "]"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(in_coq, value)) + ")"
    return str(value).lower()


def coq_file(content: Any) -> str:
    """The file: table, interface, computation, theorem, and what it rests on."""
    table: list[list[Any]] = [[] for _ in range(256)]
    for signs, decision, _, triangles in content["tiles"]:
        table[signs].append((decision, [tuple(t) for t in triangles]))
    rows = ";\n  ".join(in_coq(row) for row in table)
    segments, below, above = (in_coq(one) for one in interface(content))
    asked = in_coq([signs in content["asked"] for signs in range(256)])
    name = content["rule"].replace("-", "_").replace(".", "_")
    return f"""(* Written by export.py from the certificate of {content["rule"]}. *)
From Coq Require Import NArith List.
From Proofs Require Import Lattice Check.
Import ListNotations.
Open Scope N_scope.

Definition table : list (list (N * list numbered)) := [
  {rows}].
Definition {name} : rule := Rule {content["bits"]} {asked} table (drawn_from
  {segments}
  {below}
  {above}).

Lemma passes : check {name} = true.
Proof. vm_cast_no_check (eq_refl true). Qed.

Theorem {name}_makes_surfaces : makes_surfaces (choices {name}) (tile {name}).
Proof. apply checked_rule, passes. Qed.

Check {name}_makes_surfaces.
Print Assumptions {name}_makes_surfaces.
"""


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        print(coq_file(json.load(file)), end="")
