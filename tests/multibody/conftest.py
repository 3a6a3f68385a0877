"""What these tests simulate runs by the engine, and again by the method that suits it.

Those of `BY_ONE` in a module run by the latter alone: what they test is the same code for both.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import support_runs


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Both methods for tests of files that simulate."""
    if getattr(metafunc.module, "simulate", None) is support_runs.simulate:
        alone = metafunc.function.__name__ in getattr(metafunc.module, "BY_ONE", ())
        metafunc.parametrize("method_under_test", ["auto"] if alone else ["engine", "auto"], indirect=True)


@pytest.fixture(autouse=True)
def method_under_test(request: pytest.FixtureRequest) -> Iterator[None]:
    """Let configs that name no method be computed by this one."""
    with support_runs.by(getattr(request, "param", "auto")):
        yield
