"""The plugin door: a granular bed that acts on bodies of any Exudyn model.

    bed = GranularBed(mbs, preset("play_sand"), surface=-0.14)
    bed.add_cables(elements, diameter=0.006)
    bed.attach()                      # before mbs.Assemble()
    ...
    mbs.SolveDynamic(settings)
    print(bed.work, bed.force)

The forces on all bodies are computed in one call and reach them through one massless `ObjectGenericODE2` over their own
nodes (see `overlay`); nothing else of the model is touched, no user function of the model is taken. State that belongs
to a step (the anchors of the static law, the work done) is advanced when the engine first asks for a force in the step
after it, from the engine's own record of where that step started; so a step that the engine rejects and repeats leaves
no trace.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.geometry.surface import surface as corners
from granular_contact.media.checks import check
from granular_contact.media.floor import TERM as FLOOR_TERM
from granular_contact.media.floor import Floor
from granular_contact.media.kinds import WORDS, Medium, term_names, what_it_takes
from granular_contact.media.layer import Layer
from granular_contact.media.static_friction import Elastoplastic, Smooth
from granular_contact.multibody import shapes
from granular_contact.multibody.history import LoadHistory
from granular_contact.multibody.ledger import Ledger
from granular_contact.multibody.overlay import Overlay
from granular_contact.multibody.runs import Group, Run, named

Vector = NDArray[np.float64]
LEANING = 0.01  # sine of an angle, 0.6 degrees: forces in the plane are then off by its square


class GranularBed:
    """Bed of one medium, or of several whose forces add, acting on the bodies named to it.

    Parameters
    ----------
    mbs : exudyn.MainSystem
        System whose bodies move in its x-y plane, y up.
    medium : Medium, Layer, or sequence of these
        For example `preset("play_sand")`; a `Layer` is a medium between two depths. Where several lie, forces add.
    surface : float or (k, 2) array
        Height y of the level surface (m), or the corners x, y (m) of a surface of straight pieces, level beyond them.
    slope : float
        Rise per length of a surface given by its height, which is then that at x = 0; it has no end.
    gravity : float
        Magnitude of gravity (m/s2) in the static resistance of the medium.
    static : Elastoplastic or Smooth
        How the sign of the static resistance is regularised.
    form : {"distributed", "resultant"}
        Law integrated along the immersed part, or the source paper's single force at its middle.
    end_cap : bool
        Whether free end faces add to the drag.
    floor : Floor, optional
        Contact with a level floor; its work is kept apart from that of the media.

    Raises
    ------
    ValueError
        One of these, or a number of a medium, is not allowed.

    Notes
    -----
    Bodies move in the plane; a spatial one that leans out of it while it moves ends the solve with an error.

    `work`, `force`, `terms` and the whole `history` can be read at any time, during a solve or after it.

    A solve that starts when the last one ended, or in the state in which it ended, goes on with bristles and history as
    they are; any other rests them. A static solve moves bodies and leaves no history.
    """

    def __init__(
        self,
        mbs: Any,
        medium: Medium | Layer | Sequence[Medium | Layer],
        surface: ArrayLike,
        *,
        slope: float = 0.0,
        gravity: float = 9.81,
        static: Elastoplastic | Smooth | None = None,
        form: str = "distributed",
        end_cap: bool = False,
        floor: Floor | None = None,
    ) -> None:
        if form not in ("distributed", "resultant"):
            raise ValueError(f"form: got {form!r}, allowed are 'distributed' and 'resultant'")
        if np.ndim(gravity) != 0 or not np.isfinite(gravity):
            raise ValueError(f"gravity: got {gravity}, allowed is a finite number, its magnitude (m/s2)")
        self.mbs = mbs
        self.profile = _profile(surface, slope)
        given = tuple(medium) if isinstance(medium, Sequence) and not isinstance(medium, str) else (medium,)
        _expect("medium", given, (Medium, Layer), "a medium, such as preset('play_sand'), a Layer, or several of these")
        if not given:
            raise ValueError("medium: got none, allowed is at least one")
        self.layers = tuple(one if isinstance(one, Layer) else Layer(one) for one in given)
        self.media = tuple(layer.medium for layer in self.layers)
        if form == "resultant" and not all(layer.whole for layer in self.layers):
            raise ValueError("form: got 'resultant', but there are layers: allowed is 'distributed'")
        _expect("floor", [] if floor is None else [floor], (Floor,), "a Floor")
        self.floor = floor if floor is not None and floor.stiffness is not None else None
        static = Elastoplastic() if static is None else static
        _expect("static", [static], (Elastoplastic, Smooth), "Elastoplastic() or Smooth()")
        for part in (*self.layers, static):
            check(part)
        self.records = [one.record(static, gravity) for one in self.media]
        self.resultant = form == "resultant"
        self.end_cap = end_cap
        self.runs: list[Run] = []
        self.groups: list[Group] = []
        self.load_calls = 0
        self._awake = self._acts = False  # whether a run may touch the surface; whether forces were sent last
        self._ledger: Ledger | None = None
        self._time: float | None = None  # time of the step for which forces were last asked
        self._accepted: float | None = None  # time of the last accepted state
        self._last = np.zeros(0)  # its coordinates

    # ---- what the medium acts on ----

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
        """Let the medium act on a straight cylinder fixed to a rigid body, planar or spatial with Euler parameters.

        start, end: axis of the cylinder, (2,) m in the body's frame; diameter in m; free_end: whether the face at `end`
        is free (for end caps); name: under which the forces on the body are kept, that of the body unless given.
        strips: how finely depth, velocity and friction state are resolved along it.

        Raises
        ------
        SceneError
            The body is of another kind, the cylinder has no length or no diameter, or no medium here takes such shapes;
            a spatial body does not start in the plane.
        """
        axis = np.concatenate([shapes.planar("bed.add_rigid", point) for point in (start, end)])
        kind, flags = shapes.section("bed.add_rigid", diameter, None)
        flags |= self._flags(free_end)
        self._take(
            "bed.add_rigid", name, lambda at: shapes.line_runs(at, self.mbs, body, axis, None, kind, strips, flags)
        )

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

        points: (k, 2) m in the body's frame, k >= 2; a plate's `width` (m) is normal to the plane of motion, a round
        bar has a `diameter` (m); give one of the two. turns: (k - 1,) rad, the angle by which each side between two
        points turns, counter-clockwise, where it is the chord of an arc, so that an arc of few points is round for the
        medium; straight unless given. Other arguments and errors as for `add_rigid`.
        """
        kind, flags = shapes.section("bed.add_line", diameter, width)
        flags |= self._flags(free_end)
        self._take(
            "bed.add_line", name, lambda at: shapes.line_runs(at, self.mbs, body, points, turns, kind, strips, flags)
        )

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

        points: corners (k, 2) m in the body's frame, in either sense of turning; width (m) normal to the plane of
        motion; turns: of the sides, the last of which joins the first point again, as for `add_line`. Other arguments
        and errors as for `add_rigid`.
        """
        flags = {"width": shapes.positive("bed.add_outline", "width", width)}
        self._take(
            "bed.add_outline", name, lambda at: shapes.outline_runs(at, self.mbs, body, points, turns, strips, flags)
        )

    def add_ball(
        self, body: Any, center: ArrayLike, diameter: float, *, mass: float | None = None, name: str | None = None
    ) -> None:
        """Let the medium act on a sphere fixed to a rigid body; center (2,) m in its frame, diameter in m.

        mass: of the sphere itself (kg), for laws that know it; that of the body unless given. Errors as for
        `add_rigid`.
        """
        self._take("bed.add_ball", name, lambda at: [shapes.ball_run(at, self.mbs, body, center, diameter, mass)])

    def add_cables(
        self,
        elements: Sequence[Any],
        diameter: float | None = None,
        *,
        width: float | None = None,
        strips_per_element: int = 4,
        free_end: bool = True,
        name: str | None = None,
    ) -> None:
        """Let the medium act on ANCFCable2D elements that follow one another: a round beam, or a strip of this width.

        Raises
        ------
        SceneError
            There is no item, one is no ANCFCable2D, two neighbours in the list share no node, or no medium here takes
            such shapes.
        """
        cables = list(elements)
        if not cables:
            raise scene_error("bed.add_cables", "got no elements; allowed is at least one")
        kind, flags = shapes.section("bed.add_cables", diameter, width)
        size = len(cables) if self.resultant else shapes.ELEMENTS_PER_RUN

        def runs(at: str) -> list[Run]:
            # Runs are counted from the tip, where the beam meets the medium first.
            made = [
                shapes.cable_run(
                    at,
                    self.mbs,
                    cables[max(0, stop - size) : stop],
                    kind,
                    strips_per_element,
                    flags | self._flags(free_end and stop == len(cables)),
                )
                for stop in range(len(cables), 0, -size)
            ]
            for run in made:
                run.body = made[-1].body  # one beam, by the name of its first element
            return made

        self._take("bed.add_cables", name, runs)

    def _flags(self, free_end: bool) -> dict[str, Any]:
        return {"cap": self.end_cap and free_end, "resultant": self.resultant}

    def _take(self, where: str, name: str | None, make: Callable[[str], list[Run]]) -> None:
        """Add runs, each with the media that act on its kind of shape left to `attach`."""
        self._open()
        made = make(where)
        for run in made:
            if not any(run.kind in medium.takes for medium in self.media):
                raise scene_error(
                    where, f"nothing acts on {WORDS[run.kind]}: {'; '.join(map(what_it_takes, self.media))}"
                )
            if run.kind == "ball" and not all(layer.whole for layer in self.layers):
                raise scene_error(where, "a ball is met as a whole, but the bed has layers: allowed is one medium")
            run.body = run.body if name is None else name
        self.runs += made

    def _open(self) -> None:
        if self._ledger is not None:
            raise scene_error("bed", "it is attached already; name every body before attach()")

    def attach(self, constant: Mapping[int, ArrayLike] | None = None) -> None:
        """Put the load into the system; once, after all bodies are named and before `mbs.Assemble()`.

        constant: generalised forces (by node number) that act all the time and may share the way, such as weights.

        Raises
        ------
        SceneError
            Nothing was named, or attach was called before.
        """
        self._open()
        if not self.runs:
            raise scene_error("bed", "no body was named: use add_rigid or add_cables first")
        self.group()
        nodes = {node: run.size // len(run.nodes) for run in self.runs for node in run.nodes}
        self._overlay = Overlay(self.mbs, nodes, constant or {})
        for group in self.groups:
            group.lay(self._overlay)
        self._triplets = np.zeros((sum(group.entries for group in self.groups), 3))
        self._overlay.attach(self._force, self._jacobian)

    def group(self) -> None:
        """Close the list of bodies: form groups for the kernels, and a history to be filled."""
        self._ledger = self._new_ledger()
        self.groups = list(self._grouped())
        self._spatial = [group for group in self.groups if group.is_spatial]

    def _grouped(self) -> Iterator[Group]:
        """Runs that one medium, or the floor, meets on one kind of body, with their columns in the history."""
        bodies = named(self.runs)

        def groups(acting: list[Run], index: int, profile: Vector, record: Any, flags: list[Any]) -> Iterator[Group]:
            for dtype in dict.fromkeys(run.geometry.dtype for run in acting):
                chosen = [i for i, run in enumerate(acting) if run.geometry.dtype == dtype]
                runs = [acting[i] for i in chosen]
                columns = [self.ledger.columns(index, bodies.index(run.body)) for run in runs]
                yield Group(runs, [flags[i] for i in chosen], profile, record, columns)

        if self.floor is not None:
            for kind in dict.fromkeys(run.kind for run in self.runs):
                acting = [run for run in self.runs if run.kind == kind]
                flags = [run.run for run in acting]
                yield from groups(acting, self.ledger.media - 1, self.floor.profile, self.floor.record(kind), flags)
        for i, (layer, record) in enumerate(zip(self.layers, self.records, strict=True)):
            acting = [run for run in self.runs if run.kind in layer.medium.takes]
            yield from groups(acting, i, self.profile, record, [_layered(run, layer) for run in acting])

    def _new_ledger(self) -> Ledger:
        terms = [len(medium.terms) for medium in self.media] + [1] * (self.floor is not None)
        return Ledger(terms, len(named(self.runs)), self.floor is not None)

    @property
    def term_names(self) -> tuple[str, ...]:
        """Names of the terms of all media, and of the floor's contact."""
        return term_names(self.media) + ((FLOOR_TERM,) if self.floor is not None else ())

    # ---- what the engine calls ----

    def _force(self, t: float) -> None:
        """Set the forces at the system's present state."""
        self.load_calls += 1
        if t != self._time:
            self._begin(t)
        if not self._awake and not self._acts:
            return
        forces = self._overlay.forces
        forces[:] = self._overlay.constant
        if self._awake:
            for group in self.groups:
                group.force(self._q, self._v, forces)
        self._overlay.send()
        self._acts = self._awake

    def _jacobian(self, t: float, factor_q: float, factor_v: float) -> Any:
        """Tangent at the system's present state, as the engine's sparse matrix."""
        if t != self._time:
            self._begin(t)
        if not self._awake:
            return self._overlay.empty
        count = 0
        for group in self.groups:
            # The engine keeps these on the left-hand side, opposite in sign to the force.
            count = group.tangent(self._q, self._v, -factor_q, -factor_v, self._triplets, count)
        return self._overlay.matrix(self._triplets[:count])

    def _begin(self, t: float) -> None:
        """A new step (or a new try of one): accept the state that it starts from, look who may be touched in it."""
        data = self.mbs.systemData
        self._q, self._v = data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)
        ended, self._time = self._time, t
        start_time = data.GetTime(exu.ConfigurationType.StartOfStep)
        if t <= start_time:  # the very first evaluation of a solve, before its first step
            start_time = t
            later = ended is None or not math.isclose(t, ended, rel_tol=1e-9)  # than a sum of steps comes to
            if later and not np.array_equal(self._q, self._last):
                self._accepted = None  # it does not start where the last one ended
            self.accept_state(t, self._q, self._v)
        elif start_time != self._accepted or self.ledger.length == 1:
            if start_time == self._accepted:  # the first step: bodies may have been moved since forces were first asked
                self._accepted = None
            start = exu.ConfigurationType.StartOfStep
            self.accept_state(
                start_time, data.GetODE2Coordinates(start, copy=False), data.GetODE2Coordinates_t(start, copy=False)
            )
        if any(group.leaning(self._q) > LEANING for group in self._spatial):
            raise scene_error("bed", f"at {t:.6g} s a body has left the x-y plane, where alone its resistance is known")
        self._awake = any([group.wake(t - start_time) for group in self.groups])

    def accept(self) -> None:
        """Take the current state of the system as accepted; for callers that know it is (a post-step function)."""
        data = self.mbs.systemData
        self.accept_state(data.GetTime(), data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False))

    @property
    def ledger(self) -> Ledger:
        """Rows of the history, once the list of bodies is closed."""
        assert self._ledger is not None  # the engine asks for forces only once the bed is attached
        return self._ledger

    def accept_state(self, t: float, q: Vector, v: Vector) -> None:
        """`accept`, for callers that have the time (s) and all coordinates and rates of the system at hand.

        q, v: float64 and contiguous, as the engine keeps them; they are read as such, unchecked.
        """
        if t == self._accepted:
            return
        if self._accepted is None or t < self._accepted:
            self._restart(q, v)
        row = self.ledger.new_row(t)
        for group in self.groups:
            group.accept(q, v, row)
        self._accepted, self._last = t, q.copy()

    def _restart(self, q: Vector, v: Vector) -> None:
        """A new solve begins: forget the history, rest the bristles."""
        self.ledger.length = 0
        for group in self.groups:
            group.start(self.mbs, q, v)

    # ---- what is read afterwards ----

    @property
    def history(self) -> LoadHistory:
        """All steps up to the system's current state, which counts as accepted; reading it changes nothing."""
        return self._seen(lambda: self.accepted)

    def _seen(self, read: Callable[[], LoadHistory]) -> LoadHistory:
        """What is read with the system's current state accepted, which is taken back afterwards."""
        if self._accepted is None or not self.mbs.systemData.GetTime() > self._accepted:
            return read()
        length, accepted, last = self.ledger.length, self._accepted, self._last
        kept = [group.remember() for group in self.groups]
        self.accept()
        found = read()
        self.ledger.length, self._accepted, self._last = length, accepted, last
        for group, memory in zip(self.groups, kept, strict=True):
            group.recall(memory)
        return found

    @property
    def _now(self) -> LoadHistory:
        """The last entry of the history, at no more than the cost of one."""
        if self._ledger is None:
            return self.accepted
        return self._seen(lambda: self.ledger.last(self.term_names, named(self.runs)))

    @property
    def accepted(self) -> LoadHistory:
        """The steps accepted so far; safe to read while a solve is under way."""
        ledger = self._new_ledger() if self._ledger is None else self._ledger
        return ledger.history(self.term_names, named(self.runs))

    @property
    def work(self) -> float:
        """Work done by the medium on the bodies (J); its negative is the energy dissipated in the medium."""
        work = self._now.work
        return float(work[-1]) if len(work) else 0.0

    @property
    def terms(self) -> dict[str, Vector]:
        """Each term's resultant x, y (N) and moment about the origin (N m) at the end, (3,) each.

        Right-handed about z, as the engine has moments: counter-clockwise is positive. So is all else that a bed tells.
        """
        return _last(self._now.terms, self.term_names)

    @property
    def bodies(self) -> dict[str, Vector]:
        """Resultant x, y (N) and moment about the origin (N m) on each named body at the end, (3,) each."""
        return _last(self._now.bodies, named(self.runs))

    @property
    def force(self) -> Vector:
        """Resultant (2,) N of the medium on all named bodies at the end."""
        total: Vector = sum(self.terms.values(), np.zeros(3))[:2]
        return total


def _expect(name: str, given: Sequence[Any], kinds: tuple[type, ...], allowed: str) -> None:
    for one in given:
        if not isinstance(one, kinds):
            raise ValueError(f"{name}: got {one!r}, allowed is {allowed}")


def _last(rows: Vector, names: tuple[str, ...]) -> dict[str, Vector]:
    return dict(zip(names, rows[-1] if len(rows) else np.zeros((len(names), 3)), strict=True))


def _layered(run: Run, layer: Layer) -> NDArray[np.void]:
    """Record (1,) of a run for a medium in a layer."""
    record = run.run.copy()
    record["layered"], record["top"], record["bottom"] = not layer.whole, layer.top, layer.bottom
    return record


def _profile(surface: ArrayLike, slope: float) -> Vector:
    """Corners (k, 2) m, as the kernels read them, of a surface given as a height and a slope, or as corners."""
    given = np.asarray(surface, float)
    profile = np.array([[0.0, float(given)]]) if given.ndim == 0 else given
    if profile.ndim != 2 or profile.shape[1] != 2 or len(profile) == 0:
        raise ValueError(f"surface: got an array of shape {given.shape}, allowed are a number and (k, 2) corners")
    if not np.isfinite(profile).all():
        raise ValueError(f"surface: got {given.tolist()}, allowed are finite numbers")
    if (np.diff(profile[:, 0]) <= 0.0).any():
        raise ValueError("surface: x of the corners must rise from one to the next")
    if np.ndim(slope) != 0 or not np.isfinite(slope):
        raise ValueError(f"slope: got {slope}, allowed is a finite number, the rise per length")
    if slope != 0.0 and len(profile) > 1:
        raise ValueError(f"slope: got {slope} and corners of the surface; allowed is one of the two")
    return np.ascontiguousarray(corners(profile, slope))
