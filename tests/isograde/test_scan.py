"""Pieces and handles beside the trilinear level set's, for every family: measured, and true."""

from isograde.cases import all_cases
from isograde.declaration import declaration_from
from isograde.model import Verdict

from tests.isograde.families import CORRECT
from tests.isograde.judging import Here, grade

CLAIM = "topology.scan"
NOISE = [all_cases()["noise/white-8x9x10"]]


def scanned(name: str) -> tuple[Verdict, dict[str, object]]:
    """The verdict and the numbers of a correct extractor on noise."""
    family = CORRECT[name]
    declared = declaration_from(family.says, name)
    ((_, _, finding),) = grade(Here(family.function, declared), NOISE, CLAIM)
    return finding.verdict, dict(finding.numbers)


def test_the_trilinear_surface_has_the_pieces_and_handles_of_the_truth() -> None:
    """And who decides otherwise, rightly for itself, is told by how much, and held to nothing."""
    verdict, numbers = scanned("trilinear")
    assert verdict is Verdict.PASS
    assert numbers
    for name in ("cubes", "tetrahedra_of_kuhn", "label_cubes", "dual_cubes"):
        verdict, numbers = scanned(name)
        assert verdict is Verdict.FAIL, name
        assert numbers
