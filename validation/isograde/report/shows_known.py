"""The lines of a snippet that compare an answer with a field whose answer is known by formula.

They follow `isograde.report.formulas` as `isograde.report.shows` follows printed samples: there are
`values`, `isovalue`, `spacing`, `origin`, what is known, and the answer as `vertices` and
`simplices` in world units from the first sample. Names in braces are filled in.
"""

from __future__ import annotations

# Segments joined into curves: `lines`, points in order, a closed one ends where it began.
LINES = """
# Join the segments into curves; a closed one ends where it began.
points, near, lines = vertices + origin, {{}}, []
for a, b in simplices.tolist():
    near.setdefault(a, []).append(b)
    near.setdefault(b, []).append(a)
for start in sorted(near, key=lambda end: len(near[end]) % 2 == 0):  # Loose ends first.
    while near[start]:
        line = [start]
        while near[line[-1]]:
            line.append(near[line[-1]].pop())
            near[line[-1]].remove(line[-2])
            if line[-1] == start:
                break
        lines.append(points[line])
"""
COUNT = (
    LINES
    + """
closed = sum(bool((line[0] == line[-1]).all()) for line in lines)
if (closed, len(lines) - closed) != {expected}:
    ends = [line[0].round(4).tolist() for line in lines]
    wrong.append(f"{{closed}} closed and {{len(lines) - closed}} open curves, not {expected}; "
                 f"they start at {{ends}}")
"""
)
LINKING = (
    LINES
    + """

def corner(u, v, w):  # Signed area of spherical triangles.
    lu, lv, lw = (np.linalg.norm(x, axis=-1) for x in (u, v, w))
    dots = (u * v).sum(-1) * lw + (v * w).sum(-1) * lu + (w * u).sum(-1) * lv
    return 2 * np.arctan2((u * np.cross(v, w)).sum(-1), lu * lv * lw + dots)


# Linking numbers: Gauss's integral is a sum over pairs of segments, exact for polygons.
loops, found = [line for line in lines if (line[0] == line[-1]).all()], []
for one, other in combinations(loops, 2):
    a, b, c, d = one[:-1, None], one[1:, None], other[None, :-1], other[None, 1:]
    area = corner(c - a, d - b, d - a) + corner(c - a, c - b, d - b)
    found.append(abs(round(area.sum() / (4 * np.pi))))
if sorted(found) != {links}:
    wrong.append(f"linking numbers {{sorted(found)}}, not {links}")

# Knots: colour the arcs of a projection, 2 over = the sum of those under; 3 colourings make
# a trefoil's determinant 3, the unknot's is 1.
view = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
knots = []
for loop in loops:
    p, step, n = loop @ view, np.diff(loop @ view, axis=0), len(loop) - 1
    met = []
    for i, j in combinations(range(n), 2):
        both = np.array([step[i, :2], -step[j, :2]]).T
        if j - i in (1, n - 1) or abs(np.linalg.det(both)) < 1e-14:
            continue
        s, t = np.linalg.solve(both, p[j, :2] - p[i, :2])
        if 0 <= s < 1 and 0 <= t < 1:
            above = p[i, 2] + s * step[i, 2] > p[j, 2] + t * step[j, 2]
            met.append((i + s, j + t) if above else (j + t, i + s))
    under, rows = sorted(place for _, place in met), np.zeros((len(met), len(met)))
    for row, (over, place) in zip(rows, met):
        into = under.index(place)
        row[np.searchsorted(under, over) % len(met)] += 2
        row[into] -= 1
        row[(into + 1) % len(met)] -= 1
    knots.append(abs(round(np.linalg.det(rows[1:, 1:]))) if len(met) > 2 else 1)
if sorted(knots) != {determinants}:
    wrong.append(f"determinants of knots {{sorted(knots)}}, not {determinants}")
"""
)
ON_SURFACES = """
# At each vertex both functions are within M h^2 / 2 of 0, M their largest second derivatives
# near the curve, h the longest edge of a cell.
points = vertices[np.unique(simplices)] + origin
wrong += [] if len(points) else ["there is no curve where surfaces meet"]
for function, bound in zip((first, second), {bounds}):
    for place, value in zip(points, function(*points.T)):
        if abs(value) > bound:
            what = f"{{function.__name__}} is {{value:.3g}}, its bound {{bound:.3g}}"
            wrong.append(f"at {{place.tolist()}} {{what}}")
"""
COVERS = """

def away(points, starts, ends):  # The distance of each point from the nearest segment.
    far = []
    for point in points:
        step = ends - starts
        share = ((point - starts) * step).sum(axis=1) / (step**2).sum(axis=1).clip(1e-300)
        near = starts + share.clip(0, 1)[:, None] * step
        far.append(np.linalg.norm(near - point, axis=1).min())
    return np.array(far)


# Found and known curves are within {cells} of a cell's diagonal of each other.
segments, bound = vertices[simplices] + origin, {cells} * np.linalg.norm(spacing)
starts = np.concatenate([curve[:-1] for curve in known])
ends = np.concatenate([curve[1:] for curve in known])
if not len(segments):
    wrong.append("there is no curve where surfaces meet")
else:
    for what, points, far in (
        ("the known curve has a point", starts, away(starts, segments[:, 0], segments[:, 1])),
        ("there is a vertex", segments[:, 0], away(segments[:, 0], starts, ends)),
    ):
        if far.max() > bound:
            place = points[far.argmax()].tolist()
            wrong.append(f"{{what}} at {{place}}, {{far.max():.3g}} from the other curves")
"""
EULER = """
# Faces of every dimension, an even one more, an odd one less; pieces by what hangs together.
faces, euler = simplices, 0
for dimension in range(simplices.shape[1] - 1, -1, -1):
    faces = np.unique(np.sort(faces, axis=1), axis=0)
    euler += (-1) ** dimension * len(faces)
    faces = np.concatenate([np.delete(faces, corner, axis=1) for corner in range(dimension + 1)])
group = {{end: end for end in np.unique(simplices).tolist()}}


def root(end):
    while group[end] != end:
        end = group[end]
    return end


for row in simplices.tolist():
    for end in row[1:]:
        group[root(end)] = root(row[0])
pieces = [end for end in group if root(end) == end]
if (euler, len(pieces)) != {expected}:
    places = (vertices[pieces[:4]] + origin).round(4).tolist()
    wrong.append(f"Euler characteristic {{euler}} in {{len(pieces)}} pieces, not {expected}; "
                 f"pieces at {{places}}")
"""
FLAT = """
# What is affine is interpolated without an error: in cells, the value over the slope.
points = vertices[np.unique(simplices)] + origin
slope = abs(phi(np.eye({n})) - phi(np.zeros((1, {n})))).sum(axis=0) * max(spacing)
wrong += [] if len(points) else ["there is no simplex where there are zeros"]
for place, far in zip(points, (abs(phi(points)) / slope).max(axis=1)):
    if far > {allowed}:
        wrong.append(f"the vertex at {{place.tolist()}} is {{far:.3g}} of a cell off its flat set")
"""
CONFORMING = """
# Facets that one simplex has, off the border.
sides = [np.delete(simplices, corner, axis=1) for corner in range(simplices.shape[1])]
facets, uses = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0, return_counts=True)
loose = []
for facet in vertices[facets[uses == 1]]:
    flat = abs(facet - facet[0]).max(axis=0) < 1e-9
    border = flat & ((abs(facet[0] - low) < 1e-6) | (abs(facet[0] - high) < 1e-6))
    loose += [] if border.any() else [facet]
# Two cuts of one face: the middle of a facet lies in another facet.
for one, other in permutations(loose, 2):
    middle = one.mean(axis=0)
    if (middle < other.min(axis=0) - 1e-9).any() or (middle > other.max(axis=0) + 1e-9).any():
        continue
    equations, right = np.vstack([other.T, np.ones(len(other))]), np.append(middle, 1)
    weights = np.linalg.lstsq(equations, right, rcond=None)[0]
    if abs(equations @ weights - right).max() < 1e-7 and weights.min() > -1e-7:
        wrong.append(f"{{one.tolist()}} lies on {{other.tolist()}}")
"""
PERFECT = """
# No two points at one place, no triangle without area, and (below) no two that cross.
bad = ~np.isfinite(vertices).all(axis=1)
wrong += [f"vertex {{i}} is {{vertices[i].tolist()}}" for i in np.flatnonzero(bad)]
simplices = simplices[~bad[simplices].any(axis=1)]
used = np.unique(simplices)
for i, j in combinations(used, 2):
    if np.linalg.norm((vertices[i] - vertices[j]) / spacing) < {margin}:
        wrong.append(f"vertices {{i}} and {{j}} stand together at {{vertices[i].tolist()}}")
for row in simplices:
    a, b, c = vertices[row] / spacing
    if np.linalg.norm(np.cross(b - a, c - a)) < {margin}:
        wrong.append(f"no area: {{vertices[row].tolist()}}")
"""

# --- errors that shrink --------------------------------------------------------------------------

ORDERS = """
# Each simplex belongs to the nearest body.
corners = vertices[simplices]
nearest = np.argmin([abs(distance(corners.mean(axis=1), i)) for i in range(len(scales))], axis=0)
sides = corners[:, 1:] - corners[:, :1]
sizes = np.sqrt(np.linalg.det(sides @ sides.swapaxes(1, 2)).clip(0)) / {factorial_k}


def error(i):  # {what}.
    own = nearest == i
{error}

errors = np.array([error(i) for i in range(len(scales))])
# The slope of log error over log h with its 95 % interval (Student's factor {student}).
x, y = np.log(1 / scales), np.log(errors.clip(1e-300))
deviation = x - x.mean()
order = deviation @ y / (deviation @ deviation)
rest = y - y.mean() - order * deviation
half = {student} * np.sqrt(rest @ rest / (len(x) - 2) / (deviation @ deviation))
if order + half < {formal} - {slack}:
    interval = f"{{order - half:.2f}} to {{order + half:.2f}}"
    wrong.append(f"order {{order:.2f}} (95 %: {{interval}}), formally {formal:g}")
    wrong += [f"at h = 1 / {{scale}} the error is {{e:.3g}}" for scale, e in zip(scales, errors)]
"""
ERRORS = {
    "position": (
        "the largest distance of a vertex, over the scale",
        """    return abs(distance(vertices[np.unique(simplices[own])], i)).max() / scales[i]
""",
    ),
    "normal": (
        "the angle between simplices and body, root mean square by size",
        """    real = own & (sizes > 0)
    places = corners[real].mean(axis=1)
    steps = 1e-6 * np.eye({n})
    outward = np.stack([signed({flattened}, i) for s in (1, -1) for step in steps], axis=-1)
    outward = (outward[:, :{n}] - outward[:, {n}:])[:, None]
    normals = outward / np.linalg.norm(outward, axis=-1, keepdims=True)
{across}    span, _ = np.linalg.qr(sides[real].swapaxes(1, 2))
    sine = np.linalg.norm(normals @ span, ord=2, axis=(1, 2))
    angle = np.arcsin(np.minimum(sine, 1))
    return np.sqrt((sizes[real] * angle**2).sum() / sizes[real].sum())
""",
    ),
    "distance": (
        "the largest value of the trilinear interpolant, whose slope is 1, over the scale",
        """    weights = np.array([[2, 2, 2], [3, 3, 0], [0, 3, 3], [3, 0, 3]]) / 6
    probes = np.einsum("pk,fkd->pfd", weights, corners[own]).reshape(-1, 3)
    return abs(map_coordinates(values, probes.T, order=1, mode="nearest")).max() / scales[i]
""",
    ),
    "measure": (
        "the relative error of the length, the area, ..",
        """    return abs(sizes[own].sum() / {known}[i] - 1)
""",
    ),
    "volume": (
        "the relative error of the volume",
        """    volume = np.linalg.det(corners[own] - middles[i]).sum() / {factorial}
    return abs(abs(volume) / {known}[i] - 1)
""",
    ),
    "curvature": (
        "the relative error of the total mean curvature",
        """    # Half the sum over edges of length times the angle by which the normal turns.
    across = np.cross(sides[own, 0], sides[own, 1])
    across = across / np.linalg.norm(across, axis=1, keepdims=True).clip(1e-300)
    edges = {{}}
    for row, normal in zip(simplices[own].tolist(), across):
        for a, b in zip(row, row[1:] + row[:1]):
            edges.setdefault(frozenset((a, b)), []).append((a, b, normal))
    pairs = [(*one, other[2]) for one, other in (e for e in edges.values() if len(e) == 2)]
    if not pairs:
        return 1.0
    a, b, one, other = map(np.array, zip(*pairs))
    along = vertices[b] - vertices[a]
    long = np.linalg.norm(along, axis=1)
    sine = (np.cross(one, other) * along).sum(axis=1) / long.clip(1e-300)
    total = (long * np.arctan2(sine, (one * other).sum(axis=1))).sum() / 2
    return abs(abs(total) / {known}[i] - 1)
""",
    ),
}
CUT_NORMALS = """    planes = np.broadcast_to(across, (len(places), *across.shape))
    normals = np.concatenate([normals, planes], axis=1)
"""
FLATTENED = ("places + s * step", "places + s * step - heights(places + s * step) @ across")

# --- calls in company, and what they cost --------------------------------------------------------

BUFFER = """
wrong, other = [], np.ascontiguousarray(np.flip(values, range(-{n}, 0)))
answer = extract({values})
kept = [part.copy() for part in arrays(answer, {n}, {k})]
for _ in range({others}):
    extract({other})
for what, before, now in zip(("vertices", "simplices"), kept, arrays(answer, {n}, {k})):
    if not np.array_equal(before, now):
        same = before.shape == now.shape
        where = f", row {{np.argwhere(before != now)[0][0]}} first" if same else ""
        wrong.append(f"the {{what}} changed when other fields were asked{{where}}")
"""
AGAIN = """
step = 2.0 ** np.ceil(np.log2(np.abs(values).max()))
question, level = values + step, tuple(one + step for one in isovalue)
close = tuple(one + {close} * np.ptp(question) for one in level)
axes, count = tuple(range(-{n}, 0)), question.size // len(level)
low, high = (edge(axes, keepdims=True) for edge in (question.min, question.max))
below = (np.arange(question.shape[-{n}]) < question.shape[-{n}] // 2).reshape(-1, *[1] * ({n} - 1))
values, isovalue, wrong = question.copy(), level, []
alone = [part.copy() for part in arrays(extract({question}), {n}, {k})]


def among_others(many):  # In one array: fields of one high sample, each at another place.
    for number in range(many):
        each = np.repeat(low.reshape(-1, 1), count, axis=1)
        each[:, {prime} * number % count] = high.reshape(-1)
        values[...] = each.reshape(values.shape)
        extract({values})


def ask(when):
    values[...] = question
    if not all(map(np.array_equal, alone, arrays(extract({values}), {n}, {k}))):
        wrong.append(f"another answer {{when}} than alone")


among_others({forgotten})
values[...], isovalue = question, close
extract({values})
isovalue = level
ask("after other samples in the same array, and an isovalue close by,")
for half in (np.where(below, low, question), np.where(below, question, low)):
    values[...] = half
    extract({values})
among_others({period} - 2)
ask("255 and 256 calls after its halves")
"""
THREADS = """
wrong, other = [], np.ascontiguousarray(np.flip(values, range(-{n}, 0)))
alone = [part.copy() for part in arrays(extract({values}), {n}, {k})]
ready = Barrier(4)


def ask(number):
    ready.wait()
    for call in range(24):
        if number % 2:
            extract({other})
            continue
        found = arrays(extract({values}), {n}, {k})
        if not all(map(np.array_equal, alone, found)):
            wrong.append(f"thread {{number}}, call {{call}}: another answer than alone")


setswitchinterval(1e-5)
with ThreadPoolExecutor(4) as pool:
    list(pool.map(ask, range(4)))
"""
SLOWER = """

def seconds(values):  # Of the processor, the least of three calls.
    took = []
    for _ in range(3):
        start = process_time()
        extract({values})
        took.append(process_time() - start)
    return min(took)


# The field and its mirror images: {times} times the samples.
grown = [(0, 0)] * (values.ndim - {n}) + [(0, count) for count in values.shape[-{n}:]]
large = np.pad(values, grown, mode="symmetric")
wrong, one, more = [], seconds(values), seconds(large)
if more > max({seconds}, {share} * one):
    wrong.append(f"{{one:.3g}} s, and {{more:.3g}} s for {times} times the samples")
"""
HELD = """

def held(what):  # Bytes of memory that the process holds, or held at most, on Linux.
    return 1024 * int(open("/proc/self/status").read().split(what)[1].split()[0])

"""
LARGER = (
    HELD
    + """
def peak(values):  # By how many bytes a call raises what is held, while it runs.
    extract({values})
    with open("/proc/self/clear_refs", "w") as reset:
        reset.write("5")
    before = held("VmRSS:")
    extract({values})
    return max(0, held("VmHWM:") - before)


# The field and its mirror images: {times} times the samples.
grown = [(0, 0)] * (values.ndim - {n}) + [(0, count) for count in values.shape[-{n}:]]
large = np.pad(values, grown, mode="symmetric")
wrong, one, more = [], peak(values), peak(large)
if more > max({bytes}, {share} * max(one, values.nbytes)):
    wrong.append(f"{{one >> 20}} MB, and {{more >> 20}} MB for {times} times the samples")
"""
)
LEAK = (
    HELD
    + """
for _ in range(12):  # What is learned once is no leak.
    found = arrays(extract({values}), {n}, {k})
wrong, before = [], held("VmRSS:")
for _ in range({calls}):
    found = arrays(extract({values}), {n}, {k})
left = held("VmRSS:") - before
allowed = max({least}, {calls} * min(sum(part.nbytes for part in found), values.nbytes) // 2)
if left > allowed:
    each = f"{{left // {calls} // 1024}} kB each"
    wrong.append(f"{calls} calls leave {{left / 2**20:.1f}} MB behind, {{each}}")
"""
)
