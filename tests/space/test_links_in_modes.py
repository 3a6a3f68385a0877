"""Links that bend in a few natural modes, in space: against theory, against all their elements, and what is refused."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from support_bending import into_space, order, pendulum
from support_models import one_body
from support_refusals import CONFIG_OR_SCENE, message_of
from support_runs import ROOT

from granular_contact import Results, cli, load, simulate
from granular_contact.config import scenario_to_dict
from granular_contact.config.schema.space import SpatialScenario
from granular_contact.mechanics.space.freedoms import freedoms
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.run import run
from granular_contact.scene import build
from granular_contact.scene.space.modes import shapes
from granular_contact.scene.space.section import Section

Config = dict[str, Any]
E, DENSITY, LENGTH, WIDTH, THICKNESS = 2e9, 1200.0, 0.3, 0.003, 0.002
LINE = DENSITY * WIDTH * THICKNESS  # kg/m
STRIP = {"type": "link", "length_m": LENGTH, "width_m": WIDTH, "thickness_m": THICKNESS, "density_kg_m3": DENSITY}
ROOTS = np.array([1.87510407, 4.69409113])  # of a cantilever's characteristic equation


def reduced(modes: int) -> Config:
    return {"reduced": {"modes": modes}}


def cantilever(elements: int, modes: int, end: float, gravity: float = 9.81) -> Config:
    strip = STRIP | {"flexible": {"youngs_modulus_Pa": E, "elements": elements}}
    model = one_body("strip", strip, "wall", "weld")
    return {"model": model, "method": reduced(modes), "gravity_m_s2": gravity, "solver": {"end_time_s": end}}


def swung() -> Config:
    """A strip on a hub that turns, its section inclined, with a weight beside its axis: it bends twice and twists."""
    sides = {"length_m": 0.2, "width_m": 0.01, "thickness_m": 0.002, "density_kg_m3": 1200}
    strip = {"type": "link", **sides, "flexible": {"youngs_modulus_Pa": 2e8, "elements": 6}}
    hub = {"type": "rigid", "mass_kg": 0.2, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), 1e-4)}
    weight = {"type": "rigid", "mass_kg": 0.005, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), 1e-7)}
    joints = {
        "swing": {"type": "hinge", "parent": "ground", "child": "hub", "axis": [0, 1, 0.5], "home_deg": 20},
        "clamp": {"type": "weld", "parent": "hub", "child": "strip", "rpy_deg": [30, 0, 0]},
        "end": {"type": "weld", "parent": "strip", "child": "weight", "parent_point_m": [0.2, 0.02, 0]},
    }
    bodies = {"hub": hub, "strip": strip, "weight": weight}
    model = {"in_space": True, "name": "turns", "bodies": bodies, "joints": joints}
    solver = {"end_time_s": 0.1, "accuracy": 1e-4}
    return {"model": model, "initial": {"joints": {"swing": {"rate_rad_s": 3}}}, "solver": solver}


def apart(reduced: Results, full: Results, link: str) -> float:
    """How far both deflections are apart at most, of the greatest one."""
    times = np.linspace(0.0, min(reduced["time_s"][-1], full["time_s"][-1]), 300)
    tip, whole = (
        np.array([np.interp(times, of["time_s"], of[f"{link}_deflection_{x}_m"]) for x in "yz"])
        for of in (reduced, full)
    )
    return float(np.linalg.norm(tip - whole, axis=0).max() / np.linalg.norm(whole, axis=0).max())


# ---- theory ----


def test_modes_are_those_of_a_cantilever_with_order_two() -> None:
    """Two of bending in each plane and two of torsion, whose shapes have the energy omega^2 / 2."""
    section = Section(None, WIDTH, THICKNESS)
    about_y, about_z = (ROOTS**2 / LENGTH**2 * np.sqrt(E * moment / LINE) for moment in section.second_moments)
    polar = DENSITY * section.second_moments.sum()
    torsion = 0.5 * np.pi / LENGTH * np.sqrt(E / 2.6 * section.torsion_constant / polar)
    counts, errors = [4, 8, 16], []
    for count in counts:
        scene = build(load(cantilever(count, 2, 0.1)))
        joints, S = shapes(scene, scene.beams[0])
        K = np.array([joint.elastic.stiffness for joint in joints if joint.elastic is not None])
        omega = np.sqrt(np.einsum("kai,ka->i", S**2, K))
        errors.append(np.abs(omega / [torsion, 3.0 * torsion, *about_y, *about_z] - 1.0))
    for of_mode in np.transpose(errors).tolist():
        assert order(counts, of_mode) == pytest.approx(2.0, abs=0.2)
    assert np.max(errors[-1]) < 5e-3


def test_one_mode_falls_twice_as_far_as_it_hangs_in_half_a_period() -> None:
    """Let go where it is straight, W = a (1 - cos w t) phi(L), a = g int phi / w^2 int phi^2: 0.12668 q L^4 / EI."""
    gravity = 0.981  # so that it is a linear beam: its slope is 0.02
    results = simulate(load(cantilever(16, 1, 0.15, gravity)))
    root, shape = ROOTS[0], 0.7340955  # sigma of phi, for which int phi = 2 sigma L / root, phi(L)^2 = 4 int phi^2 / L
    omega = root**2 / LENGTH**2 * np.sqrt(E * Section(None, WIDTH, THICKNESS).second_moments[0] / LINE)
    hangs = 4.0 * shape / root * gravity / omega**2
    fallen = -results["strip_deflection_z_m"]
    assert np.pi / omega < 0.12  # s, half of a period
    assert fallen.max() == pytest.approx(2.0 * hangs, rel=5e-3)  # by l^2 0.2 %
    assert results["time_s"][int(fallen.argmax())] == pytest.approx(np.pi / omega, rel=0.02)
    assert results.summary["energy"]["imbalance_relative"] < 1e-3


# ---- against all elements ----


def test_a_few_modes_bend_and_twist_as_all_elements_do() -> None:
    full = simulate(load(swung()))
    assert np.abs(full["strip_twist_deg"]).max() > 0.5
    errors = {}
    for modes in (1, 2, 6):
        results = simulate(load(swung() | {"method": reduced(modes)}))
        errors[modes] = apart(results, full, "strip")
        assert not results.warnings
        assert results.summary["energy"]["imbalance_relative"] < 1e-3
    assert errors[2] < 0.3 * errors[1] < 0.012
    assert errors[6] < 1e-5  # all that there are


def test_two_modes_follow_a_strike_in_sand_and_one_mode_warns() -> None:
    """On an inclined axis, as in `validation/oblique_modes.py`, from both sides."""
    scene = into_space(pendulum(0.15, 8), 0.0)
    scene["model"]["joints"]["pivot"]["axis"] = [0.0, 0.866, 0.5]
    scene["solver"]["accuracy"] = 1e-3
    full = simulate(load(scene))
    for modes, least, most in ((1, 0.2, 0.5), (2, 0.02, 0.06), (8, 0.0, 1e-4)):
        results = simulate(load(scene | {"method": reduced(modes)}))
        error, warnings = (
            apart(results, full, "link"),
            [warning for warning in results.warnings if "too few modes" in warning],
        )
        assert least <= error < most
        assert bool(warnings) is (modes < 3)
        if warnings:
            estimate = float(warnings[0].split("be ")[1].split(" m")[0]) / full.summary["max_deflection_m"]
            assert 0.4 * error < estimate < 1.7 * error


def test_errors_by_facets_follow_from_the_modes_that_a_link_has() -> None:
    """Departures by other facets have the freedoms of the modes alone, with their natural frequencies."""
    motion: list[Any] = []
    for modes in (2, 0):
        scenario = load(cantilever(6, modes, 1e-3)).scenario
        run(build(scenario), scenario, inspect=lambda *of: motion.append(SpatialKinematics(*of)))
    assert freedoms(motion[1])[0].shape[2] == 0
    W, K, _ = (each[0] for each in freedoms(motion[0]))
    mass = W.T @ motion[0].trajectory.mass @ W
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(mass, K)).real)
    assert len(squares) == 6
    first = ROOTS[0] ** 2 / LENGTH**2 * np.sqrt(E * Section(None, WIDTH, THICKNESS).second_moments[0] / LINE)
    assert np.sqrt(squares[0]) == pytest.approx(first, rel=2e-2)  # 1 / (4 n^2) is 0.7 %


@pytest.mark.parametrize("modes", [1, 2])
def test_in_stiff_sand_the_error_told_is_that_of_a_link_that_the_sand_holds(modes: int) -> None:
    """A blade dragged through sand that hardly lets it bend: alone it would bend far more."""
    blade = STRIP | {"length_m": 0.15, "width_m": 0.02, "facet_size_m": 0.01}
    blade["flexible"] = {"youngs_modulus_Pa": 2e8, "elements": 6, "bending_damping_N_m2_s": 1e-4}
    cart = {"type": "rigid", "mass_kg": 1.0, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), 1e-3)}
    joints = {
        "rail": {"type": "slider", "parent": "ground", "child": "cart", "axis": [1, 0, 0]},
        "clamp": {"type": "weld", "parent": "cart", "child": "blade", "rpy_deg": [0, 90, 0]},
    }
    ramp = {"type": "ramp", "from": 0, "to": 0.02, "duration_s": 0.1}
    bodies = {"cart": cart, "blade": blade}
    scene = {
        "model": {"in_space": True, "name": "dragged", "bodies": bodies, "joints": joints},
        "medium": "rft3d_sand",
        "bed": {"height_m": -0.03},
        "drives": {"rail": {"type": "motion", "position_m": ramp}},
        "solver": {"end_time_s": 0.1, "accuracy": 1e-3},
    }
    results = simulate(load(scene | {"method": reduced(modes)}))
    full = simulate(load(scene))
    error = apart(results, full, "blade") * full.summary["max_deflection_m"]
    (told,) = (warning for warning in results.warnings if "too few modes" in warning)
    assert error / 3.0 < float(told.split("be ")[1].split(" m")[0]) < 3.0 * error


def test_zero_modes_give_a_rigid_link_on_its_prescribed_motion() -> None:
    """The shipped whip on its mast, dragged for a tenth of a second: without modes it is the rigid one."""
    short = ["solver.end_time_s=0.1", "solver.accuracy=3e-3", "model.bodies.whip.flexible.elements=6"]
    config = ROOT / "configs" / "whip.yaml"
    runs = [simulate(load(config, [*short, f"method.reduced.modes={modes}"])) for modes in (0, 3)]
    rigid = simulate(load(config, [*short[:2], "model.bodies.whip.flexible=null"]))
    assert np.abs(runs[0]["whip_deflection_y_m"]).max() < 1e-12
    for axis in "xyz":
        assert runs[0][f"tip_{axis}_m"][-1] == pytest.approx(rigid[f"tip_{axis}_m"][-1], abs=1e-5)
    assert np.abs(runs[1]["whip_deflection_y_m"]).max() > 1e-3
    for each in runs:
        assert each["mast_angle_deg"][-1] == pytest.approx(rigid["mast_angle_deg"][-1], abs=1e-9)
        assert each["drive_work_J"][-1] > 0.0


def test_link_held_by_its_tip_has_the_same_modes() -> None:
    by_root, by_tip = cantilever(6, 2, 0.02), cantilever(6, 2, 0.02)
    by_tip["model"]["joints"]["wall"] |= {"child_point_m": [LENGTH, 0, 0], "rpy_deg": [0, 0, 180]}
    held_by_root, held_by_tip = (simulate(load(scene)) for scene in (by_root, by_tip))
    assert held_by_root["strip_z_m"][-1] < -1e-4
    assert held_by_tip["strip_z_m"][-1] == pytest.approx(held_by_root["strip_z_m"][-1], rel=1e-6)


# ---- what is refused, and what is kept ----


def carrying() -> Config:
    scene = swung()
    scene["model"]["joints"]["end"] |= {"type": "ball"}
    return scene


def between() -> Config:
    scene = swung()
    scene["model"]["joints"]["clamp"] |= {"child_point_m": [0.1, 0, 0]}
    return scene


def stretching() -> Config:
    scene = swung()
    scene["model"]["bodies"]["strip"]["flexible"] |= {"axial_stiffness_N": 1e5}
    return scene


def rigid() -> Config:
    scene = swung()
    scene["model"]["bodies"]["strip"].pop("flexible")
    return scene


@pytest.mark.parametrize(
    ("scene", "method", "message"),
    [
        (carrying(), reduced(1), "method: strip carries weight, which moves against it"),
        (between(), reduced(1), "method: strip is held between its ends"),
        (stretching(), reduced(1), "method: strip stretches"),
        (rigid(), reduced(1), "method.reduced.modes: got 1, but the model has no link that bends: allowed is 0"),
        (swung(), reduced(7), "method.reduced.modes: got 7, but strip has 6 elements"),
        (swung(), {"reduced": {"rtol": 1e-4}}, "method.reduced.rtol: got 0.0001, which is of the plane"),
        (swung(), {"reduced": {"static": "true_sign"}}, "method.reduced.static: got true_sign, which is of the plane"),
        (swung() | {"initial": {"settle": True}}, reduced(1), "method: initial.settle is true"),
    ],
)
def test_scenes_without_modal_reduction_are_refused_with_the_key(scene: Config, method: Config, message: str) -> None:
    assert message in message_of(CONFIG_OR_SCENE, lambda: build(load(copy.deepcopy(scene) | {"method": method})))


def test_the_choice_survives_a_file_and_the_command_keeps_the_accuracy(tmp_path: Any) -> None:
    scenario = load(swung() | {"method": reduced(2)}).scenario
    assert SpatialScenario.model_validate(scenario_to_dict(scenario)) == scenario
    out = tmp_path / "out"
    whip = ["run", str(ROOT / "configs" / "whip.yaml"), "--set", "solver.end_time_s=0.01", "--set"]
    whip += ["solver.accuracy=3e-3", "--method", "reduced", "--modes", "2", "--no-plots", "--out", str(out)]
    assert cli.main(whip) == 0
    kept = load(out / "scenario.yaml").scenario
    assert (kept.method.reduced.modes, kept.solver.accuracy) == (2, 3e-3)
