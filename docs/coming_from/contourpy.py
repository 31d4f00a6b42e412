"""contourpy's `contour_generator` and its `lines`, made of isoref."""

import numpy as np
from isoref.fast.diconex import diconex


class ContourGenerator:
    """Contour lines of z on a grid of points (x, y); higher values are on their left."""

    # One piece, made by one thread.
    chunk_count, thread_count = (1, 1), 1

    def __init__(self, x, y, z, line_type):
        self.z = np.ma.asarray(z, np.float64)
        if self.z.ndim != 2 or min(self.z.shape) < 2:
            raise TypeError("z must be a 2D array of at least 2 x 2 points")
        self.line_type = line_type
        rows, columns = np.indices(self.z.shape, np.float64)
        down = np.reshape(y, (-1, 1)) if np.ndim(y) == 1 else y
        self.x = columns if x is None else np.broadcast_to(x, rows.shape)
        self.y = rows if y is None else np.broadcast_to(down, rows.shape)

    def lines(self, level):
        """The polylines at a level; a closed one ends where it began. And their codes, if asked."""
        # A point equal to the level is low there, so what is high here is the negated rest.
        z = self.z if np.ma.is_masked(self.z) else np.ma.getdata(self.z)
        found = diconex(-z, -level, mode="mixed").polygons() if np.isfinite(level) else []
        lines = [np.stack([_at(self.x, line), _at(self.y, line)], axis=1) for line in found]
        coded = getattr(self.line_type, "name", self.line_type) == "SeparateCode"
        return (lines, [_codes(line) for line in lines]) if coded else lines

    def multi_lines(self, levels):
        """The polylines at each of several levels."""
        if np.ndim(levels) != 1:
            raise ValueError(f"Levels array must be 1D not {np.ndim(levels)}D")
        return [self.lines(level) for level in levels]


def _at(known, places):
    """What is known at grid points, at places on the edges between them."""
    low, high = np.floor(places).astype(int), np.ceil(places).astype(int)
    t = (places - low).sum(axis=1)
    return (1 - t) * known[*low.T] + t * known[*high.T]


def _codes(line):
    """A code a point, as Matplotlib's paths have them: begin, go on, close."""
    codes = np.full(len(line), 2, np.uint8)
    codes[0], codes[-1] = 1, 79 if (line[0] == line[-1]).all() else 2
    return codes


def contour_generator(
    x=None, y=None, z=None, *, name="serial", line_type="Separate", corner_mask=None
):
    """What draws contour lines of z; x and y are one- or two-dimensional, or plain indices."""
    known = getattr(line_type, "name", line_type) in ("Separate", "SeparateCode")
    if name != "serial" or not known or corner_mask is not None:
        raise ValueError('this is name="serial", without masks, "Separate" or "SeparateCode"')
    return ContourGenerator(x, y, z, line_type)
