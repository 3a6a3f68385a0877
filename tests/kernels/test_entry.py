"""Kernels called without a look at the types of their arguments."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact.kernels import batches
from granular_contact.kernels.entry import bound, entry


def test_an_entry_does_what_its_kernel_does():
    reach = np.array([[-1.0, 5.0, 0.0], [-1.0, 0.0, 0.0]])
    active, same = np.zeros(2, dtype=bool), np.zeros(2, dtype=bool)
    update = entry(batches.update_active, reach, 0.0, active)
    assert update(reach, 0.05, active) is batches.update_active(reach, 0.05, same) is True
    np.testing.assert_array_equal(active, same)
    assert active.tolist() == [True, False]


def test_an_entry_passes_errors_on():
    with pytest.raises(TypeError):
        entry(batches.update_active, np.zeros((1, 3)), 0.0, np.zeros(1, dtype=bool))(
            "no array", 0.0, np.zeros(1, dtype=bool)
        )


def test_a_bound_kernel_sees_what_its_arrays_hold_at_each_call():
    reach, active = np.array([[-1.0, 5.0, 0.0], [-1.0, 0.0, 0.0]]), np.zeros(2, dtype=bool)
    update = bound(batches.update_active, reach, 0.05, active)
    assert update() is True
    assert active.tolist() == [True, False]
    reach[0, 1] = 0.0
    assert update() is False
    assert not active.any()
    other = bound(batches.update_active, np.array([[-1.0, 5.0, 0.0]]), 0.05, np.zeros(1, dtype=bool))  # of other sizes
    assert other() is True
