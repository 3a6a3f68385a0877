"""Links that bend in space: against theory and against the plane, whichever way they look, wherever they are held."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from support_bending import MODULUS, POISSON, THICKNESS, WIDTH, into_space, kirchhoff, order, pendulum, princeton
from support_models import one_body
from support_refusals import message_of
from support_runs import ROOT

from granular_contact import Results, Simulation, load, simulate
from granular_contact.engines.exudyn.build_in_space import build as assembled
from granular_contact.engines.exudyn.solve import solve
from granular_contact.errors import ConfigError, SceneError
from granular_contact.report.histories import groups
from granular_contact.sand.space.beam_shape import Beam
from granular_contact.scene import build
from granular_contact.scene.space.section import Section

pytestmark = pytest.mark.slow

Config = dict[str, Any]
SOFT = {"youngs_modulus_Pa": 2e9, "elements": 6}
ROD = {"type": "link", "length_m": 0.2, "diameter_m": 0.006, "density_kg_m3": 1200}
STRIP = {"type": "link", "length_m": 0.3, "width_m": 0.02, "thickness_m": 0.002, "density_kg_m3": 1200}
HUB = {"type": "rigid", "mass_kg": 0.2, "inertia_kg_m2": {"xx": 1e-4, "yy": 1e-4, "zz": 1e-4}}


def config(bodies: Config, joints: Config, **more: Any) -> Config:
    return {"model": {"in_space": True, "name": "bent", "bodies": bodies, "joints": joints}, **more}


def clamped(link: Config, flexible: Config, **more: Any) -> Config:
    return {"model": one_body("rod", link | {"flexible": flexible}, "wall", "weld"), **more}


def tip(results: Results) -> Any:
    return np.column_stack([results[f"tip_{axis}_m"] for axis in "xyz"])


# ---- theory ----


@pytest.mark.parametrize("angle", [0.0, 45.0, 90.0])
def test_a_strip_bends_as_a_rod_of_kirchhoff_does(angle: float) -> None:
    """Weight at the end of a strip whose section is turned: large bending about both axes, and torsion."""
    section = Section(None, WIDTH, THICKNESS)
    shear = MODULUS / (2.0 * (1.0 + POISSON))
    stiffness = np.array([shear * section.torsion_constant, *(MODULUS * section.second_moments)])
    exact = kirchhoff(8.896, angle, stiffness)[1:]
    counts, errors = [4, 8, 16], []
    for count in counts:
        results = simulate(load(princeton(8.896, angle, count)))
        bent = np.array([results[f"strip_deflection_{axis}_m"][0] for axis in "yz"])
        errors.append(float(np.linalg.norm(bent - exact) / np.linalg.norm(exact)))
    # By the rule of midpoints l^2 / 4 L^2 of a small deflection, which large ones change little.
    assert errors[1] == pytest.approx(0.25 / 8**2, rel=0.15)
    assert order(counts, errors) == pytest.approx(2.0, abs=0.1)


def test_frequencies_in_both_planes_and_in_torsion() -> None:
    """A cantilever's first two of bending in each plane, and the first of torsion; of the whole system, linearised."""
    length, E = STRIP["length_m"], 2e9
    strip = STRIP | {"width_m": 0.006}  # so slender that the rotary inertia of its section is nothing
    section = Section(None, strip["width_m"], strip["thickness_m"])
    line = strip["density_kg_m3"] * section.area
    squares = np.array([1.8751041, 4.6940911]) ** 2 / (2.0 * np.pi * length**2)
    about_y, about_z = (squares * np.sqrt(E * moment / line) for moment in section.second_moments)
    shear, polar = E / 2.6, STRIP["density_kg_m3"] * section.second_moments.sum()
    torsion = np.sqrt(shear * section.torsion_constant / polar) / (4.0 * length)
    counts, closest = [4, 8, 16], []
    for count in counts:
        scene = build(load(clamped(strip, SOFT | {"elements": count}, gravity_m_s2=0.0)))
        values = assembled(scene).mbs.ComputeODE2Eigenvalues(convert2Frequencies=True, useAbsoluteValues=True)[0]
        frequencies = np.real(values)
        exact = np.array([*about_y, about_z[0], torsion])
        closest.append([np.abs(frequencies / frequency - 1.0).min() for frequency in exact])
    for errors in np.transpose(closest).tolist():
        assert order(counts, errors) == pytest.approx(2.0, abs=0.2)
        assert errors[1] < 0.016  # 0.0016 to 0.013


def test_saint_venants_constant_of_torsion() -> None:
    """Roark's table: 0.1406 a^4 of a square, 0.229 a b^3 for a = 2 b, a b^3 / 3 of a thin strip."""
    assert Section(None, 1.0, 1.0).torsion_constant == pytest.approx(0.1406, rel=1e-3)
    assert Section(None, 0.5, 1.0).torsion_constant == pytest.approx(0.229 * 0.5**3, rel=2e-3)
    assert Section(None, 1.0, 1e-3).torsion_constant == pytest.approx(1e-9 / 3.0, rel=1e-3)


# ---- against the plane ----


@pytest.mark.parametrize(("bending", "elements", "slender"), [(15.1642, 8, 1.0), (0.15, 16, 4.0)])
def test_a_pendulum_in_space_moves_as_in_the_plane(bending: float, elements: int, slender: float) -> None:
    """Two different beams, cables of cubic elements and rigid elements with springs, each by steps of its own.

    Cables have no rotary inertia of their section, which in one of a hundredth of the stiffness changes waves of
    bending by 1.5e-4 of the way at the source's diameter; so that one is a fourth as thick. Both hardly stretch.
    """
    flat, deep = pendulum(bending, elements, slender), into_space(pendulum(bending, elements, slender), 130.0)
    flat["model"]["bodies"]["link"]["flexible"]["axial_stiffness_N"] = 6e6
    planar, spatial = simulate(load(flat)), simulate(load(deep))
    times = np.linspace(0.0, 0.025, 200)
    x, y = (np.interp(times, planar["time_s"], planar[name]) for name in ("tip_x_m", "tip_y_m"))
    turned = np.array([np.cos(np.radians(130.0)), np.sin(np.radians(130.0)), 0.0])
    along, up = (np.interp(times, spatial["time_s"], values) for values in (tip(spatial) @ turned, spatial["tip_z_m"]))
    way = float(np.sum(np.hypot(np.diff(x), np.diff(y))))
    assert np.hypot(along - x, up - y).max() < 1e-4 * way
    assert spatial.summary["max_deflection_m"] == pytest.approx(planar.summary["max_deflection_m"], rel=0.02)
    assert spatial.summary["max_depth_m"] == pytest.approx(planar.summary["max_depth_m"], rel=2e-3)
    assert not [planar for planar in spatial.warnings if "measured in" not in planar]  # of the diameter
    panels = [
        panel.title
        for group in groups(spatial.names, spatial.terms, lambda name: spatial[name])
        for panel in group.panels
    ]
    assert {"deflection of link", "greatest strain of links"} <= set(panels)
    figures = spatial.figures()
    assert set(figures) >= {"deflection", "views", "energy"}
    shown = " ".join(axes.get_ylabel() for axes in figures["deflection"].axes).split()
    assert {"deflection", "strain"} <= set(shown)


# ---- in sand ----


def leg(medium: str, link: Config, azimuth: float) -> Config:
    """A soft link that is swung into sand, askew: it bends about both axes and twists."""
    bodies = {"hub": HUB, "rod": link | {"flexible": SOFT | {"bending_damping_N_m2_s": 1e-4}}}
    swing = {"type": "hinge", "parent": "ground", "child": "hub", "axis": [0, 1, 0.5], "home_deg": 30}
    joints = {
        "swing": swing | {"rpy_deg": [0, 0, azimuth]},
        "clamp": {"type": "weld", "parent": "hub", "child": "rod", "rpy_deg": [30, 0, 0]},
    }
    solver = {"end_time_s": 0.03, "step_s": 2e-4, "rest_time_s": None, "tolerance": 1e-7}
    return config(
        bodies,
        joints,
        medium=medium,
        initial={"joints": {"swing": {"rate_rad_s": 4}}},
        solver=solver,
        gravity_m_s2=9.81,
    )


@pytest.mark.parametrize(("medium", "link"), [("play_sand", ROD), ("rft3d_sand", STRIP)])
def test_a_scene_turned_about_the_vertical_moves_alike(medium: str, link: Config) -> None:
    original, turned = (simulate(load(leg(medium, link, azimuth))) for azimuth in (0.0, 57.0))
    way = 4.0 * 0.2 * 0.03  # m, of the tip
    for name in ("rod_deflection_y_m", "rod_deflection_z_m", "rod_twist_deg", "tip_z_m"):
        arm = np.radians(0.2) if name.endswith("_deg") else 1.0  # m per degree, at the length of the link
        assert arm * np.abs(turned[name] - original[name]).max() < 1e-8 * way, name
    assert np.abs(original["rod_deflection_y_m"]).max() > 1e-4  # it does bend about both axes
    assert np.abs(original["rod_deflection_z_m"]).max() > 1e-4
    assert original.summary["energy"]["imbalance_relative"] < 1e-3
    assert original["granular_work_J"][-1] < -1e-3


BEDS: dict[str, Config] = {
    "level": {},
    "slope": {"slope_deg": 4, "slope_direction_deg": 220},
    "map": {"height_map": {"file": "hills.csv", "cell_m": 0.05, "corner_m": [-0.5, -0.5]}},
    "layers": {"layers": [{"top_m": 0.003, "medium": {"from": "play_sand", "density_kg_m3": 4000}}]},
    "floor": {"depth_m": 0.004, "floor": {"stiffness_N_m3": 1e7, "damping_s_m": 1.0}},
}


@pytest.mark.parametrize("name", BEDS)
def test_a_very_stiff_link_is_rigid_on_every_bed(name: str, tmp_path: Any) -> None:
    """Slope, map of heights, layers and floor meet the elements as they meet one bar."""
    x, y = np.meshgrid(*[-0.5 + 0.05 * np.arange(21)] * 2)
    np.savetxt(tmp_path / "hills.csv", 0.004 * np.sin(15.0 * x) * np.cos(12.0 * y), delimiter=",")
    bed = copy.deepcopy(BEDS[name]) | {"height_m": -0.095}
    if name == "map":
        bed["height_map"]["file"] = str(tmp_path / "hills.csv")
    rigid = leg("play_sand", ROD, 0.0) | {"bed": bed, "initial": {"joints": {"swing": {"rate_rad_s": 12}}}}
    stiff, level = copy.deepcopy(rigid), copy.deepcopy(rigid) | {"bed": {"height_m": -0.095}}
    for scene in (rigid, level):
        scene["model"]["bodies"]["rod"].pop("flexible")
    stiff["model"]["bodies"]["rod"]["flexible"] = {"youngs_modulus_Pa": 2e13, "elements": 6}
    tips = [tip(simulate(load(scene))) for scene in (rigid, stiff, level)]
    way = np.abs(np.diff(tips[0], axis=0)).sum()
    assert np.abs(tips[0][-1] - tips[1][-1]).max() < 3e-4 * way
    assert name == "level" or np.abs(tips[0][-1] - tips[2][-1]).max() > 3e-3 * way


def test_a_link_that_bends_rests_on_a_slope_by_its_bristles() -> None:
    """It falls 2 mm onto a slope of 15 deg, sinks in, and does not slide down."""
    flight = {"type": "free", "parent": "ground", "child": "rod"}
    start = {"flight": {"z_m": 0.003, "rpy_deg": [0, -15, 0]}}
    scene = config(
        {"rod": ROD | {"flexible": SOFT}}, {"flight": flight}, medium="play_sand", initial={"joints": start},
        bed={"height_m": 0.0, "slope_deg": 15}, solver={"end_time_s": 0.4, "accuracy": 1e-3},
    )  # fmt: skip
    results = simulate(load(scene))
    assert results.status.code == "rest"
    moved = [results[f"rod_{axis}_m"][-1] - results[f"rod_{axis}_m"][0] for axis in "xyz"]
    assert np.hypot(*moved[:2]) < 1e-3
    assert -5e-3 < moved[2] < -2e-3


def test_energy_is_kept_in_a_whirl_in_vacuum() -> None:
    """A strip that whirls askew about its end, bent by a thirteenth of its length: only damping takes energy."""
    flexible = {"youngs_modulus_Pa": 1.5e8, "torsion_damping_N_m2_s": 1e-5, "bending_damping_N_m2_s": 1e-5}
    scene = config(
        {"rod": STRIP | {"flexible": flexible}},
        {"pin": {"type": "ball", "parent": "ground", "child": "rod"}},
        initial={"joints": {"pin": {"spin_rad_s": [3, 6, 8]}}},
        solver={"end_time_s": 0.15, "accuracy": 1e-4},
    )
    results = simulate(load(scene))
    assert results.summary["max_deflection_m"] > 0.02
    assert results["damping_work_J"][-1] < -1e-5
    assert results.summary["energy"]["imbalance_relative"] < 1e-4


def test_the_whip_trails_behind_its_arm() -> None:
    """The shipped config, dragged for half a second: the tip lags along the way, and bends little across it."""
    results = simulate(
        load(
            ROOT / "configs" / "whip.yaml",
            ["solver.end_time_s=0.5", "solver.accuracy=3e-3", "model.bodies.whip.flexible.elements=8"],
        )
    )
    behind, across = results["whip_deflection_y_m"], results["whip_deflection_z_m"]
    assert behind[-1] < -0.025
    assert np.abs(across).max() < 0.5 * np.abs(behind).max()
    assert results["drive_work_J"][-1] > 0.9 * -results["granular_work_J"][-1] > 0.05
    places, forces = results.motion.forces["whip"]
    last = int(np.argmax(np.linalg.norm(forces, axis=1)))
    assert places[last, 2] < -0.25  # the force is drawn where the whip is immersed, below 0.26 m


# ---- where it is held ----


def test_the_engine_goes_on_after_a_try_that_ran_away() -> None:
    """The reed of docs/howto/bending_links.md: at 56 ms an iteration ends at 1e38 N, whose matrix has no factors."""
    reed = STRIP | {"length_m": 0.25, "width_m": 0.01, "thickness_m": 0.003}
    reed |= {"flexible": {"youngs_modulus_Pa": 2.5e9, "elements": 12, "bending_damping_N_m2_s": 1e-4}}
    post = {"type": "link", "length_m": 0.1, "diameter_m": 0.012, "density_kg_m3": 2700, "facet_size_m": 0.02}
    joints = {
        "mast": {"type": "hinge", "parent": "ground", "child": "post", "axis": [0, 0, 1]},
        "clamp": {"type": "weld", "parent": "post", "child": "reed"}
        | {"parent_point_m": [0.1, 0, 0], "rpy_deg": [30, 90, 0]},
    }
    turns = {"mast": {"type": "motion", "angle_deg": {"type": "ramp", "from": 0, "to": 60, "duration_s": 0.4}}}
    scene = config({"post": post, "reed": reed}, joints, medium="rft3d_sand", bed={"height_m": -0.2}, drives=turns)
    scene |= {"solver": {"end_time_s": 0.0565, "accuracy": 1e-3}, "method": "engine"}
    assert solve(assembled(build(load(scene)))).status.code == "end_time"


@pytest.mark.parametrize(
    ("elements", "stiffness", "method"),
    [(16, 0.5, "engine"), (16, 0.05, "engine"), (32, 0.5, "engine"), (32, 0.5, "minimal")],
)
def test_a_spring_that_is_let_go_gives_its_energy_to_the_link(elements: int, stiffness: float, method: str) -> None:
    """Its moment turns half an element in 0.1 us, after which the damping of the link holds that.

    By steps of their own, the shortest was not tried. By the engine, a step a thousand times too long was accepted
    because its error grew as it became shorter (0.9 % of the energy, 0.4 %), and a new attempt had the matrix of
    iterates at 1e16 N, which has no factors.
    """
    rod = {"type": "link", "length_m": 0.15, "diameter_m": 0.004, "density_kg_m3": 1400}
    rod |= {"flexible": {"youngs_modulus_Pa": 2e9, "elements": elements, "bending_damping_N_m2_s": 1e-4}}
    pin = {"type": "hinge", "parent": "ground", "child": "rod", "axis": [0, 1, 0], "home_deg": 30}
    pin["spring"] = {"stiffness_Nm_per_rad": stiffness}
    solver = {"end_time_s": 0.02, "accuracy": 1e-3}
    scene = config({"rod": rod}, {"pin": pin}, medium="rft3d_sand", bed={"height_m": -1.0}, solver=solver)
    results = simulate(scene | {"method": method})
    # Positions are right to the accuracy of their path, so energies to about as much.
    assert results.status.code == "end_time"
    assert results.summary["energy"]["imbalance_relative"] < 1e-3
    assert np.ptp(results["spring_J"]) > 0.5 * results["spring_J"][0]


def test_link_held_by_its_tip_moves_as_one_held_by_its_root() -> None:
    end = {"type": "hinge", "parent": "ground", "child": "rod", "axis": [0, 1, 0]}
    by_root = config({"rod": ROD | {"flexible": SOFT}}, {"pin": end}, solver={"end_time_s": 0.05, "step_s": 5e-4})
    by_tip = copy.deepcopy(by_root)
    by_tip["model"]["joints"]["pin"] |= {"child_point_m": [0.2, 0, 0], "rpy_deg": [0, 0, 180]}
    held_by_root, held_by_tip = (simulate(load(scene)) for scene in (by_root, by_tip))
    assert held_by_root["rod_z_m"][-1] == pytest.approx(held_by_tip["rod_z_m"][-1], rel=1e-6)
    assert held_by_root["elastic_J"].max() > 1e-9
    assert held_by_root["elastic_J"].max() == pytest.approx(held_by_tip["elastic_J"].max(), rel=1e-3)


def test_a_link_held_at_both_ends_is_a_beam_on_two_supports() -> None:
    """Own weight between a hinge and a slider with a hinge: it sags by 5 q L^4 / 384 EI in the middle."""
    flexible = {"youngs_modulus_Pa": 2e10, "elements": 16}
    bodies = {"rod": ROD | {"flexible": flexible}, "carriage": HUB, "half": HUB | {"mass_kg": 1e-6}}
    joints = {
        "left": {"type": "hinge", "parent": "ground", "child": "rod", "axis": [0, 1, 0]},
        "rail": {"type": "slider", "parent": "ground", "child": "carriage", "parent_point_m": [0.2, 0, 0]},
        "middle": {"type": "weld", "parent": "rod", "child": "half", "parent_point_m": [0.1, 0, 0]},
    }
    scene = config(bodies, joints, initial={"settle": True}, solver={"end_time_s": 2e-4, "step_s": 1e-4})
    right = {"type": "hinge", "parent": "rod", "child": "carriage", "axis": [0, 1, 0], "parent_point_m": [0.2, 0, 0]}
    scene["model"]["closures"] = {"right": right}
    results = simulate(load(scene))
    section = Section(0.006, 0.006, 0.006)
    sag = 5.0 / 384.0 * 1200 * 9.81 * section.area * 0.2**4 / (2e10 * section.second_moments[0])
    assert results["half_z_m"][0] == pytest.approx(-sag, rel=0.01)


def test_a_chain_of_links_that_bend_has_the_mass_of_rigid_ones() -> None:
    link = {"length_m": 0.1, "diameter_m": 0.006, "density_kg_m3": 1200}
    chain = {"count": 3, "link": link, "hinge": {"axes": [[0, 1, 0], [0, 0, 1]]}}
    scenes = []
    for more in ({}, {"flexible": SOFT}):
        model = {"in_space": True, "name": "chain", "chain": chain | {"link": link | more}}
        scenes.append(build(load({"model": model})))
    rigid, bent = scenes
    assert bent.mass == pytest.approx(rigid.mass, rel=1e-12)
    assert len(bent.beams) == 3
    assert bent.reported == ("link_1", "link_2", "link_3")
    moments = [sum(body.mass * body.motion.position for body in scene.rigid) for scene in scenes]
    assert np.allclose(*moments, rtol=1e-12)


# ---- what is told ----


def test_observations_are_named_as_columns_are() -> None:
    run = Simulation(load(leg("play_sand", ROD, 0.0)))
    run.reset()
    seen = dict(run.step({}, 0.01))
    results = run.results()
    names = {name for name in seen if not name.endswith(("_rad", "_contact"))}
    assert names <= set(results.names)
    for name in ("rod_x_m", "rod_pitch_deg", "rod_vz_m_s", "rod_spin_y_rad_s", "rod_granular_z_N", "rod_depth_m"):
        assert results[name][-1] == pytest.approx(seen[name], rel=1e-6, abs=1e-9), name


def test_a_link_that_bends_too_little_to_show_is_rigid_in_space() -> None:
    """As in the plane: its strains were round-off, and a stress of 6.6 TPa was told of an EI of 1e13 N m2.

    A force of 2 N bends the rod by 3e-6 of its length at 2e14 Pa, and 2 N by 3e-12 at 2e20 Pa.
    """
    shown, lost = (leg("play_sand", ROD, 0.0) for _ in range(2))
    shown["model"]["bodies"]["rod"]["flexible"] = {"youngs_modulus_Pa": 2e14, "elements": 6}
    lost["model"]["bodies"]["rod"]["flexible"] = {"youngs_modulus_Pa": 2e20, "elements": 6}
    assert [beam.name for beam in build(load(shown)).beams] == ["rod"]
    scene = build(load(lost))
    assert (scene.beams, scene.stiff) == ((), ("rod",))
    assert scene.mass == pytest.approx(build(load(shown)).mass, rel=1e-12)
    summary = simulate(scene).summary
    assert summary["too_stiff_to_bend"] == ["rod"]
    assert summary["status"] == "end_time"


def test_too_few_elements_are_reported_with_their_error() -> None:
    """From both sides: the error is told where it is large, and no more than twice as large as it is."""
    section = Section(None, WIDTH, THICKNESS)
    shear = MODULUS / (2.0 * (1.0 + POISSON))
    stiffness = np.array([shear * section.torsion_constant, *(MODULUS * section.second_moments)])
    exact = kirchhoff(8.896, 0.0, stiffness)[2]
    for count, warned in ((2, True), (8, False)):
        scene = princeton(8.896, 0.0, count)
        scene["solver"]["end_time_s"] = 5e-4
        results = simulate(load(scene))
        sentences = [warning for warning in results.warnings if "too few elements" in warning]
        assert bool(sentences) is warned
        if warned:
            error = abs(results["strip_deflection_z_m"][0] - exact)
            assert 0.5 * error < float(sentences[0].split("be ")[1].split(" m")[0]) < 2.0 * error


@pytest.mark.parametrize(
    ("link", "flexible", "key", "reason"),
    [
        (ROD, {"elements": 4}, "rod.flexible", "neither of bending_stiffness_N_m2 and youngs_modulus_Pa"),
        (ROD, SOFT | {"elements": 0}, "flexible.elements", "got the number 0"),
        (ROD | {"width_m": 0.01}, SOFT, "rod.diameter_m", "round or rectangular"),
        (STRIP, {"bending_stiffness_N_m2": 1.0}, "flexible.bending_stiffness_N_m2", "youngs_modulus_Pa"),
        (STRIP, SOFT | {"axial_damping_N_s": 1.0}, "flexible.axial_damping_N_s", "keeps its length"),
    ],
)
def test_impossible_bending_links_are_refused_with_the_key(
    link: Config, flexible: Config, key: str, reason: str
) -> None:
    message = message_of(ConfigError, load, clamped(link, flexible))
    assert key in message
    assert reason in message


def test_a_strip_in_a_medium_of_bars_is_refused_by_the_name_of_the_link() -> None:
    with pytest.raises(SceneError, match=r"model\.bodies\.rod: its beam can get into the sand, but in space"):
        build(load(clamped(STRIP, SOFT, medium="play_sand")))


def test_rigid_links_are_cylinders_and_bending_links_small_facets() -> None:
    rigid = build(load(leg("rft3d_sand", ROD, 0.0) | {"model": clamped_to_hub(ROD)})).rigid[0]
    (shape,) = [(type(part.shape).__name__, part.facet_size) for part in rigid.parts]
    assert shape == ("Cylinder", None)
    bent = build(load(leg("rft3d_sand", ROD, 0.0)))
    sizes = {part.facet_size for body in bent.rigid for part in body.parts}
    assert max(sizes) == pytest.approx(0.2 / SOFT["elements"] / 4.0)
    assert min(sizes) == pytest.approx(max(sizes))


def clamped_to_hub(link: Config) -> Config:
    """The model of `leg` with a rigid link."""
    model = copy.deepcopy(leg("rft3d_sand", link, 0.0)["model"])
    model["bodies"]["rod"].pop("flexible")
    return model


def test_pieces_are_open_where_the_bar_goes_on() -> None:
    """All faces of a closed surface add up to none; without its ends a piece lacks their area."""
    for size, round_ in (((0.008, 0.008), True), ((0.02, 0.003), False)):
        area = Section(size[0] if round_ else None, *size).area
        for ends in ((True, True), (False, True), (True, False), (False, False)):
            corners = Beam(0.03, size, round_, ends).corners()
            vectors = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            lacks = (int(ends[1]) - int(ends[0])) * area
            assert vectors.sum(axis=0) == pytest.approx([lacks, 0.0, 0.0], abs=1e-9 * area + 1e-15)
            middle = corners.mean(axis=1)
            assert (np.sum(middle[:, 1:] * vectors[:, 1:], axis=1) > -1e-18).all()  # they look outward
