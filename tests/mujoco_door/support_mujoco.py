"""Small MuJoCo models in sand."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact import Rft3d

Array = NDArray[np.float64]
SAND = Rft3d(1600.0, 0.5, 0.3)
GRAVITY = 9.81
BOX = '<geom name="box" type="box" size="0.05 0.04 0.03" density="2700"/>'


def model_of(
    geoms: str = BOX, *, step: float = 1e-3, joint: str = "<freejoint/>", more: str = "", place: str = "0 0 0.1"
) -> Any:
    """One body, or what is given in its place."""
    import mujoco

    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{step}"/>{more}<worldbody><body name="body" pos="{place}">{joint}{geoms}</body>'
        "</worldbody></mujoco>"
    )


def thrown(model: Any) -> Any:
    """Data of a free body that is thrown."""
    import mujoco

    data = mujoco.MjData(model)
    data.qvel[:] = 0.5, 0.2, -1.0, 1.0, 2.0, 3.0
    return data


def energy(model: Any, data: Any) -> float:
    """Of all bodies (J)."""
    import mujoco

    mujoco.mj_fwdPosition(model, data)
    momentum = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, momentum, data.qvel)
    return float(0.5 * data.qvel @ momentum + GRAVITY * model.body_mass @ data.xipos[:, 2])


def go(model: Any, data: Any, bed: Any, seconds: float) -> None:
    """Apply and step."""
    import mujoco

    for _ in range(round(seconds / model.opt.timestep)):
        bed.apply(data)
        mujoco.mj_step(model, data)
