"""Values of the controls of a scene: checked, in SI units, within the ranges of their drives."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.controllers import finite
from granular_contact.errors import MOST_NAMES, ControlError, unknown_name
from granular_contact.scene.drives import Control, RangeExcess, controls_of, range_warnings
from granular_contact.scene.types import Scene

ROUND_OFF = 1e-9  # relative to a range; a value that exceeds it by less counts as its end


AN_EXTERNAL = "as {type: external, torque_Nm: 0}"


class ControlValues:
    """Values of the controls of a scene.

    names: names of the controls, in the order of the drives. set_to: the present values by joint, in SI units. beyond:
    by joint, how often and how far values were outside its range.
    """

    def __init__(self, scene: Scene) -> None:
        self._controls: dict[str, Control] = controls_of(scene)
        self.names = tuple(self._controls)
        self._joints_and_units = {name: (control.joint, control.unit) for name, control in self._controls.items()}
        self._ranges = {control.joint: control.bounds_in_si for control in self._controls.values()}
        self.set_to = {control.joint: control.start for control in self._controls.values()}
        self.beyond: dict[str, RangeExcess] = {}

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Ranges (controls, 2) in the units of the names; infinite for a control without a range."""
        return np.array([control.bounds for control in self._controls.values()]).reshape(-1, 2)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about values outside ranges, in sentences."""
        return tuple(range_warnings(self._controls, self.beyond))

    def checked(self, controls: Mapping[str, float] | ArrayLike) -> dict[str, float]:
        """Values to set by joint, in SI units.

        Parameters
        ----------
        controls
            Values by the name of the control, or an array in the order of `names`.

        Raises
        ------
        ControlError
            A name is unknown, the array has another length, or a value is not finite.
        """
        by_name = controls if type(controls) is dict or isinstance(controls, Mapping) else self._named(controls)
        values = {}
        for name, value in by_name.items():  # the fast path of valid floats: it is called in each step of 1 ms
            joint_and_unit = self._joints_and_units.get(name)
            if joint_and_unit is None or type(value) is not float or not -math.inf < value < math.inf:
                return self._checked_one_by_one(by_name)
            joint, unit = joint_and_unit
            values[joint] = unit * value
        return values

    def _checked_one_by_one(self, by_name: Mapping[str, Any]) -> dict[str, float]:
        """As `checked`, also for numbers of other types and for angles in radians; raises with all faults."""
        faults, values = [], {}
        for name, value in by_name.items():
            control = self._controls.get(name) or self._controls.get(re.sub("_rad$", "_deg", name))
            if not self._controls:
                faults.append(f"no control {name!r}: no drive is external; give a joint one, {AN_EXTERNAL}")
            elif control is None:
                faults.append(unknown_name("control", name, self.names))
            elif (number := finite(value)) is None:
                faults.append(f"{name}: got {value!r}, allowed is a finite number")
            else:
                values[control.joint] = control.in_si(name, number)
        if faults:
            raise ControlError("\n".join(faults))
        return values

    def within(self, joint: str, value: float) -> float:
        """A value (SI units) limited to the range of its joint; a value outside is recorded in `beyond`."""
        low, high = self._ranges[joint]
        if low <= value <= high:
            return value
        end = min(max(value, low), high)
        if (excess := abs(value - end)) > ROUND_OFF * (high - low):
            self.beyond[joint] = self.beyond.get(joint, RangeExcess()).with_excess(excess)
        return end

    def _named(self, controls: Any) -> dict[str, Any]:
        """Values by the name of the control, from an array in the order of `names`."""
        try:
            values = np.asarray(controls)
        except ValueError:  # rows of different lengths
            raise ControlError(f"controls: got {controls!r:.80}, allowed is one number for each control") from None
        if values.shape != (len(self.names),):
            count, names = len(self.names), ", ".join(self.names[:MOST_NAMES]) or "none"
            names += ", ..." * (count > MOST_NAMES)
            raise ControlError(f"controls: got the shape {values.shape}, allowed is ({count},): {names}")
        return dict(zip(self.names, values.tolist(), strict=True))
