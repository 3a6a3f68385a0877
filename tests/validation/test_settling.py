"""Depths after `initial.settle` against static balance; all cases but the two most expensive."""

from __future__ import annotations

import pytest

from granular_contact.engines.exudyn import settle
from validation import settling

CASES = [name for name in settling.CASES if name not in ("walker_in_space", "snake")]


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_sinkage_is_that_of_the_static_balance(name: str) -> None:
    result = settling.settled(settling.tree_of(name))
    # In space a thousandth of the weight was put on besides: the depth goes at least as fast as its square root.
    assert abs(result.too_deep) < 2e-3 * result.depth
    assert abs(result.lacking) < 1e-6


def test_too_deep_a_sinkage_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Resistance of facets grows as the depth: 3 % of the weight too much are 3 % of the sinkage."""
    monkeypatch.setattr(settle, "OVERLOAD", 0.03)
    result = settling.settled(settling.tree_of("steered_wheel"))
    assert 0.01 < result.too_deep / result.depth < 0.03
