"""The same verdicts whatever of the processor NumPy uses (issue 13: everything repeatable)."""

import copy

import pytest

from tests.isograde.repeated import SPECS, differing, elsewhere, features


@pytest.mark.slow
def test_verdicts_do_not_depend_on_features_of_the_processor() -> None:
    """All that NumPy chooses between is switched off, in the workers too; all claims are asked."""
    if not (off := features()):
        pytest.skip("on this processor NumPy has nothing to choose between")
    plain, other = elsewhere(), elsewhere(NPY_DISABLE_CPU_FEATURES=off)
    assert differing(plain, other) == []
    for spec in SPECS:
        said = [one for each in plain[spec].values() for one in each.values()]
        assert len(plain[spec]) >= 30
        assert said.count("pass") > 300
    # The comparison can fail.
    changed = copy.deepcopy(plain)
    case, claims = next(iter(changed[SPECS[0]].items()))
    claims[next(iter(claims))] = "fail"
    assert len(differing(plain, changed)) == 1
    del changed[SPECS[0]][case]
    assert differing(plain, changed)
