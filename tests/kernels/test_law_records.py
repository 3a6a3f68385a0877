"""Kernels call the functions of a law by their addresses in the record of a medium."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from support_laws import ALL_LAWS, BAR_LAWS, SCALAR_LAWS, SOFT, G, label, run_record

from granular_contact.sand.kernels import law
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.probe import probe

LEVEL = np.zeros((1, 2))


@pytest.mark.parametrize("medium", ALL_LAWS, ids=label)
def test_a_medium_holds_the_record_of_its_law(medium: object) -> None:
    law_record = medium.record(SOFT, G)
    record = medium_record(law_record)
    np.testing.assert_array_equal(record["own"].view(np.uint8).ravel()[: law_record.nbytes], law_record.view(np.uint8))
    assert law_record.nbytes <= record["own"].nbytes
    on_balls = medium in SCALAR_LAWS
    assert (record["ball_force"][0] != 0, record["strip_force"][0] != 0) == (on_balls, not on_balls)
    assert record["forces"][0] != 0 != record["drag_anchor"][0]
    assert (record["cap_force"][0] != 0) == (medium is BAR_LAWS[0])


def test_functions_are_those_of_the_record() -> None:
    """A pressure (Pa) that resists with the depth of the lower end, and an anchor that stays.

    Its record begins with all that another law has, and was once taken for that one's.
    """
    bar_record = BAR_LAWS[0].record(SOFT, G)
    record_type = np.dtype([*bar_record.dtype.descr, ("pressure", "f8")])
    record = np.zeros(1, record_type)
    record["pressure"] = 50.0
    for name in bar_record.dtype.names:
        record[name] = bar_record[name]

    @njit
    def strip_force(strip, run, m, f):
        f[1, 0, 1] += m.pressure * run.width * (strip.b - strip.a) * max(strip.z0, strip.z1)

    @njit
    def drag_anchor(p, anchor, m):  # noqa: ARG001
        return anchor

    law.LAWS[record_type] = {"strip_force": strip_force, "drag_anchor": drag_anchor}
    P, F, totals = np.array([[0.0, 0.1], [0.3, -0.3]]), np.zeros((2, 2)), np.zeros((law.TERMS, 3))
    probe(P, np.zeros((2, 2)), P, run_record(0.02), LEVEL, record, F, totals)
    assert F[0, 1] == pytest.approx(50.0 * 0.02 * 0.75 * 0.3, rel=1e-14)
    np.testing.assert_allclose(totals[1], [0.0, F[0, 1], 0.0], rtol=1e-14)
    assert not totals[[0, 2]].any()
