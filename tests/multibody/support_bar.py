"""A steel bar of 0.2 m by 10 mm, by hand: text of its model, mass, and inertia about an end."""

from __future__ import annotations

import numpy as np
from support_runs import DENSITY

BAR = "type: link, length_m: 0.2, diameter_m: 0.01, density_kg_m3: 7700"
MASS = DENSITY * np.pi / 4 * 0.01**2 * 0.2  # kg
INERTIA = MASS * (0.2**2 / 3 + 0.01**2 / 16)  # kg m2
