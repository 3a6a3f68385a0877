"""Kernels called without a look at the types of their arguments."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact.kernels import groups
from granular_contact.kernels.entry import entry


def test_an_entry_does_what_its_kernel_does():
    reach = np.array([[-1.0, 5.0, 0.0], [-1.0, 0.0, 0.0]])
    asleep, same = np.zeros(2, dtype=bool), np.zeros(2, dtype=bool)
    wake = entry(groups.wake, reach, 0.0, asleep)
    assert wake(reach, 0.05, asleep) is groups.wake(reach, 0.05, same) is True
    np.testing.assert_array_equal(asleep, same)
    assert asleep.tolist() == [True, False]


def test_an_entry_passes_errors_on():
    with pytest.raises(TypeError):
        entry(groups.wake, np.zeros((1, 3)), 0.0, np.zeros(1, dtype=bool))("no array", 0.0, np.zeros(1, dtype=bool))
