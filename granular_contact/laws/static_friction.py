"""Regularisations of the sign in the static resistance; their equations are in `sand.kernels.friction`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.values.strict import NotNegative, Positive

if TYPE_CHECKING:  # a config is read without numpy
    import numpy as np
    from numpy.typing import NDArray


class Elastoplastic(Coefficients):
    """Static resistance that holds still: each point is tied to an anchor, which yields.

    Parameters
    ----------
    yield_displacement : float
        Stretch (m) at which a bristle, the spring of static friction, yields; above 0.
    damping_time : float
        Its damping over its stiffness (s), 0 or more.
    """

    type: Literal["elastoplastic"]
    yield_displacement: Positive = Field(1e-5, alias="yield_displacement_m")
    damping_time: NotNegative = Field(1e-3, alias="damping_time_s")

    def fill(self, record: NDArray[np.void]) -> None:
        """Write the constants into a medium record (1,)."""
        from granular_contact.sand.kernels.friction import ELASTOPLASTIC

        record["friction"] = ELASTOPLASTIC
        record["u_y"], record["tau"] = self.yield_displacement, self.damping_time


class Smooth(Coefficients):
    """Static resistance that follows the velocity, tanh(v / reference_speed), and creeps under a constant load.

    Parameters
    ----------
    reference_speed : float
        Speed (m/s) over which the sign is smoothed, above 0.
    """

    type: Literal["smooth"]
    reference_speed: Positive = Field(1e-3, alias="reference_speed_m_s")

    def fill(self, record: NDArray[np.void]) -> None:
        """Write the constants into a medium record (1,)."""
        from granular_contact.sand.kernels.friction import SMOOTH

        record["friction"] = SMOOTH
        record["v_eps"] = self.reference_speed
