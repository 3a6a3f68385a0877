"""The plugin door: a granular bed that acts on bodies of any Exudyn model.

    bed = GranularBed(mbs, play_sand(), surface=-0.14)
    bed.add_cables(elements, diameter=0.006)
    bed.attach()                      # before mbs.Assemble()
    ...
    mbs.SolveDynamic(settings)
    print(bed.work, bed.force)

Each run of strips is laid over its body as a massless `ObjectGenericODE2` on the body's own nodes; nothing else of the
model is touched, no user function of the model is taken. State that belongs to a step (the anchors of the static law,
the work done) is advanced when the engine first asks for a force in the step after it, from the engine's own record of
where that step started; so a step that the engine rejects and repeats leaves no trace.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.kernels.runs import DEPTH, POWER, ROW, TIME, TOTALS, WORK
from granular_contact.media.lee_marghitu import TERMS, LeeMarghitu
from granular_contact.media.static_friction import Elastoplastic, Smooth
from granular_contact.multibody.history import LoadHistory
from granular_contact.multibody.runs import ELEMENTS_PER_RUN, Run, cable_run, rigid_run

Vector = NDArray[np.float64]


class GranularBed:
    """Bed of one medium under one level surface, acting on the bodies named to it.

    Parameters
    ----------
    mbs : exudyn.MainSystem
        System whose bodies move in its x-y plane, y up.
    medium : LeeMarghitu
        For example `play_sand()`.
    surface : float
        Height y of the free surface (m).
    gravity : float
        Magnitude of gravity (m/s2) in the static resistance of the medium.
    static : Elastoplastic or Smooth
        How the sign of the static resistance is regularised.
    form : {"distributed", "resultant"}
        Law integrated along the immersed part, or the source paper's single force at its middle.
    end_cap : bool
        Whether free end faces add to the drag.

    Notes
    -----
    `work`, `force`, `terms` and the whole `history` can be read at any time, during a solve or after it.
    """

    def __init__(
        self,
        mbs: Any,
        medium: LeeMarghitu,
        surface: float,
        *,
        gravity: float = 9.81,
        static: Elastoplastic | Smooth | None = None,
        form: str = "distributed",
        end_cap: bool = False,
    ) -> None:
        if form not in ("distributed", "resultant"):
            raise ValueError(f"form: got {form!r}, allowed are 'distributed' and 'resultant'")
        for name, value in (("surface", surface), ("gravity", gravity)):
            if not np.isfinite(value):
                raise ValueError(f"{name}: got {value}, allowed is a finite number")
        self.mbs = mbs
        self.surface = float(surface)
        self.medium = medium.record(Elastoplastic() if static is None else static, gravity)
        self.resultant = form == "resultant"
        self.end_cap = end_cap
        self.runs: list[Run] = []
        self.load_calls = 0
        self._attached = False
        self._time: float | None = None  # time of the step for which forces were last asked
        self._accepted: float | None = None  # time of the last accepted state
        self._history = np.zeros((256, ROW))
        self._rows = 0

    # ---- what the medium acts on ----

    def add_rigid(
        self, body: Any, start: ArrayLike, end: ArrayLike, diameter: float, *, strips: int = 16, free_end: bool = True
    ) -> None:
        """Let the medium act on a straight cylinder fixed to a RigidBody2D.

        start, end: axis of the cylinder, (2,) m in the body's frame; diameter in m; strips: how finely the static law
        is resolved along it; free_end: whether the face at `end` is free (for end caps).

        Raises
        ------
        SceneError
            The body is of another kind, or the cylinder has no length or no diameter.
        """
        self._open()
        a, b = np.asarray(start, float)[:2], np.asarray(end, float)[:2]
        self.runs.append(rigid_run(self.mbs, body, a, b, diameter, strips, self._flags(free_end)))

    def add_cables(
        self, elements: Sequence[Any], diameter: float, *, strips_per_element: int = 4, free_end: bool = True
    ) -> None:
        """Let the medium act on ANCFCable2D elements that follow one another, a round beam of this diameter (m).

        Raises
        ------
        SceneError
            An item is no ANCFCable2D, or two neighbours in the list share no node.
        """
        self._open()
        items = list(elements)
        size = len(items) if self.resultant else ELEMENTS_PER_RUN
        # Runs are counted from the tip, where the beam meets the medium first.
        for stop in range(len(items), 0, -size):
            chunk = items[max(0, stop - size) : stop]
            flags = self._flags(free_end and stop == len(items))
            self.runs.append(cable_run(self.mbs, chunk, diameter, strips_per_element, flags))

    def _flags(self, free_end: bool) -> dict[str, Any]:
        return {"surface": self.surface, "cap": self.end_cap and free_end, "resultant": self.resultant}

    def _open(self) -> None:
        if self._attached:
            raise scene_error("bed", "it is attached already; name every body before attach()")

    def attach(self) -> None:
        """Put the load into the system; once, after all bodies are named and before `mbs.Assemble()`.

        Raises
        ------
        SceneError
            Nothing was named, or attach was called before.
        """
        self._open()
        if not self.runs:
            raise scene_error("bed", "no body was named: use add_rigid or add_cables first")
        self._attached = True
        for run in self.runs:
            self.mbs.AddObject(
                items.ObjectGenericODE2(
                    nodeNumbers=[exu.NodeIndex(node) for node in run.nodes],
                    forceUserFunction=self._force_function(run),
                    jacobianUserFunction=self._jacobian_function(run),
                    visualization=items.VObjectGenericODE2(show=False),
                )
            )

    # ---- what the engine calls ----

    def _force_function(self, run: Run) -> Callable[..., list[float]]:
        def force(mbs: Any, t: float, item: int, q: list[float], v: list[float]) -> list[float]:  # noqa: ARG001
            self.load_calls += 1
            if t != self._time:
                self._begin(t)
            if not run.awake:
                return run.zeros
            return run.force(self._q, self._v)

        return force

    def _jacobian_function(self, run: Run) -> Callable[..., Any]:
        def jacobian(
            mbs: Any,  # noqa: ARG001
            t: float,
            item: int,  # noqa: ARG001
            q: list[float],  # noqa: ARG001
            v: list[float],  # noqa: ARG001
            factor_q: float,
            factor_v: float,
        ) -> Any:
            if t != self._time:
                self._begin(t)
            # The engine keeps these on the left-hand side, opposite in sign to the force.
            return run.jacobian(self._q, self._v, -factor_q, -factor_v)

        return jacobian

    def _begin(self, t: float) -> None:
        """A new step (or a new try of one): accept the state that it starts from, look who may be touched in it."""
        data = self.mbs.systemData
        self._q, self._v = data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)
        self._time = t
        start_time = data.GetTime(exu.ConfigurationType.StartOfStep)
        if t <= start_time:  # the very first evaluation of a solve, before its first step
            start_time = t
            self._accept(t, self._q, self._v)
        elif start_time != self._accepted or self._rows == 1:
            if start_time == self._accepted:  # the first step: bodies may have been moved since forces were first asked
                self._accepted = None
            start = exu.ConfigurationType.StartOfStep
            self._accept(
                start_time, data.GetODE2Coordinates(start, copy=False), data.GetODE2Coordinates_t(start, copy=False)
            )
        for run in self.runs:
            run.wake(t - start_time)

    def accept(self) -> None:
        """Take the current state of the system as accepted; for callers that know it is (a post-step function)."""
        data = self.mbs.systemData
        self._accept(data.GetTime(), data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False))

    def _accept(self, t: float, q: Vector, v: Vector) -> None:
        if t == self._accepted:
            return
        if self._accepted is None or t < self._accepted:
            self._restart(q, v)
        row = self._new_row()
        for run in self.runs:
            run.accept(q, v, row)
        row[TIME] = t
        if self._rows > 1:
            last = self._history[self._rows - 2]
            row[WORK] = last[WORK] + 0.5 * (row[POWER] + last[POWER]) * (t - last[TIME])
        self._accepted = t

    def _restart(self, q: Vector, v: Vector) -> None:
        """A new solve begins: forget the history, rest the bristles."""
        self._rows = 0
        for run in self.runs:
            run.start(self.mbs, q, v, self.medium)

    def _new_row(self) -> Vector:
        if self._rows == len(self._history):
            self._history = np.vstack([self._history, np.zeros_like(self._history)])
        self._rows += 1
        row: Vector = self._history[self._rows - 1]
        row[:] = 0.0
        row[DEPTH] = -np.inf
        return row

    # ---- what is read afterwards ----

    @property
    def history(self) -> LoadHistory:
        """All steps up to the system's current state, which counts as accepted; reading it changes nothing."""
        if self._accepted is None or not self.mbs.systemData.GetTime() > self._accepted:
            return self.accepted
        rows, accepted = self._rows, self._accepted
        kept = [run.remember() for run in self.runs]
        self.accept()
        history = self.accepted
        self._rows, self._accepted = rows, accepted
        for run, memory in zip(self.runs, kept, strict=True):
            run.recall(memory)
        return history

    @property
    def accepted(self) -> LoadHistory:
        """The steps accepted so far; safe to read while a solve is under way."""
        rows = self._history[: self._rows]
        time, work, power, depth = rows[:, (TIME, WORK, POWER, DEPTH)].T
        return LoadHistory(time, work, power, depth, rows[:, TOTALS:].reshape(-1, len(TERMS), 3).copy())

    @property
    def work(self) -> float:
        """Work done by the medium on the bodies (J); its negative is the energy dissipated in the medium."""
        return float(self.history.work[-1]) if self._rows else 0.0

    @property
    def terms(self) -> dict[str, Vector]:
        """Each term's resultant x, y (N) and moment about the origin (N m) at the end, (3,) each."""
        last = self.history.terms[-1] if self._rows else np.zeros((len(TERMS), 3))
        return dict(zip(TERMS, last, strict=True))

    @property
    def force(self) -> Vector:
        """Resultant (2,) N of the medium on all named bodies at the end."""
        total: Vector = sum(self.terms.values(), np.zeros(3))[:2]
        return total
