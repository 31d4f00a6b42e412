"""The claims as a test module: ``pytest --pyargs isograde.conformance --isograde NAME``.

Each claim is a test of its own, `test_claim[topology.closed]` and so on, to be chosen with ``-k``,
stopped at the first with ``-x``, and shared out with ``-n``. NAME is as `isograde grade` takes it:
``python:mymodule:extract``, ``exec:./program``, a ready-made name. It may stand in the ini file,
with known failures and the cases to ask beside it (`isograde.pytest_plugin`).
"""

from __future__ import annotations

from typing import NoReturn

import pytest

from isograde.adapters.functions import Implementation
from isograde.claim_tests import ClaimTest, parameters
from isograde.expectations import ExpectationError, expectations
from isograde.model import AdapterError
from isograde.pytest_plugin import EXPECT, IMPLEMENTATION, ONLY
from isograde.runner import NothingToRun


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test a claim of the implementation that is named."""
    config = metafunc.config
    name = IMPLEMENTATION.of(config)
    if not name:
        wrong_use("name one: --isograde python:mymodule:extract, or isograde = .. in the ini file")
    try:
        known = expectations(EXPECT.of(config) or None)
        rows = parameters(name, known, only=tuple(ONLY.of(config).split()))
    except (AdapterError, ExpectationError, NothingToRun) as error:
        wrong_use(str(error))
    metafunc.parametrize(("implementation", "claim"), rows)


def wrong_use(why: str) -> NoReturn:
    """Stop the collection, and say why in one line."""
    raise pytest.Collector.CollectError(f"isograde: {why}")


def test_claim(implementation: Implementation, claim: ClaimTest) -> None:
    """The claim holds, or fails as was expected."""
    claim(implementation)
