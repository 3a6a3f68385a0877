"""The plugin for MuJoCo: a granular bed that acts on bodies of any MuJoCo model, which is not changed."""

from __future__ import annotations

import warnings
import weakref
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.engines.mujoco import checks, geoms
from granular_contact.engines.mujoco.bed_data import BedData
from granular_contact.engines.mujoco.callback import Callback
from granular_contact.engines.mujoco.engine import name_of
from granular_contact.engines.mujoco.facet_error import ComparedLoads
from granular_contact.engines.mujoco.load import BedLoad
from granular_contact.engines.mujoco.sand import PlanarSand, Sand, SpatialSand
from granular_contact.engines.mujoco.shared import Shared
from granular_contact.engines.mujoco.state import BedState
from granular_contact.errors import scene_error
from granular_contact.laws.floor import Floor
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.bed_arguments import direction, with_warnings
from granular_contact.sand.contact_lines import Body, ContactLine

Vector = NDArray[np.float64]


class MujocoBed:
    """Granular bed that acts on bodies of a MuJoCo model, in space or in a plane.

    `add_geoms` and `add_lines` name what the medium acts on. Then call `apply` before each step, or `install` once.

    Parameters
    ----------
    model : mujoco.MjModel
        The model; it is not changed.
    medium, slope, static, form, end_cap, floor
        As in `GranularBed`. Corners as `surface`, and another `form` than "distributed", need `plane`.
    surface : float or (k, 2) array
        Height (m) of a level surface along `up`, above the world origin. With `plane` also corners (m) of a surface of
        straight pieces: distance along `plane`, and height.
    up : (3,) array, optional
        Direction (world frame) against which depth is measured; the opposite of the model's gravity unless given.
    gravity : float, optional
        Magnitude of gravity (m/s2) in the static resistance of the medium; that of the model unless given.
    plane : (3,) array, optional
        Makes the bed planar, for laws of strips on sections of the bodies: a horizontal direction, in the world frame,
        that spans with `up` the plane in which all bodies move.
    record : bool
        Whether `BedData.history` keeps a row of each step.
    lenient : bool
        Whether a step without a call of `apply` before it is allowed; otherwise it is an error.

    Raises
    ------
    ValueError
        A parameter, or a coefficient of a medium, is out of its range.

    Notes
    -----
    Forces are implicit in the step (`kernels.added_mass`). Their error is of first order in the step. Bodies stand
    still, except for light flat ones with steps above 1 ms. Friction state, forces and work belong to one `MjData`
    each: `of(data)`.
    """

    def __init__(
        self,
        model: Any,
        medium: Law | Layer | Sequence[Law | Layer],
        surface: ArrayLike = 0.0,
        *,
        slope: ArrayLike = 0.0,
        up: ArrayLike | None = None,
        gravity: float | None = None,
        plane: ArrayLike | None = None,
        static: Elastoplastic | Smooth | None = None,
        form: str = "distributed",
        end_cap: bool = False,
        floor: Floor | None = None,
        record: bool = False,
        lenient: bool = False,
    ) -> None:
        self.model, self.planar = model, plane is not None
        self._static = Elastoplastic() if static is None else static
        model_gravity = np.array(model.opt.gravity, float)
        if (up is None or gravity is None) and not model_gravity.any():
            raise ValueError("up, gravity: the model has no gravity, give both")
        self.up = direction("up", -model_gravity if up is None else up)
        options: dict[str, Any] = {"slope": slope, "static": self._static, "end_cap": end_cap, "floor": floor}
        options["gravity"] = float(np.linalg.norm(model_gravity)) if gravity is None else gravity
        self._bed = BedLoad(medium, surface, self.up, plane, form, options)
        self.load, self.turn = self._bed.load, self._bed.turn
        with_warnings(self.load)
        self._bodies, self._geom_numbers = dict[int, Body](), list[int]()
        self._options = {"record": record, "lenient": lenient}
        self._shared: Shared | None = None  # made at the first use with data, after which no geom can be added
        self._beds: weakref.WeakKeyDictionary[Any, BedData] = weakref.WeakKeyDictionary()  # by MjData
        self._callback = Callback()

    def body(self, name: str | int) -> Body:
        """Body of the model on which lines for `add_lines` can be made.

        Parameters
        ----------
        name : str or int
            Name or number of the body.

        Returns
        -------
        Body
            As functions of `granular_contact.sand.contact_lines` take it.

        Raises
        ------
        SceneError
            There is no such body, or it is fixed to the world.
        """
        number = checks.movable(self.model, name)
        self._check_open()
        size, place = (3 if self.planar else 7), len(self._bodies)
        if number not in self._bodies:
            coordinates = np.arange(size * place, size * (place + 1))
            self._bodies[number] = Body(name_of(self.model, "body", number), coordinates)
        return self._bodies[number]

    def add_geoms(self, pattern: str, *, facet_size: float | None = None, hull: bool = False) -> list[str]:
        """Let the medium act on geoms of the model: primitives and meshes.

        If geoms of a body that are named in one call overlap, the medium acts on their outer surface alone.

        Parameters
        ----------
        pattern : str
            Regular expression for the whole name of a geom, or of its body if the geom has no name.
        facet_size : float, optional
            Longest allowed edge of a facet (m); unless given, one for an error of about 0.3 % of the path.
        hull : bool
            Whether the convex hull of a mesh is taken, as in MuJoCo's contacts.

        Returns
        -------
        list of str
            Names of the geoms.

        Raises
        ------
        SceneError
            No geom fits; one has no volume, an open mesh or is fixed to the world; no medium has a law for its shape.
        """
        self._check_open()
        chosen = geoms.chosen(self.model, pattern, self._geom_numbers)
        for geom in chosen:
            body = self.body(geom.body)
            if self.planar:
                self._bed.add_section(self.model, body, geom)
                continue
            kinds = self._bed.shape_kinds
            shape = geoms.shape(self.model, geom, bars="bar" in kinds and "surface" not in kinds, hull=hull)
            others = [other for other in chosen if other.body == geom.body and other is not geom]
            if others and "surface" in kinds:
                shape = geoms.Outside(shape, geom, others)
            mass = float(self.model.body_mass[geom.body])
            self._bed.add_shape(body, shape, geom.position, geom.rotation, facet_size=facet_size, mass=mass)
        self._geom_numbers += [geom.number for geom in chosen]
        return [geom.name for geom in chosen]

    def add_lines(self, lines: Sequence[ContactLine]) -> None:
        """Let the medium of a planar bed act on contact lines on bodies of `body`.

        The first coordinate of a point on a line is along the x axis of the body's frame (along its y axis, if x lies
        across the plane). The second is along the direction a quarter turn ahead, in the sense from `plane` to `up`.

        Parameters
        ----------
        lines : sequence of ContactLine
            Lines made by functions of `granular_contact.sand.contact_lines`.

        Raises
        ------
        SceneError
            The bed is in space, or an error of `GranularLoad.add`.
        """
        self._check_open()
        if not self.planar:
            raise scene_error("bed.add_lines", "the bed is one in space: use add_geoms, or give it plane=(x, y, z)")
        self.load.add(lines)

    def _check_open(self) -> None:
        if self._shared is not None:
            raise scene_error("bed", "it is in use already; name every geom before the first call with data")

    def of(self, data: Any) -> BedData:
        """Forces, work and friction state of the bed with an MjData, made at the first call with these data.

        The first call of all compiles kernels and warns of parts of the model that disagree with sand. A copy of an
        MjData starts with unstretched bristles; `copy` copies them.

        Parameters
        ----------
        data : MjData
            Data of the model.

        Returns
        -------
        BedData
            Forces, work and friction state.

        Raises
        ------
        SceneError
            The data are those of another model, or no geom or line was added.
        """
        bed_data = self._beds.get(data)
        if bed_data is not None:
            return bed_data
        checks.refuse_other(self.model, data)
        if self._shared is None:
            self._shared = self._close()
        bed_data = BedData(self._shared, self.model, data)
        rows = data.xfrc_applied[self._shared.numbers]
        for other in list(self._beds.values()):
            if other.wrote(rows):
                bed_data.adopt(other)
        self._beds[data] = bed_data
        return bed_data

    def _close(self) -> Shared:
        """Close the list of shapes, warn of the model, and make what all data share."""
        if not self.load.lines:
            raise scene_error("bed", "nothing was named: use add_geoms first")
        self.load.close()
        numbers = list(self._bodies)
        for sentence in checks.warnings_of(self.model, numbers, self._bed.height, self.up):
            warnings.warn(sentence, stacklevel=4)
        sand: Sand
        if self.planar:
            facings = np.array([self._bed.axes_in(self.model, number)[0] for number in numbers])
            sand = PlanarSand(self.load, self._static, facings)
        else:
            sand = SpatialSand(self.load, self._static)
        compared = None if self.planar else ComparedLoads(partial(self._bed.with_facets, bodies=len(numbers)))
        return Shared(self.model, numbers, sand, self.turn, compared_loads=compared, **self._options)

    def apply(self, data: Any) -> BedData:
        """Compute the forces of the next step and write them to `data.xfrc_applied`; call it before each `mj_step`.

        Call it once a step, after the controls are set. Friction state and work advance if `data.time` has advanced; if
        it has gone back, a new motion starts. Other forces in `xfrc_applied` stay: set them, do not add to the numbers.

        Parameters
        ----------
        data : MjData
            Data of the model.

        Returns
        -------
        BedData
            As `of` gives it.

        Raises
        ------
        SceneError
            Steps were made since the last call without calling `apply`, and the bed is not `lenient`.
        """
        bed_data = self.of(data)
        bed_data.apply(data)
        return bed_data

    def copy(self, source: Any, target: Any) -> BedData:
        """Copy friction state and work from one MjData to another, as `mj_copyData` copies MuJoCo's own state.

        Parameters
        ----------
        source, target : MjData
            Data of the model.

        Returns
        -------
        BedData
            That of the target.
        """
        bed_data = self.of(target)
        bed_data.restore(self.of(source).state)
        return bed_data

    def restore(self, data: Any, state: BedState) -> None:
        """Return to a saved state; restore MuJoCo's own state beside it.

        Parameters
        ----------
        data : MjData
            Data of the model.
        state : BedState
            A value of `BedData.state`.
        """
        self.of(data).restore(state)

    def install(self, *datas: Any) -> MujocoBed:
        """Set MuJoCo's passive callback to this bed, for these data or, if none are given, for all data of the model.

        A process has one such callback; an earlier one is called, too. The bed is also a context that resets it:

            with bed.install():
                mujoco.mj_step(model, data, nstep=1000)

        Parameters
        ----------
        *datas : MjData
            Data of the model.

        Returns
        -------
        MujocoBed
            This bed.
        """
        for data in datas:
            self.of(data)
        if self._shared is None:
            self._shared = self._close()
        self._callback.install(self.model, datas, self._evaluate)
        return self

    def _evaluate(self, _: Any, data: Any) -> None:
        """The passive callback; calls that the bed itself causes by trial steps are ignored."""
        bed_data = self.of(data)
        if not bed_data.busy:
            bed_data.evaluate(data)

    def uninstall(self) -> None:
        """Set the callback that MuJoCo had before `install`."""
        self._callback.uninstall()

    def __enter__(self) -> MujocoBed:
        return self

    def __exit__(self, *_: object) -> None:
        self.uninstall()
