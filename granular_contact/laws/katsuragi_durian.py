"""Medium of Katsuragi and Durian (2007): k z + m v^2 / d1 on a ball of mass m.

The mass is that of the ball itself; the contact line has it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from granular_contact.laws.gravity import INERTIA
from granular_contact.laws.scalar import WITH_DEPTH, ScalarLaw
from granular_contact.values.strict import Faults, NotNegative, Positive

LENGTHS = ("drag_length", "drag_length_per_diameter")


class KatsuragiDurian(ScalarLaw):
    """k z + m v^2 / d1 with the mass m of the ball itself (Katsuragi and Durian 2007).

    Parameters
    ----------
    stiffness : float or None
        k (N/m), 0 or more; null: not stated by the source, a run needs it.
    drag_length : float, optional
        d1 (m), above 0; give this, or the next.
    drag_length_per_diameter : float, optional
        d1 over the diameter of the ball, above 0.
    """

    law: Literal["katsuragi_durian"]
    stiffness: Annotated[NotNegative | None, WITH_DEPTH] = Field(alias="stiffness_N_m")
    drag_length: Annotated[Positive | None, INERTIA] = Field(None, alias="drag_length_m")
    drag_length_per_diameter: Annotated[Positive | None, INERTIA] = Field(None, alias="drag_length_diameters")

    def __init__(self, stiffness: float | None, *lengths: float | None, **named: Any) -> None:
        """As `Coefficients`; in Python 0 is none of the two lengths, too."""
        named = {name: value or None if name in LENGTHS else value for name, value in named.items()}
        super().__init__(stiffness, *(value or None for value in lengths[:2]), *lengths[2:], **named)

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]  # as in `Coefficients`

    equation = "F = k z + m v^2 / d1"
    terms = ("static", "inertial")

    def own(self) -> dict[str, float]:
        """As `ScalarLaw.own`."""
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
