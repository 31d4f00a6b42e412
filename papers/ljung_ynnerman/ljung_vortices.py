"""Phase vortices: nodal lines of a complex MRI, checked by the winding of the phase."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from isograde.oracles.space_curves import phase_winding
from isograde.reproduction import Table
from isoref.curves import real_and_imaginary
from isoref.fast import marching_faces
from isoref.marching_faces import FacePoints
from isoref.plane_waves import Complex
from ljung_pictures import vortex_picture


def complex_mri(folder: Path) -> tuple[Complex, tuple[float, ...]]:
    """Magnitude and phase of every echo as one complex array (N1, N2, N3, echoes); the spacing."""
    import nibabel

    magnitude, phase = (
        np.asarray(nibabel.load(folder / f"romeo_{name}.nii").dataobj, np.float64)
        for name in ("Mag", "Phase")
    )
    spacing = nibabel.load(folder / "romeo_Mag.nii").header.get_zooms()[:3]
    psi = magnitude * np.exp(1j * np.pi * phase / np.abs(phase).max())
    return psi, tuple(float(step) for step in spacing)


def vortices(psi: Complex, spacing: tuple[float, ...], picture: Path) -> tuple[Table, str | None]:
    """Nodal lines of a complex MRI of three echoes, checked by the winding of the phase."""
    table = Table("Phase vortices in a complex gradient-echo MRI")
    inside, lines = [], []
    for echo in range(psi.shape[3]):
        fields = real_and_imaginary(psi[..., echo], spacing)
        points = marching_faces.marching_faces(*fields)
        curves = marching_faces.intersection_curves(*fields)
        closed = sum(curve.closed for curve in curves)
        table.add(f"echo {echo + 1}: points", None, len(points))
        table.add(f"echo {echo + 1}: curves", None, f"{len(curves)}, {closed} closed")
        length = round(sum(curve.length for curve in curves), 1)
        table.add(f"echo {echo + 1}: length", None, length, note="in the file's units (mm)")
        wrong = winding_mismatches(psi[..., echo], points)
        note = "the phase turns once around each line"
        what = f"echo {echo + 1}: faces whose winding differs"
        table.add(what, None, wrong, expected=0, note=note)
        lines.append(curves)
        inside.append(np.abs(psi[..., echo]))
    problem = vortex_picture(inside[-1], lines[-1], spacing, picture)
    return table, problem


def winding_mismatches(psi: Complex, points: FacePoints) -> int:
    """On how many lattice faces the headings of the points do not add up to the phase's winding."""
    corner = np.stack(np.unravel_index(points.voxels, points.cells), axis=1)
    wrong = 0
    for axis in range(3):
        winding = phase_winding(np.angle(psi), axis)
        across = points.faces // 2 == axis
        place = corner[across]
        place[:, axis] += points.faces[across] % 2
        np.add.at(winding, tuple(place.T), -points.headings[across])
        wrong += int((winding != 0).sum())
    return wrong
