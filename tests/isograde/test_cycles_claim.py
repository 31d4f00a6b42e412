"""`cases.cycles`: the six VESTA surfaces have the cycles they promise, and others do not."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from isograde.adapters.declaring import declaration_from, declaration_json
from isograde.adapters.ready_made import READY_MADE
from isograde.claims import cycles as family
from isograde.model import Case, Declaration, Finding, Limits, Outcome, Request, Status, Trial
from isoref.field import Field, Floats, Integers
from isoref.mesh import Mesh
from isoref.methods import METHODS

from tests.isograde import miniatures
from tests.isograde.miniatures import Inside, Miniature

(CLAIM,) = family.CLAIMS


def noise(seed: int = 1) -> Field:
    """A field with every ambiguity."""
    return Field.of(np.random.default_rng(seed).normal(size=(7, 8, 6)), (1, 0.5, 2), (3, -1, 0))


def judged(vertices: Floats, faces: Integers, mode: str, field: Field | None = None) -> Finding:
    """What the claim says of this mesh of `noise` at 0.1, declared to have this mode."""
    field = noise() if field is None else field
    case = Case("noise", lambda: field, 0.1, field.values.size)
    declaration = Declaration("here", connectivity=mode)
    outcome = Outcome(Status.OK, vertices, faces)
    return CLAIM.judge(Trial(case, field, declaration, {"plain": outcome}))


def of_method(name: str, mode: str) -> Finding:
    """What the claim says of a method of the reference."""
    mesh = METHODS[name](noise(), 0.1)
    return judged(mesh.vertices, mesh.simplices, mode)


@pytest.mark.parametrize("mode", family.MODES)
@pytest.mark.parametrize("resolution", ["L", "H"])
@pytest.mark.parametrize("kind", ["vesta", "marching-vesta"])
def test_each_surface_has_the_cycles_of_its_mode_only(
    kind: str, mode: str, resolution: str
) -> None:
    """Six surfaces, two algorithms: the declared mode passes, the two others fail."""
    name = f"{kind}-{mode}-{resolution}"
    assert READY_MADE[f"isoref:{name}"].declaration(name).connectivity == mode
    found = {declared: of_method(name, declared).verdict for declared in family.MODES}
    assert found == {declared: "pass" if declared == mode else "fail" for declared in family.MODES}


MINIATURES: dict[str, Callable[..., bool]] = {
    "disconnect": miniatures.apart,
    "connect": miniatures.together,
    "mixed": miniatures.by_mean,
}


@pytest.mark.parametrize("mode", family.MODES)
def test_other_hands_pass_too(mode: str) -> None:
    """The plain extractor of the tests, which shares no code with VESTA."""
    adapter = Inside(Miniature(mode, miniatures.made(decide=MINIATURES[mode])))
    adapter.open(Limits())
    outcome = adapter.run(Request("noise", "plain", noise(), 0.1))
    assert outcome.vertices is not None
    assert outcome.faces is not None
    assert judged(outcome.vertices, outcome.faces, mode).verdict == "pass"


# Declared to separate inside samples on ambiguous faces, and do not.
BROKEN = ("vesta-connect-L", "vesta-mixed-L", "asymptotic-decider", "lorensen-cline")


@pytest.mark.parametrize("method", BROKEN)
def test_who_declares_a_mode_and_has_another_is_caught(method: str) -> None:
    """Each decides some faces otherwise, right or not."""
    assert of_method(method, "disconnect").verdict == "fail"


def test_the_asymptotic_decider_is_no_mode() -> None:
    """It decides by the saddle: right, and none of the three."""
    for mode in family.MODES:
        assert of_method("asymptotic-decider", mode).verdict == "fail"


def test_who_declares_nothing_is_not_judged() -> None:
    """A promise never made is not held against anybody."""
    assert of_method("asymptotic-decider", "").verdict == "unsupported"


def tube() -> tuple[Field, Mesh]:
    """Two 3-cycles of one cell, joined by six triangles (Fig. 10b) where VESTA has two."""
    grey = np.full((2, 2, 2), -1.0)
    grey[0, 0, 0] = grey[1, 1, 1] = 1.2
    field = Field.of(grey)
    mesh = METHODS["vesta-disconnect-L"](field, 0.1)
    (a, b, c), (d, e, f) = mesh.simplices
    walls = [[a, b, d], [b, e, d], [b, c, e], [c, f, e], [c, a, f], [a, d, f]]
    return field, Mesh.of(mesh.vertices, walls)


def test_a_tube_between_cycles_is_caught() -> None:
    """Section II.E: the optional tube between voxels that share a corner is not VESTA's."""
    field, joined = tube()
    right = METHODS["vesta-disconnect-L"](field, 0.1)
    assert judged(right.vertices, right.simplices, "disconnect", field).verdict == "pass"
    found = judged(joined.vertices, joined.simplices, "disconnect", field)
    assert found.verdict == "fail"
    assert "disc of its own" in found.detail


def test_ties_are_not_judged() -> None:
    """A cell with a tied corner has its points on samples."""
    field = Field.of(np.full((2, 2, 2), 0.1) - np.eye(2))
    mesh = METHODS["vesta-mixed-L"](field, 0.1)
    assert judged(mesh.vertices, mesh.simplices, "mixed", field).verdict == "skip"


def test_a_mode_is_declared_as_json() -> None:
    """Every adapter can carry it; a mode that does not exist is refused."""
    declared = Declaration("mine", connectivity="mixed")
    assert declaration_from(declaration_json(declared), "other") == declared
    with pytest.raises(Exception, match="'both' is not one of"):
        declaration_from({"connectivity": "both"}, "mine")


def test_averages_are_those_of_faces() -> None:
    """(n, 6) sums, by slicing the cell."""
    field = noise()
    case = Case("noise", partial(noise), 0.1, field.values.size)
    trial = Trial(case, field, Declaration("here"), {})
    cell = field.values[1:3, 2:4, 3:5] - 0.1
    expected = [np.take(cell, side, axis).sum() for axis in range(3) for side in (0, 1)]
    assert np.allclose(family.averages(trial, np.array([[1, 2, 3]])), [expected])
