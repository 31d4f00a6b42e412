"""
Where two isosurfaces meet
==========================

A complex field vanishes where the isosurfaces of its real and of its imaginary part meet: along
curves, the vortices of the wave. Marching Faces finds them without making either surface (Ljung
and Ynnerman). Left a hundred random waves; right a wave made to be knotted: its vortex is a
trefoil. Closed curves have a colour each, open ones end on the border and are grey.
"""

import matplotlib.pyplot as plt
import numpy as np
from isoref.fast.marching_faces import nodal_lines
from isoref.plane_waves import random_waves

waves = random_waves((56, 56, 56), k=36.0, seed=4)

# Milnor's knot: u^2 = v^3 on the three-sphere, carried to space by stereographic projection.
x, y, z = np.meshgrid(*[np.linspace(-3, 3, 72)] * 3, indexing="ij")
r2 = x**2 + y**2 + z**2
u = (2 * z + 1j * (r2 - 1)) / (r2 + 1)
v = 2 * (x + 1j * y) / (r2 + 1)
trefoil = u**2 - v**3

figure = plt.figure(figsize=(11, 5.2))
for place, psi, title in ((1, waves, "random waves"), (2, trefoil, "a trefoil")):
    curves = nodal_lines(psi)
    axis = figure.add_subplot(1, 2, place, projection="3d")
    closed = [curve for curve in curves if curve.closed]
    colors = plt.cm.turbo(np.linspace(0.05, 0.95, len(closed)))
    for curve in curves:
        if not curve.closed:
            axis.plot(*curve.polyline.T, color="0.65", linewidth=0.6)
    for curve, color in zip(closed, colors, strict=True):
        axis.plot(*curve.polyline.T, color=color, linewidth=2.2)
    axis.set_title(f"{title}: {len(closed)} closed, {len(curves) - len(closed)} open")
    axis.set_box_aspect((1, 1, 1), zoom=1.15)
    axis.tick_params(labelbottom=False, labelleft=False)
    axis.view_init(32, -58)
figure.tight_layout()
plt.show()
