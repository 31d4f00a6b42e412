"""Adapters to Python functions."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from isograde.adapters import open_adapter, ready_made_names
from isograde.adapters.conventions import refusal
from isograde.declaration import Declaration, DeclarationError, declaration_from
from isograde.model import SURFACES, AdapterError, Limits, Outcome, Request, Status
from isoref.field import Field
from isoref.methods import METHODS
from numpy.typing import NDArray
from skimage.measure import marching_cubes

QUICK = Limits(seconds=20.0, megabytes=1024)


def ask(spec: str, field: Field, *isovalues: float) -> Outcome:
    """The outcome of one call through an adapter of its own."""
    adapter = open_adapter(spec)
    adapter.open(QUICK)
    try:
        return adapter.run(Request("test", "plain", field, isovalues))
    finally:
        adapter.close()


def ball(spacing: tuple[float, ...] = (1, 2, 3), origin: tuple[float, ...] = (9, 8, 7)) -> Field:
    """High in the middle of 5 x 6 x 7 samples."""
    i, j, k = np.indices((5, 6, 7))
    return Field.of(4 - (i - 2.1) ** 2 - (j - 2.4) ** 2 - (k - 3.2) ** 2, spacing, origin)


def volume(outcome: Outcome) -> float:
    """Signed volume; positive where right-hand normals point outwards."""
    assert outcome.mesh is not None, outcome.detail
    a, b, c = outcome.mesh.vertices[outcome.mesh.simplices].swapaxes(0, 1)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize("spec", ["skimage:lewiner", "skimage:lorensen", "isoref:lorensen-cline"])
def test_every_adapter_answers_in_the_conventions_of_the_house(spec: str) -> None:
    """World units, origin included, right-hand normals to lower values."""
    outcome = ask(spec, ball(), 1.0)
    assert outcome.status is Status.OK, outcome.detail
    assert outcome.vertices is not None
    assert (outcome.vertices.min(0) > (9, 8, 7)).all()
    assert (outcome.vertices.max(0) < (13, 18, 25)).all()
    assert 6 * 14 < volume(outcome) < 6 * 4 / 3 * np.pi * 3**1.5


def test_a_declared_error_for_an_empty_surface_becomes_an_empty_mesh() -> None:
    """scikit-image raises where the isovalue is out of range; the house has an empty mesh."""
    outcome = ask("skimage:lewiner", ball(), 99.0)
    assert outcome.status is Status.OK
    assert outcome.mesh is not None
    assert len(outcome.mesh.simplices) == 0


MINE = """
import numpy as np

def extract(values, isovalue, spacing):
    "Answers with how the samples lie in memory."
    return [[*map(float, values.strides), values[0, 1, 2]]], [[values.flags.writeable, 0, 0]]

extract.declaration = {"name": "mine", "conventions": {"units": "world"}}

class Group:
    @staticmethod
    def method(values, isovalue, spacing):
        return [], []

def declaration():
    return {"level": 1, "mesh": {"soup": 0.001}}


def curve(a, b, isovalue_a, isovalue_b, spacing):
    "One closed polyline: the first samples, the isovalues."
    return [[[a.flat[0], b.flat[0], 0], [isovalue_a, isovalue_b, 0], [0, 0, 1],
             [a.flat[0], b.flat[0], 0]]]


def together(values, isovalues, spacing):
    "The same, asked the other way."
    return curve(*values, *isovalues, spacing)

together.declaration = {"limits": {"kinds": [[3, 2]]}}


def contours(values, isovalue, spacing):
    return [[[0.0, 0.0], [isovalue, 1.0]]]

contours.declaration = {"limits": {"kinds": [[2, 1]], "least": 3, "types": ["float64"]}}


def four(a, b, isovalue, spacing):
    return [], []


def misspelt(values, isovalue, spacing):
    return [], []

misspelt.declaration = {"vertices": "edge"}
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A module of the user's own, in the folder where isograde is started."""
    (tmp_path / "mine.py").write_text(MINE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def opened(spec: str) -> Declaration:
    """What is declared behind the adapter."""
    adapter = open_adapter(spec)
    try:
        return adapter.open(QUICK)
    finally:
        adapter.close()


def test_a_module_or_a_file_in_the_current_folder_is_found(mine: Path) -> None:
    """As in the README: python:mine:extract."""
    assert opened("python:mine:extract").name == "mine"
    assert opened("python:mine.py:extract").name == "mine"
    assert opened(f"python:{mine / 'mine.py'}:extract").name == "mine"


def test_a_function_s_own_declaration_goes_before_its_module_s(mine: Path) -> None:
    assert opened("python:mine:extract").level == 2
    declared = opened("python:mine:Group.method")
    assert (declared.level, declared.soup) == (1, 0.001)
    assert declared.name == "python:mine:Group.method"


@pytest.mark.parametrize(
    "values",
    [
        np.arange(60.0).reshape(3, 4, 5),
        np.asfortranarray(np.arange(60.0).reshape(3, 4, 5)),
        np.arange(60.0).reshape(3, 4, 5)[::-1, :, ::-1],
        np.arange(480.0).reshape(6, 8, 10)[::2, ::2, ::2],
        np.arange(60.0, dtype=">f4").reshape(5, 4, 3).transpose(2, 0, 1)[:, :4, :4],
    ],
    ids=["C", "Fortran", "backwards", "gaps", "foreign"],
)
def test_samples_lie_in_memory_as_they_did_for_us(mine: Path, values: NDArray[Any]) -> None:
    """The claims on memory layout rest on it. Samples can be written to."""
    outcome = ask("python:mine:extract", Field.of(values), 0.0)
    assert outcome.vertices is not None, outcome.detail
    assert outcome.simplices is not None
    assert outcome.vertices.tolist() == [[*values.strides, values[0, 1, 2]]]
    assert outcome.simplices.tolist() == [[1, 0, 0]]


def test_a_large_field_with_its_large_mesh_passes_unharmed() -> None:
    """Above a megabyte arrays pass in files: the same mesh as without an adapter."""
    values = np.random.default_rng(0).random((60, 60, 60))
    outcome = ask("skimage:lorensen", Field.of(values), 0.5)
    vertices, faces, *_ = marching_cubes(values, 0.5, method="lorensen")
    assert outcome.vertices is not None
    assert outcome.simplices is not None
    assert outcome.vertices.nbytes > 1 << 20
    assert np.array_equal(outcome.vertices, vertices)
    assert np.array_equal(outcome.simplices[:, [0, 2, 1]], faces)


@pytest.mark.parametrize("name", ["curve", "together"])
def test_several_fields_go_apart_or_together(mine: Path, name: str) -> None:
    """2 m + 1 parameters, or three; each field with its own isovalue, and no third array."""
    pair = Field.of(np.stack([np.full((2, 3, 4), 5.0), np.full((2, 3, 4), 7.0)]), dimension=3)
    outcome = ask(f"python:mine:{name}", pair, 0.25, 0.75)
    assert outcome.vertices is not None, outcome.detail
    assert outcome.simplices is not None
    assert outcome.vertices.tolist() == [[5, 7, 0], [0.25, 0.75, 0], [0, 0, 1]]
    assert outcome.simplices.tolist() == [[0, 1], [1, 2], [2, 0]]


def test_parameters_tell_the_kind_where_none_is_declared(mine: Path) -> None:
    assert opened("python:mine:curve").limits.kinds == ((3, 2),)
    assert opened("python:mine:together").limits.kinds == ((3, 2),)
    assert opened("python:mine:extract").limits.kinds == ((3, 1),)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("four", r"asks for 4 arguments; for \(n, m\) = \(3, 1\) it is called with 3"),
        ("misspelt", "there is no 'edge'; did you mean 'edges'"),
        ("absent", "it has .*contours"),
    ],
)
def test_what_cannot_be_called_is_said_at_the_adapter(mine: Path, name: str, words: str) -> None:
    with pytest.raises(AdapterError, match=words):
        opened(f"python:mine:{name}")


def test_what_the_limits_refuse_is_never_sent(mine: Path) -> None:
    """The kind, the least length of an axis, the type; anything else is sent."""
    spec = "python:mine:contours"
    assert ask(spec, Field.of(np.zeros((3, 3))), 0.5).status is Status.OK
    refused = {
        "(n, m) = (3, 1)": Field.of(np.zeros((3, 3, 3))),
        "fewer than 3 samples": Field.of(np.zeros((3, 2))),
        "samples of type float32": Field.of(np.zeros((3, 3), np.float32)),
    }
    for reason, field in refused.items():
        outcome = ask(spec, field, 0.5)
        assert outcome.status is Status.DECLINED
        assert reason in outcome.detail


def test_a_component_s_axis_is_not_sent_where_there_is_one(mine: Path) -> None:
    """The same samples, whether or not the field counts its one component."""
    single = Field.of(np.arange(60.0).reshape(1, 3, 4, 5), dimension=3)
    outcome = ask("python:mine:extract", single, 0.0)
    assert outcome.vertices is not None, outcome.detail
    assert outcome.vertices.tolist() == [[160, 40, 8, 7]]


def test_every_method_of_the_reference_has_an_adapter() -> None:
    """Those of the catalogue, and no name that it does not have."""
    offered = {name.removeprefix("isoref:") for name in ready_made_names(SURFACES)}
    surfaces = {name for name in offered if f"isoref:{name}" in ready_made_names()}
    assert surfaces - {"simplicial-printed"} == set(METHODS)


def test_a_call_reports_its_cost() -> None:
    outcome = ask("skimage:lewiner", Field.of(np.random.default_rng(0).random((40, 40, 40))), 0.5)
    assert outcome.seconds > 0
    assert outcome.peak_bytes > 1 << 20


PLACED = """
import numpy as np

def extract(values, isovalue, spacing, directions=None):
    "One triangle along the axes, as they run in the world."
    return np.diag(spacing) @ directions, [[0, 1, 2]]

extract.declaration = {"limits": {"directions": True, "negative": True}}
"""
PROGRAM = """
import json, sys

import numpy as np

for line in sys.stdin:
    asked = json.loads(line)
    if asked["command"] == "start":
        limits = {"directions": True, "negative": True}
        answer = {"protocol": 3, "declaration": {"limits": limits}}
    elif asked["command"] == "run":
        places = np.diag(asked["spacing"]) @ np.array(asked["directions"])
        answer = {"id": asked["id"], "vertices": places.tolist(), "simplices": [[0, 1, 2]]}
    else:
        break
    print(json.dumps(answer), flush=True)
"""


@pytest.mark.parametrize("kind", ["python", "exec"])
def test_directions_and_negative_spacings_are_handed_on(kind: str, tmp_path: Path) -> None:
    """To functions by a keyword, to programs by a key; what is declared alone is sent."""
    path = tmp_path / "placed.py"
    path.write_text(PLACED if kind == "python" else PROGRAM, encoding="utf-8")
    spec = f"python:{path}:extract" if kind == "python" else f"exec:{sys.executable} {path}"
    rows = ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    field = Field(np.zeros((2, 2, 2)), (-1.0, 2.0, 3.0), (0.0,) * 3, rows)
    outcome = ask(spec, field, 0.5)
    assert outcome.vertices is not None, outcome.detail
    assert outcome.vertices.tolist() == [[0, -1, 0], [-2, 0, 0], [0, 0, 3]]


def test_who_does_not_say_so_is_not_asked_for_directions() -> None:
    """`refusal`, by which no such field is sent; each of the two words lets its own pass."""
    rows = ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    turned = Field(np.zeros((2, 2, 2)), (1.0,) * 3, (0.0,) * 3, rows)
    backwards = Field(np.zeros((2, 2, 2)), (1.0, -1.0, 1.0), (0.0,) * 3)
    for field, word in ((turned, "directions"), (backwards, "negative")):
        request = Request("test", "plain", field, (0.5,))
        assert word in refusal(request, Declaration("mine"))
        assert not refusal(request, declaration_from({"limits": {word: True}}, "mine"))


@pytest.mark.parametrize(
    "said",
    [
        {"conventions": {"units": "index"}},
        {"conventions": {"axes": "reversed"}},
        {"given": "function", "vertices": {"own": 1}},
    ],
)
@pytest.mark.parametrize("word", ["directions", "negative"])
def test_directions_are_for_who_answers_in_the_world(said: dict[str, Any], word: str) -> None:
    """What else they would mean nobody could say."""
    with pytest.raises(DeclarationError, match="directions and negative spacings are for who"):
        declaration_from({**said, "limits": {word: True}}, "mine")
