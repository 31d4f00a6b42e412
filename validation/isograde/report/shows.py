"""The lines of a snippet that look for what is wrong, claim by claim, in plain NumPy.

They follow lines that define `extract`, the samples (`values`, `isovalue`, `spacing`) and the
answer in the array's axes (`vertices`, `simplices`, in `spacing` units), and append to a list
`wrong` one sentence for each fault, with its place. None of them knows anything of the grader: each
looks in the most direct way there is, so that who reads it can check it. Sides are counted where
simplices meet edges moved a little aside; sheets inside a cell by flooding a fine grid; pieces by
what hangs together. They need not find all that a judge finds, but what they find is wrong.

Names in braces are filled in: {n}, {m}, {sign} (of the declared normals), {tie} (how a sample is
inside), {kuhn} (whether the cells are split), {wanted} (how an ambiguous face is decided), {bound}.
"""

from __future__ import annotations

from isograde.report.shows_known import CONFORMING

FACETS = """
# Facets (ends, edges, ..) with the number of simplices that have each.
sides = [np.delete(simplices, corner, axis=1) for corner in range(simplices.shape[1])]
facets, uses = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0, return_counts=True)
"""
OPEN = (
    FACETS
    + """
# Inside the lattice each has two; on the border one will do.
for facet in vertices[facets[uses % 2 == 1]]:
    flat = (facet == facet[0]).all(axis=0)
    border = flat & ((abs(facet[0] - low) < 1e-6) | (abs(facet[0] - high) < 1e-6))
    if not border.any():
        wrong.append(f"open at {{facet.tolist()}}")
"""
)
# The same with signs, so that four simplices that meet at a tie are told from two pairs.
CANCELLED = """
# Equal vertices count as one, and those at one sample. A facet has a sign in each simplex, by the
# order of its corners.
places = vertices / spacing
at_sample = (abs(places - places.round()) < 5e-5).all(axis=1)
places[at_sample] = places[at_sample].round()
points, one = np.unique(places * spacing + 0.0, axis=0, return_inverse=True)
total = Counter()
for row in one.reshape(-1)[simplices].tolist():
    for corner in range(len(row)):
        facet = row[:corner] + row[corner + 1 :]
        turns = corner + sum(a > b for a, b in combinations(facet, 2))
        total[tuple(sorted(facet))] += (-1) ** turns
for facet in [list(facet) for facet in total if total[facet] and len({{*facet}}) == len(facet)]:
    ends = points[facet]
    flat = (abs(ends - ends[0]) < 1e-6).all(axis=0)
    border = flat & ((abs(ends[0] - low) < 1e-6) | (abs(ends[0] - high) < 1e-6))
    if not border.any():
        wrong.append(f"not cancelled at {{ends.tolist()}}")
"""
CROWDED = (
    FACETS
    + """
for facet, count in zip(vertices[facets], uses):
    if count > 2:
        wrong.append(f"{{count}} simplices meet at {{facet.tolist()}}")
"""
)
SHEETS = """
# Round a vertex the simplices hang together by the facets that hold it: there is one sheet.
for vertex in np.unique(simplices):
    left = [set(row) for row in simplices.tolist() if vertex in row]
    sheet = [left.pop()]
    for one in sheet:
        near = [other for other in left if len(one & other) == len(one) - 1]
        left = [other for other in left if other not in near]
        sheet += near
    if left:
        wrong.append(f"several sheets meet at {{vertices[vertex].tolist()}}")
"""
TURNED = """
# Two simplices that share a facet give it opposite orientations: the signs add up to zero.
total, uses = {{}}, {{}}
for row in simplices.tolist():
    for corner in range(len(row)):
        facet = row[:corner] + row[corner + 1 :]
        swaps = sum(a > b for i, a in enumerate(facet) for b in facet[i + 1 :])
        key = tuple(sorted(facet))
        total[key] = total.get(key, 0) + (-1) ** (corner + swaps)
        uses[key] = uses.get(key, 0) + 1
for key in total:
    if uses[key] == 2 and total[key]:
        wrong.append(f"turned opposite ways at {{vertices[list(key)].tolist()}}")
"""
TWICE = """
same, count = np.unique(np.sort(simplices, axis=1), axis=0, return_counts=True)
wrong += [f"{{row.tolist()}} is there more than once" for row in same[count > 1]]
"""
UNUSED = """
unused = np.setdiff1d(np.arange(len(vertices)), simplices)
wrong += [f"no simplex uses vertex {{i}}" for i in unused]
"""
APART = """
places, count = np.unique((vertices / spacing).round(6) + 0.0, axis=0, return_counts=True)
wrong += [f"{{c}} vertices at index {{p.tolist()}}" for p, c in zip(places, count) if c > 1]
"""
RANGE = """
wrong += [f"{{row.tolist()}} of {{len(vertices)}} vertices" for row in simplices
          if row.min() < 0 or row.max() >= len(vertices)]
"""
REPEATED = """
wrong += [f"{{row}} names a vertex twice" for row in simplices.tolist() if len({{*row}}) < len(row)]
"""
FINITE = """
bad = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
wrong += [f"vertex {{i}} is {{vertices[i].tolist()}}" for i in bad]
"""
FLAT = """
for row in simplices:
    corners = vertices[row] / spacing
    for places in corners, corners.round(6):
        if np.prod(np.linalg.svd(places[1:] - places[0], compute_uv=False)) < 1e-12:
            wrong.append(f"no measure: {{vertices[row].tolist()}}")
            break
"""
NOTHING = """
wrong += [f"{{len(simplices)}} simplices, where there is nothing"] if len(simplices) else []
"""
SIDES = """
# A face of the lattice spanned by {m} axes (one field: an edge), moved a little aside, is met by as
# many simplices, counted with sign, as the samples at its corners say.
n, m = {n}, {m}
shape = np.array(values.shape[-n:])
above = values.reshape(m, *shape).astype(float) - np.reshape(isovalue, (m,) + (1,) * n)
# A sample so small beside one across the surface that the surface rounds to it is not asked; aside
# is nearer than any other crossing comes to a sample.
least = 1e-4
for f in above if m == 1 else ():
    high, low = (maximum_filter(np.where(s, abs(f), 0.0), 3) for s in (f > 0, f <= 0))
    across = np.where(f > 0, low, high)
    f[abs(f) < 1e-9 * across] = 0
    least = min([least, *(abs(f) / np.maximum(across, 1e-300))[f != 0]])
places, aside = vertices / spacing, least / 10 * np.random.default_rng(0).uniform(0.3, 1, n)


def asked(corner, axes):
    a = np.array(corner)
    if m == 1:
        ends = above[(0, *a)], above[(0, *(a + np.eye(n, dtype=int)[axes[0]]))]
        return None if 0 in ends else int(ends[0] > 0) - int(ends[1] > 0)
    # How often the two fields turn round zero along the four edges of the square.
    u, v = np.eye(n, dtype=int)[list(axes)]
    ring = np.array([above[(slice(None), *p)] for p in (a, a + u, a + u + v, a + v, a)])
    if (ring == 0).any():
        return None
    turns = 0
    for (p, q), (r, s) in zip(ring, ring[1:]):
        if (p > 0) != (r > 0):
            other = q + (s - q) * p / (p - r)
            if abs(other) < 1e-6 * abs(ring).max():  # Both are zero at one place of an edge.
                return None
            turns += (np.sign(r) if other > 0 else 0) * -1
    return int(turns)


for axes in combinations(range(n), m):
    span = np.eye(n)[list(axes)]
    others = [axis for axis in range(n) if axis not in axes]
    for corner in np.ndindex(*shape):
        start = np.array(corner)
        if (start[list(axes)] + 1 >= shape[list(axes)]).any():
            continue
        beyond = (start < inset) | (start > shape - 1 - inset)
        if beyond[others].any():
            continue
        wanted = asked(corner, axes)
        if wanted is None:
            continue
        for way in product((1, -1), repeat=n - m):
            line = start.astype(float)
            line[others] += way * aside[others]
            if (line < 0).any() or (line > shape - 1).any():
                continue
            found = 0
            for row in simplices:
                here = places[row]
                left = np.vstack([np.hstack([here.T, -span.T]), [1.0] * len(row) + [0.0] * m])
                if abs(np.linalg.det(left)) > 1e-25:
                    share = np.linalg.solve(left, [*line, 1.0])
                    if (share > 0).all() and (share[len(row) :] < 1).all():
                        frame = np.vstack([span, here[1:] - here[0]])
                        found += int(np.sign(np.linalg.det(frame))) if {signed} else 1
            if {differs}:
                what = f"{{found}}, not {{wanted}}"
                wrong.append(f"from sample {{start.tolist()}} along axes {{axes}}: {{what}}")
                break
"""
DIFFERS = {
    "signed": "found != {sign} * wanted",
    "unsigned": "found < abs(wanted) or (found - wanted) % 2",
}
# What stands where: lines on vertices alone.
VERTICES = """
# Each vertex is on a lattice edge (or one that splits the cells) with samples on both sides, or
# strictly inside a cell that has samples on both sides.
inside = values {tie} isovalue[0]
top = np.array(values.shape) - 1
for place in vertices[np.unique(simplices)] / spacing:
    whole = abs(place - place.round()) < 1e-5
    start = np.clip(np.where(whole, place.round(), np.floor(place)).astype(int), 0, top)
    free, end = ~whole & (start < top), np.where(whole, start, np.minimum(start + 1, top))
    share = (place - start)[free]
    block = inside[tuple(slice(a, b + 1) for a, b in zip(start, end))]
    near = values[tuple(slice(max(a - 1, 0), b + 2) for a, b in zip(start, end))]
    on_edge = free.sum() == 1 or ({kuhn} and free.any() and np.ptp(share) < 1e-5)
    if (near == isovalue[0]).any():
        continue
    if (place < -1e-5).any() or (place > top + 1e-5).any():
        wrong.append(f"a vertex at index {{place.tolist()}}, outside the lattice")
    elif on_edge and inside[tuple(start)] == inside[tuple(end)]:
        wrong.append(f"a vertex at index {{place.tolist()}}, on an edge that is not crossed")
    elif not on_edge and not ({kuhn} or free.all()):
        wrong.append(f"a vertex at index {{place.tolist()}}, on no lattice edge and inside no cell")
    elif block.all() or not block.any():
        wrong.append(f"a vertex at index {{place.tolist()}}, where all samples are on one side")
    elif on_edge and {crossing}:
        a, b = float(values[tuple(start)]), float(values[tuple(end)])
        right = {share}
        if abs(share[0] - right) > 1e-4:
            wrong.append(f"a vertex at {{share[0]}} of the edge from {{start}}, not at {{right}}")
"""
IN_CELLS = """
# Each vertex is in a cell, its border included, that has samples on both sides.
inside = values {tie} isovalue[0]
for place in vertices[np.unique(simplices)] / spacing:
    first = np.maximum(np.ceil(place - 1 - 1e-5), 0).astype(int)
    last = np.floor(place + 1e-5).astype(int)
    blocks = [inside[tuple(slice(i, i + 2) for i in cell)]
              for cell in product(*(range(a, b + 1) for a, b in zip(first, last)))]
    if all(block.all() or not block.any() for block in blocks):
        wrong.append(f"a vertex at index {{place.tolist()}}, in no cell with samples on both sides")
"""
CROSSING = """
# Two simplices meet in what they share: no point is strictly inside both, and where they share no
# corner, none is in both.
count = simplices.shape[1]
for one, other in combinations(simplices, 2):
    a, b = vertices[one] / spacing, vertices[other] / spacing
    if (a.min(axis=0) > b.max(axis=0)).any() or (b.min(axis=0) > a.max(axis=0)).any():
        continue
    # The largest s for which some point has all its weights in both at least s.
    none, ones = np.zeros(count), np.ones(count)
    equal = np.vstack([np.hstack([a.T, -b.T]), [*ones, *none], [*none, *ones]])
    found = linprog(
        [0.0] * 2 * count + [-1.0],
        A_ub=np.hstack([-np.eye(2 * count), np.ones((2 * count, 1))]),
        b_ub=np.zeros(2 * count),
        A_eq=np.hstack([equal, np.zeros((len(equal), 1))]),
        b_eq=[*[0.0] * a.shape[1], 1.0, 1.0],
    )
    shared = (a[:, None] == b).all(axis=2).any()
    if found.status == 0 and (found.x[-1] > 1e-6 or not shared):
        where = (a.T @ found.x[:count]).round(4).tolist()
        wrong.append(f"{{one.tolist()}} and {{other.tolist()}} cross at index {{where}}")
"""
# What cells become: the part of the surface in each cell, and its trace on the cell's faces.
CELLS = """
# The triangles of each cell; the edges that one of them has alone bound the cell's part.
places, top = vertices / spacing, np.array(values.shape) - 1
above = values.astype(float) - isovalue[0]
cells = {{}}
for row in simplices.tolist():
    cell = np.clip(np.floor(places[row].mean(axis=0)).astype(int), 0, top - 1)
    cells.setdefault(tuple(cell.tolist()), []).append(row)


def bounding(rows):
    pairs = (frozenset((row[i], row[i - 1])) for row in rows for i in range(3))
    edges = Counter(pair for pair in pairs if len(pair) == 2)
    return [tuple(edge) for edge, uses in edges.items() if uses % 2]
"""
# A trace on a face is told by the two sides of the square, u = 0, u = 1, v = 0 or v = 1, it joins.
TRACES = """

def trace(cell, axis, side):
    u, v = (one for one in range(3) if one != axis)
    found = []
    for edge in bounding(cells.get(cell, [])):
        here = places[list(edge)] - cell
        if (abs(here[:, axis] - side) < 1e-6).all():
            ends = here[:, [u, v]]
            flat, within = abs(ends - ends.round()) < 1e-6, (abs(ends - 0.5) < 0.5 + 1e-5).all()
            met = [(int(f.argmax()), int(e[f.argmax()].round())) for e, f in zip(ends, flat)]
            found.append(frozenset(met if within else ()))
    return found


def face(cell, axis, side):
    start = np.array(cell) + side * np.eye(3, dtype=int)[axis]
    window = [slice(i, i + 2) for i in start]
    window[axis] = start[axis]
    return above[tuple(window)]


def cutting(corners):
    return {{frozenset(((0, a), (1, b))) for a, b in corners}}
"""
EACH_FACE = """

for cell in np.ndindex(*top):
    for axis, side in product(range(3), (0, 1)):
        f, found = face(cell, axis, side), trace(cell, axis, side)
        inner = [c for c in product((0, 1), repeat=2) if f[c] > 0]
        if (above[tuple(slice(i, i + 2) for i in cell)] == 0).any():
            continue
        ambiguous = len(inner) == 2 and inner[0][0] != inner[1][0] and inner[0][1] != inner[1][1]
"""
FACES = (
    CELLS
    + TRACES
    + EACH_FACE
    + """
        # A segment cuts off a corner: inside corners are separated, or outside ones, and they join.
        outer = [c for c in product((0, 1), repeat=2) if f[c] < 0]
        joined = set(found) == cutting(outer)
        if ambiguous and (joined or set(found) == cutting(inner)):
            if joined != ({wanted}):
                what = "joins" if joined else "separates"
                wrong.append(f"cell {{cell}} {{what}} inside corners of its face {{f.tolist()}}")
        elif ambiguous or (len(found) != 1 and 0 < len(inner) < 4):
            wrong.append(f"cell {{cell}} has {{len(found)}} segments in its face {{f.tolist()}}")
"""
)
WANTED = {
    "topology.bilinear": "(f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]) * f[0, 0] > 0 if f[0, 0] > 0 "
    "else (f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]) < 0",
    "cells.separate": "False",
    "cells.join": "True",
    "cells.mean": "f.sum() >= 0",
}
LEGAL = (
    CELLS
    + TRACES
    + EACH_FACE
    + """
        outer = [c for c in product((0, 1), repeat=2) if f[c] < 0]
        sides = {{(0, 0): f[0], (0, 1): f[1], (1, 0): f[:, 0], (1, 1): f[:, 1]}}
        crossed = frozenset(one for one, (p, q) in sides.items() if (p > 0) != (q > 0))
        right = [{{crossed}} if crossed else set()]
        right = [cutting(inner), cutting(outer)] if ambiguous else right
        if set(found) not in right or len(set(found)) < len(found):
            told = [sorted(one) for one in found]
            wrong.append(f"cell {{cell}} on its face {{f.tolist()}}: segments between {{told}}")
        # What two cells leave in the face between them is the same, whose its flat triangles are.
        beyond = tuple((np.array(cell) + np.eye(3, dtype=int)[axis]).tolist())
        if side and beyond[axis] < top[axis] and set(found) != set(trace(beyond, axis, 0)):
            wrong.append(f"cells {{cell}} and {{beyond}} cut the face between them differently")
for row in simplices:
    if (places[row].max(axis=0).round(6) > np.floor(places[row].min(axis=0).round(6)) + 1).any():
        wrong.append(f"a triangle spans several cells: {{vertices[row].tolist()}}")
"""
)
COUNT = (
    CELLS
    + """

for cell, rows in cells.items():
    edges, corners = bounding(rows), set(sum(rows, []))
    group = {{end: end for edge in edges for end in edge}}
    for a, b in edges:
        group = {{end: group[b] if g == group[a] else g for end, g in group.items()}}
    polygons = len(set(group.values()))
    inner = sum(((places[i] > cell) & (places[i] < np.add(cell, 1))).all() for i in corners)
    wanted = len(edges) + 2 * int(inner) - 2 * polygons
    if len(rows) != wanted and not (len(rows) == wanted + 4 and polygons > 1):
        wrong.append(f"cell {{cell}} has {{len(rows)}} triangles, its outline takes {{wanted}}")
"""
)
REGIONS = """

def regions(above, fine):
    # Flood the multilinear interpolant on a grid so many times as fine; inside and outside parts.
    for axis in range(above.ndim):
        at = np.linspace(0, above.shape[axis] - 1, fine * (above.shape[axis] - 1) + 1)
        weights = np.maximum(0, 1 - abs(at[:, None] - np.arange(above.shape[axis])))
        above = np.moveaxis(np.tensordot(weights, above, (1, axis)), 0, axis)
    return label(above > 0)[1] + label(above <= 0)[1]


def pieces(rows):
    group = {{end: end for row in rows for end in row}}
    for row in rows:
        names = {{group[end] for end in row}}
        group = {{end: row[0] if g in names else g for end, g in group.items()}}
    return len(set(group.values()))
"""
TRILINEAR = (
    FACES
    + REGIONS
    + """

# Each sheet divides its cell once more.
for cell in np.ndindex(*top):
    block = above[tuple(slice(i, i + 2) for i in cell)]
    if (block == 0).any():
        continue
    found, wanted = pieces(cells.get(cell, [])), regions(block, 60) - 1
    if found != wanted:
        wrong.append(f"cell {{cell}} has {{found}} sheets, the trilinear level set {{wanted}}")
    # A sheet is a surface: two triangles at each of its edges.
    rows = cells.get(cell, [])
    edges = Counter(frozenset((row[i], row[i - 1])) for row in rows for i in range(3))
    for edge, uses in edges.items():
        if uses > 2:
            ends = vertices[list(edge)].tolist()
            wrong.append(f"{{uses}} triangles of cell {{cell}} meet at {{ends}}")
"""
)
SCAN = (
    """
above = values.astype(float) - isovalue[0]
"""
    + REGIONS
    + """

# Each piece divides the box once more.
found, wanted = pieces(simplices.tolist()), regions(above, 24) - 1
if found != wanted:
    wrong.append(f"{{found}} pieces, the trilinear level set has {{wanted}}")
"""
)
SQUARES = """
# The segments of each square, told by the two of its sides they join.
places, top = vertices / spacing, np.array(values.shape) - 1
above = values.astype(float) - isovalue[0]
cells = {{}}
for row in simplices.tolist():
    cell = tuple(np.clip(np.floor(places[row].mean(axis=0)).astype(int), 0, top - 1).tolist())
    ends = places[row] - cell
    flat = abs(ends - ends.round()) < 1e-6
    cells.setdefault(cell, []).append(
        frozenset((int(f.argmax()), int(e[f.argmax()].round())) for e, f in zip(ends, flat)))


def cutting(corners):
    return {{frozenset(((0, a), (1, b))) for a, b in corners}}


for cell in np.ndindex(*top):
    f, found = above[cell[0] : cell[0] + 2, cell[1] : cell[1] + 2], cells.get(cell, [])
    if (f == 0).any():
        continue
    inner = [c for c in product((0, 1), repeat=2) if f[c] > 0]
    outer = [c for c in product((0, 1), repeat=2) if f[c] < 0]
    ambiguous = len(inner) == 2 and inner[0][0] != inner[1][0] and inner[0][1] != inner[1][1]
"""
SQUARE_FACES = (
    SQUARES
    + """
    joined = set(found) == cutting(outer)
    if ambiguous and (joined or set(found) == cutting(inner)) and joined != ({wanted}):
        what = "joins" if joined else "separates"
        wrong.append(f"square {{cell}} {{what}} its inside corners {{f.tolist()}}")
"""
)
SQUARE_LEGAL = (
    SQUARES
    + """
    sides = {{(0, 0): f[0], (0, 1): f[1], (1, 0): f[:, 0], (1, 1): f[:, 1]}}
    crossed = frozenset(one for one, (p, q) in sides.items() if (p > 0) != (q > 0))
    right = [{{crossed}} if crossed else set()]
    right = [cutting(inner), cutting(outer)] if ambiguous else right
    if set(found) not in right or len(found) > len(set(found)):
        told = [sorted(one) for one in found]
        wrong.append(f"square {{cell}}, {{f.tolist()}}: segments between {{told}}")
"""
)
# Spheres and circles, by what is known of them.
BODIES = {
    "bodies.pieces": """
group = {{end: end for row in simplices.tolist() for end in row}}
for row in simplices.tolist():
    names = {{group[end] for end in row}}
    group = {{end: row[0] if g in names else g for end, g in group.items()}}
found = len(set(group.values()))
wrong += [f"{{found}} pieces of one sphere"] if found != 1 else []
""",
    "bodies.holes": FACETS
    + """
# V - E + F of a sphere is 2, of a circle 0, and every facet has two simplices.
found = len(np.unique(simplices)) - len(simplices) if {n} == 2 else (
    len(np.unique(simplices)) - len(facets) + len(simplices))
wrong += [f"Euler characteristic {{found}}"] if found != (2 if {n} == 3 else 0) else []
wrong += [f"{{(uses % 2).sum()}} facets are open"] if (uses % 2).any() else []
""",
    "bodies.offset": """
# The enclosed volume (area), less the right one, over the area (length) of the mesh.
corners = vertices[simplices]
edges = corners[:, 1:] - corners[:, :1]
area = np.sqrt(np.linalg.det(edges @ edges.swapaxes(1, 2))).sum() / {factorial_k}
volume = {sign} * np.linalg.det(corners - centre).sum() / {factorial}
off = (volume - {volume}) / area
if not abs(off) <= {bound}:
    wrong.append(f"the surface is off by {{off}} of a cell on the average")
""",
    "bodies.centroid": """
corners = vertices[simplices]
solid = np.linalg.det(corners - centre)
middles = (corners - centre).sum(axis=1) / ({n} + 1)
found = centre + (middles * solid[:, None]).sum(axis=0) / solid.sum()
if not np.linalg.norm(found - centre) <= {bound}:
    wrong.append(f"its centroid is at {{found.tolist()}}, not {{centre.tolist()}}")
""",
    "bodies.distance": """
far = abs(np.linalg.norm(vertices[np.unique(simplices)] - centre, axis=1) - radius)
if not far.max() <= {bound}:
    wrong.append(f"a vertex is {{far.max()}} from the sphere")
""",
    "bodies.degree": """
corners = vertices[simplices]
found = {sign} * np.linalg.det(corners - centre).sum() / {factorial} / {volume}
if not abs(found - 1) < 0.5:
    wrong.append(f"the ball is covered {{found:.2f}} times")
""",
}  # fmt: skip
SHOWS = {
    "topology.closed": OPEN,
    "topology.ties": CANCELLED,
    "topology.manifold": CROWDED,
    "topology.oriented": TURNED,
    "structure.no_duplicate": TWICE,
    "structure.all_used": UNUSED,
    "structure.apart": APART,
    "structure.in_range": RANGE,
    "structure.no_repeated_index": REPEATED,
    "structure.finite": FINITE,
    "structure.with_measure": FLAT,
    "simplices.nothing": NOTHING,
    "curves.identical": NOTHING,
    "simplices.conforming": CONFORMING,
}
# Of surfaces, and of contours, with vertices on the edges of the lattice.
SURFACE_SHOWS = {
    "cells.legal": LEGAL,
    "cells.count": COUNT,
    "cells.frequencies": FACES,
    "topology.trilinear": TRILINEAR,
    **dict.fromkeys(WANTED, FACES),
}
CONTOUR_SHOWS = {"cells.legal": SQUARE_LEGAL, **dict.fromkeys(WANTED, SQUARE_FACES)}
