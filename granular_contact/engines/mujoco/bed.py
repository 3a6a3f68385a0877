"""The second door: a granular bed that acts on the bodies of a MuJoCo model as it is."""

from __future__ import annotations

import warnings
import weakref
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.engines.mujoco import checks, geoms
from granular_contact.engines.mujoco.callback import Callback
from granular_contact.engines.mujoco.engine import name_of
from granular_contact.engines.mujoco.facet_error import Facets
from granular_contact.engines.mujoco.load import BedLoad
from granular_contact.engines.mujoco.of_data import BedData
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
    """Bed of one medium, or of several whose forces add, acting on bodies of a MuJoCo model.

    Parameters
    ----------
    model : mujoco.MjModel
        The model; it is not changed.
    medium, slope, static, form, end_cap, floor
        As of `GranularBed`. A profile and `form` need `plane`.
    surface : float or (k, 2) array
        Height of the level surface (m) along `up`, above the origin of the world; in a plane also corners.
    up : (3,) array, optional
        Direction, world frame, against which depth is counted; opposite to the model's gravity unless given.
    gravity : float, optional
        Magnitude of gravity (m/s2) in the static resistance of the medium; the model's unless given.
    plane : (3,) array, optional
        Makes the bed planar: the horizontal direction (world frame) that spans, with `up`, the plane in which all
        bodies move. Laws of strips then act on sections of the bodies.
    record : bool
        Whether `BedData.history` keeps a row of each step.
    lenient : bool
        Whether steps without a call of `apply` are passed over, and not an error.

    Raises
    ------
    ValueError
        One of these, or a number of a medium, is not allowed.

    Notes
    -----
    Forces are implicit in the step (`kernels.added_mass`), of first order in it, and bodies stand still at any.
    Friction state, forces and work belong to one `MjData` each: `of(data)`.
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
        pull = np.array(model.opt.gravity, float)
        if (up is None or gravity is None) and not pull.any():
            raise ValueError("up, gravity: the model has no gravity, give both")
        self.up = direction("up", -pull if up is None else up)
        options: dict[str, Any] = {"slope": slope, "static": self._static, "end_cap": end_cap, "floor": floor}
        options["gravity"] = float(np.linalg.norm(pull)) if gravity is None else gravity
        self._bed = BedLoad(medium, surface, self.up, plane, form, options)
        self.load, self.turn = self._bed.load, self._bed.turn
        with_warnings(self.load)
        self._names, self._geoms = dict[int, Body](), list[int]()
        self._options = {"record": record, "lenient": lenient}
        self._shared: Shared | None = None
        self._of: weakref.WeakKeyDictionary[Any, BedData] = weakref.WeakKeyDictionary()
        self._callback = Callback()

    def body(self, name: str | int) -> Body:
        """A body of the model, as the bed has it.

        Parameters
        ----------
        name : str or int
            Its name or number.

        Returns
        -------
        Body

        Raises
        ------
        SceneError
            There is no such body, or it is fixed to the world.
        """
        number = checks.movable(self.model, name)
        self._check_open()
        size, place = (3 if self.planar else 7), len(self._names)
        if number not in self._names:
            coordinates = np.arange(size * place, size * (place + 1))
            self._names[number] = Body(name_of(self.model, "body", number), coordinates)
        return self._names[number]

    def add_geoms(self, pattern: str, *, facet_size: float | None = None, hull: bool = False) -> list[str]:
        """Let the medium act on geoms of the model, primitives and meshes as they are.

        Where geoms of a body that are named in one call overlap, only what lies outside the others is met.

        Parameters
        ----------
        pattern : str
            Regular expression that the whole name of a geom fits, or that of its body if it has none.
        facet_size : float, optional
            Greatest edge of facets (m); for an error of about 0.3 % of the path unless given.
        hull : bool
            Whether the convex hull of a mesh counts, as in MuJoCo's contacts.

        Returns
        -------
        list of str
            Names of the geoms.

        Raises
        ------
        SceneError
            Nothing fits; a geom has no volume, an open mesh or is fixed to the world; nothing acts on its shape.
        """
        self._check_open()
        found = geoms.chosen(self.model, pattern, self._geoms)
        for one in found:
            body = self.body(one.body)
            if self.planar:
                self._bed.add_section(self.model, body, one)
                continue
            met = self._bed.met
            shape, turn = geoms.shape(self.model, one, bars="bar" in met and "surface" not in met, hull=hull)
            others = [other for other in found if other.body == one.body and other is not one]
            if others and "surface" in met:
                shape = geoms.Outside(shape, one, others)
            mass = float(self.model.body_mass[one.body])
            self._bed.add_shape(body, shape, one.place, turn, facet_size=facet_size, mass=mass)
        self._geoms += [one.number for one in found]
        return [one.name for one in found]

    def add_lines(self, lines: Sequence[ContactLine]) -> None:
        """Let the medium of a planar bed act on lines of `sand.contact_lines`, on bodies as of `body`.

        Points in the frame of a body: along its x axis (its y axis where x lies across the plane), and along what is
        ahead of that by a quarter turn from `plane` to `up`.

        Parameters
        ----------
        lines : sequence of ContactLine
            Of `granular_contact.sand.contact_lines`.

        Raises
        ------
        SceneError
            The bed is one in space, or as of `GranularLoad.add`.
        """
        self._check_open()
        if not self.planar:
            raise scene_error("bed.add_lines", "the bed is one in space: use add_geoms, or give it plane=(x, y, z)")
        self.load.add(lines)

    def _check_open(self) -> None:
        if self._shared is not None:
            raise scene_error("bed", "it is in use already; name every geom before the first call with data")

    def of(self, data: Any) -> BedData:
        """What the bed keeps for an MjData, made at the first call; the first of all compiles and looks at the model.

        A copy of an MjData begins without stretched bristles; `copy` takes them along.

        Parameters
        ----------
        data : MjData
            Of the model.

        Returns
        -------
        BedData
            Forces, work and friction state.

        Raises
        ------
        SceneError
            It is data of another model; nothing was named that the medium acts on.
        """
        found = self._of.get(data)
        if found is not None:
            return found
        checks.refuse_other(self.model, data)
        if self._shared is None:
            self._shared = self._close()
        kept = BedData(self._shared, self.model, data)
        rows = data.xfrc_applied[self._shared.numbers]
        for other in list(self._of.values()):
            if other.wrote(rows):
                kept.adopt(other)
        self._of[data] = kept
        return kept

    def _close(self) -> Shared:
        if not self.load.lines:
            raise scene_error("bed", "nothing was named: use add_geoms first")
        self.load.close()
        numbers = list(self._names)
        for sentence in checks.warnings_of(self.model, numbers, self._bed.height, self.up):
            warnings.warn(sentence, stacklevel=4)
        sand: Sand
        if self.planar:
            facings = np.array([self._bed.axes_in(self.model, number)[0] for number in numbers])
            sand = PlanarSand(self.load, self._static, facings)
        else:
            sand = SpatialSand(self.load, self._static)
        facets = None if self.planar else Facets(partial(self._bed.with_facets, bodies=len(numbers)))
        return Shared(self.model, numbers, sand, self.turn, facets=facets, **self._options)

    def apply(self, data: Any) -> BedData:
        """Find the forces of the step from here and put them into `data.xfrc_applied`; before each `mj_step`.

        Once a step, after the controls are set: friction state and work advance where `data.time` has moved since the
        last call; where it went back, as after a reset, they begin anew. Other forces in `xfrc_applied` stay: set them,
        do not add to what stands there.

        Parameters
        ----------
        data : MjData
            Of the model.

        Returns
        -------
        BedData
            As of `of`.

        Raises
        ------
        SceneError
            Steps were made in between without a call.
        """
        kept = self.of(data)
        kept.apply(data)
        return kept

    def copy(self, source: Any, target: Any) -> BedData:
        """Give the friction state and the work of one MjData to another, as `mj_copyData` does with MuJoCo's state.

        Parameters
        ----------
        source, target : MjData
            Of the model.

        Returns
        -------
        BedData
            That of the target.
        """
        kept = self.of(target)
        kept.restore(self.of(source).state)
        return kept

    def restore(self, data: Any, state: BedState) -> None:
        """Go back to a state.

        Parameters
        ----------
        data : MjData
            Of the model.
        state : BedState
            What `BedData.state` gave.
        """
        self.of(data).restore(state)

    def install(self, *datas: Any) -> MujocoBed:
        """Become MuJoCo's passive callback for these data, or for all of the model if none is named.

        MuJoCo has one such callback for the whole process; what was there before is called too. Also a context:

            with bed.install():
                mujoco.mj_step(model, data, nstep=1000)

        Parameters
        ----------
        *datas : MjData
            Of the model.

        Returns
        -------
        MujocoBed
            Itself.
        """
        for data in datas:
            self.of(data)
        if self._shared is None:
            self._shared = self._close()
        self._callback.install(self.model, datas, self._evaluate)
        return self

    def _evaluate(self, _: Any, data: Any) -> None:
        kept = self.of(data)
        if not kept.busy:
            kept.evaluate(data)

    def uninstall(self) -> None:
        """Give MuJoCo the callback that it had before."""
        self._callback.uninstall()

    def __enter__(self) -> MujocoBed:
        return self

    def __exit__(self, *_: object) -> None:
        self.uninstall()
