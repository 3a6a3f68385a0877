"""Links in space that stretch: against theory, the other engine and the plane, and warnings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support_bending import order

from granular_contact import load, simulate
from granular_contact.engines.exudyn.build_in_space import build as assembled
from granular_contact.errors import SceneError
from granular_contact.scene import build

Config = dict[str, Any]
LENGTH, DIAMETER, DENSITY, YOUNG = 0.2, 0.006, 1200.0, 1e6  # of rubber
AREA = np.pi / 4.0 * DIAMETER**2
RUBBER = {"youngs_modulus_Pa": YOUNG, "elements": 4, "axial_stiffness_N": YOUNG * AREA}
MASS, STILL = 0.05, {"settle": True}  # kg, of what hangs on it
SHORT = {"end_time_s": 2e-4, "step_s": 1e-4}


def link(flexible: Config, **more: float) -> Config:
    return {
        "type": "link",
        "length_m": LENGTH,
        "diameter_m": DIAMETER,
        "density_kg_m3": DENSITY,
        **more,
        "flexible": flexible,
    }


def hanging(flexible: Config, *, by_tip: bool = False, **more: Any) -> Config:
    """A rod that hangs straight down on a weld, with a weight at its other end."""
    weight = {"type": "rigid", "mass_kg": MASS, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), 1e-5)}
    far, near = [LENGTH, 0.0, 0.0], [0.0, 0.0, 0.0]
    wall = {"type": "weld", "parent": "ground", "child": "rod", "rpy_deg": [0, -90 if by_tip else 90, 0]}
    end = {"type": "weld", "parent": "rod", "child": "weight", "parent_point_m": near if by_tip else far}
    joints = {"wall": wall | {"child_point_m": far if by_tip else near}, "end": end}
    bodies = {"rod": link(flexible), "weight": weight}
    return {"model": {"in_space": True, "name": "hangs", "bodies": bodies, "joints": joints}, **more}


@pytest.mark.slow
@pytest.mark.parametrize("by_tip", [False, True])
def test_a_rod_that_hangs_is_as_long_as_hooke_says(by_tip: bool) -> None:
    """(M + m / 2) g L / E A, whose integral over the rod the rule of midpoints has without error; strain at its top."""
    results = simulate(load(hanging(RUBBER, by_tip=by_tip, initial=STILL, solver=SHORT)))
    mass = DENSITY * AREA * LENGTH
    stretch = (MASS + 0.5 * mass) * 9.81 * LENGTH / (YOUNG * AREA)
    assert results["rod_stretch_m"][0] == pytest.approx(stretch, rel=1e-6)
    top = (MASS + mass) * 9.81 / (YOUNG * AREA)
    strain, numbers = results["rod_strain"], results.summary["links"]["rod"]
    assert strain[0] == pytest.approx(top, rel=1e-6)
    assert numbers["stress_Pa"] == pytest.approx(YOUNG * strain.max(), rel=1e-9)


def test_frequency_of_longitudinal_waves_converges_to_theory() -> None:
    """Sqrt(E / rho) / 4 L of a rod that is clamped at one end."""
    counts, errors, exact = [4, 8, 16], [], np.sqrt(YOUNG / DENSITY) / (4.0 * LENGTH)
    for count in counts:
        given = hanging(RUBBER | {"elements": count}, gravity_m_s2=0.0)
        del given["model"]["bodies"]["weight"], given["model"]["joints"]["end"]
        mbs = assembled(build(load(given))).mbs
        values = np.real(mbs.ComputeODE2Eigenvalues(convert2Frequencies=True, useAbsoluteValues=True)[0])
        errors.append(float(np.abs(values / exact - 1.0).min()))
    assert order(counts, errors) == pytest.approx(2.0, abs=0.1)
    assert errors[1] < 2e-3


def test_a_weight_bounces_alike_by_both_engines() -> None:
    """Let go at the length it was made with, with a damper: the same stretch, and all energy accounted for."""
    solver = {"end_time_s": 0.1, "step_s": 1e-3, "spectral_radius": 0.9, "tolerance": 1e-9}
    given = hanging(RUBBER | {"axial_damping_N_s": 0.05}, solver=solver)
    tree, engine = (simulate(load(given | {"method": method})) for method in ("minimal", "engine"))
    most = float(tree["rod_stretch_m"].max())
    assert most > 1.8 * MASS * 9.81 * LENGTH / (YOUNG * AREA)  # nearly twice that at rest
    assert np.abs(tree["rod_stretch_m"] - engine["rod_stretch_m"]).max() < 1e-6 * most
    assert tree["damping_work_J"][-1] < -1e-5
    assert tree.summary["energy"]["imbalance_relative"] < 1e-3


def test_a_rubber_pendulum_swings_as_in_the_plane() -> None:
    """Let go from the horizontal, it is 4 % longer below: cables of cubic elements, and rigid ones that slide."""
    runs = []
    for space in (True, False):
        axis, z = ({"axis": [0, 1, 0]}, [0.0]) if space else ({"home_deg": 0}, [])
        inertia: Any = dict.fromkeys(("xx", "yy", "zz"), 1e-5) if space else 1e-5
        weight = {"type": "rigid", "mass_kg": MASS, "inertia_kg_m2": inertia}
        pin = {"type": "hinge", "parent": "ground", "child": "rod", **axis}
        end = {"type": "weld", "parent": "rod", "child": "weight", "parent_point_m": [LENGTH, 0.0, *z]}
        bodies = {"rod": link(RUBBER | {"elements": 16}), "weight": weight}
        model = {"in_space": space, "name": "swings", "bodies": bodies, "joints": {"pin": pin, "end": end}}
        given = {"model": model, "solver": {"end_time_s": 0.2, "accuracy": 1e-3}}
        runs.append(simulate(load(given)))
    times, up = np.linspace(0.0, 0.2, 200), ("tip_z_m", "tip_y_m")
    planar, spatial = (np.interp(times, r["time_s"], r[name]) for r, name in zip(runs, up, strict=True))
    assert runs[0]["rod_stretch_m"].max() > 0.04 * LENGTH
    assert np.abs(planar - spatial).max() < 5e-3 * np.abs(np.diff(spatial)).sum()


def test_links_held_at_both_ends_stretch_or_are_refused() -> None:
    """A strip on two fixed hinges carries a weight nearly as a string does: 2 T sin a = P, T = E A (1 / cos a - 1).

    Without stretch its length would be held by a constraint that is none to first order: it was left out in silence.
    """
    half = link(RUBBER | {"youngs_modulus_Pa": 1e4, "elements": 4})
    weight = {"type": "rigid", "mass_kg": MASS, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), 1e-7)}
    pin = {"type": "hinge", "parent": "ground", "axis": [0, 1, 0]}
    joints = {
        "left": pin | {"child": "rod"},
        "end": {"type": "weld", "parent": "rod", "child": "weight", "parent_point_m": [LENGTH, 0, 0]},
        "begin": {"type": "weld", "parent": "weight", "child": "other"},
    }
    right = pin | {"child": "other", "parent_point_m": [2 * LENGTH, 0, 0], "child_point_m": [LENGTH, 0, 0]}
    bodies = {"rod": half, "weight": weight, "other": half}
    model = {"in_space": True, "name": "string", "bodies": bodies, "joints": joints, "closures": {"right": right}}
    results = simulate(load({"model": model, "initial": STILL, "solver": SHORT}))
    load_on_it = (MASS + DENSITY * AREA * LENGTH) * 9.81
    angles, level = np.linspace(0.0, 1.0, 100001), LENGTH / 8.0  # half an element beside the weight
    pull = 2.0 * YOUNG * AREA * ((LENGTH - level) / np.cos(angles) - LENGTH + level) / LENGTH * np.sin(angles)
    sag = (LENGTH - level) * np.tan(angles[int(np.searchsorted(pull, load_on_it))])
    assert results["weight_z_m"][0] == pytest.approx(-sag, rel=0.02)  # of a string, E I is 1e-3 of P L^2
    del half["flexible"]["axial_stiffness_N"]
    with pytest.raises(SceneError, match=r"model\.closures\.right: right holds a straight link by both of its ends"):
        build(load({"model": model}))


@pytest.mark.parametrize("way", ["bending", "torsion", "axial"])
def test_internal_damping_is_that_of_kelvin_and_voigt(way: str) -> None:
    """A body on a light rod whose root is shoved swings with D w / 2 K of the critical damping, of whatever K is.

    D / K is the same in all of the rod, so that to the body it is a spring k with the damper k D / K.
    """
    bending, axial, share, inertia = YOUNG * np.pi / 64.0 * DIAMETER**4, YOUNG * AREA, 0.05, 1e-4
    K, key, column = {
        "bending": (bending, "bending_damping_N_m2_s", "rod_deflection_z_m"),
        "torsion": (bending / 1.3, "torsion_damping_N_m2_s", "rod_twist_deg"),
        "axial": (axial, "axial_damping_N_s", "rod_stretch_m"),
    }[way]
    spring = 3.0 * K / LENGTH**3 if way == "bending" else K / LENGTH
    w = float(np.sqrt(spring / (inertia if way == "torsion" else MASS)))
    small = inertia if way == "torsion" else 1e-9
    weight = {"type": "rigid", "mass_kg": MASS, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), small)}
    bodies = {"rod": link(RUBBER | {key: 2.0 * K * share / w}, density_kg_m3=1e-3), "weight": weight}
    turns = way == "torsion"
    shove = {"type": "hinge" if turns else "slider", "axis": [0, 0, 1] if way == "bending" else [1, 0, 0]}
    joints = {
        "shove": {"parent": "ground", "child": "rod", **shove},
        "end": {"type": "weld", "parent": "rod", "child": "weight", "parent_point_m": [LENGTH, 0, 0]},
    }
    period = 2.0 * np.pi / w
    table = {
        "type": "table",
        "time_s": [0.0, 0.1 * period, 9.0 * period],
        "values": [0.0, *[1.0 if turns else 1e-3] * 2],
    }
    given = {
        "model": {"in_space": True, "name": "swings", "bodies": bodies, "joints": joints},
        "drives": {"shove": {"type": "motion", "angle_deg" if turns else "position_m": table}},
        "gravity_m_s2": 0.0,
        # Of bending forces are 2e-5 N, where 1e-5 of the weight is 5e-6 N: a tolerance that is measured by that alone
        # took 7 % off the decrement.
        "solver": {"end_time_s": 2.4 * period, "step_s": period / 200.0},
    }
    deflection = simulate(load(given))[column]
    late = np.abs(deflection[len(deflection) // 3 :])
    peaks = late[1:-1][(late[1:-1] > late[:-2]) & (late[1:-1] >= late[2:])]
    assert len(peaks) >= 3
    # Half a period lies between peaks; of a discrete rod w is at most 1 % off.
    decrement = np.log(peaks[0] / peaks[2])
    assert decrement == pytest.approx(2.0 * np.pi * share / np.sqrt(1.0 - share**2), rel=0.03)


def test_links_that_are_welded_end_to_end_are_one_link() -> None:
    """Halves of elements that meet are welded to whole ones: the same elements, and the same motion to round-off."""
    whole = link(RUBBER | {"elements": 4}, length_m=2 * LENGTH)
    half = link(RUBBER | {"elements": 2})
    swing = {"type": "hinge", "parent": "ground", "axis": [0, 1, 0]}
    next_one = {"type": "weld", "parent": "a", "child": "b", "parent_point_m": [LENGTH, 0, 0]}
    tips = []
    for bodies, joints in (
        ({"a": whole}, {"swing": swing | {"child": "a"}}),
        ({"a": half, "b": half}, {"swing": swing | {"child": "a"}, "next": next_one}),
    ):
        model = {"in_space": True, "name": "chain", "bodies": bodies, "joints": joints}
        solver = {"end_time_s": 0.1, "step_s": 1e-3, "tolerance": 1e-10}
        tips.append(simulate(load({"model": model, "solver": solver})))
    single, welded = tips
    assert single["elastic_J"].max() > 5e-5
    assert welded["elastic_J"] == pytest.approx(single["elastic_J"], abs=1e-8 * single["elastic_J"].max())
    assert welded["tip_z_m"] == pytest.approx(single["tip_z_m"], abs=1e-8 * LENGTH)
