"""What is set of the controls of a scene: checked, in SI units, within the ranges of their drives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.controllers import finite
from granular_contact.errors import MOST_NAMES, ControlError, unknown_name
from granular_contact.scene.drives import Beyond, Control, controls_of, range_warnings
from granular_contact.scene.types import Scene

ROUND_OFF = 1e-9  # of a range: what lies beyond it by less was meant to be its end


AN_EXTERNAL = "as {type: external, torque_Nm: 0}"


class ControlValues:
    """Values of the controls of a scene.

    names: of the controls, in the order of the drives; set_to: what is set, by joint and in SI units; beyond: what was
    given beyond ranges, by joint.
    """

    def __init__(self, scene: Scene) -> None:
        self._controls: dict[str, Control] = controls_of(scene)
        self.names = tuple(self._controls)
        self._plain = {name: (one.joint, one.unit) for name, one in self._controls.items()}
        self._ranges = {control.joint: control.bounds_in_si for control in self._controls.values()}
        self.set_to = {control.joint: control.start for control in self._controls.values()}
        self.beyond: dict[str, Beyond] = {}

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Ranges (controls, 2) in the units of the names; infinite for any."""
        return np.array([control.bounds for control in self._controls.values()]).reshape(-1, 2)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was given beyond ranges, in sentences."""
        return tuple(range_warnings(self._controls, self.beyond))

    def checked(self, controls: Mapping[str, float] | ArrayLike) -> dict[str, float]:
        """What to set, by joint and in SI units.

        Raises
        ------
        ControlError
            Other names or another number of them, or a number that is not finite.
        """
        given = controls if type(controls) is dict or isinstance(controls, Mapping) else self._named(controls)
        found = {}
        for name, value in given.items():  # a step of 1 ms has no time for more, where nothing is wrong
            plain = self._plain.get(name)
            if plain is None or type(value) is not float or not -math.inf < value < math.inf:
                return self._checked_one_by_one(given)
            joint, unit = plain
            found[joint] = unit * value
        return found

    def _checked_one_by_one(self, given: Mapping[str, Any]) -> dict[str, float]:
        """The same, of other numbers and names too; with every fault."""
        faults, found = [], {}
        for name, value in given.items():
            control = self._controls.get(name) or self._controls.get(name.removesuffix("_rad") + "_deg")
            if not self._controls:
                faults.append(f"no control {name!r}: no drive is external; give a joint one, {AN_EXTERNAL}")
            elif control is None:
                faults.append(unknown_name("control", name, self.names))
            elif (number := finite(value)) is None:
                faults.append(f"{name}: got {value!r}, allowed is a finite number")
            else:
                found[control.joint] = control.in_si(name, number)
        if faults:
            raise ControlError("\n".join(faults))
        return found

    def within(self, joint: str, value: float) -> float:
        """A value, or the end of the range of its joint where it lies beyond it; which is kept, to be reported."""
        least, most = self._ranges[joint]
        if least <= value <= most:
            return value
        end = min(max(value, least), most)
        if (excess := abs(value - end)) > ROUND_OFF * (most - least):
            self.beyond[joint] = self.beyond.get(joint, Beyond()).and_by(excess)
        return end

    def _named(self, controls: Any) -> dict[str, Any]:
        """Controls that were given in their order."""
        try:
            values = np.asarray(controls)
        except ValueError:  # rows of different lengths
            raise ControlError(f"controls: got {controls!r:.80}, allowed is one number for each control") from None
        if values.shape != (len(self.names),):
            count, names = len(self.names), ", ".join(self.names[:MOST_NAMES]) or "none"
            names += ", ..." * (count > MOST_NAMES)
            raise ControlError(f"controls: got the shape {values.shape}, allowed is ({count},): {names}")
        return dict(zip(self.names, values.tolist(), strict=True))
