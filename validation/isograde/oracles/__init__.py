"""Oracles. None shares code, numbering or arithmetic with what it judges.

complexes   the topology of a mesh of simplices of any dimension
chains      segments joined into curves
lattice     samples, sides, ties, and where a vertex stands among them
degree      how often, and which way, a mesh meets the faces of the lattice
traces      the curves in which a mesh meets the faces of the cells, and which are legal
bilinear    what the bilinear interpolant connects on an ambiguous face
flat        to which cell a triangle belongs that lies in the face between two
bodies      smooth closed sets of any dimension whose every number is known
"""
