"""Oracles. None shares code, numbering or arithmetic with what it judges.

halfedges   the topology of a triangle mesh
lattice     samples, sides, ties, and where a vertex stands among them
winding     how often, and which way, a mesh passes between two samples
traces      the curves in which a mesh meets the faces of the cells, and which are legal
bilinear    what the bilinear interpolant connects on an ambiguous face
flat        to which cell a triangle belongs that lies in the face between two
"""
