"""Isosurface extraction, written to be read.

Each module is an article about one idea; `isoref.fast` holds vectorised twins of those that need
them, with the same names and the same answers, and `extract` uses these. Read in this order:

1. Marching cubes: `lorensen_cline`, then what it stands on, `cycles`, `cube`, `rule`, `sweep`,
   `field` and `mesh`.
2. Its repair: `asymptotic_decider`, `diagonals`, `trilinear_cubes`, and the catalogue, `methods`.
3. Volume-enclosing surfaces: `diconex`, `vesta`, `marching_vesta`, `freeze_out`, `hypersurface`,
   `cornelius`.
4. Other families: `dual`, `surface_nets`, `dual_marching_cubes`, `label_cubes`,
   `marching_tetrahedra`. What a surface carries: `attributes`; closed on
   the border: `capping`; without triangles that have no area: `degenerate`, and `ties`, where
   samples equal the isovalue. In blocks, on many machines: `distributed`.
5. Where two isosurfaces meet: `curves`, `marching_faces`, `hermite`, `surface_intersection`,
   `plane_waves`.
6. Any dimension and codimension: `kuhn`, `simplex_section`, `simplicial`,
   `recursive_sections`, `face_tracing`, `hypercubes`, `dyadic`, `projection`.
"""

from isoref.field import Field, FieldError
from isoref.mesh import Mesh
from isoref.methods import METHODS, extract, extract_frames

__all__ = ["METHODS", "Field", "FieldError", "Mesh", "extract", "extract_frames"]
