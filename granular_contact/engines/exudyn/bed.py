"""The plugin door: a granular bed that acts on bodies of any Exudyn model.

The load itself is `granular_contact.sand`, which knows no engine; how it gets into the system is `coupling`; what is
read of it there, `attached`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from granular_contact.engines.exudyn.attached import Attached
from granular_contact.engines.exudyn.coupling import Coupling
from granular_contact.errors import SceneError, scene_error
from granular_contact.laws.floor import Floor
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.contact_lines import ball, outline, planar, polyline
from granular_contact.sand.given import told
from granular_contact.sand.load import GranularLoad

if TYPE_CHECKING:
    from granular_contact.sand.space.shapes import Shape


class GranularBed(Attached):
    """Bed of one medium, or of several whose forces add, acting on the bodies named to it.

    Parameters
    ----------
    mbs : exudyn.MainSystem
        System whose bodies move in its x-y plane, y up.
    medium : Law, Layer, or sequence of these
        For example `preset("play_sand")`; a `Layer` is a medium between two depths. Where several lie, forces add.
    surface : float or (k, 2) array
        Height y of the level surface (m), or the corners x, y (m) of a surface of straight pieces, level beyond them.
        In space its height along `up`, where it is sloped that at the world origin.
    slope : float or, in space, (3,) array
        Rise per length of a surface given by its height, which is then that at x = 0; it has no end. In space the rise
        along each axis of the world.
    up : (3,) array, optional
        Makes the bed one in space, on rigid bodies that move as they like (`add_body`): the direction, in the world
        frame, against which depth is counted and gravity acts on the medium.
    gravity : float
        Magnitude of gravity (m/s2) in the static resistance of the medium.
    static : Elastoplastic or Smooth
        How the sign of the static resistance is regularised.
    form : {"distributed", "resultant"}
        Law integrated along the immersed part, or the source paper's single force at its middle.
    end_cap : bool
        Whether free end faces add to the drag.
    floor : Floor, optional
        Contact with a level floor; its work is kept apart from that of the media. Its stiffness is per area in space.

    Raises
    ------
    ValueError
        One of these, or a number of a medium, is not allowed.

    Notes
    -----
    Without `up` bodies move in the plane; a spatial one that leans out of it while it moves ends the solve with an
    error. `work`, `force`, `terms` and the whole `history` can be read at any time, during a solve or after it.
    A solve that starts when the last one ended, or in the state in which it ended, goes on with friction state and
    history as they are; any other resets them. A static solve moves bodies and leaves no history.
    """

    def __init__(
        self,
        mbs: Any,
        medium: Law | Layer | Sequence[Law | Layer],
        surface: ArrayLike,
        *,
        slope: ArrayLike = 0.0,
        up: ArrayLike | None = None,
        gravity: float = 9.81,
        static: Elastoplastic | Smooth | None = None,
        form: str = "distributed",
        end_cap: bool = False,
        floor: Floor | None = None,
    ) -> None:
        options: dict[str, Any] = {"slope": slope, "gravity": gravity, "static": static, "end_cap": end_cap}
        self.in_space = up is not None
        if up is None:
            self.load = GranularLoad(medium, surface, **options, form=form, floor=floor)
        else:
            if form != "distributed":
                raise ValueError(f"form: got {form!r}, allowed in space (with up) is 'distributed'")
            from granular_contact.sand.space.load import SpatialLoad

            self.load = SpatialLoad(medium, np.asarray(surface), **options, up=up, floor=floor)
        self.mbs, self.coupling = mbs, Coupling(mbs, told(self.load))

    def add_rigid(
        self,
        body: Any,
        start: ArrayLike,
        end: ArrayLike,
        diameter: float,
        *,
        strips: int = 16,
        free_end: bool = True,
        name: str | None = None,
    ) -> None:
        """Let the medium act on a straight cylinder fixed to a rigid body.

        Parameters
        ----------
        body : ObjectIndex
            A rigid body of Exudyn, planar, or spatial with Euler parameters.
        start, end : (2,) array
            Axis of the cylinder (m), in the frame of the body.
        diameter : float
            m.
        strips : int
            How finely depth, velocity and friction state are resolved along it.
        free_end : bool
            Whether the face at `end` is free (for end caps).
        name : str, optional
            Under which the forces on the body are kept; that of the body unless given.

        Raises
        ------
        SceneError
            The body is of another kind, the cylinder has no length or no diameter, or no medium here takes such shapes;
            a spatial body does not start in the plane.
        """
        with self._call("add_rigid"):
            axis = np.concatenate([planar(point) for point in (start, end)])
            on = self.coupling.body(body, name)
            self.load.add(polyline(on, axis, diameter=diameter, strips=strips, free_end=free_end))

    def add_line(
        self,
        body: Any,
        points: ArrayLike,
        *,
        diameter: float | None = None,
        width: float | None = None,
        turns: ArrayLike | None = None,
        strips: int = 16,
        free_end: bool = True,
        name: str | None = None,
    ) -> None:
        """Let the medium act on a thin bar or plate along a polyline fixed to a rigid body.

        Parameters
        ----------
        body, strips, free_end, name
            As of `add_rigid`.
        points : (k, 2) array
            Corners (m) in the frame of the body, two or more.
        diameter, width : float
            Diameter of a round bar, or width of a plate normal to the plane of motion (m); give one of the two.
        turns : (k - 1,) array, optional
            Angle (rad) by which each side turns, counter-clockwise, where it is the chord of an arc: an arc of few
            points is round for the medium. Straight unless given.

        Raises
        ------
        SceneError
            As of `add_rigid`.
        """
        with self._call("add_line"):
            on = self.coupling.body(body, name)
            line = polyline(on, points, diameter=diameter, width=width, turns=turns, strips=strips, free_end=free_end)
            self.load.add(line)

    def add_outline(
        self,
        body: Any,
        points: ArrayLike,
        width: float,
        *,
        turns: ArrayLike | None = None,
        strips: int = 32,
        name: str | None = None,
    ) -> None:
        """Let the medium act on the outside of a solid with a polygon as its section, fixed to a rigid body.

        Parameters
        ----------
        body, strips, name
            As of `add_rigid`.
        points : (k, 2) array
            Corners (m) in the frame of the body, in either sense of turning; the last side joins the first point again.
        width : float
            Width (m) normal to the plane of motion.
        turns : (k,) array, optional
            As of `add_line`.

        Raises
        ------
        SceneError
            As of `add_rigid`.
        """
        with self._call("add_outline"):
            self.load.add(outline(self.coupling.body(body, name), points, width, turns=turns, strips=strips))

    def add_ball(
        self, body: Any, center: ArrayLike, diameter: float, *, mass: float | None = None, name: str | None = None
    ) -> None:
        """Let the medium act on a sphere fixed to a rigid body.

        Parameters
        ----------
        body, name
            As of `add_rigid`.
        center : (2,) array
            Its centre (m) in the frame of the body.
        diameter : float
            m.
        mass : float, optional
            Mass of the sphere itself (kg), for laws that need it; that of the body unless given.

        Raises
        ------
        SceneError
            As of `add_rigid`.
        """
        with self._call("add_ball"):
            on = self.coupling.body(body, name)
            own = float(self.mbs.GetObject(body)["mass"]) if mass is None else mass
            self.load.add(ball(on, center, diameter, own))

    def add_cables(
        self,
        elements: Sequence[Any],
        diameter: float | None = None,
        *,
        width: float | None = None,
        section: ArrayLike | None = None,
        strips_per_element: int = 4,
        free_end: bool = True,
        name: str | None = None,
    ) -> None:
        """Let the medium act on elements of a beam that follow one another; `beams` says how each kind is met.

        Parameters
        ----------
        elements : sequence of ObjectIndex
            ANCFCable2D or BeamGeometricallyExact2D, in space ANCFCable or BeamGeometricallyExact, of two nodes, each of
            which shares a node with the one before.
        diameter, width, section : float, float, (2,) array
            One of these (m): diameter of a round beam; in the plane the width of a flat one normal to it; in space the
            sides of a geometrically exact one along y and z of its nodes.
        strips_per_element : int
            How finely depth, velocity and friction state are resolved along an element.
        free_end, name
            As of `add_rigid`, for the last face and the beam.

        Raises
        ------
        SceneError
            There is no item, one is of another kind, two neighbours in the list share no node, or no medium here takes
            such shapes.
        """
        with self._call("add_cables", in_space=self.in_space):
            size = {"diameter": diameter, "width": width, "section": section}
            self.coupling.cables(list(elements), name, strips_per_element, free_end, in_space=self.in_space, **size)

    def add_body(
        self,
        body: Any,
        shape: Shape,
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        rotation: ArrayLike | None = None,
        facet_size: float | None = None,
        name: str | None = None,
    ) -> None:
        """Let the medium act on a shape fixed to a rigid body in space, of a bed with `up`.

        A law of balls takes a Sphere as a whole, one of bars a Bar, any other the surface of the rest.

        Parameters
        ----------
        body : ObjectIndex
            A rigid body of Exudyn in space.
        shape : Shape
            Box, Cylinder, Sphere, Capsule, Cone, Plate, Bar or Mesh.
        position : (3,) array
            Origin of the frame of the shape (m), in the frame of the body.
        rotation : (3, 3) array, optional
            Axes of the frame of the shape as columns, in the frame of the body.
        facet_size : float, optional
            Greatest edge of its facets (m); for an error of about 0.3 % of the path unless given.
        name : str, optional
            Under which the forces on the body are kept; that of the body unless given.

        Raises
        ------
        SceneError
            The body is of another kind, no medium here takes such shapes, or the bed is one in the plane.
        """
        with self._call("add_body", in_space=True):
            on = self.coupling.body(body, name, in_space=True)
            mass = float(self.mbs.GetObject(body)["mass"])
            self.load.add_shape(on, shape, position, rotation, facet_size=facet_size, mass=mass)  # type: ignore[attr-defined]

    def attach(self, constant: Mapping[int, ArrayLike] | None = None) -> None:
        """Put the load into the system; once, after all bodies are named and before `mbs.Assemble()`.

        Parameters
        ----------
        constant : mapping of int to array, optional
            Generalised forces by node number that act all the time, such as weights.

        Raises
        ------
        SceneError
            Nothing was named, or attach was called before.
        """
        self.load.check_open()
        if not self.load.lines:
            raise scene_error("bed", "no body was named: use add_rigid or add_cables first")
        self.coupling.attach(constant or {}, warns=True)

    @contextmanager
    def _call(self, name: str, *, in_space: bool = False) -> Iterator[None]:
        """A call that names a body: its errors say which one it was; in_space: whether the bed must be one in space."""
        try:
            self.load.check_open()
            if in_space != self.in_space:
                in_plane, there = "in the plane: give it up=(x, y, z)", "in space (with up): use add_body or add_cables"
                raise scene_error("bed", f"the bed is one {there if self.in_space else in_plane}")
            yield
        except SceneError as error:
            raise SceneError([replace(fault, key=f"bed.{name}") for fault in error.faults]) from None
