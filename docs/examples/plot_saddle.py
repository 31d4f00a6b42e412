r"""
What a face decides
===================

Four samples, two of them inside and diagonally opposite. The bilinear interpolant

.. math:: B(s, t) = B_{00} (1-s)(1-t) + B_{10} s (1-t) + B_{01} (1-s) t + B_{11} s t

has hyperbolas as its contours. The value at its saddle says which way they run: where the saddle
is inside, the inside corners are joined; where it is outside, they are separated. Here one corner
rises, and the decision turns over on the way. Dashed are the asymptotes, whose crossing is the
saddle; red is what the asymptotic decider draws on the face (Nielson and Hamann 1991).
"""

import matplotlib.pyplot as plt
import numpy as np
from isoref import extract

s, t = np.meshgrid(np.linspace(0, 1, 201), np.linspace(0, 1, 201), indexing="ij")
b00, b10, b01 = 1.0, -1.0, -1.0

figure, axes = plt.subplots(1, 4, figsize=(12, 3.5))
for axis, b11 in zip(axes, (0.5, 0.9, 1.2, 2.5), strict=True):
    interpolant = b00 * (1 - s) * (1 - t) + b10 * s * (1 - t) + b01 * (1 - s) * t + b11 * s * t
    axis.contourf(s, t, interpolant, [-9, 0, 9], colors=["#ffffff", "#cfe2f0"])
    axis.contour(s, t, interpolant, [0], colors="#3a5f7d", linewidths=2)

    bend = b00 + b11 - b10 - b01
    axis.axvline((b00 - b01) / bend, color="grey", linestyle="--", linewidth=0.8)
    axis.axhline((b00 - b10) / bend, color="grey", linestyle="--", linewidth=0.8)

    # One cell with this face below and outside samples above.
    cell = np.full((2, 2, 2), -1.0)
    cell[:, :, 0] = [[b00, b01], [b10, b11]]
    mesh = extract(cell, 0.0, method="asymptotic-decider")
    for triangle in mesh.vertices[mesh.simplices]:
        on_face = triangle[triangle[:, 2] == 0]
        if len(on_face) == 2:
            axis.plot(*on_face[:, :2].T, color="crimson", linewidth=1.5)

    for x, y, value in ((0, 0, b00), (1, 0, b10), (0, 1, b01), (1, 1, b11)):
        color = "black" if value >= 0 else "white"
        axis.plot(x, y, "o", color=color, markeredgecolor="black", clip_on=False, zorder=3)
    value = (b00 * b11 - b10 * b01) / bend
    word = "joined" if value >= 0 else "separated"
    axis.set(title=f"corner {b11}, saddle {value:+.3f}:\n{word}", aspect="equal")
    axis.set(xticks=[], yticks=[], xlim=(0, 1), ylim=(0, 1))
figure.tight_layout()
plt.show()
