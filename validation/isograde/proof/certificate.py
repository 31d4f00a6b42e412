"""The certificate of a proof: a file from which anyone can check it again.

It holds what was enumerated and nothing that has to be believed: the rule's bits, the signs for
which it is asked, and the tile of each case. `isograde.proof.check_certificate`, or a program of
your own, checks the conditions of the argument on these. The premises on decisions, which no file
can show, are written down as the trials they were.

JSON, with these keys:

format      "isograde certificate 1"
rule        the rule's name, for the reader
claim       the sentence that was proved, for the reader
premises    [name, sentence, how it was checked] of each, for the reader
numbering   how corners, faces and nodes are numbered, for the reader
bits        the bits of a decision; bit f < 6 belongs to face f, further bits to the cell
asked       the signs for which the rule decides; for others the decision is 0
tiles       [signs, decision, interior points, triangles] of each case, triangles as lists of nodes
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from isograde.proof.proving import Proof

FORMAT = "isograde certificate 1"
NUMBERING = {
    "corner": "bit a of a corner's number is its coordinate along axis a; bit c of signs says that "
    "corner c is inside",
    "face": "face 2 a + s is perpendicular to axis a, at coordinate s",
    "node": "node 4 a + k < 12 is where the surface crosses the edge along axis a whose other two "
    "coordinates are the two bits of k, the lower axis in the lower bit; nodes from 12 on are "
    "interior points",
}


def certificate(proof: Proof) -> dict[str, Any]:
    """What the file says of a proof that holds.

    Raises `ValueError` for a proof that does not hold: nothing is certified then.
    """
    if not proof.holds:
        raise ValueError(f"{proof.rule} is not proved ({', '.join(proof.broken)}): no certificate")
    return {
        "format": FORMAT,
        "rule": proof.rule,
        "claim": proof.sentence,
        "premises": [[check.name, check.sentence, check.how] for check in proof.checks],
        "numbering": NUMBERING,
        "bits": proof.bits,
        "asked": list(proof.asked),
        "tiles": [
            [
                case.signs,
                case.decision,
                len(tile.interior),
                [[int(node) for node in triangle] for triangle in tile.triangles],
            ]
            for case, tile in proof.tiles.items()
        ],
    }


def write_certificate(proof: Proof, path: Path) -> None:
    """Write the certificate, one tile a line."""
    content = certificate(proof)
    tiles = content.pop("tiles")
    head = json.dumps(content, indent=1).removesuffix("\n}")
    lines = ",\n  ".join(json.dumps(tile, separators=(",", ":")) for tile in tiles)
    path.write_text(f'{head},\n "tiles": [\n  {lines}\n ]\n}}\n', encoding="utf-8")
