"""A failed case as a few lines of Python that show it without the grader.

The lines hold the implementation as its own users call it, the samples, and statements that collect
what is wrong, print it, and end in an assertion: they fail on the accused, and say nothing where
the claim holds. What is wrong is looked for in the simplices, so the same lines serve every kind.
For programs in other languages, and for cases too large to print, there is only the command that
grades the case again.
"""

from __future__ import annotations

from textwrap import indent
from typing import Any

import numpy as np

from isograde.report.lines import JSON
from isograde.report.reading import CONVENTIONS, Report, Summary
from isograde.variants import symmetry_of

# Print so many numbers at most.
PRINTED = 400

PYTHON_FILE = 'import runpy\n\nextract = runpy.run_path("{module}")["{function}"]'
PYTHON = "from {module} import {function} as extract"

# Two functions that every snippet has: an answer as arrays, whatever its form, and a call.
ANSWER = '''
def arrays(answer, n, k):
    """Vertices and simplices of an answer: a pair, polylines, a soup, or an object with both."""
    if hasattr(answer, "vertices"):
        answer = answer.vertices, getattr(answer, "simplices", getattr(answer, "faces", None))
    if isinstance(answer, tuple):
        vertices, rows = answer
        if k == 2:  # polygons, cut into triangles from their first corner
            polygons = [[int(corner) for corner in row if corner >= 0] for row in rows]
            rows = [[p[0], *p[i : i + 2]] for p in polygons for i in range(1, len(p) - 1)]
        return np.asarray(vertices, float).reshape(-1, n), np.asarray(rows, int).reshape(-1, k + 1)
    if k == 1 and isinstance(answer, list):  # polylines; a closed one ends where it began
        points, rows = [], []
        for line in map(np.asarray, answer):
            closed = len(line) > 2 and (line[0] == line[-1]).all()
            count, start = len(line) - closed, len(points)
            rows += [[start + i, start + (i + 1) % count] for i in range(len(line) - 1)]
            points += list(line[:count])
        return np.array(points, float).reshape(-1, n), np.array(rows, int).reshape(-1, 2)
    soup = np.asarray(answer, float).reshape(-1, k + 1, n)
    return soup.reshape(-1, n), np.arange(soup.size // n).reshape(-1, k + 1)
'''
CALL = "answer = extract({values}, {isovalue}[0], {spacing})"
CALL_SEVERAL = """# m fields at once, or one argument for each.
several = len(signature(extract).parameters) > 3
given = (*{values}, *{isovalue}) if several else ({values}, {isovalue})
answer = extract(*given, {spacing})"""
FACETS = """
# Facets (ends, edges, ..) with the number of simplices that have each.
sides = [np.delete(simplices, corner, axis=1) for corner in range(simplices.shape[1])]
facets, uses = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0, return_counts=True)
"""
SHOW_OPEN = (
    FACETS
    + """
# Inside the lattice each has two; on the border one will do.
for facet in vertices[facets[uses % 2 == 1]]:
    flat = (facet == facet[0]).all(axis=0)
    border = flat & ((abs(facet[0] - low) < 1e-6) | (abs(facet[0] - high) < 1e-6))
    if not border.any():
        wrong.append(f"open at {facet.tolist()}")
"""
)
SHOW_CROWDED = (
    FACETS
    + """
for facet, count in zip(vertices[facets], uses):
    if count > 2:
        wrong.append(f"{count} simplices meet at {facet.tolist()}")
"""
)
SHOW_SHEETS = """
# Round a vertex the simplices hang together by the facets that hold it: there is one sheet.
for vertex in np.unique(simplices):
    left = [set(row) for row in simplices.tolist() if vertex in row]
    sheet = [left.pop()]
    for one in sheet:
        near = [other for other in left if len(one & other) == len(one) - 1]
        left = [other for other in left if other not in near]
        sheet += near
    if left:
        wrong.append(f"several sheets meet at {vertices[vertex].tolist()}")
"""
SHOW_TURNED = """
# Two simplices that share a facet give it opposite orientations: the signs add up to zero.
total, uses = {}, {}
for row in simplices.tolist():
    for corner in range(len(row)):
        facet = row[:corner] + row[corner + 1 :]
        swaps = sum(a > b for i, a in enumerate(facet) for b in facet[i + 1 :])
        key = tuple(sorted(facet))
        total[key] = total.get(key, 0) + (-1) ** (corner + swaps)
        uses[key] = uses.get(key, 0) + 1
for key in total:
    if uses[key] == 2 and total[key]:
        wrong.append(f"turned opposite ways at {vertices[list(key)].tolist()}")
"""
SHOW_TWICE = """
same, count = np.unique(np.sort(simplices, axis=1), axis=0, return_counts=True)
wrong += [f"{row.tolist()} is there more than once" for row in same[count > 1]]
"""
SHOW_UNUSED = """
wrong += [f"no simplex uses vertex {i}" for i in np.setdiff1d(np.arange(len(vertices)), simplices)]
"""
SHOW_APART = """
places, count = np.unique(vertices, axis=0, return_counts=True)
wrong += [f"{c} vertices at {p.tolist()}" for p, c in zip(places, count) if c > 1]
"""
SHOW_RANGE = """
wrong += [f"{row.tolist()} of {len(vertices)} vertices" for row in simplices
          if row.min() < 0 or row.max() >= len(vertices)]
"""
SHOW_REPEATED = """
wrong += [f"{row} names a vertex twice" for row in simplices.tolist() if len({*row}) < len(row)]
"""
SHOW_FINITE = """
bad = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
wrong += [f"vertex {i} is {vertices[i].tolist()}" for i in bad]
"""
SHOW_FLAT = """
for row in simplices:
    sides = vertices[row[1:]] - vertices[row[0]]
    if abs(np.linalg.det(sides @ sides.T)) < 1e-24:
        wrong.append(f"no measure: {vertices[row].tolist()}")
"""
SHOWS = {
    "topology.closed": SHOW_OPEN,
    "topology.ties": SHOW_OPEN,
    "topology.manifold": SHOW_CROWDED,
    "topology.oriented": SHOW_TURNED,
    "structure.no_duplicate": SHOW_TWICE,
    "structure.all_used": SHOW_UNUSED,
    "structure.apart": SHOW_APART,
    "structure.in_range": SHOW_RANGE,
    "structure.no_repeated_index": SHOW_REPEATED,
    "structure.finite": SHOW_FINITE,
    "structure.with_measure": SHOW_FLAT,
}
# Two answers that should be one have as many simplices, and the same vertices.
SHOW_COUNTS = """
if len(posed_simplices) != len(simplices):
    wrong.append(f"{len(simplices)} simplices; {meaning}, {len(posed_simplices)}")
"""
SHOW_PLACES = """
if len(posed_vertices) and len(vertices):
    away = abs(posed_vertices[:, None] - vertices).max(axis=2).min(axis=1)
    far = posed_vertices[away.argmax()]
    wrong += [f"a vertex at {far.tolist()}, {meaning}"] if away.max() > 1e-4 else []
elif len(posed_vertices) != len(vertices):
    wrong.append(f"{len(vertices)} vertices; {meaning}, {len(posed_vertices)}")
"""
SHOW_SEGMENTS = """
# Edges that lie in a face between cells, each by its two ends: they say how faces are decided.
found = []
for points, rows in ((vertices, simplices), (posed_vertices, posed_simplices)):
    ends = (points / spacing).round(4)[rows]
    pairs = np.concatenate([ends[:, [0, 1]], ends[:, [1, 2]], ends[:, [2, 0]]])
    flat = ((pairs[:, 0] == pairs[:, 1]) & (pairs[:, 0] == pairs[:, 0].round())).any(axis=1)
    found.append({tuple(sorted(map(tuple, pair))) for pair in (pairs[flat] + 0.0).tolist()})
wrong += [f"from {a} to {b} in one answer only" for a, b in sorted(found[0] ^ found[1])]
"""
BACK_SPACING = """
# Back to the spacing of the field.
posed_vertices = posed_vertices / posed_spacing * spacing
"""
BACK_SYMMETRY = """
# Back to the axes of the field.
places = posed_vertices / posed_spacing
places = np.where({mirrored}, {last} - places, places)[:, {order}]
posed_vertices = places * spacing
"""
# Variants that leave every vertex where it is.
SAME_PLACES = frozenset({
    "repeat", "scale", "shift", "fortran", "strided", "backwards", "float32", "float64", "int16",
    "uint8", "components",
})  # fmt: skip
SHOW_NOTHING = """
wrong += [f"{len(posed_simplices)} simplices, {meaning}"] if len(posed_simplices) else []
"""
ENDED = """
print(*wrong, sep="\\n")
assert not wrong, {rule}
"""
PRINT = """
# {detail}
print(vertices)
print(simplices)
"""


def snippet(report: Report, summary: Summary) -> str | None:
    """The lines that show the claim's smallest failed case, or None where there are none."""
    record = report.evidence.get(summary.id)
    call = calling(report.spec, report.declaration.get("given", "samples"))
    if summary.id in CONVENTIONS:
        return None  # There an error is right, or none is, as it is declared.
    if record is None or call is None or not 0 < len(record["values"]) <= PRINTED:
        return None
    if len(record.get("posed", {}).get("values", [])) > 2 * PRINTED:
        return None
    n, m = record["kind"]
    lines = [*_begun(call.strip(), m), "", ANSWER, ""]
    if _has_nan(record.get("posed", record)):
        lines += ["nan = np.nan", ""]
    house = _house(report.declaration)
    lines += [_samples(record, m), _asked(n, m), *_some(house.format(prefix=""))]
    if "border" in SHOWS.get(summary.id, ""):
        lines.append(_ends(report.declaration, record["shape"]))
    return "\n".join([*lines, *_shows(record, summary, house)]) + "\n"


def _some(text: str) -> list[str]:
    """The text, where there is any."""
    return [text] if text else []


def _begun(call: str, m: int) -> list[str]:
    """The imports, and the lines that define `extract`."""
    first, _, rest = call.partition("\n\n\n")
    imports = first.split("\n") if rest and "def " not in first and "=" not in first else []
    lines = rest if imports else call
    imports = [line for line in imports if line != "import numpy as np"]
    if m > 1:
        imports.append("from inspect import signature")
    return [*sorted(imports), *[""] * bool(imports), "import numpy as np", "", "", lines]


def _house(declaration: JSON) -> str:
    """The lines that put vertices in world units and the array's axes, and weld soups."""
    said, lines = declaration["conventions"], []
    if said["axes"] == "reversed":
        lines.append("{prefix}vertices = {prefix}vertices[:, ::-1]")
    if said["units"] == "index":
        lines.append("{prefix}vertices = {prefix}vertices * {prefix}spacing")
    if declaration["mesh"] != "indexed":
        lines += [
            "# Its vertices count as one where they are within its tolerance.",
            "{prefix}vertices, one = np.unique({prefix}vertices.round(6), axis=0, "
            "return_inverse=True)",
            "{prefix}simplices = one.reshape(-1)[{prefix}simplices]",
        ]
    return "\n".join(lines)


def _ends(declaration: JSON, shape: list[int]) -> str:
    """The line that says where the lattice ends: nowhere along an axis that is closed there."""
    ends = declaration["domain"]
    each = ends if len(ends) == len(shape) else ends[:1] * len(shape)
    low = [end["inset"] if end["end"] == "open" else np.inf for end in each]
    high = [
        n - 1 - end["inset"] if end["end"] == "open" else np.inf
        for n, end in zip(shape, each, strict=True)
    ]
    inf = "inf = np.inf\n" if np.inf in low else ""
    return f"{inf}low, high = np.array({low}) * spacing, np.array({high}) * spacing"


def _asked(n: int, m: int, prefix: str = "") -> str:
    """The lines that call and make arrays of the answer."""
    names = {name: prefix + name for name in ("values", "isovalue", "spacing")}
    call = (CALL if m == 1 else CALL_SEVERAL).format(**names)
    return f"{call}\n{prefix}vertices, {prefix}simplices = arrays(answer, {n}, {n - m})"


def _shows(record: JSON, summary: Summary, house: str) -> list[str]:
    """The lines that show what is wrong."""
    n, m = record["kind"]
    rule, detail = str(summary.claim["rule"]), record["finding"]["detail"]
    posed = record.get("posed")
    ended = ENDED.format(rule=ascii(rule)).rstrip()
    if posed is not None and len(posed["shape"]) == n and posed["values"]:
        compared = _compared(posed, n, m).rstrip()
        return [
            f"\n# The same, {' '.join(posed['meaning'].split())}.",
            _samples(posed, m, "posed_"),
            _asked(n, m, "posed_"),
            *_some(house.format(prefix="posed_")),
            f"\nmeaning, wrong = {posed['meaning']!a}, []{compared}{ended}",
        ]
    show = SHOWS.get(summary.id)
    if summary.id == "topology.manifold" and "vertices" in record["finding"].get("numbers", {}):
        show = SHOW_SHEETS
    if show is None:
        return [PRINT.format(detail=" ".join(detail.split())).rstrip()]
    return [f"\nwrong = []{show.rstrip()}{ended}"]


def _compared(posed: JSON, n: int, m: int) -> str:
    """The lines that compare the answer to a variant, brought back, with the plain one."""
    name = posed["variant"]
    segments = SHOW_SEGMENTS if (n, m) == (3, 1) else ""
    if name in SAME_PLACES:
        return SHOW_COUNTS + SHOW_PLACES.lstrip("\n") + segments
    if name in ("above", "below"):
        return SHOW_NOTHING
    if name == "spacing":
        return BACK_SPACING + SHOW_PLACES + segments
    if name.startswith("symmetry/"):
        order, mirrored = symmetry_of(name)
        last = (np.array(posed["shape"]) - 1).tolist()
        back = np.argsort(order).tolist()
        moved = BACK_SYMMETRY.format(mirrored=list(mirrored), last=last, order=back)
        return moved + SHOW_PLACES + segments
    return SHOW_COUNTS


def calling(spec: str, given: str = "samples") -> str | None:
    """The lines that define `extract` as the implementation's users call it; None if none do.

    given : what it is called with, as it declares
    """
    from isograde.adapters.registry import READY_MADE, on_samples_source

    kind, _, rest = spec.partition(":")
    if kind == "python":
        module, _, function = rest.rpartition(":")
        template = PYTHON_FILE if module.endswith(".py") else PYTHON
        lines = template.format(module=module, function=function)
        if given == "function":
            imports, definitions = on_samples_source()
            definitions = ["\n".join([*imports, lines]), *definitions]
            lines = "\n\n\n".join([*definitions, "extract = on_samples(extract)"])
        return lines
    ready = READY_MADE.get(spec)
    return None if ready is None else ready.source


def _has_nan(record: JSON) -> bool:
    """Whether a sample is not a number."""
    return any(isinstance(value, str) for value in [*record["isovalues"], *record["values"]])


def _samples(record: JSON, m: int, prefix: str = "") -> str:
    """The lines that make the samples, the isovalues, the spacing and the ends of the lattice."""
    numbers = [float(value) if isinstance(value, str) else value for value in record["values"]]
    shape = record["shape"] if m == 1 else [m, *record["shape"]]
    values = np.asarray(numbers, record["dtype"]).reshape(shape)
    start = f"{prefix}values = np.array("
    printed = np.array2string(values, separator=", ", threshold=10 * PRINTED, floatmode="unique")
    rows = indent(printed, " " * len(start)).strip().replace("\n\n", "\n")
    dtype = f', dtype="{record["dtype"]}"' if record["dtype"] != "float64" else ""
    spacing: Any = tuple(record["spacing"])
    lines = [
        f"{start}{rows}{dtype})",
        f"{prefix}isovalue, {prefix}spacing = {tuple(record['isovalues'])}, {spacing}",
    ]
    return "\n".join(lines)
