"""The granular load of a bed in the world of a model, and the same load with other facets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.engines.mujoco import geoms
from granular_contact.engines.mujoco.engine import mujoco
from granular_contact.laws.static_friction import Smooth
from granular_contact.sand import contact_lines
from granular_contact.sand.bed_arguments import direction
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.load import GranularLoad

Vector = NDArray[np.float64]
# Factor on the displacement, over that of Exudyn, over which the loading of a face that rests is spread in space. A
# step of MuJoCo takes the stiffness of the face once, at its start; with a factor of 1 a robot on two round legs creeps
# at steps of 1 ms.
WIDER = 3.0
SLIDES = 1e-6  # m/s: above it static resistance is fully mobilised where the error of facets is estimated


class BedLoad:
    """A granular load in the plane or in space, and the shapes added to it.

    up (3,): unit vector, world frame. plane (3,): horizontal direction of the plane, world frame; None in space.
    options: keyword arguments that `GranularLoad` and `SpatialLoad` have in common. turn (3, 3): rotation from the
    world to the frame of the bed.
    """

    def __init__(
        self, medium: Any, surface: ArrayLike, up: Vector, plane: ArrayLike | None, form: str, options: dict[str, Any]
    ) -> None:
        self._medium, self._surface, self._form, self._options = medium, surface, form, options
        self.up, self.planar = up, plane is not None
        self._shapes: list[tuple[tuple[Any, ...], dict[str, Any]]] = []
        if plane is None and form != "distributed":
            raise ValueError(f"form: got {form!r}, allowed in space (without plane) is 'distributed'")
        if plane is not None:
            unit = direction("plane", plane)
            horizontal = unit - (unit @ up) * up
            if np.linalg.norm(horizontal) < 1e-12:
                raise ValueError(f"plane: got {np.asarray(plane).tolist()}, which is along up; allowed is across it")
            horizontal = horizontal / np.linalg.norm(horizontal)
            self.turn: Vector = np.array([horizontal, np.cross(up, horizontal), up])
        self.load = self._make_load(options)
        if not self.planar:
            self.turn = self.load.turn

    def _make_load(self, options: dict[str, Any]) -> Any:
        """Load without shapes."""
        if self.planar:
            return GranularLoad(self._medium, self._surface, **options, form=self._form)
        from granular_contact.sand.space.load import SpatialLoad

        return SpatialLoad(self._medium, self._surface, up=self.up, **options, spread=WIDER)

    def add_shape(self, body: Body, shape: Any, position: Vector, rotation: Vector, **sizes: Any) -> None:
        """Let the medium act on a shape in space; arguments as in `SpatialLoad.add_shape`."""
        self._shapes.append(((body, shape, position, rotation), sizes))
        self.load.add_shape(body, shape, position, rotation, **sizes)

    def add_section(self, model: Any, body: Body, geom: geoms.Geom) -> None:
        """Let the medium act on the section of a geom with the plane."""
        s, t = self.axes_in(model, geom.body)
        if geom.kind == geoms.KIND.mjGEOM_SPHERE:
            centre, mass = [geom.position @ s, geom.position @ t], float(model.body_mass[geom.body])
            self.load.add(contact_lines.ball(body, centre, 2.0 * float(geom.size[0]), mass))
            return
        corners, width, turns = geoms.section(geom, s, t)
        self.load.add(contact_lines.outline(body, corners, width, turns=turns))

    def with_facets(self, share: float, bodies: int) -> Any:
        """Load in space on the bodies (their number) with a share of the size of facets; no bristles, no scatter."""
        load = self._make_load(self._options | {"static": Smooth(SLIDES)})
        for shape, sizes in self._shapes:
            load.add_shape(*shape, **sizes, share=share)
        load.close()
        for batch in load.batches:
            batch.clusters["scatter"] = 0.0
        load.start(np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], bodies))
        return load

    @property
    def shape_kinds(self) -> set[str]:
        """Kinds of shapes that the laws of the media take in space: "surface", "bar", "ball"."""
        from granular_contact.sand.space.load import element_kinds

        return {kind for medium in self.load.media for kind in element_kinds(medium)}

    def height(self, position: Vector) -> float:
        """Height (m) of the surface along `up` at a position (3,) m, world frame."""
        x, y, _ = self.turn @ position
        if self.planar:
            profile = self.load.profile
            return float(np.interp(x, profile[:, 0], profile[:, 1]))
        ground = np.asarray(self.load.ground, float)
        return float(ground[0] + ground[1] * x + ground[2] * y)

    def axes_in(self, model: Any, body: int) -> tuple[Vector, Vector]:
        """Axes s and t (3,) of the plane in the frame of a body.

        s is the x axis of the body projected onto the plane, or its y axis if the x axis lies across the plane. t is
        ahead of s by a quarter turn from `plane` to `up`.
        """
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        across = data.xmat[body].reshape(3, 3).T @ -self.turn[1]
        axis = np.eye(3)[0 if abs(across[0]) < 0.9 else 1]
        s = direction("plane", axis - (axis @ across) * across)
        return s, np.cross(across, s)
