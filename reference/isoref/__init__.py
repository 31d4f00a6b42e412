"""Isosurface extraction, written to be read.

Each module is an article about one idea. Start with `isoref.cube`, then read
`isoref.asymptotic_decider`.
"""

from isoref.field import Field, FieldError
from isoref.mesh import Mesh
from isoref.methods import METHODS, extract

__all__ = ["METHODS", "Field", "FieldError", "Mesh", "extract"]
