"""Law of Katsuragi and Durian (2007) for a ball of the mass m: F = k z + m v^2 / d1.

m is the mass of the ball itself. The contact line of the ball holds it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from granular_contact.laws.gravity import INERTIA
from granular_contact.laws.scalar import DEPTH_FORCE, ScalarLaw
from granular_contact.values.strict import Faults, NotNegative, Positive

LENGTHS = ("drag_length", "drag_length_per_diameter")


class KatsuragiDurian(ScalarLaw):
    """Force k z + m v^2 / d1 against the motion of a ball of the mass m (Katsuragi and Durian 2007).

    Parameters
    ----------
    stiffness : float or None
        k (N/m), 0 or more; null: the source does not state it, and a run needs it.
    drag_length : float, optional
        d1 (m), above 0; give either this or `drag_length_per_diameter`.
    drag_length_per_diameter : float, optional
        d1 divided by the diameter of the ball, above 0.
    """

    law: Literal["katsuragi_durian"]
    stiffness: Annotated[NotNegative | None, DEPTH_FORCE] = Field(alias="stiffness_N_m")
    drag_length: Annotated[Positive | None, INERTIA] = Field(None, alias="drag_length_m")
    drag_length_per_diameter: Annotated[Positive | None, INERTIA] = Field(None, alias="drag_length_diameters")

    def __init__(self, stiffness: float | None, *lengths: float | None, **named: Any) -> None:
        """Make the law; see `Coefficients`. In Python a length of 0 counts as not given."""
        named = {name: value or None if name in LENGTHS else value for name, value in named.items()}
        super().__init__(stiffness, *(value or None for value in lengths[:2]), *lengths[2:], **named)

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]  # as in `Coefficients`

    equation = "F = k z + m v^2 / d1"
    terms = ("static", "inertial")

    def force_constants(self) -> dict[str, float]:
        """Constants of the force; see `ScalarLaw.force_constants`."""
        return {
            "k": self.stiffness or 0.0,
            "d1": self.drag_length or 0.0,
            "d1_per_diameter": self.drag_length_per_diameter or 0.0,
        }

    def _faults(self) -> Faults:
        yield from super()._faults()
        given = (self.drag_length is not None) + (self.drag_length_per_diameter is not None)
        if given != 1:
            got = "both" if given else "neither"
            yield (), f"got {got} of drag_length_m and drag_length_diameters; exactly one is allowed"
