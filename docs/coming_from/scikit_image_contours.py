"""scikit-image's `skimage.measure.find_contours`, made of isoref."""

import numpy as np
from isoref.fast.diconex import diconex

# Of two pixels that share a corner only: what is low is drawn round below.
MODES = {"low": "connect", "high": "disconnect"}


def find_contours(
    image, level=None, fully_connected="low", positive_orientation="low", *, mask=None
):
    """The contours, low values on their left; a closed one ends where it began."""
    if fully_connected not in MODES or positive_orientation not in MODES:
        raise ValueError("fully_connected and positive_orientation are low or high")
    image = np.asarray(image, np.float64)
    if image.ndim != 2 or min(image.shape) < 2:
        raise ValueError("an image of 2 x 2 samples or more is needed")
    known = ~np.isnan(image)
    if mask is not None and np.shape(mask) != image.shape:
        raise ValueError("image and mask must have the same shape")
    if mask is not None and np.asarray(mask).dtype != bool:
        raise TypeError("the mask must be a binary array")
    known &= True if mask is None else mask
    level = 0.5 * (np.nanmin(image) + np.nanmax(image)) if level is None else float(level)

    # Their low is value <= level, our inside value >= isovalue: negated, the two are the same.
    low, mode = np.where(np.isnan(image), -level, -image), MODES[fully_connected]
    lines = diconex(low, -level, mode=mode).polygons()
    halfway = diconex(low, -level, mode=mode, displaced=False).polygons()
    drawn = known[1:, 1:] & known[1:, :-1] & known[:-1, 1:] & known[:-1, :-1]
    found = []
    for line, where in zip(lines, halfway, strict=True):
        square = tuple(np.floor((where[1:] + where[:-1]) / 2).astype(int).T)
        found += _pieces(line, np.ravel_multi_index(square, drawn.shape), drawn[square])
    return [line[::-1] if positive_orientation == "high" else line for line in found]


def _pieces(line, square, drawn):
    """The line without segments of no length or in squares that are not drawn.

    A closed one begins, as theirs do, where its segment in the last square ends.
    """
    long = (line[1:] != line[:-1]).any(axis=1)
    line, square, drawn = line[np.append(True, long)], square[long], drawn[long]
    if len(square) and (line[0] == line[-1]).all():
        first = int(np.argmax(square) if drawn.all() else np.argmin(drawn)) + 1
        line, drawn = np.roll(line[:-1], -first, axis=0), np.roll(drawn, -first)
        line = np.vstack([line, line[:1]])
    return [part for part in np.split(line, np.flatnonzero(~drawn) + 1) if len(part) > 1]
