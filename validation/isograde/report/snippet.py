"""A failed case as a few lines of Python that show it without the grader.

The lines hold the implementation as its own users call it, the samples, and statements that collect
what is wrong, print it, and end in an assertion: they fail on the accused, and say nothing where
the claim holds. What is wrong is looked for in the simplices, so the same lines serve every kind.
A field that is too large to print is made by its formula, where it has one. A program in another
language is asked by a few lines more. Where there are no lines, as for a folder of answers, the
page says why in a sentence (`without`); there is still the command that grades the case again.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import factorial, prod
from textwrap import indent
from typing import Any

import numpy as np
from scipy.special import stdtrit

from isograde.adapters.worker import CLOSE, FORGOTTEN, MANY, OTHERS, PERIOD, PRIME
from isograde.cases import all_cases
from isograde.cases.accuracy import row
from isograde.cases.bodies import ISOVALUES
from isograde.claims import accuracy, calls, curves, simplices
from isograde.model import Case, Verdict
from isograde.oracles.apart import MARGIN
from isograde.report import formulas
from isograde.report.lines import JSON
from isograde.report.reading import CONVENTIONS, Report, Summary
from isograde.report.shows import (
    BODIES,
    CONTOUR_SHOWS,
    CROSSING,
    CROWDED,
    DIFFERS,
    FINITE,
    IN_CELLS,
    OPEN,
    SCAN,
    SHEETS,
    SHOWS,
    SIDES,
    SURFACE_SHOWS,
    VERTICES,
    WANTED,
)
from isograde.report.shows_known import (
    AGAIN,
    BUFFER,
    COUNT,
    COVERS,
    CUT_NORMALS,
    ERRORS,
    EULER,
    FLAT,
    FLATTENED,
    LARGER,
    LEAK,
    LINKING,
    ON_SURFACES,
    ORDERS,
    PERFECT,
    SLOWER,
    THREADS,
)
from isograde.variants import symmetry_of

# Print so many numbers at most.
PRINTED = 400
# A sample this much smaller than another may have a crossing within the judges' tolerance of it.
TOUCHED = 1e-4
# Crossings are looked for in a few lines up to so many cells away.
FAR = 1e6
# Known bodies that a formula of one line makes.
BODY_NAME = re.compile(r"bodies/(2|3)-1/(circle|sphere)-\d+-(?P<type>\w+)")

PYTHON_FILE = 'import runpy\n\nextract = runpy.run_path("{module}")["{function}"]'
PYTHON = "from {module} import {function} as extract"
# A program in any language is asked as the grader asks it, in as few lines as that takes.
PROGRAM = '''import json
from pathlib import Path
from subprocess import PIPE, Popen
from tempfile import TemporaryDirectory


# Asked as `isograde explain protocol` says, from the folder from which it was graded.
command = {command}
program = Popen(command, shell=True, stdin=PIPE, stdout=PIPE, encoding="utf-8")
folder = TemporaryDirectory()


def told(**message):
    """What the program answers to a message."""
    print(json.dumps(message), file=program.stdin, flush=True)
    said = json.loads(program.stdout.readline() or '{{"error": "the program ended"}}')
    if refused := said.get("error", said.get("unsupported")):
        raise RuntimeError(refused)
    return said


def extract(values, isovalue, spacing):
    """The program's polylines, or its vertices and simplices; they may stand in files."""
    isovalues, path = np.atleast_1d(isovalue).tolist(), Path(folder.name, "values.npy")
    values = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    np.save(path, values)
    said = told(
        command="run", id=1, dtype=values.dtype.str, shape=values.shape[-len(spacing) :],
        components=len(isovalues), spacing=list(map(float, spacing)), isovalues=isovalues,
        offset=path.stat().st_size - values.nbytes, values=str(path), directory=folder.name,
        case="lines",
    )
    if "answer" in said:
        said = json.loads(Path(folder.name, said["answer"]).read_text(encoding="utf-8"))
    given = [said.get(word) for word in ("vertices", "simplices", "faces", "polygons", "polylines")]
    files = [np.load(path.parent / one) if isinstance(one, str) else one for one in given]
    vertices, *rows, lines = files
    rows = next((one for one in rows if one is not None), lines)
    if isinstance(rows, list) and any(None in row for row in rows):
        raise ValueError(f"a corner is no number: {{rows}}")
    return lines or (vertices, rows)


told(command="start", protocol=3)
'''

# Two functions that every snippet has: an answer as arrays, whatever its form, and a call.
ANSWER = '''
def arrays(answer, n, k):
    """Vertices and simplices of an answer: a pair, polylines, a soup, or an object with both."""
    if hasattr(answer, "vertices"):
        answer = answer.vertices, getattr(answer, "simplices", getattr(answer, "faces", None))
    if isinstance(answer, tuple):
        vertices, rows = answer[:2]  # normals, or directions, may follow
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
SEVERAL = """\
needed = [one for one in signature(extract).parameters.values() if one.default is one.empty]
several = len(needed) > 3
"""
CALL_SEVERAL = f"""# m fields at once, or one argument for each.
{SEVERAL}given = (*{{values}}, *{{isovalue}}) if several else ({{values}}, {{isovalue}})
answer = extract(*given, {{spacing}})"""
# The same, for lines that ask about several fields one after another.
GIVEN = f"""

def given(values):  # m fields at once, or one argument for each.
{indent(SEVERAL, "    ")}\
    return (*values, *isovalue, spacing) if several else (values, isovalue, spacing)
"""
# Two answers that should be one have as many simplices, and the same vertices.
SHOW_COUNTS = """
if len(posed_simplices) != len(simplices):
    wrong.append(f"{len(simplices)} simplices; {meaning}, {len(posed_simplices)}")
"""
SHOW_PLACES = """
here, there = vertices[np.unique(simplices)], posed_vertices[np.unique(posed_simplices)]
for points, others, where in (there, here, meaning), (here, there, "in the plain answer"):
    if len(points) and len(others):
        away = abs(points[:, None] - others).max(axis=2).min(axis=1)
        far = f"a vertex at {points[away.argmax()].tolist()}, {where}, in one answer only"
        wrong += [far] if away.max() > 1e-4 else []
if (not len(here)) != (not len(there)):
    wrong.append(f"{len(here)} vertices; {meaning}, {len(there)}")
"""
SHOW_SEGMENTS = """
# Edges that lie in a face between cells, each by its two ends: they say how faces are decided.
found = []
for points, rows in ((vertices, simplices), (posed_vertices, posed_simplices)):
    ends = (points / spacing).round(4)[rows]
    pairs = np.concatenate([ends[:, [0, 1]], ends[:, [1, 2]], ends[:, [2, 0]]])
    middle, top = pairs.mean(axis=1), np.array(values.shape) - 1
    pairs = pairs[((middle > {least}) & (middle < top - {least})).all(axis=1)]
    flat = ((pairs[:, 0] == pairs[:, 1]) & (pairs[:, 0] == pairs[:, 0].round())).any(axis=1)
    found.append({{tuple(sorted(map(tuple, pair))) for pair in (pairs[flat] + 0.0).tolist()}})
wrong += [f"from {{a}} to {{b}} in one answer only" for a, b in sorted(found[0] ^ found[1])]
"""
SHOW_TURNS = """
# Triangles by their corners, from the least on: those of both answers are turned alike.
turns = []
for points, rows in ((vertices, simplices), (posed_vertices, posed_simplices)):
    corners = [[tuple(x) for x in one] for one in (points[rows].round(4) + 0.0).tolist()]
    first = [one.index(min(one)) for one in corners]
    turns.append({frozenset(one): one[i:] + one[:i] for one, i in zip(corners, first)})
both = [one for one in turns[0] if one in turns[1] and turns[0][one] != turns[1][one]]
wrong += [f"the triangle {turns[0][one]} is turned over in one answer" for one in both]
"""
SHOW_EULER = """
# Faces of every dimension, an even one more, an odd one less.
found = []
for faces in (simplices, posed_simplices):
    found.append(0)
    for dimension in range(faces.shape[1] - 1, -1, -1):
        faces = np.unique(np.sort(faces, axis=1), axis=0)
        found[-1] += (-1) ** dimension * len(faces)
        faces = np.concatenate([np.delete(faces, end, axis=1) for end in range(dimension + 1)])
if found[0] != found[1]:
    wrong.append(f"Euler characteristic {found[0]}; {meaning}, {found[1]}")
"""
SHOW_TOGETHER = """
# Which crossings hang together inside a cell, by triangles of the cell that share a vertex.
found = []
for points, rows in ((vertices, simplices), (posed_vertices, posed_simplices)):
    places, cells = (points / spacing).round(4) + 0.0, {}
    for row in places[rows]:
        cell = np.clip(np.floor(row.mean(axis=0)), 0, np.array(values.shape) - 2)
        parts, here = cells.get((*cell.tolist(),), []), {*map(tuple, row.tolist())}
        apart = [part for part in parts if not part & here]
        cells[(*cell.tolist(),)] = [*apart, here.union(*(p for p in parts if p & here))]
    found.append({(cell, tuple(sorted(p for p in part if sum(x == round(x) for x in p) > 1)))
                  for cell in cells for part in cells[cell]})
for cell, part in sorted(found[0] ^ found[1]):
    wrong.append(f"cell {cell}: in one answer only, {part} hang together")
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
BACK_TRANSLATION = """
# Back to the samples of the field; what is beyond them, or at their border, is not compared.
posed_vertices = posed_vertices - {cells} * np.array(spacing)
"""
# How the samples of a variant lie in memory, where that is what is asked.
LAYOUTS = {
    "fortran": "posed_values = np.asfortranarray(posed_values)",
    "strided": "posed_values = np.repeat(np.repeat(posed_values, 2, 0), 2, -1)[::2, ..., ::2]",
    "cropped": "rim = [(1, 2)] * posed_values.ndim\n"
    "inner = tuple(slice(1, 1 + n) for n in posed_values.shape)\n"
    "posed_values = np.pad(posed_values, rim)[inner]",
    "backwards": "posed_values = np.array(posed_values[..., ::-1, :], order='C')[..., ::-1, :]",
    "read-only": "posed_values.flags.writeable = False",
    "mapped": "posed_values = np.asfortranarray(posed_values)\n"
    "posed_values.flags.writeable = False",
    "stride-0": "same = [np.ptp(posed_values, a).max() for a in range(posed_values.ndim)]\n"
    "axis = same.index(0)"
    "\nposed_values = np.broadcast_to(np.take(posed_values, [0], axis), posed_values.shape)",
}
SHOW_MEETINGS = """
# Where the answer meets faces of the lattice of {m} dimensions nothing is left to choose.
met = []
for points in (vertices, posed_vertices):
    places = points / spacing
    whole = abs(places - places.round()) < 1e-6
    met.append(points[whole.sum(axis=1) >= {k}])
for here, there, what in ((*met, "in the plain answer"), (*met[::-1], meaning)):
    for place in here:
        if not len(there) or abs(there - place).max(axis=1).min() > 1e-5:
            wrong.append(f"a vertex at {{place.tolist()}} {{what}} only")
"""
SHOW_NOTHING = """
wrong += [f"{len(posed_simplices)} simplices, {meaning}"] if len(posed_simplices) else []
"""
SHOW_AGAIN = """
# The same arrays each time, number for number.
for _ in range(40):
    posed_vertices, posed_simplices = arrays(extract({values}), {n}, {k})
    if not (np.array_equal(vertices, posed_vertices)
            and np.array_equal(simplices, posed_simplices)):
        wrong.append("another call gives other arrays")
"""
ANSWERS = """
wrong = []
try:
    extract({values})
except Exception as error:
    wrong.append(repr(error))
"""
SHAPES = """
wrong, answer = [], extract({values})
if isinstance(answer, tuple):
    vertices, simplices = map(np.asarray, answer[:2])
    if vertices.ndim != 2 or vertices.shape[1] != {n} or vertices.dtype.kind not in "fiu":
        wrong.append(f"vertices: {{vertices.dtype}} of shape {{vertices.shape}}")
    if simplices.ndim != 2 or simplices.shape[1] != {k} + 1 or simplices.dtype.kind not in "iu":
        wrong.append(f"simplices: {{simplices.dtype}} of shape {{simplices.shape}}")
"""
CHANGED = """
before, wrong = values.copy(), []
extract({values})
if not np.array_equal(before, values, equal_nan=values.dtype.kind == "f"):
    wrong.append("the samples that were given have been written over")
"""
# Claims that are judged on the call itself, before anything is made of its answer.
ON_CALL = {
    "structure.answers": ANSWERS,
    "structure.shapes": SHAPES,
    "robustness.input_unmodified": CHANGED,
}
ENDED = """
print(*wrong, sep="\\n")
assert not wrong, {rule}
"""
# What some of the lines import, by a word that they use.
IMPORTS = {
    "signature(": "from inspect import signature",
    "Counter(": "from collections import Counter",
    "combinations(": "from itertools import combinations",
    "permutations(": "from itertools import permutations",
    "sha256(": "from hashlib import sha256",
    "Barrier(": "from threading import Barrier",
    "ThreadPoolExecutor(": "from concurrent.futures import ThreadPoolExecutor",
    "setswitchinterval(": "from sys import setswitchinterval",
    "process_time(": "from time import process_time",
    "map_coordinates(": "from scipy.ndimage import map_coordinates",
    "product(": "from itertools import product",
    "linprog(": "from scipy.optimize import linprog",
    "label(": "from scipy.ndimage import label",
    "maximum_filter(": "from scipy.ndimage import maximum_filter",
}
SPHERE = """
# A {name} of radius {radius}, in cells, and the lattice that holds it.
centre, radius = np.array({centre}), {radius}
places = np.stack(np.meshgrid(*map(np.arange, {shape}), indexing="ij"), axis=-1)
values = {values}
isovalue, spacing = ({isovalue},), (1.0,) * {n}
"""
# What it is given in place of the interpolant of the samples.
OF_SPHERE = """
def of_body(*place):
    off = sum((p - c) ** 2 for p, c in zip(place, centre, strict=True))
    return radius - off**0.5 + {isovalue}


def extract(values, isovalue, spacing, given=extract):
    return given(values, isovalue, spacing, function=of_body)
"""
# How samples are made of a distance, by their type, as `isograde.cases.bodies` makes them.
SAMPLED = {
    "float64": "{depth} + {isovalue}",
    "float32": "({depth} + {isovalue}).astype(np.float32)",
    "uint8": "np.clip(np.rint({depth} * {scale} + {isovalue}), 0, 255).astype(np.uint8)",
    "int16": "np.rint({depth} * {scale} + {isovalue}).astype(np.int16)",
}


# Claims that look at more than vertices and simplices, or leave out what is about one sample.
LONG = frozenset(
    {
        "accuracy.normals_of_planes",
        "accuracy.normals_returned",
        "accuracy.continuity",
        "curves.confidence",
        "accuracy.shapes",
        "symmetry.directions",
        "symmetry.normals_returned",
        "robustness.elsewhere",
        "topology.tie_side",
    }
)


class NoLinesError(Exception):
    """There are no lines to show a failure by; the text says why, in a sentence."""


# Before the lines on who was seen to answer the same question in two ways.
UNSTEADY = (
    "# It was seen to answer otherwise when asked again: if nothing is said, run this again.\n"
)


def snippet(report: Report, summary: Summary) -> str | None:
    """The lines that show the claim's smallest failed case, or None where there are none."""
    try:
        program = _program(report, summary)
    except NoLinesError:
        return None
    again = report.summaries.get("robustness.deterministic")
    return UNSTEADY + program if again is not None and again.bad else program


def without(report: Report, summary: Summary) -> str:
    """Why there are no lines to show the claim's failure by; nothing where there are."""
    try:
        _program(report, summary)
    except NoLinesError as reason:
        return str(reason)
    return ""


def _program(report: Report, summary: Summary) -> str:
    """The lines that show the claim's smallest failed case; raises `NoLinesError`."""
    call = calling(report.spec, report.declaration.get("given", "samples"))
    if summary.id in CONVENTIONS:
        raise NoLinesError(
            "What it does with such input is a convention, measured and shown, which never changes "
            "the exit status; so there are no lines that call it wrong."
        )
    if summary.id in LONG:
        raise NoLinesError(
            "What this claim asks of this family takes more than a few lines to show."
        )
    if call is None:
        raise NoLinesError("No lines of Python call this implementation; the command above does.")
    record = report.evidence.get(summary.id)
    if record is not None and record["finding"]["verdict"] in ENDS:
        ended = record["finding"]["verdict"]
        raise NoLinesError(
            f"Lines that ask this would end as the call did ({ended}); the command asks "
            "in a process of its own."
        )
    if summary.id in BODIES:
        return _of_body(report, summary, call.strip())
    if summary.id in KNOWN or summary.id.startswith(("accuracy.", "calls.")):
        return _of_formula(report, summary, call.strip())
    return _of_samples(report, summary, call.strip())


# How a call may end that lines of Python would not survive, or would wait for.
ENDS = (Verdict.CRASH.value, Verdict.TIMEOUT.value)


# Claims on a changed field, which ask nothing of the plain one.
BY_ITSELF = ("cells.perfect", "range.extremes")


def _of_samples(report: Report, summary: Summary, call: str) -> str:
    """The program that prints the samples, extracts and looks for what is wrong."""
    record = report.evidence.get(summary.id)
    if record is None:
        raise NoLinesError("The case was not kept; the command above makes it again.")
    posed = record.get("posed", {})
    raised = _raised(posed)
    if summary.id in BY_ITSELF and posed.get("values"):
        # The changed field is judged by itself.
        record = {**posed, "finding": record["finding"], "kind": record["kind"]}
        posed = {}
    _check_size(record, posed)
    n, m = record["kind"]
    house = _house(report.declaration)
    lines = [ANSWER, ""]
    if _has_nan(record.get("posed", record)):
        lines += ["nan = np.nan", ""]
    lines.append(_samples(record, m))
    if summary.id in ON_CALL or raised:
        return _on_call(record, summary, call, lines)
    shown = _shows(report, record, summary, house)
    if shown is None:
        raise NoLinesError(
            "What this claim asks of this family takes more than a few lines to show."
        )
    lines += [_asked(n, m), *_some(house.format(prefix=""))]
    if any("border" in line for line in shown):
        lines.append(_ends(report.declaration, record["shape"]))
    if any("inset" in line for line in shown):
        lines.append(f"inset = np.array({_insets(report.declaration, n)})")
    return _whole(call, [*lines, *shown])


def _check_size(record: JSON, posed: JSON) -> None:
    """Raise `NoLinesError` where there are too many samples to print."""
    count = prod(record["shape"]) * record["kind"][1]
    if not 0 < len(record["values"]) <= PRINTED or len(posed.get("values", [])) > 2 * PRINTED:
        raise NoLinesError(
            f"The smallest case found has {count:,} samples, too many to print; the command above "
            "makes it again."
        )


def _raised(posed: JSON) -> bool:
    """Whether the other way to pose the case ended in an error."""
    return bool(posed.get("values")) and posed["came"].get("status") == "raised"


# --- fields that are known by formula ------------------------------------------------------------

# Claims whose cases are known by formula, beside those on accuracy and on calls.
KNOWN = {
    "curves.count": COUNT,
    "curves.linking": LINKING,
    "curves.on_surfaces": ON_SURFACES,
    "curves.covers": COVERS,
    "simplices.euler": EULER,
    "simplices.flat": FLAT,
}


def _of_formula(report: Report, summary: Summary, call: str) -> str:
    """The program that makes a known field and compares what came of it with what is known."""
    failure = summary.failure
    name = "" if failure is None else failure.of or failure.case
    seed = report.header["seed"]
    case = all_cases(seed).get(name)
    made = None if case is None else formulas.of_case(case, seed)
    if failure is None or case is None or made is None:
        raise NoLinesError("The field of this case is not made by a formula of a few lines.")
    n, m = case.kind
    rule = ascii(str(summary.claim["rule"]))
    begun = [ANSWER, made.rstrip()]
    if summary.id.startswith("calls."):
        shown = _on_calls(summary.id, case, failure.numbers)
        begun += [GIVEN.rstrip()] if m > 1 else []
    else:
        begun += [_asked(n, m), *_some(_house(report.declaration).format(prefix=""))]
        shown = f"\nwrong = []{_of_known(report, summary.id, case, failure.numbers)}"
    return _whole(call, [*begun, shown.rstrip() + ENDED.format(rule=rule).rstrip()])


def _of_known(report: Report, claim: str, case: Case, numbers: Mapping[str, Any]) -> str:
    """The lines that compare an answer with what is known of this case."""
    family, _, name = claim.partition(".")
    if family == "accuracy":
        return _of_order(name, case, numbers)
    facts, text = case.facts, KNOWN[claim]
    if claim == "curves.count":
        return text.format(expected=(facts["closed"], facts["open"]))
    if claim == "simplices.euler":
        return text.format(expected=(facts["manifold"].euler, facts["manifold"].pieces))
    if claim == "simplices.flat":
        soup = report.declaration["mesh"]
        slack = 0.0 if soup == "indexed" else float(soup["soup"])
        allowed = simplices.ROUNDING * max(case.build().shape) + slack
        return text.format(n=case.kind.n, allowed=allowed)
    known, h = facts["curves"], max(case.build().spacing)
    bounds = tuple(bend * h**2 / 2 + curves.ROUNDING for bend in known.bend(h))
    return text.format(
        links=list(known.links),
        determinants=list(known.determinants),
        bounds=bounds,
        cells=1 if known.transversal else curves.TOUCHING,
    )


def _of_order(name: str, case: Case, numbers: Mapping[str, Any]) -> str:
    """The lines that measure an error at several sizes and fit its order."""
    bodies, _ = row(case.facts["row"])
    n, cut = case.kind.n, bool(bodies[0].across)
    what, error = ERRORS[name]
    filled = error.format(
        n=n,
        factorial=factorial(n),
        known=np.array(formulas.measures(bodies).get(name, [])).tolist(),
        flattened=FLATTENED[cut],
        across=CUT_NORMALS if cut else "",
    )
    return ORDERS.format(
        what=what[0].upper() + what[1:],
        error=filled,
        factorial_k=factorial(case.kind.k),
        student=round(float(stdtrit(len(bodies) - 2, 0.975)), 6),
        formal=numbers["formal"],
        slack=accuracy.SLACK,
    )


def _on_calls(claim: str, case: Case, numbers: Mapping[str, Any]) -> str:
    """The lines that ask several times, and look at what the calls do to each other or cost."""
    n, m = case.kind
    texts = {"buffer": BUFFER, "again": AGAIN, "threads": THREADS, "leak": LEAK}
    text = texts.get(claim.removeprefix("calls."))
    times = 2**n
    if claim == "calls.growth":
        if "seconds" not in numbers:
            raise NoLinesError(
                "The larger field ran out of time, and lines would wait for it as long."
            )
        # Of both, the memory is shown, which other programs do not disturb.
        least = max(numbers["bytes"], case.build().values.nbytes)
        allowed = max(calls.BYTES, calls.WORSE * times * least)
        text = LARGER if numbers["bytes_larger"] > allowed else SLOWER
    assert text is not None, claim
    one = "{0}, isovalue[0], spacing" if m == 1 else "*given({0})"
    return text.format(
        values=one.format("values"), other=one.format("other"),
        question=one.format("question"), n=n, k=n - m, times=times,
        share=calls.WORSE * times, seconds=calls.SECONDS, bytes=calls.BYTES, calls=MANY,
        least=calls.LEAK, others=OTHERS, close=CLOSE, forgotten=FORGOTTEN, period=PERIOD,
        prime=PRIME,
    )  # fmt: skip


def _whole(call: str, lines: list[str]) -> str:
    """The program: imports, what defines `extract`, and these lines."""
    body = "\n".join(lines)
    needed = [line for word, line in IMPORTS.items() if word in body]
    return "\n".join([*_begun(call, needed), "", body]) + "\n"


def _on_call(record: JSON, summary: Summary, call: str, lines: list[str]) -> str:
    """The program that asks once and looks at what the call itself does."""
    n, m = record["kind"]
    if m > 1:
        raise NoLinesError(
            "What a call itself does is shown of one field only, and here are several."
        )
    # A claim on all calls is shown on the variant that it names.
    values, posed = "values, isovalue[0], spacing", record.get("posed")
    if posed is not None:
        if not posed["values"]:
            raise NoLinesError("The samples of this variant are too many to print, or none.")
        layout = LAYOUTS.get(posed["variant"], "").replace("posed_values", "values")
        lines = [*lines[:-1], _samples(posed, m), *_some(layout)]
    text = ON_CALL.get(summary.id, ANSWERS).format(values=values, n=n, k=n - m)
    ended = ENDED.format(rule=ascii(str(summary.claim["rule"]))).rstrip()
    return _whole(call, [*lines, text.rstrip() + ended])


def _of_body(report: Report, summary: Summary, call: str) -> str:
    """The program that makes a sphere or a circle, extracts it and measures what came."""
    failure = summary.failure
    found = None if failure is None else BODY_NAME.fullmatch(failure.case)
    if failure is None or found is None:
        raise NoLinesError("The field of this body is not made by a formula of one line.")
    if report.declaration["mesh"] != "indexed":
        raise NoLinesError("Of a soup the numbers of a body take more than a few lines.")
    body = all_cases(report.header["seed"])[failure.case].facts["body"]
    n, kind = body.n, found["type"]
    own = report.declaration.get("given") == "function" and kind == "float64"
    depth = "(radius - np.linalg.norm(places - centre, axis=-1))"
    scale = {"uint8": "255 / 16", "int16": "256"}.get(kind, "1")
    level = ISOVALUES[kind]
    numbers = {
        "n": n, "bound": failure.numbers.get("bound"), "volume": body.volume,
        "factorial": factorial(n), "factorial_k": factorial(n - 1), "sign": 1,
    }  # fmt: skip
    lines = [
        ANSWER,
        SPHERE.format(
            name=body.name, radius=body.radii[0], centre=body.centroid.tolist(), shape=body.shape,
            values=SAMPLED[kind].format(depth=depth, isovalue=level, scale=scale),
            isovalue=level, n=n,
        ),
        *_some(OF_SPHERE.format(isovalue=level) if own else ""),
        _asked(n, 1),
        *_some(_house(report.declaration).format(prefix="")),
    ]  # fmt: skip
    turned = turns(report.declaration, n)
    if turned:
        lines.append("simplices = simplices[:, ::-1]  # Its normals point to higher values.")
    shown = f"\nwrong = []{BODIES[summary.id].format(**numbers).rstrip()}"
    ended = ENDED.format(rule=ascii(str(summary.claim["rule"]))).rstrip()
    return _whole(call, [*lines, shown + ended])


def _some(text: str) -> list[str]:
    """The text, where there is any."""
    return [text] if text else []


def _begun(call: str, needed: Sequence[str]) -> list[str]:
    """The imports, and the lines that define `extract`."""
    first, _, rest = call.partition("\n\n\n")
    imports = first.split("\n") if rest and "def " not in first and "=" not in first else []
    lines = rest if imports else call
    imports = [line for line in imports if line != "import numpy as np"]
    imports = sorted({*imports, *needed})
    return [*imports, *[""] * bool(imports), "import numpy as np", "", "", lines]


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


def _insets(declaration: JSON, n: int) -> list[float]:
    """How far inside the lattice the mesh ends, along each axis."""
    ends = declaration["domain"]
    return [max(end["inset"], 0.0) for end in (ends if len(ends) == n else ends[:1] * n)]


def turns(declaration: JSON, n: int) -> bool:
    """The simplices are turned the other way than det(-g_1, .., -g_m, t_1, .., t_k) > 0."""
    said = declaration["conventions"]
    reflected = said["axes"] == "reversed" and n // 2 % 2 == 1
    return bool((said["normals"] == "to_high") != reflected)


def _shows(report: Report, record: JSON, summary: Summary, house: str) -> list[str] | None:
    """The lines that show what is wrong; None where none are known."""
    n, m = record["kind"]
    rule, posed = str(summary.claim["rule"]), record.get("posed")
    ended = ENDED.format(rule=ascii(rule)).rstrip()
    if summary.id == "robustness.deterministic":
        call = "values, isovalue[0], spacing" if m == 1 else "*given, spacing"
        raw = f"\nvertices, simplices = arrays(answer, {n}, {n - m})\nwrong = []"
        return [f"{raw}{SHOW_AGAIN.format(values=call, n=n, k=n - m).rstrip()}{ended}"]
    if posed is not None and summary.id.split(".")[0] not in COMPARED:
        return None
    if posed is not None and len(posed["shape"]) == n and posed["values"]:
        compared = _compared(posed, n, m, record["finding"]["detail"])
        if compared is None:
            return None
        return [
            f"\n# The same, {' '.join(posed['meaning'].split())}.",
            _samples(posed, m, "posed_"),
            *_some(LAYOUTS.get(posed["variant"], "")),
            _asked(n, m, "posed_"),
            *_some(house.format(prefix="posed_")),
            f"\nmeaning, wrong = {posed['meaning']!a}, []{compared.rstrip()}{ended}",
        ]
    show = _show_of(report.declaration, record, summary.id)
    return None if show is None else [f"\nwrong = []{show.rstrip()}{ended}"]


# Families of claims that compare the answers to two ways to pose a case.
COMPARED = ("symmetry", "robustness", "range")


def _show_of(declaration: JSON, record: JSON, claim: str) -> str | None:
    """The lines that look for what this claim forbids, for this family; None where none are."""
    kind, numbers = tuple(record["kind"]), record["finding"].get("numbers", {})
    n, m = kind
    interpolant, vertices = declaration["interpolant"], declaration["vertices"]
    ends = {end["end"] for end in declaration["domain"]}
    edges, whole = vertices == "edges", all(end["inset"] == 0 for end in declaration["domain"])
    text = SHOWS.get(claim)
    if claim == "cells.perfect":
        text = PERFECT.format(margin=MARGIN).replace("{", "{{").replace("}", "}}") + CROSSING
    elif claim == "range.extremes":
        told = record["finding"]["detail"]
        text = FINITE if "no mesh" in told else OPEN if "one simplex" in told else SIDES
    elif claim == "topology.manifold" and "vertices" in numbers:
        text = SHEETS
    elif claim == "topology.raw":
        told = [name for name, count in numbers.items() if count]
        one, more = (any(word in name for name in told) for word in ("of one", "of more"))
        text = OPEN if one else CROWDED if more else SHEETS
    elif claim == "topology.sides" and m <= 2 and "periodic" not in ends:
        text = SIDES
        if m == 1 and _nearly_touched(record):
            raise NoLinesError(
                "The surface comes so near to a sample here that sides are compared across it, "
                "which takes more than a few lines."
            )
    elif claim == "geometry.embedded":
        text = CROSSING
    elif claim in ("geometry.vertices", "geometry.crossing") and m == 1 and ends == {"open"}:
        text = _vertices_of(interpolant, vertices) if whole or vertices == "cells" else None
    elif edges and whole and interpolant in ("multilinear", "labels"):
        of_kind = {(3, 1): SURFACE_SHOWS, (2, 1): CONTOUR_SHOWS}.get(kind, {})
        text = of_kind.get(claim, text)
    if claim == "topology.scan" and kind == (3, 1):
        text = SCAN if numbers.get("pieces") != numbers.get("pieces_wanted") else None
        text = text if whole else None
        if numbers.get("isovalue", record["isovalues"][0]) != record["isovalues"][0]:
            raise NoLinesError(
                "A saddle or a sample is on the isovalue here, so the level set that is asked for "
                "is that beside it, which a few lines cannot tell apart."
            )
    far = numbers.get("first")
    if claim == "geometry.embedded" and far is not None and np.abs(far).max() > FAR:
        raise NoLinesError(
            "The triangles that cross are so far outside the lattice that a few lines cannot tell; "
            "the lines of `geometry.vertices` show a vertex that is there."
        )
    if text is None:
        return None
    tie = ">=" if declaration["conventions"]["tie"] == "inside" else ">"
    signed = declaration["conventions"]["normals"] != "none" and n > m
    sign = -1 if turns(declaration, n) else 1
    return text.format(
        n=n, m=m, sign=sign, tie=tie, signed=signed,
        differs=DIFFERS["signed" if signed else "unsigned"].format(sign=sign),
        wanted=WANTED.get(claim, WANTED["topology.bilinear"]),
        kuhn=interpolant == "kuhn", crossing=claim == "geometry.crossing",
        share="0.5" if interpolant == "labels" else "(isovalue[0] - a) / (b - a)",
    )  # fmt: skip


def _nearly_touched(record: JSON) -> bool:
    """Whether samples of one field are so unequal that a crossing may be at a sample but for it."""
    away = np.abs(np.array(record["values"], float) - record["isovalues"][0])
    return bool(away[away > 0].min(initial=np.inf) < TOUCHED * away.max(initial=0.0))


def _vertices_of(interpolant: object, vertices: object) -> str | None:
    """The lines on where vertices may be, of families for which that is a few lines."""
    if vertices == "cells":
        return IN_CELLS
    return VERTICES if vertices == "edges" and isinstance(interpolant, str) else None


def _compared(posed: JSON, n: int, m: int, told: str) -> str | None:
    """The lines that compare the answer to a variant, brought back, with the plain one.

    told : how they differ
    """
    name = posed["variant"]
    if "turned over" in told:
        return None
    surfaces = (n, m) == (3, 1)
    segments = SHOW_SEGMENTS.format(least=-1) if surfaces else ""
    segments = SHOW_TOGETHER if "together otherwise" in told else segments
    if name.startswith("translate"):
        if not surfaces:
            return None
        moved = BACK_TRANSLATION.format(cells=2 if name.endswith("-2") else 1)
        return moved + SHOW_SEGMENTS.format(least=0) + SHOW_TURNS
    if name in ("above", "below", "infinite"):
        return SHOW_NOTHING
    if "Euler characteristic" in told:
        return SHOW_EULER
    if name == "components":
        return SHOW_MEETINGS.format(m=m, k=n - m)
    if name == "spacing":
        return BACK_SPACING + SHOW_PLACES + segments
    if name.startswith("symmetry/"):
        order, mirrored = symmetry_of(name)
        last = (np.array(posed["shape"]) - 1).tolist()
        back = np.argsort(order).tolist()
        moved = BACK_SYMMETRY.format(mirrored=list(mirrored), last=last, order=back)
        return moved + SHOW_PLACES + segments
    # Whatever else is asked leaves every vertex where it is.
    turns = SHOW_TURNS if surfaces else ""
    return SHOW_COUNTS + SHOW_PLACES.lstrip("\n") + segments + turns


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
    if kind == "exec":
        return PROGRAM.format(command=ascii(rest))
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
