"""
A hole, and its repair
======================

Two cells share a face on which two diagonally opposite corners are inside. The drawings of 1987
cut the inside corners apart in the left cell and join them in the right one: four edges stay
open. The asymptotic decider asks the face itself, and both cells hear the same answer.
"""

import matplotlib.pyplot as plt
import numpy as np
from isoref import METHODS, Field
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

values = -np.ones((3, 2, 2))
values[1, 0, 0] = values[1, 1, 1] = values[0, 0, 0] = 1
values[2] = 1
field = Field.of(values)

figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), subplot_kw={"projection": "3d"})
for axis, name in zip(axes, ("lorensen-cline", "asymptotic-decider"), strict=True):
    mesh = METHODS[name](field, 0.0)
    halves = {(t[i], t[(i + 1) % 3]) for t in mesh.simplices.tolist() for i in range(3)}
    open_edges = [mesh.vertices[[a, b]] for a, b in halves if (b, a) not in halves]
    torn = [e for e in open_edges if np.all(e[:, 0] == 1)]
    surface = Poly3DCollection(
        mesh.vertices[mesh.simplices], facecolor="#7fb2d9", edgecolor="#3a5f7d", alpha=0.85
    )
    axis.add_collection3d(surface)
    if torn:
        axis.add_collection3d(Line3DCollection(torn, colors="crimson", linewidths=3))
    wires = [
        [index, np.add(index, step)]
        for index in np.ndindex(values.shape)
        for step in np.eye(3, dtype=int)
        if np.all(np.add(index, step) < values.shape)
    ]
    axis.add_collection3d(Line3DCollection(wires, colors="#999999", linewidths=0.8))
    for index in np.ndindex(values.shape):
        full = values[index] > 0
        axis.scatter(*index, s=45, c="black" if full else "white", edgecolor="black")
    axis.set(
        xlim=(-0.1, 2.1),
        ylim=(-0.1, 1.1),
        zlim=(-0.1, 1.1),
        title=f"{name}: {len(torn)} torn edges",
    )
    axis.set_box_aspect((2.2, 1.2, 1.2), zoom=1.3)
    axis.view_init(22, -62)
    axis.set_axis_off()
figure.tight_layout()
plt.show()
