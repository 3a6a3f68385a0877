"""Regularisations of the sign in the static resistance. Their equations are in `sand.kernels.friction`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.values.strict import NotNegative, Positive

if TYPE_CHECKING:  # a config is read without numpy
    import numpy as np
    from numpy.typing import NDArray


class Elastoplastic(Coefficients):
    """Static resistance that can hold a body at rest: each point is tied to an anchor by a spring that yields.

    Parameters
    ----------
    yield_displacement : float
        Stretch (m) at which a bristle, the spring of static friction, yields; above 0.
    damping_time : float
        Damping of a bristle divided by its stiffness (s), 0 or more.
    """

    type: Literal["elastoplastic"]
    yield_displacement: Positive = Field(1e-5, alias="yield_displacement_m")
    damping_time: NotNegative = Field(1e-3, alias="damping_time_s")

    def fill(self, record: NDArray[np.void]) -> None:
        """Write the constants into the record (1,) of a medium.

        Parameters
        ----------
        record : (1,) array
            Record of the law. It is changed.
        """
        from granular_contact.sand.kernels.friction import ELASTOPLASTIC

        record["friction"] = ELASTOPLASTIC
        record["u_y"], record["tau"] = self.yield_displacement, self.damping_time


class Smooth(Coefficients):
    """Static resistance proportional to tanh(v / reference_speed). A body creeps under a constant load.

    Parameters
    ----------
    reference_speed : float
        Speed (m/s) over which the sign is smoothed, above 0.
    """

    type: Literal["smooth"]
    reference_speed: Positive = Field(1e-3, alias="reference_speed_m_s")

    def fill(self, record: NDArray[np.void]) -> None:
        """Write the constants into the record (1,) of a medium.

        Parameters
        ----------
        record : (1,) array
            Record of the law. It is changed.
        """
        from granular_contact.sand.kernels.friction import SMOOTH

        record["friction"] = SMOOTH
        record["v_eps"] = self.reference_speed
