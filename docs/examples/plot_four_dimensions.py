"""
A torus in four dimensions
==========================

The two equations x² + y² = 1 and p² + q² = 1 describe the Clifford torus, a flat surface in
four-dimensional space. Simplicial isosurfacing cuts the Kuhn triangulation of a four-dimensional
lattice with both at once (Min 2003). Here are two pictures of one mesh. Where q is dropped, each
point of a cylinder is met twice. Seen from the pole of the three-sphere it lies on, by
stereographic projection, it is an ordinary ring.
"""

import matplotlib.pyplot as plt
import numpy as np
from isoref import Field
from isoref.fast.simplicial import extract
from isoref.projection import project
from matplotlib.colors import LightSource
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

side = np.linspace(-1.3, 1.3, 14)
x, y, p, q = np.meshgrid(side, side, side, side, indexing="ij")
values = np.stack([1 - x**2 - y**2, 1 - p**2 - q**2])
field = Field.of(values, side[1] - side[0], [side[0]] * 4, dimension=4)
mesh = extract(field)

edges = {frozenset((t[i], t[i - 1])) for t in mesh.simplices.tolist() for i in range(3)}
euler = len(mesh.vertices) - len(edges) + len(mesh.simplices)

shadow = project(mesh, (0, 1, 2)).vertices
radius = np.linalg.norm(mesh.vertices, axis=1)[:, None]
sphere = mesh.vertices / radius
ring = sphere[:, :3] / (1 - sphere[:, 3:])

figure, axes = plt.subplots(1, 2, figsize=(10, 5), subplot_kw={"projection": "3d"})
light = LightSource(azdeg=225, altdeg=50)
for axis, points, title in (
    (axes[0], shadow, "q dropped"),
    (axes[1], ring, "stereographic"),
):
    surface = Poly3DCollection(
        points[mesh.simplices],
        facecolors="#e0b877",
        shade=True,
        lightsource=light,
        alpha=0.85,
    )
    axis.add_collection3d(surface)
    low, high = points.min(axis=0), points.max(axis=0)
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axis.set_box_aspect(high - low, zoom=1.1)
    axis.set_title(title, y=1.03)
    axis.view_init(32, -60)
    axis.set_axis_off()
figure.suptitle(f"{len(mesh.simplices)} triangles in R⁴, Euler characteristic {euler}")
plt.show()
