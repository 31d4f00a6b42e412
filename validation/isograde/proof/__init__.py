r"""A proof that a cube rule is closed, oriented and manifold on every field.

What is proved
--------------
A *rule* puts into each cell of a lattice of samples a *tile*: oriented triangles on *nodes*. A
node is the point where the surface crosses a lattice edge, one for each crossed edge and shared
by the cells round it, or an interior point of one cell. The tile follows from the signs of the
cell's eight samples and from *decisions*, numbers that the rule reads off the samples: one bit
for each ambiguous face (its two inside corners are diagonally opposite), and further bits for the
cell itself.

    On every finite lattice, for all samples: each directed edge of the mesh occurs once, and each
    that does not lie in the border of the lattice occurs in the other direction too; the triangles
    round each vertex are one fan, a full turn off the border. Seen from the inside of the surface
    normals point away.

This is said of numbers of vertices, not of places: *by index*. It is a statement about all fields,
of which there are infinitely many, and all the same it can be checked by enumeration.

The argument
------------
*Why finitely many cases are enough.* Nothing of a field enters the mesh but signs and decisions. A
cell has 256 signs; a decision has a fixed number of bits. So there are finitely many tiles, and
finitely many kinds of face at which two tiles can meet: an axis, the signs of four corners, and
whether the face is decided 0 or 1. All of these are enumerated; of the field nothing else is used.

*Why local conditions suffice.* Two different cells share a face, a lattice edge, a corner or
nothing. Two different nodes in both of two cells therefore lie on one face between these two, for
a lattice edge has one node and a corner none. So an edge of the mesh belongs to one cell only, or
lies on a face and belongs to none but the two cells there: what happens along an edge is decided
by one tile, or by two tiles at a face. The conditions are

1. *In a tile* every crossed lattice edge has its node and no other edge has one, no triangle names
   a node twice, and no directed edge occurs twice. An edge of the tile then belongs to two
   triangles that run along it in opposite directions, or to one; call the latter a *segment*, the
   former, where its ends lie on one face, a *chord* of that face.
2. *Segments* lie on the faces of the cell, with the inside on their right seen from outside the
   cell.
3. *At a face* both cells have the same segments, in opposite directions.
4. *No chord* of a face is one of both cells there.
5. *Round each node* the tile's triangles are one fan: a full turn about an interior point; a
   path about a node on a lattice edge, from one of the two faces at that edge to the other.

*Edges.* Take a directed edge of the mesh. If its ends lie on no common face, one cell contains
it, it occurs there once (1), and once in the other direction, for it is no segment (2). If they
lie on a face, let the two cells there be A and B. A segment of A is in B a segment in the other
direction (3), and neither cell contains it again (1). A chord of A occurs once in each direction
in A (1); in B it is no segment, for it would then be one of A (3), and no chord (4). So no
directed edge occurs twice, and each occurs in the other direction too, unless its face has one
cell only: then the face lies in the border of the lattice.

*Vertices.* The triangles round an interior point are one full turn, in one cell (5). Round a
lattice edge stand four cells, each sharing a face at that edge with the next. In each the
triangles about the edge's node are one path from the one face to the other (5); a path begins and
ends with a segment, and each face has one segment at the node, shared by its two cells (3). So
the four paths join to one full turn. Where the edge lies in the border, two cells stand there, or
one, next to each other: their paths join to one path.

*Sides.* By (2) the surface has the inside behind it along each face of each cell.

That these conditions suffice is also proved by machine, in Coq: `validation/proofs`.

What enumeration cannot show
----------------------------
*That a decision belongs to its face.* By (3) both cells must come to one decision on their face;
it must be a function of the face's four values, and of nothing else in either cell. A decision is
arithmetic on floats, and no enumeration covers it. It is a *premise*, and it is tried: on pairs
of cells that share a face, with numbers made to tempt (`isograde.proof.adversarial`). Its trial
is no proof, and what is proved is said under this condition. A rule that compares no numbers
needs none.

*That no other tiles occur.* The rule must answer every case with the same tile whenever it is
asked, name no node that is not there, and never decide what is not enumerated: further premises,
checked on all tiles and on all trials.

*That cells which are not asked fit.* A rule is asked for decisions only where `asks` says so;
elsewhere they count as 0, also on a face whose other cell is asked and decides 1. Such cells are
enumerated with either decision of their faces.

What ties do
------------
A sample on the isovalue is inside; a saddle or a mean on it is decided by the rule, in one way.
Ties change no tile, so nothing above depends on general position. They do change places: vertices
of different numbers can coincide and triangles can have no area. Whoever welds vertices by their
place makes another mesh, of which nothing is proved.

What is not claimed
-------------------
That triangles do not cut each other in space; that the surface is the interpolant's. And the
conditions are sufficient, not necessary: a rule can break one and still make closed surfaces, for
instance because no values reach the tile that is wrong. It is then not proved, and not refuted.

Modules
-------
`tiles` enumerates a rule's tiles and checks conditions 1, 2 and 5; `meetings` checks 3 and 4 where
two tiles meet; `premises` tries the rule itself, on the numbers of `adversarial`; `proving` puts
them together; `certificate` writes down the tiles, for `check_certificate`, a program that shares
nothing with any of these and accepts or refuses them from the definitions alone.
"""

from isograde.proof.proving import Check, Proof, prove

__all__ = ["Check", "Proof", "prove"]
