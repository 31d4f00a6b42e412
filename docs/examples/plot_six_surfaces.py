"""
Six surfaces of the same voxels
===============================

Where active voxels touch in an edge only, a surface that encloses them can cut them apart
(disconnect), join them (connect), or ask the local average of the values (mixed). Each of the
three comes in two resolutions: high (H) puts a point in the middle of every cycle of more than
three edges, low (L) only where a cycle has more than seven. All six are closed, whatever the
voxels are (Schlei 2010).
"""

import matplotlib.pyplot as plt
import numpy as np
from isoref import METHODS, Field
from matplotlib.colors import LightSource
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

# Two voxels that touch in an edge, and a third that touches one of them in another edge.
values = np.zeros((5, 5, 4))
values[1, 1, 1] = 1.0
values[2, 2, 1] = 1.0
values[3, 2, 2] = 0.7
# A bridge below the threshold that only the average of the mixed mode hears.
values[1, 2, 1] = values[2, 1, 1] = 0.3
field = Field.of(values)
light = LightSource(azdeg=225, altdeg=45)

figure, axes = plt.subplots(2, 3, figsize=(10, 5.6), subplot_kw={"projection": "3d"})
for row, resolution in zip(axes, ("L", "H"), strict=True):
    for axis, mode in zip(row, ("disconnect", "mixed", "connect"), strict=True):
        mesh = METHODS[f"vesta-{mode}-{resolution}"](field, 0.5)
        surface = Poly3DCollection(
            mesh.vertices[mesh.simplices],
            facecolors="#9cc3e0",
            edgecolors="#2f4a60",
            linewidths=0.5,
            shade=True,
            lightsource=light,
        )
        axis.add_collection3d(surface)
        axis.set(xlim=(0.5, 3.5), ylim=(0.5, 2.5), zlim=(0.5, 2.5))
        axis.set_title(f"{mode}, {resolution}: {len(mesh.simplices)} triangles", y=0.95)
        axis.set_box_aspect((3, 2, 2), zoom=1.6)
        axis.view_init(28, -52)
        axis.set_axis_off()
figure.subplots_adjust(left=0, right=1, bottom=0, top=0.97, wspace=0, hspace=0.05)
plt.show()
