"""Schema of points, directions and orientations in space."""

from __future__ import annotations

import math
from typing import Annotated

from granular_contact.values.strict import Faults, Listed, Strict, directed

Point3 = Annotated[tuple[float, float, float], Listed]
Quaternion = Annotated[tuple[float, float, float, float], Listed]
ORIGIN = (0.0, 0.0, 0.0)


Axis = Annotated[Point3, directed("a direction, as [0, 0, 1] for upward")]


class Oriented(Strict):
    """A part with an orientation in the frame of the part that holds it."""

    rpy_deg: Point3 | None = None
    """Orientation as roll, pitch and yaw: rotations about x, then y, then z of the holding frame (for a shape that of
    its body, for a joint that of its parent). null, and no quaternion: not rotated."""
    quaternion: Quaternion | None = None
    """The same orientation as a quaternion w, x, y, z, of any length. Give this or rpy_deg."""

    def _faults(self) -> Faults:
        if self.rpy_deg is not None and self.quaternion is not None:
            yield ("quaternion",), "stands beside rpy_deg; one of the two is allowed"
        if self.quaternion is not None and not 0.0 < math.hypot(*self.quaternion) < math.inf:
            message = f"got {list(self.quaternion)}; allowed are four numbers that are not all 0"
            yield ("quaternion",), message

    @property
    def is_turned(self) -> bool:
        """Whether an orientation is given."""
        return self.rpy_deg is not None or self.quaternion is not None
