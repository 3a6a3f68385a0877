"""Points, directions and orientations in space, as configs write them."""

from __future__ import annotations

import math
from typing import Annotated

from granular_contact.values.strict import Faults, Listed, Strict, directed

Point3 = Annotated[tuple[float, float, float], Listed]
Quaternion = Annotated[tuple[float, float, float, float], Listed]
ORIGIN = (0.0, 0.0, 0.0)


Axis = Annotated[Point3, directed("a direction, as [0, 0, 1] for upward")]


class Oriented(Strict):
    """What is turned against the frame that it stands in."""

    rpy_deg: Point3 | None = None
    """Roll, pitch and yaw: about x, y and z of that frame, one after another. null, and no quaternion: none."""
    quaternion: Quaternion | None = None
    """The same as w, x, y, z, of any length; give one of the two."""

    def _faults(self) -> Faults:
        if self.rpy_deg is not None and self.quaternion is not None:
            yield ("quaternion",), "stands beside rpy_deg; one of the two is allowed"
        if self.quaternion is not None and not 0.0 < math.hypot(*self.quaternion) < math.inf:
            words = f"got {list(self.quaternion)}; allowed are four numbers that are not all 0"
            yield ("quaternion",), words

    @property
    def is_turned(self) -> bool:
        """Whether an orientation is given."""
        return self.rpy_deg is not None or self.quaternion is not None
