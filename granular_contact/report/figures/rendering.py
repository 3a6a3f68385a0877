"""Pictures of a motion in space by VTK (pyvista), off-screen: shaded bodies with edges and shadows, on the sand.

They need the extra `render`. Without it, or without OpenGL, `animation` draws the side view instead.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont
from scipy.interpolate import RegularGridInterpolator

from granular_contact.geometry import rotations
from granular_contact.report.figures.animation import Picture, pace_text, time_text
from granular_contact.report.figures.style import INK, SAND, SAND_EDGE, VERMILION
from granular_contact.report.units import Array, round_below, sized
from granular_contact.results import Results
from granular_contact.results.motion import Motion

WIDTH, HEIGHT = 640, 400  # px
AZIMUTH, ELEVATION, OPENING = 25.0, 22.0, 20.0  # degrees: camera from the front, to the right and up; angle of view
FIRST, OTHERS = "#D3D7DB", ("#7FA9C9", "#A9C4D8")  # colours of the first body, and of the others in turn
EDGE, SHADOW, SKY = "#1F4058", "#D5C296", "#F6F8FA"
# Direction to each light, and its brightness.
LIGHTS = (((-0.45, -0.55, 1.0), 0.85), ((0.9, -0.5, 0.4), 0.35), ((0.0, -0.4, 0.2), 0.25))
FILLED = 0.85  # share of the height or width of a picture that the box of all bodies at all instants fills
SHARP = 30.0  # degrees between two faces, above which their edge is drawn
SEEN = 0.3  # share of the light of bodies under the surface that shows through it
BEYOND = 3.0  # extent of the surface beyond the motion, over the size of the scene
LIFTED = 1e-3  # height of shadows above the surface, over the size of the scene
FALLS = 4  # iterations that find where the light through a point meets the surface; 1 suffices for a level one
LONGEST, LEAST = 0.3, 0.02  # length of the longest arrow over the size of the scene; least force drawn over the largest
HEAD = 0.04  # length of an arrow's head over the size of the scene
MARGIN, LINE = 0.03, 0.028  # of texts: margin and height, over the width of the picture


_TRIAL = "import pyvista as p; q = p.Plotter(off_screen=True); q.add_mesh(p.Cube()); q.screenshot(return_img=True)"


@lru_cache(maxsize=1)
def works() -> bool:
    """Return whether pyvista is installed and can draw off-screen on this machine.

    It is tried in a separate process, because without a driver VTK may end the process.
    """
    if find_spec("pyvista") is None:
        return False
    return subprocess.run([sys.executable, "-c", _TRIAL], capture_output=True).returncode == 0


def pictures(results: Results, width: int = WIDTH, height: int = HEIGHT) -> Iterator[Picture]:
    """Yield a picture (height, width, 3) of each instant of a run in space, with name, pace and the largest force."""
    motion = results.motion
    assert motion is not None
    stage = Stage(motion, width, height)
    captions = _Captions(results.name.replace("_", " "), pace_text(motion.time), stage.legend)
    try:
        for k, time in enumerate(motion.time):
            yield captions.on(stage.picture(k), time_text(float(time), float(motion.time[-1])))
    finally:
        stage.close()


class Stage:
    """Scene of a motion in space with camera and lights, which is set to one instant after another."""

    def __init__(self, motion: Motion, width: int, height: int) -> None:
        import pyvista

        pyvista.vtk_verbosity("off")  # else it says on stderr that there is no display
        self._pv, self._motion = pyvista, motion
        self._plotter: Any = pyvista.Plotter(off_screen=True, window_size=[width, height], lighting="none")
        self._plotter.set_background(SKY)
        self._low, self._high = _bounds(motion)
        self._size = float(np.linalg.norm(self._high - self._low))
        forces = [np.linalg.norm(force, axis=1) for _, force in motion.forces.values()]
        self._largest = max((float(np.nanmax(sizes, initial=0.0)) for sizes in forces), default=0.0)
        self._height: Any = None
        self._step = round_below(0.35 * self._size)
        self._bodies = [self._body(i) for i in range(len(motion.parts))]
        self._ground()
        self._camera_and_lights()

    @property
    def legend(self) -> list[str]:
        """Texts on the scale of arrows and of the grid."""
        arrows = [f"longest arrow {sized(self._largest, 'N', '.2g')}"] if self._largest > 0.0 else []
        return arrows + ([] if self._height is None else [f"grid {sized(self._step, 'm', 'g')}"])

    def close(self) -> None:
        """Release the off-screen window."""
        self._plotter.close()

    def picture(self, k: int) -> Picture:
        """Picture (height, width, 3) of the instant with index k."""
        poses = self._motion.poses[k]
        for i, (mesh, actors) in enumerate(self._bodies):
            if i in self._motion.bent:
                mesh.points = self._motion.bent[i][k]
                continue
            placed = np.eye(4)
            placed[:3, :3], placed[:3, 3] = rotations.of_quaternion(poses[i, 3:]), poses[i, :3]
            for actor in actors:
                actor.user_matrix = placed
        self._shadows(k)
        self._arrows(k)
        self._plotter.render()  # (a screenshot is that of the last time)
        return np.asarray(self._plotter.screenshot(return_img=True))[..., :3].copy()

    def _body(self, i: int) -> tuple[Any, list[Any]]:
        """Mesh of a part, and the actors of its faces and edges."""
        part = self._motion.parts[i]
        names = list(dict.fromkeys(other.name for other in self._motion.parts))
        k = names.index(part.name)
        mesh = self._pv.PolyData.from_regular_faces(part.points, part.faces)
        look: dict[str, Any] = {"color": OTHERS[k % 2] if k else FIRST, "smooth_shading": True, "specular": 0.15}
        if i in self._motion.bent:
            return mesh, [self._plotter.add_mesh(mesh, **look)]
        actors = [self._plotter.add_mesh(mesh, feature_angle=SHARP, split_sharp_edges=True, **look)]
        edges = mesh.clean().extract_feature_edges(feature_angle=SHARP, manifold_edges=False)
        if edges.n_points:
            actors.append(self._plotter.add_mesh(edges, color=EDGE, lighting=False, opacity=0.7))
        return mesh, actors

    def _ground(self) -> None:
        """Add the surface of the sand, with the lines of a grid; it is shaded only if it is not level."""
        if self._motion.ground is None:
            return
        x, y, z = self._motion.ground
        self._height = RegularGridInterpolator((x, y), z.T, bounds_error=False, fill_value=None)
        reach = BEYOND * self._size  # where it goes on as steep as at its edges
        x, y = (np.array([at[0] - reach, *at, at[-1] + reach]) for at in (x, y))
        z = self._height(tuple(np.meshgrid(x, y)))
        ground = self._pv.StructuredGrid(*np.meshgrid(x, y), z)
        uneven = float(np.ptp(z)) > 0.0
        self._plotter.add_mesh(ground, color=SAND, opacity=1.0 - SEEN, lighting=uneven, smooth_shading=uneven)
        lines = self._pv.MultiBlock()
        for axis, along in enumerate((x, y)):
            first, last = np.ceil(along[0] / self._step), np.floor(along[-1] / self._step)
            for at in self._step * np.arange(first, last + 1):
                lines.append(ground.slice(normal=np.eye(3)[axis], origin=at * np.eye(3)[axis]))
        self._plotter.add_mesh(lines.combine(), color=SAND_EDGE, line_width=0.6, lighting=False, opacity=0.5)

    def _camera_and_lights(self) -> None:
        a, e = np.radians(AZIMUTH), np.radians(ELEVATION)
        toward = np.array([np.sin(a) * np.cos(e), -np.cos(a) * np.cos(e), np.sin(e)])
        middle, camera = 0.5 * (self._low + self._high), self._plotter.camera
        camera.focal_point, camera.position = middle, middle + 3.0 * self._size * toward
        camera.up, camera.view_angle = (0.0, 0.0, 1.0), OPENING
        self._plotter.reset_camera(bounds=tuple(np.ravel(np.column_stack([self._low, self._high]))))
        ratio = float(np.divide(*self._plotter.window_size))
        camera.view_angle = opening(np.array(camera.position), middle, self._low, self._high, ratio)
        for direction, intensity in LIGHTS:
            place = middle + self._size * np.array(direction)
            light = self._pv.Light(position=place, focal_point=middle, intensity=intensity, light_type="scene light")
            light.positional = False
            self._plotter.add_light(light)
        self._plotter.enable_anti_aliasing("ssaa")

    def _shadows(self, k: int) -> None:
        """Draw shadows: bodies projected onto the surface along the direction of the first light."""
        if self._height is None:
            return
        light, shadows = np.array(LIGHTS[0][0]), self._pv.MultiBlock()
        for i, part in enumerate(self._motion.parts):
            points = self._motion.points(i, slice(k, k + 1))[0]
            fallen = points.copy()
            for _ in range(FALLS):
                above = np.maximum(points[:, 2] - self._height(fallen[:, :2]), 0.0)
                fallen = points - above[:, None] / light[2] * light
            fallen[:, 2] = self._height(fallen[:, :2]) + LIFTED * self._size
            shadows.append(self._pv.PolyData.from_regular_faces(fallen, part.faces))
        self._renew("shadows", shadows, color=SHADOW, lighting=False)

    def _arrows(self, k: int) -> None:
        arrows = self._pv.MultiBlock()
        for at, force in self._motion.forces.values():
            size = float(np.linalg.norm(force[k]))
            if size > LEAST * self._largest:  # (not where it is not a number)
                length = LONGEST * self._size * size / self._largest
                head = min(0.6, HEAD * self._size / length)
                look = {"tip_length": head, "tip_radius": 0.3 * head, "shaft_radius": 0.1 * head}
                arrows.append(self._pv.Arrow(start=at[k], direction=force[k], scale=length, **look))
        self._renew("forces", arrows, color=VERMILION, ambient=0.2)

    def _renew(self, name: str, made: Any, **look: Any) -> None:
        """Replace the meshes of this name."""
        if len(made):
            self._plotter.add_mesh(made.combine(), name=name, reset_camera=False, render=False, **look)
        else:
            self._plotter.remove_actor(name, render=False)


class _Captions:
    """Texts on all pictures: name, pace and scale; and the time."""

    def __init__(self, name: str, pace: str, legend: list[str]) -> None:
        self.name, self.pace, self.legend = name, pace, "    ".join(legend)

    def on(self, picture: Picture, clock: str) -> Picture:
        """Write the texts on a picture."""
        height, width, _ = picture.shape
        image = Image.fromarray(picture)
        draw = ImageDraw.Draw(image)
        plain, bold = (_font(style, round(LINE * width)) for style in ("", "-Bold"))
        edge, top = MARGIN * width, 0.03 * height
        draw.text((edge, top), self.name, INK, bold, "la")
        draw.text((width / 2, top), clock, INK, bold, "ma")
        draw.text((width - edge, top), self.pace, INK, plain, "ra")
        draw.text((edge, height - top), self.legend, INK, plain, "ld")
        return np.asarray(image)


@lru_cache(maxsize=4)
def _font(style: str, size: int) -> Any:
    """Font that is part of matplotlib."""
    return ImageFont.truetype(Path(matplotlib.get_data_path()) / f"fonts/ttf/DejaVuSans{style}.ttf", size)


def opening(place: Array, middle: Array, low: Array, high: Array, ratio: float) -> float:
    """Vertical angle of view (deg) of a camera at `place` (3,) m towards `middle`, for which a box fills the picture.

    low, high: corners of the box (3,) m; ratio: width to height of the picture.
    """
    ahead = (middle - place) / np.linalg.norm(middle - place)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    corners = np.array(np.meshgrid(*np.column_stack([low, high]))).reshape(3, -1).T - place
    across, upright = np.abs(corners @ np.column_stack([right, np.cross(right, ahead)]) / (corners @ ahead)[:, None]).T
    return float(np.degrees(2.0 * np.arctan(max(upright.max(), across.max() / ratio) / FILLED)))


def _bounds(motion: Motion) -> tuple[Array, Array]:
    """Corners (3,) m of the box around all bodies at all instants."""
    points = np.concatenate([motion.points(i).reshape(-1, 3) for i in range(len(motion.parts))])
    return points.min(axis=0), points.max(axis=0)
