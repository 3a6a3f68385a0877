"""The load of a bed in the world of a model, and once more with other facets."""

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
# In space the loading of a face that rests is spread over so much more of its bristles' yield than in Exudyn: MuJoCo's
# steps take its stiffness once, at their start, and with the narrower one a robot of two round legs creeps at 1 ms.
WIDER = 3.0
SLIDES = 1e-6  # m/s, from which on all resists where the error of facets is estimated


class BedLoad:
    """A granular load in the plane or in space, and the shapes added to it.

    up, plane: directions (3,) of the world, plane None in space; options: of `GranularLoad` and `SpatialLoad` alike.
    turn (3, 3): from the world to the frame of the bed.
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
            given = direction("plane", plane)
            along = given - (given @ up) * up
            if np.linalg.norm(along) < 1e-12:
                raise ValueError(f"plane: got {np.asarray(plane).tolist()}, which is along up; allowed is across it")
            along = along / np.linalg.norm(along)
            self.turn: Vector = np.array([along, np.cross(up, along), up])
        self.load = self._made(options)
        if not self.planar:
            self.turn = self.load.turn

    def _made(self, options: dict[str, Any]) -> Any:
        if self.planar:
            return GranularLoad(self._medium, self._surface, **options, form=self._form)
        from granular_contact.sand.space.load import SpatialLoad

        return SpatialLoad(self._medium, self._surface, up=self.up, **options, spread=WIDER)

    def add_shape(self, body: Body, shape: Any, place: Vector, turn: Vector, **sizes: Any) -> None:
        """`SpatialLoad.add_shape`."""
        self._shapes.append(((body, shape, place, turn), sizes))
        self.load.add_shape(body, shape, place, turn, **sizes)

    def add_section(self, model: Any, body: Body, one: geoms.Geom) -> None:
        """Let the medium act on the section of a geom with the plane."""
        along, up = self.axes_in(model, one.body)
        if one.kind == geoms.KIND.mjGEOM_SPHERE:
            centre, mass = [one.place @ along, one.place @ up], float(model.body_mass[one.body])
            self.load.add(contact_lines.ball(body, centre, 2.0 * float(one.size[0]), mass))
            return
        corners, width, turns = geoms.section(one, along, up)
        self.load.add(contact_lines.outline(body, corners, width, turns=turns))

    def with_facets(self, share: float, bodies: int) -> Any:
        """A load on so many bodies with a share of the size of facets, without bristles and what scatters."""
        load = self._made(self._options | {"static": Smooth(SLIDES)})
        for shape, sizes in self._shapes:
            load.add_shape(*shape, **sizes, share=share)
        load.close()
        for batch in load.batches:
            batch.clusters["scatter"] = 0.0
        load.start(np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], bodies))
        return load

    @property
    def met(self) -> set[str]:
        """As what the media meet bodies in space."""
        from granular_contact.sand.space.load import element_kinds

        return {kind for medium in self.load.media for kind in element_kinds(medium)}

    def height(self, place: Vector) -> float:
        """Height of the surface along `up` at a place (3,) m of the world."""
        x, y, _ = self.turn @ place
        if self.planar:
            profile = self.load.profile
            return float(np.interp(x, profile[:, 0], profile[:, 1]))
        ground = np.asarray(self.load.ground, float)
        return float(ground[0] + ground[1] * x + ground[2] * y)

    def axes_in(self, model: Any, body: int) -> tuple[Vector, Vector]:
        """The axes s and t of the plane in the frame of a body: s its x axis, or its y axis if that lies across."""
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        across = data.xmat[body].reshape(3, 3).T @ -self.turn[1]
        axis = np.eye(3)[0 if abs(across[0]) < 0.9 else 1]
        s = direction("plane", axis - (axis @ across) * across)
        return s, np.cross(across, s)
