"""Slopes beyond the angle of repose and gravity other than that of the tests: in configs and in beds of both kinds."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_models import one_body
from support_refusals import faults_of

from granular_contact import KatsuragiDurian, LinearDepth, Poncelet, load, preset
from granular_contact.errors import SceneError
from granular_contact.laws.gravity import at_gravity, gravity_notes
from granular_contact.laws.law import Law
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.scene import Scene, build

MOON, EARTH = 1.62, 9.81
ANGLE = 29.0  # of repose of cmu_dry_sand, as its authors give it


def planar(**keys: Any) -> dict[str, Any]:
    plate = {"type": "plate", "start_m": [-0.03, 0], "end_m": [0.03, 0], "width_m": 0.05, "thickness_m": 0.005}
    return {
        "model": {
            "name": "plate",
            "bodies": {"plate": {"type": "rigid", "density_kg_m3": 2700, "shapes": [plate]}},
            "joints": {"flight": {"type": "free", "parent": "ground", "child": "plate"}},
        },
        "medium": "cmu_dry_sand",
    } | keys


def spatial(**keys: Any) -> dict[str, Any]:
    box = {"type": "rigid", "density_kg_m3": 2000, "shapes": [{"type": "box", "size_m": [0.06, 0.04, 0.03]}]}
    return {"model": one_body("box", box), "medium": "cmu_dry_sand"} | keys


def scene(given: dict[str, Any]) -> Scene:
    return build(load(given))


BOTH = pytest.mark.parametrize("kind", [planar, spatial])


@BOTH
@pytest.mark.parametrize("sign", [1, -1])
def test_a_slope_steeper_than_the_angle_of_repose_is_refused(kind: Callable[..., dict[str, Any]], sign: int) -> None:
    scene(kind(bed={"slope_deg": sign * ANGLE}))
    (fault,) = faults_of(SceneError, scene, kind(bed={"slope_deg": sign * 30.5}))
    assert fault.key == "bed.slope_deg"
    assert "30.5 deg" in fault.message
    assert "cmu_dry_sand is 29 deg" in fault.message


@BOTH
def test_steepest_slope_is_that_of_the_media(kind: Callable[..., dict[str, Any]]) -> None:
    steep = {"slope_deg": 40}
    scene(kind(bed=steep, medium="rft3d_sand"))  # whose angle no source states
    scene(kind(bed=steep, medium={"from": "cmu_dry_sand", "angle_of_repose_deg": 41}))
    scene(kind(bed=steep, medium={"from": "cmu_dry_sand", "angle_of_repose_deg": None}))
    with pytest.raises(SceneError, match="cmu_dry_sand"):  # of several the first that slides, of layers too
        scene(kind(bed=steep | {"layers": [{"top_m": 0.1, "medium": "cmu_dry_sand"}]}, medium="rft3d_sand"))


def test_steep_pieces_of_a_profile_are_reported() -> None:
    step = [[-1, 0], [0, 0], [0.05, 0.05], [1, 0.05]]
    (note,) = scene(planar(bed={"profile_m": step})).notes
    assert note.key == "bed.profile_m"
    assert "2.5 % of the surface is up to 45 deg steep" in note.message  # 0.05 of 2 m
    assert "29 deg" in note.message
    assert not scene(planar(bed={"profile_m": [[-1, 0], [0, 0], [1, 0.5]]})).notes


def test_steep_places_of_a_map_are_reported(tmp_path: Path) -> None:
    def mapped(rise: float) -> tuple[Any, ...]:
        heights = np.zeros((5, 11))
        heights[:, 6:] = 0.1 * rise  # one of ten columns of cells
        np.savetxt(tmp_path / "ground.csv", heights, delimiter=",")
        ground = {"file": str(tmp_path / "ground.csv"), "cell_m": 0.1, "corner_m": [-0.5, -0.2]}
        return scene(spatial(bed={"height_m": 0, "height_map": ground})).notes

    (note,) = mapped(0.7)
    assert note.key == "bed.height_map"
    assert "10 % of the surface is up to 34.99 deg steep" in note.message  # atan 0.7
    assert not mapped(0.5)


@pytest.mark.parametrize("slope", [math.tan(math.radians(30.0)), -0.7])
def test_steep_slopes_are_refused_in_the_plane_and_in_space(slope: float) -> None:
    sand = preset("cmu_dry_sand")
    with pytest.raises(ValueError, match=r"slope.*29 deg"):
        GranularLoad(sand, 0.0, slope=slope)
    with pytest.raises(ValueError, match=r"slope.*29 deg"):
        SpatialLoad(sand, 0.0, slope=(0.0, slope, 0.0))
    SpatialLoad(sand, 0.0, slope=(0.0, 0.0, 9.0))  # along up it is none


# ---- gravity ----


def test_a_stiffness_goes_with_gravity() -> None:
    # k proportional to g, the drag length without g: k of the preset, 72 N/m, over 6.06.
    beads = preset("glass_beads_katsuragi_durian")
    moon = at_gravity(beads, MOON)
    assert isinstance(moon, KatsuragiDurian)
    assert moon.stiffness == pytest.approx(72.0 * MOON / EARTH, rel=1e-12)
    assert moon.drag_length_per_diameter == 3.4
    assert at_gravity(beads, EARTH) is beads
    on_moon = preset("glass_beads_katsuragi_durian", measured_gravity_m_s2=MOON)
    assert at_gravity(on_moon, MOON) is on_moon


@pytest.mark.parametrize(
    ("medium", "message"),
    [
        (Poncelet(2.0, 0.5), "not known, so that they are used as they are: constant_force_N"),
        (Poncelet(0.0, 0.5), None),  # what is 0 is so anywhere
        (LinearDepth(50.0), "scaled from 9.81 to 1.62 m/s2: stiffness_N_m; say measured_gravity_m_s2"),
        (LinearDepth(50.0, measured_gravity=MOON), None),
        (LinearDepth(50.0, measured_gravity=EARTH), None),
        (preset("cmu_dry_sand_plate"), "k_phi_Pa, exponent"),
        (preset("cmu_dry_sand"), None),
        (preset("play_sand"), None),
        (preset("poppy_seeds_loose"), None),
        (preset("glass_beads_katsuragi_durian"), None),
    ],
    ids=lambda value: value.name if isinstance(value, Law) else "",
)
def test_assumptions_on_other_gravity_have_a_note(medium: Law, message: str | None) -> None:
    notes = list(gravity_notes(medium, MOON))
    assert not list(gravity_notes(medium, 9.80665))
    assert [message is not None and message in note for note in notes] == ([] if message is None else [True])
    for note in notes:
        assert "1.62 m/s2" in note
        assert medium.name in note


def test_other_gravity_gives_runs_a_note_and_beds_a_warning() -> None:
    (note,) = scene(planar(medium="cmu_dry_sand_plate", gravity_m_s2=MOON)).notes
    assert (note.key, "k_phi_Pa" in note.message) == ("medium", True)
    exu = pytest.importorskip("exudyn")
    from granular_contact import GranularBed

    with pytest.warns(UserWarning, match=r"k_phi_Pa, exponent") as caught:
        GranularBed(exu.SystemContainer().AddSystem(), preset("cmu_dry_sand_plate"), 0.0, gravity=MOON)
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        GranularBed(exu.SystemContainer().AddSystem(), preset("cmu_dry_sand"), 0.0, gravity=MOON)


def test_mujoco_beds_warn_too() -> None:
    mujoco = pytest.importorskip("mujoco")
    from granular_contact.mujoco import MujocoBed

    body = '<worldbody><body><freejoint/><geom size="0.02"/></body></worldbody>'
    model = mujoco.MjModel.from_xml_string(f'<mujoco><option gravity="0 0 -1.62"/>{body}</mujoco>')
    with pytest.warns(UserWarning, match=r"gravity is 1.62 m/s2.*k_phi_Pa"):
        MujocoBed(model, preset("cmu_dry_sand_plate", plate_width_m=0.02))


def test_every_preset_says_its_gravity() -> None:
    from granular_contact.config import load_medium, medium_names

    for name in medium_names():
        assert "measured_gravity" in load_medium(name).model_fields_set, name


@pytest.mark.parametrize("medium", ["cmu_dry_sand", None])
def test_gravity_that_points_out_of_the_medium_is_reported(medium: str | None) -> None:
    notes = [note for note in scene(planar(medium=medium, gravity_m_s2=-9.81)).notes if note.key == "gravity_m_s2"]
    assert len(notes) == (medium is not None)
    assert all("got -9.81" in note.message and "positive gravity is downward" in note.message for note in notes)
