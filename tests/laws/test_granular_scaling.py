"""The granular scaling law (Slonaker et al. 2017), for every law that says how its coefficients scale with gravity.

Sizes by r, masses by s, gravity by q: then times go by sqrt(r/q), speeds by sqrt(q r), forces by s q and powers by
q^1.5 r^0.5 s. It holds in one medium where its law has no length of its own. s is r^3 where all of a shape scales, and
free where its width normal to the plane, which goes by s/r^2, is no size of the flow.

Absolute lengths and times break it: those of the bristles, which are scaled along here; the time SWITCH that stands for
their damping time where that is shorter, so it is none here; K; coefficients of a ball of one size (N/m, kg/m, N),
which go with the size here; and cohesion, which is a pressure. So do tolerances, and steps, of which there are as many.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from support_every_law import sample, unit

import granular_contact as gc
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.gravity import key_of, scalings
from granular_contact.laws.law import Law
from granular_contact.sand.kernels.friction import SWITCH

STEPS, TIME = 400, 0.4  # s
R, Q = 2.7, 0.31  # of sizes, of gravity
COLUMNS = {  # powers of r, s, q in a column
    "hang_angle_deg": (0.0, 0.0, 0.0),
    "hang_rate_rad_s": (-0.5, 0.0, 0.5),
    "depth_m": (1.0, 0.0, 0.0),
    "rail_force_N": (0.0, 1.0, 1.0),
    "rail_power_W": (0.5, 1.0, 1.5),
}


def claims(law: type[Law]) -> bool:
    """Whether all that a medium of the law has to have is known to scale."""
    needed = {name for name, field in law.model_fields.items() if field.is_required()}
    return all(scaling.power is not None for name, scaling in scalings(law).items() if name in needed)


CLAIM = [tag for tag, law in LAWS.items() if claims(law)]
FREE = [tag for tag in CLAIM if "flat" in LAWS[tag].takes]
UNKNOWN = {"bingham", "poncelet", "allen", "pressure_sinkage", "table"}
TIMES_CUBE = [(tag, R**3) for tag in CLAIM] + [(tag, 1.9) for tag in FREE]


def medium(tag: str, r: float) -> dict[str, Any]:
    """A medium of a law, in which coefficients with a length in them, for bodies of one size, go by the size."""
    law, mass, time = LAWS[tag], r**3, math.sqrt(r)
    scaled = sample(law, (mass, r, time))
    left_out = {name for name, scaling in scalings(law).items() if scaling.power is None or name == "cohesion"}
    scaled = replace(scaled, **{name: law.model_fields[name].default for name in left_out})
    if tag == "tsimring_volfson":  # its k is given at the depth of 1 m
        scaled = replace(scaled, friction=scaled.friction / r**scaled.exponent)
    return scaled.model_dump(mode="json", by_alias=True) | {"measured_gravity_m_s2": 9.81}


def scenario(tag: str, r: float = 1.0, s: float = 1.0, q: float = 1.0) -> dict[str, Any]:
    """A carriage that drags a link on a hinge, whose end ploughs through the medium."""
    t = math.sqrt(r / q)
    shape: dict[str, Any] = {"start_m": [0.05 * r, 0], "end_m": [0.1 * r, 0]}
    if "ball" in LAWS[tag].takes:
        shape = {"type": "sphere", "diameter_m": 0.03 * r, "center_m": [0.1 * r, 0]}
    elif "flat" in LAWS[tag].takes:
        shape |= {"type": "plate", "width_m": 0.02 * s / r**2, "thickness_m": 0.002 * r}
    else:
        shape |= {"type": "cylinder", "diameter_m": 0.01 * r}
    ramp = {"type": "ramp", "from": 0, "to": 0.15 * r, "duration_s": TIME * t}
    bristle = {"type": "elastoplastic", "yield_displacement_m": 1e-5 * r, "damping_time_s": SWITCH * t}
    body = {"type": "rigid", "mass_kg": 0.2 * s, "inertia_kg_m2": 2e-4 * s * r * r, "center_of_mass_m": [0.06 * r, 0]}
    return {
        "model": {
            "name": "dragged",
            "bodies": {
                "carriage": {"type": "rigid", "mass_kg": 0.1 * s, "inertia_kg_m2": 1e-5 * s * r * r},
                "link": body | {"shapes": [shape]},
            },
            "joints": {
                "rail": {"type": "slider", "parent": "ground", "child": "carriage"},
                "hang": {"type": "hinge", "parent": "carriage", "child": "link"},
            },
        },
        "medium": medium(tag, r),
        "gravity_m_s2": 9.81 * q,
        "surface_height_m": -0.06 * r,
        "initial": {"joints": {"hang": {"angle_deg": 20}}},
        "drives": {"rail": {"type": "motion", "position_m": ramp}},
        "load": {"friction": bristle},
        "solver": {"end_time_s": TIME * t, "step_s": TIME * t / STEPS, "tolerance": 1e-9},
        "output": {"figures": False},
    }


def run(given: dict[str, Any]) -> dict[str, NDArray[np.float64]]:
    results = gc.simulate(given)
    assert results.status.code == "end_time"
    assert results.warnings == ()  # at another gravity, too: all is known
    return {name: results[name] for name in COLUMNS}


@pytest.mark.parametrize(("tag", "s"), TIMES_CUBE, ids=[f"{tag}-{s:.3g}" for tag, s in TIMES_CUBE])
def test_scaled_runs_are_the_same(tag: str, s: float) -> None:
    original, scaled = run(scenario(tag)), run(scenario(tag, R, s, Q))
    for name, (of_r, of_s, of_q) in COLUMNS.items():
        want = original[name] * R**of_r * s**of_s * Q**of_q
        scale = np.abs(want).max()
        assert scale > 0.0
        # The equations are the same in these units, and so are the steps: what is left is Newton's tolerance, 1e-9.
        np.testing.assert_allclose(scaled[name], want, rtol=0.0, atol=1e-3 * scale, err_msg=name)


def test_laws_without_granular_scaling_are_the_known_ones() -> None:
    assert set(LAWS) - set(CLAIM) == UNKNOWN


@pytest.mark.parametrize("law", LAWS.values(), ids=list(LAWS))
def test_powers_are_those_of_the_units(law: type[Law]) -> None:
    """Where a density is all that has a unit, gravity alone has a time in it: the power is half of that of 1/s."""
    for name, scaling in scalings(law).items():
        key = key_of(law, name)
        (_, _, time), _ = unit(key)
        if scaling.power is not None and key != "cohesion_Pa":
            assert scaling.power == -0.5 * time
