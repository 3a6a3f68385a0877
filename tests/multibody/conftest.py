"""Run each test that simulates twice: with `method: engine` and with `method: auto`.

Tests that a module lists in `BY_ONE` run with `auto` only, because they test code that both methods share.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import support_runs


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Parametrize the tests of files that import `support_runs.simulate` by the method."""
    if getattr(metafunc.module, "simulate", None) is support_runs.simulate:
        alone = metafunc.function.__name__ in getattr(metafunc.module, "BY_ONE", ())
        metafunc.parametrize("method_under_test", ["auto"] if alone else ["engine", "auto"], indirect=True)


@pytest.fixture(autouse=True)
def method_under_test(request: pytest.FixtureRequest) -> Iterator[None]:
    """Compute configs that name no method by the method of this test."""
    with support_runs.by(getattr(request, "param", "auto")):
        yield
