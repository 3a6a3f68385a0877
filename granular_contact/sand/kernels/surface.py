"""Height of the free surface in the plane, a polyline.

profile (k, 2) m: corners x, y with rising x; the first and the last piece extend to infinity; one corner: a level bed.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part


@part
def height(profile, x):
    """Height (m) and slope (-) of the surface at x (m)."""
    last = profile.shape[0] - 1
    if last == 0:
        return profile[0, 1], 0.0
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if profile[middle, 0] <= x:
            low = middle
        else:
            high = middle
    slope = (profile[high, 1] - profile[low, 1]) / (profile[high, 0] - profile[low, 0])
    return profile[low, 1] + slope * (x - profile[low, 0]), slope


@part
def depth(profile, x, y):
    """Depth (m, positive below the surface, measured vertically) of a point."""
    return height(profile, x)[0] - y
