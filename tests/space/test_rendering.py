"""Films of runs in space: shaded by VTK where the extra `render` is installed, else the side view."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from PIL import Image
from support_models import one_body
from support_results import make

from granular_contact import Results, load, simulate
from granular_contact.report.figures import film, rendering
from granular_contact.results.motion import Motion, Part

CORNERS = 0.02 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
FACES = np.array([face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])


@pytest.fixture
def vtk() -> None:
    """Skips where nothing can be rendered."""
    if not rendering.works():
        pytest.skip("pyvista is missing, or there is no OpenGL")


def falling(rise: float = 0.0) -> Motion:
    """A cube that comes down from 0.1 m to a surface through the origin, half into it, with a force at the end."""
    z = np.array([0.1, 0.05, 0.0])
    poses = np.column_stack([np.zeros((3, 2)), z, np.ones(3), np.zeros((3, 3))])[:, None]
    force = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 5.0]])
    grid = np.array([-0.2, 0.2])
    ground = grid, grid, rise * np.array([[-0.2, 0.2], [-0.2, 0.2]])
    forces = {"cube": (np.zeros((3, 3)), force)}
    return Motion(np.array([0.0, 0.1, 0.2]), (Part("cube", CORNERS, FACES),), poses, {}, forces, ground)


def near(picture: NDArray[np.uint8], colour: str, within: int = 40) -> NDArray[np.bool_]:
    return np.abs(picture.astype(int) - np.round(255 * np.array(to_rgb(colour)))).max(axis=2) < within


@pytest.mark.parametrize(
    ("installed", "message"), [(False, "pip install 'granular-contact[render]'"), (True, "OpenGL")]
)
def test_a_film_in_space_that_is_not_shaded_is_reported(
    installed: bool, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(film, "find_spec", lambda _: installed or None)
    monkeypatch.setattr(rendering, "works", lambda: False)
    in_space = dataclasses.replace(make(), motion=falling())
    assert message in film.why_flat(in_space)
    assert film.why_flat(make()) == ""
    monkeypatch.setattr(rendering, "works", lambda: True)
    assert film.why_flat(in_space) == ""


@pytest.mark.parametrize(("size", "fills"), [((1.0, 1.0, 9.0), 1), ((9.0, 1.0, 1.0), 0)])
def test_view_angle_fits_all_moving_bodies(size: tuple[float, float, float], fills: int) -> None:
    """Of a view from the front, by hand; a tall screw left the picture at its top."""
    half = 0.5 * np.array(size)
    angle = rendering.opening(np.array([0.0, -50.0, 0.0]), np.zeros(3), -half, half, 1.6)
    near_face = 50.0 - half[1]
    parts = half[[0, 2]] / near_face / np.tan(np.radians(angle / 2)) / (1.6, 1.0)
    assert parts[fills] == pytest.approx(rendering.FILLED)
    assert parts.max() == parts[fills]


@pytest.mark.usefixtures("vtk")
def test_pictures_show_a_falling_body_its_shadow_and_its_force_arrow() -> None:
    stage = rendering.Stage(falling(), 320, 240)
    high, _, low = (stage.picture(k) for k in range(3))
    stage.close()
    bodies = [
        np.argwhere(near(picture, rendering.FIRST, 30) & (np.ptp(picture.astype(int), axis=2) < 12))
        for picture in (high, low)
    ]
    assert bodies[0][:, 0].mean() < bodies[1][:, 0].mean() - 20  # px from the top
    shadows = [np.argwhere(near(picture, rendering.SHADOW, 12)) for picture in (high, low)]
    assert len(shadows[0]) > 100
    # The light comes from the left and the front, from above: the higher the body, the farther to the right.
    assert shadows[0][:, 1].mean() > shadows[1][:, 1].mean()
    # Arrows are the only things with so much more red than blue; how bright they are, the version of VTK decides.
    arrows = [(picture[..., 0].astype(int) - picture[..., 2] > 80).sum() for picture in (high, low)]
    assert arrows[0] == 0
    assert arrows[1] > 40


@pytest.mark.usefixtures("vtk")
def test_a_shadow_falls_on_a_slope() -> None:
    """Where the light through the middle of the cube meets the slope, by hand."""
    rise = 0.3
    stage = rendering.Stage(falling(rise), 160, 120)
    stage.picture(0)
    box = stage._plotter.actors["shadows"].bounds
    stage.close()
    light = np.array(rendering.LIGHTS[0][0])
    t = 0.1 / (light[2] - rise * light[0])  # 0.1 - t light_z = rise (0 - t light_x)
    # The corners are 0.02 m off; their shadows are so around that of the middle, to 0.02 (1 + |light| / light_z).
    assert box.x_min < -t * light[0] < box.x_max
    assert box.y_min < -t * light[1] < box.y_max
    assert box.z_min >= rise * box.x_min - 1e-4


@pytest.fixture(scope="module")
def fallen() -> Results:
    """A box thrown onto sand, with a few instants for a film."""
    body = {"type": "rigid", "density_kg_m3": 2000, "shapes": [{"type": "box", "size_m": [0.06, 0.04, 0.03]}]}
    start = {"joints": {"flight": {"z_m": 0.05, "rpy_deg": [20, 35, 10], "vz_m_s": -1}}}
    run = {"model": one_body("box", body), "medium": "rft3d_sand", "bed": {"height_m": 0.0}, "initial": start}
    return simulate(load(run | {"solver": {"end_time_s": 0.02}}), most_frames=5)


def film_of(results: Results, file: Path) -> tuple[int, tuple[int, int]]:
    """How many pictures a film has, and how large they are."""
    film.write(results, file)
    with Image.open(file) as shown:
        return shown.n_frames, shown.size


@pytest.mark.usefixtures("vtk")
def test_a_film_in_space_has_a_shaded_picture_of_each_instant(fallen: Results, tmp_path: Path) -> None:
    count, size = film_of(fallen, tmp_path / "fall.gif")
    assert count == len(fallen.motion.time)
    assert size == (rendering.WIDTH, rendering.HEIGHT)


def test_without_the_renderer_a_film_in_space_is_the_side_view(fallen: Results, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(rendering, "works", lambda: False)
    count, size = film_of(fallen, tmp_path / "fall.gif")
    assert count == len(fallen.motion.time)
    assert size != (rendering.WIDTH, rendering.HEIGHT)
