"""A law that acts between two depths only: strips are cut at the boundaries of the layer.

Depths stay those below the free surface, so the pressure of what lies above is in them as if it were the same medium.
"""

from __future__ import annotations

from granular_contact.kernels.compiled import part
from granular_contact.kernels.immersion import immersed_interval


@part
def inside(z0, z1, line):
    """Part (a, b) of a strip with end depths z0, z1 (m) that lies in the medium; (0, 0) when none does."""
    if not line.layered:
        return immersed_interval(z0, z1)
    low, high = min(z0, z1), max(z0, z1)
    if high <= line.top or low >= line.bottom or high <= 0.0:
        return 0.0, 0.0
    a, b = 0.0, 1.0
    if low < line.top:
        cut = (line.top - z0) / (z1 - z0)
        a, b = (cut, b) if z0 < z1 else (a, cut)
    if high > line.bottom:
        cut = (line.bottom - z0) / (z1 - z0)
        a, b = (a, cut) if z0 < z1 else (cut, b)
    return a, b
