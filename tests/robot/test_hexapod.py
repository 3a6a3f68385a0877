"""The hexapod from its own robot file: its files are what its script makes, it walks, and so does its mirror image."""

from __future__ import annotations

import importlib.util
import math
import re
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from lxml import etree
from support_runs import ROOT

from granular_contact import config
from granular_contact.geometry.mesh import read
from granular_contact.mechanics.stepping import arm
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build

FOLDER = ROOT / "models" / "hexapod"
LEGS = [f"{place}_{side}" for place in ("front", "middle", "rear") for side in ("left", "right")]


def maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_hexapod", FOLDER / "make_hexapod.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_hexapod_files_are_those_of_its_script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By value: the last digits are the processor's."""
    module = maker()
    monkeypatch.setattr(module, "HERE", tmp_path)
    module.main()
    for name in ("meshes/trunk.stl", "meshes/leg.stl"):
        (made, faces), (kept, same) = read(tmp_path / name), read(FOLDER / name)
        np.testing.assert_array_equal(faces, same)
        np.testing.assert_allclose(made, kept, atol=1e-7 * np.abs(kept).max())  # of single precision, 6e-8
    made, kept = (values(etree.parse(folder / "hexapod.urdf").getroot()) for folder in (tmp_path, FOLDER))
    assert [key for key, _ in made] == [key for key, _ in kept]
    for (key, value_made), (_, value_kept) in zip(made, kept, strict=True):
        assert value_made == value_kept or value_made == pytest.approx(value_kept, rel=2e-6), (
            key
        )  # 6 digits are written, the last may differ


def values(root: etree._Element) -> list[tuple[str, str | list[float]]]:
    """Every attribute of an XML tree in order, as numbers where it holds numbers."""
    number = re.compile(r"[-+.\d][-+.\de ]*")
    return [
        (f"{element.tag}.{key}", [float(word) for word in text.split()] if number.fullmatch(text) else text)
        for element in root.iter(etree.Element)
        for key, text in element.attrib.items()
    ]


def test_round_off_is_written_as_zero() -> None:
    """A zero of exact geometry is a zero in the files, on every processor."""
    numbers = [x for _, parsed in values(etree.parse(FOLDER / "hexapod.urdf").getroot()) for x in parsed if x != 0.0]
    assert min(abs(x) for x in numbers if isinstance(x, float)) > 1e-9
    for mesh in (*(FOLDER / "meshes").glob("*.stl"), ROOT / "models" / "screw" / "blade.stl"):
        held = np.fromfile(mesh, np.dtype([("numbers", "<f4", 12), ("more", "<u2")]), offset=84)["numbers"]
        assert np.abs(held[held != 0.0]).min() > 1e-9, mesh


def test_the_mass_of_a_leg_is_that_of_a_bent_bar() -> None:
    """Of many segments the leg is half a ring: the centre and the moments of one, in closed form."""
    module = maker()
    module.SEGMENTS = 400
    center, tensor = module.mass_properties(module.prism(module.c_section(), module.LEG_WIDTH), 1.0)
    R, t, w = module.RADIUS, module.THICKNESS, module.LEG_WIDTH
    outer, inner = R + t / 2, R - t / 2
    assert center[0] == pytest.approx(-4 / (3 * math.pi) * (outer**3 - inner**3) / (outer**2 - inner**2), rel=1e-4)
    assert center[2] == pytest.approx(-R, rel=1e-12)
    about_ring = (outer**2 + inner**2) / 2  # polar, about the axis of the ring
    assert tensor[1, 1] == pytest.approx(about_ring - center[0] ** 2, rel=1e-4)
    assert tensor[0, 0] == pytest.approx(about_ring / 2 + w * w / 12, rel=1e-4)


@cache
def walk(*sets: str, mirrored: bool = False, end: float = 0.25) -> Results:
    """The first steps; mirrored: left legs do what right ones did."""
    sets = (*sets, f"solver.end_time_s={end}")
    if mirrored:
        phases = zip(LEGS, (1, 0, 0, 1, 1, 0), strict=True)
        sets += tuple(f"drives.hip_{leg}.angle_deg.phase_deg={180 * phase}" for leg, phase in phases)
    loaded = config.load(ROOT / "configs" / "hexapod.yaml", sets)
    return run(build(loaded), loaded.scenario)


def test_hexapod_walks_ahead_on_three_legs() -> None:
    # At the config's 1e-2 the imbalance of so short a run is 4e-4 to 19e-4, at 3e-3 it is 1e-4.
    results = walk("solver.accuracy=3e-3")
    assert results.status.code == "end_time"
    assert results.warnings == ()
    assert results.summary["energy"]["imbalance_relative"] <= 5e-4
    # A toe 60 mm below its hip sweeps 60 deg in 0.55 of a second: so fast without slip, about the middle of the stance.
    t, x = results["time_s"], results["trunk_x_m"]
    speed = np.polyfit(t[t > 0.1], x[t > 0.1], 1)[0]
    without_slip = 0.06 * math.radians(60) / 0.55
    assert 0.8 * without_slip < speed < 1.1 * without_slip
    contacts = results.summary["contacts"]
    assert [leg for leg in LEGS if contacts[f"leg_{leg}"] and contacts[f"leg_{leg}"][0][0] < 0.1] == [
        "front_left", "middle_right", "rear_left"
    ]  # fmt: skip
    assert contacts["trunk"] == []
    # The three carry its weight: the mean force over whole time but for what accelerates it.
    late = t > 0.1
    rise = np.ptp(results["trunk_vz_m_s"][late][[0, -1]]) / np.ptp(t[late])
    force = sum(results[f"leg_{leg}_granular_z_N"] for leg in LEGS)
    mean = np.trapezoid(force[late], t[late]) / np.ptp(t[late])
    assert mean == pytest.approx(1.44 * 9.81, abs=1.44 * rise + 1.0)


def test_mirrored_hexapod_walks_in_mirrored_steps() -> None:
    """Up to what steps and Newton's method leave, as legs stand in another order: far below the sway of the trunk."""
    fine = "solver.accuracy=1e-3"
    original, mirrored_walk = walk(fine), walk(fine, mirrored=True)
    t = np.linspace(0.0, 0.25, 26)
    signs = {
        "trunk_x_m": 1,
        "trunk_y_m": -1,
        "trunk_z_m": 1,
        "trunk_roll_deg": -1,
        "trunk_pitch_deg": 1,
        "trunk_yaw_deg": -1,
    }
    for column, sign in signs.items():
        walked, expected = (np.interp(t, each["time_s"], each[column]) for each in (original, mirrored_walk))
        assert np.ptp(walked) > (0.2 if column.endswith("deg") else 1e-3)
        np.testing.assert_allclose(walked, sign * expected, atol=1e-3 if column.endswith("deg") else 2e-6)


@pytest.mark.slow
def test_a_looser_accuracy_takes_fewer_steps_and_keeps_its_promise() -> None:
    # By order two steps are sqrt(100) times as long for a hundredth of the accuracy; where feet strike and signals bend
    # they are no longer than they were.
    runs = {}
    for accuracy in (1e-1, 1e-3):
        path = ROOT / "configs" / "hexapod.yaml"
        overrides = [f"solver.accuracy={accuracy}", "solver.end_time_s=0.3"]
        runs[accuracy] = run(build(config.load(path, overrides)))
    coarse, fine = (runs[accuracy] for accuracy in (1e-1, 1e-3))
    assert coarse.summary["cost"]["steps"] < 0.25 * fine.summary["cost"]["steps"]
    path = np.column_stack([fine[f"tip_{axis}_m"] for axis in "xyz"])
    way = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    t = coarse["time_s"]
    expected = np.column_stack([np.interp(t, fine["time_s"], column) for column in path.T])
    coarse_path = np.column_stack([coarse[f"tip_{axis}_m"] for axis in "xyz"])
    assert np.linalg.norm(coarse_path - expected, axis=1).max() < 0.1 * way


def test_lever_of_a_hip_is_the_reach_of_its_leg() -> None:
    scene = build(config.load(ROOT / "configs" / "hexapod.yaml"))
    for joint in scene.joints:
        if joint.kind == "hinge":
            assert (
                0.06 < arm(scene, joint) < 0.1 < scene.length
            )  # half a circle of radius 30 mm, around its centre of mass
