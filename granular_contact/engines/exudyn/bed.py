"""The plugin for Exudyn: a granular bed that acts on bodies of any Exudyn model.

`granular_contact.sand` computes the load and knows no engine; `coupling` connects it to the system; `attached` has the
properties that are read during and after a solve.
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
from granular_contact.sand.bed_arguments import with_warnings
from granular_contact.sand.contact_lines import ball, outline, polyline
from granular_contact.sand.line_checks import planar
from granular_contact.sand.load import GranularLoad

if TYPE_CHECKING:
    from granular_contact.sand.space.shapes import Shape


class GranularBed(Attached):
    """Granular bed that acts on bodies of an Exudyn system, in the plane or in space.

    The methods `add_...` name the bodies; then `attach` puts the load into the system, before `mbs.Assemble()`.

    Parameters
    ----------
    mbs : exudyn.MainSystem
        The system. Without `up` its bodies move in the x-y plane of the world, and y points up.
    medium : Law, Layer, or sequence of these
        For example `preset("play_sand")`. A `Layer` is a medium between two depths. The forces of several media add.
    surface : float or (k, 2) array
        In the plane: height y (m) of a level surface, or corners x, y (m) of a surface of straight pieces, which is
        level beyond its first and last corner. In space: height (m) along `up`, measured at the world origin.
    slope : float or, in space, (3,) array
        Rise per length of an endless sloped surface; `surface` is then its height at x = 0. In space: the rise along
        each axis of the world.
    up : (3,) array, optional
        Makes the bed spatial, for rigid bodies that move freely (`add_body`). Direction, in the world frame, opposite
        to gravity on the medium; depth is measured along its negative.
    gravity : float
        Magnitude of gravity (m/s2) in the static resistance of the medium.
    static : Elastoplastic or Smooth
        Regularisation of the sign function of the static resistance.
    form : {"distributed", "resultant"}
        Law integrated along the immersed part, or the source paper's single force at the middle of that part.
    end_cap : bool
        Whether free end faces add to the drag.
    floor : Floor, optional
        Contact with a level floor, whose work is counted apart from that of the media. In space stiffness is per area.

    Raises
    ------
    ValueError
        A parameter, or a coefficient of a medium, is out of its range.

    Notes
    -----
    In the plane forces (N) have the components x, y, and moments (N m) are positive counter-clockwise, as in Exudyn.
    In space vectors are in the world frame. A spatial body in a bed in the plane ends the solve with an error as soon
    as it leans out of the plane. `work`, `force`, `terms` and the whole `history` can be read at any time, during a
    solve or after it. A solve continues friction state and history if it starts at the time or in the state in which
    the last solve ended; any other solve resets them. A static solve moves bodies and adds nothing to the history.
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
        self.mbs, self.coupling = mbs, Coupling(mbs, with_warnings(self.load))

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
            A planar rigid body of Exudyn, or a spatial one with Euler parameters.
        start, end : (2,) array
            Ends of the axis of the cylinder (m), in the frame of the body.
        diameter : float
            Diameter of the cylinder (m).
        strips : int
            Approximate number of strips along the axis, on which depth, velocity and friction state are resolved.
        free_end : bool
            Whether the face at `end` is free (for end caps).
        name : str, optional
            Name of the body in `bodies` and in the history; the name of the Exudyn object unless given.

        Raises
        ------
        SceneError
            The body is of another kind, the cylinder has no length or no diameter, no medium of the bed has a law for
            such shapes, or a spatial body does not start in the plane.
        """
        with self._adding("add_rigid"):
            axis = np.concatenate([planar(point) for point in (start, end)])
            carrier = self.coupling.body(body, name)
            self.load.add(polyline(carrier, axis, diameter=diameter, strips=strips, free_end=free_end))

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
            As in `add_rigid`.
        points : (k, 2) array
            Corners (m) in the frame of the body, two or more.
        diameter, width : float
            Diameter of a round bar, or width of a plate normal to the plane of motion (m); give one of the two.
        turns : (k - 1,) array, optional
            Angle (rad, positive counter-clockwise) by which each side turns from its start to its end, if the side is
            the chord of an arc. A few points then describe a round arc. Sides are straight unless given.

        Raises
        ------
        SceneError
            As in `add_rigid`.
        """
        with self._adding("add_line"):
            carrier = self.coupling.body(body, name)
            size: dict[str, Any] = {"diameter": diameter, "width": width}
            self.load.add(polyline(carrier, points, turns=turns, strips=strips, free_end=free_end, **size))

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
        """Let the medium act on the outer surface of a prism with a polygonal section, fixed to a rigid body.

        Parameters
        ----------
        body, strips, name
            As in `add_rigid`.
        points : (k, 2) array
            Corners (m) in the frame of the body, clockwise or counter-clockwise. The last side ends at the first point.
        width : float
            Width (m) normal to the plane of motion.
        turns : (k,) array, optional
            As in `add_line`.

        Raises
        ------
        SceneError
            As in `add_rigid`.
        """
        with self._adding("add_outline"):
            self.load.add(outline(self.coupling.body(body, name), points, width, turns=turns, strips=strips))

    def add_ball(
        self, body: Any, center: ArrayLike, diameter: float, *, mass: float | None = None, name: str | None = None
    ) -> None:
        """Let the medium act on a sphere fixed to a rigid body.

        Parameters
        ----------
        body, name
            As in `add_rigid`.
        center : (2,) array
            Centre of the sphere (m), in the frame of the body.
        diameter : float
            Diameter of the sphere (m).
        mass : float, optional
            Mass of the sphere alone (kg), for laws that need it; the mass of the body unless given.

        Raises
        ------
        SceneError
            As in `add_rigid`.
        """
        with self._adding("add_ball"):
            carrier = self.coupling.body(body, name)
            sphere_mass = float(self.mbs.GetObject(body)["mass"]) if mass is None else mass
            self.load.add(ball(carrier, center, diameter, sphere_mass))

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
        """Let the medium act on a row of beam elements, each of which starts at the node where the previous one ends.

        Parameters
        ----------
        elements : sequence of ObjectIndex
            Elements of one kind with two nodes each: ANCFCable2D or BeamGeometricallyExact2D, in space ANCFCable or
            BeamGeometricallyExact.
        diameter, width, section : float, float, (2,) array
            Size of the cross-section (m); give one of the three. `diameter`: a round beam. `width`: in the plane, a
            flat beam with this width normal to the plane. `section`: in space, the sides of a geometrically exact beam
            along the y and z axes of its nodes.
        strips_per_element : int
            Number of strips along an element, on which depth, velocity and friction state are resolved.
        free_end, name
            As in `add_rigid`, for the face at the last node, and for the beam (the name of its first element).

        Raises
        ------
        SceneError
            The list is empty, an element is of another kind, two neighbours in the list share no node, or no medium of
            the bed has a law for such shapes.
        """
        with self._adding("add_cables", in_space=self.in_space):
            size = {"diameter": diameter, "width": width, "section": section}
            self.coupling.cables(elements, name, strips_per_element, free_end, in_space=self.in_space, **size)

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
        """Let the medium act on a shape fixed to a rigid body in space; for a bed with `up`.

        Laws for balls take a Sphere, and laws for bars a Bar. Other laws act on the surface of any shape but a Bar.

        Parameters
        ----------
        body : ObjectIndex
            A rigid body of Exudyn in space, with Euler parameters or Tait-Bryan angles.
        shape : Shape
            Box, Cylinder, Sphere, Capsule, Cone, Plate, Bar or Mesh.
        position : (3,) array
            Origin of the frame of the shape (m), in the frame of the body.
        rotation : (3, 3) array, optional
            Axes of the frame of the shape as columns, in the frame of the body.
        facet_size : float, optional
            Longest allowed edge of a facet (m); unless given, one for an error of about 0.3 % of the path.
        name
            As in `add_rigid`.

        Raises
        ------
        SceneError
            The body is of another kind, no medium of the bed has a law for such shapes, or the bed is in the plane.
        """
        with self._adding("add_body", in_space=True):
            carrier = self.coupling.body(body, name, in_space=True)
            mass = float(self.mbs.GetObject(body)["mass"])
            self.load.add_shape(carrier, shape, position, rotation, facet_size=facet_size, mass=mass)  # type: ignore[attr-defined]

    def attach(self, constant: Mapping[int, ArrayLike] | None = None) -> None:
        """Put the load into the system: once, after all bodies were added and before `mbs.Assemble()`.

        Parameters
        ----------
        constant : mapping of int to array, optional
            Constant generalised forces such as weights, by node number: N, N m for angles, in the order of the node's
            coordinates.

        Raises
        ------
        SceneError
            No body was added, or attach was called before.
        """
        self.load.check_open()
        if not self.load.lines:
            first = "add_body" if self.in_space else "add_rigid"
            raise scene_error("bed", f"no body was named: use {first} or add_cables first")
        self.coupling.attach(constant or {}, warns=True)

    @contextmanager
    def _adding(self, method: str, *, in_space: bool = False) -> Iterator[None]:
        """Context of a method that adds a body to a bed in the plane or in space: it names the method in errors."""
        try:
            self.load.check_open()
            if in_space != self.in_space:
                planar_bed = "in the plane: give it up=(x, y, z)"
                spatial_bed = "in space (with up): use add_body or add_cables"
                raise scene_error("bed", f"the bed is one {spatial_bed if self.in_space else planar_bed}")
            yield
        except SceneError as error:
            raise SceneError([replace(fault, key=f"bed.{method}") for fault in error.faults]) from None
