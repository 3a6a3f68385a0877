"""A granular load in an Exudyn system: the engine's coordinates in, generalised forces out, steps as they are accepted.

The forces on all bodies are computed in one call and reach them through an `Overlay` on their own nodes. State that
belongs to a step (the friction state, the work done) is advanced when the engine first asks for a force in the step
after it, from the engine's own record of where that step started; so a step that the engine rejects and repeats leaves
no trace.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.engines.exudyn import beams
from granular_contact.engines.exudyn.bodies import rigid_node, spatial_node
from granular_contact.engines.exudyn.engine_checks import abilities, of_vectors
from granular_contact.engines.exudyn.overlay import Overlay
from granular_contact.engines.exudyn.views import START, Views, reference
from granular_contact.errors import scene_error
from granular_contact.sand import state
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.kernels.lines import DEPTH
from granular_contact.sand.load import AHEAD, TOUCHES, GranularLoad

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.joint_actions import JointActions

Vector = NDArray[np.float64]
MOST_TILT = 0.01  # sine of an angle, 0.6 degrees: forces in the plane are then off by its square


class CouplingState(NamedTuple):
    """State of the load; time (s) of the step for which forces were asked last, coordinates accepted last, calls."""

    load: state.LoadState
    time: float | None
    last: Vector
    load_calls: int


class Coupling:
    """A load on bodies of a system; `load_calls`: how often the engine asked for forces.

    origin (2,) m, world frame: that of the engine's coordinates.
    """

    def __init__(self, mbs: Any, load: GranularLoad, origin: Vector | None = None) -> None:
        self.mbs, self.load = mbs, load
        self._origin = np.zeros(2) if origin is None else origin
        self.load_calls = 0
        self._ahead: Vector = np.zeros(0)  # of the first state (see `_begin_at`)
        self.nodes: tuple[int, ...] = ()  # that carry contact lines
        self.overlay = Overlay(mbs)
        self._joints: JointActions | None = None
        self._acts = False  # whether forces were sent last
        self._under_way = False  # whether forces are asked for within a step, and not at the start of a solve
        self._time: float | None = None  # time of the step for which forces were last asked
        self._last = np.zeros(0)  # coordinates of the last accepted state
        self.views: Views | None = None  # where the engine keeps them, if that is known
        self.roll_in: Callable[[GranularLoad], None] | None = None  # leaves the medium as a motion before the start

    # ---- before the system is assembled ----

    def body(self, number: Any, name: str | None = None, *, in_space: bool = False) -> Body:
        """A rigid body of the system, by its own name unless given; errors as of `bodies.rigid_node`.

        in_space: whether it may move as it likes, with errors as of `bodies.spatial_node`.
        """
        node, size = (spatial_node if in_space else rigid_node)(self.mbs, number)
        own = self.mbs.GetObject(number)["name"]
        return Body(own if name is None else name, self._coordinates([node], size)[0])

    def cables(
        self, elements: Sequence[Any], name: str | None, strips: int, free_end: bool, *, in_space: bool, **size: Any
    ) -> None:
        """Let the load act on elements of a beam, by the name of the first unless given; see `beams` for the rest."""
        made = beams.row(self.mbs, elements, beams.IN_SPACE if in_space else beams.IN_PLANE)
        self.nodes += tuple(node for node in made.nodes if node not in self.nodes)
        given = (made, made.name if name is None else name, self.load, self.overlay, strips, free_end)
        if in_space:
            beams.in_space(*given, **size)
        else:
            self.load.add(beams.in_plane(*given, **size))

    def _coordinates(self, nodes: Sequence[int], each: int) -> NDArray[np.int64]:
        self.nodes += tuple(node for node in nodes if node not in self.nodes)
        return self.overlay.coordinates(nodes, each)

    def attach(
        self, constant: Mapping[int, ArrayLike], joints: JointActions | None = None, *, warns: bool = False
    ) -> None:
        """Put the load into the system, generalised forces (by node number) that act all the time, and what joints do.

        joints: on the overlay of this coupling. warns: whether to warn the caller's caller of what is slower with this
        Exudyn, which results of a run tell.
        """
        for words in of_vectors(abilities(self.overlay.mbs)) if warns else ():
            warnings.warn(words, stacklevel=3)
        self.load.close()
        self._joints = joints
        self.overlay.attach(constant, self._force, self._jacobian)
        self._set, self._sink = self.overlay.set_forces, self.overlay.sink
        self._stay = abilities(self.overlay.mbs).views  # whether `_q` and `_v` follow the engine

    # ---- what the engine calls ----

    def _force(self, _mbs: Any, t: float, _item: Any, _q: list[float], _v: list[float]) -> list[float]:
        """`apply`, where the engine asks for forces."""
        self.apply(t)
        return self.overlay.nothing

    def apply(self, t: float) -> None:
        """Set the forces at the system's present state, at the time t (s); nothing else is called in most iterations.

        A call from the engine into Python takes as long as the law on a few strips; so whoever is called before each
        residual anyway calls this as well, and lets the overlay go `unasked`.
        """
        self.load_calls += 1
        if t != self._time:
            self._begin(t)
        elif not self._stay:
            self._read()
        joints, overlay, active, pulls = self._joints, self.overlay, self.load.active, False
        if joints is not None:
            pulls = joints.acts
            if t != joints.time:
                joints.begin(t)
        if active or pulls or self._acts:
            forces = overlay.forces
            forces[:] = overlay.constant
            if joints is not None and pulls:
                joints.add_forces(self._q, self._v, forces)
            if active:
                self.load.add_forces(self._q if self._under_way else self._q + self._ahead, self._v, forces)
            self._set(self._sink, "forceVector", forces)  # as `Overlay.send`
            self._acts = active or pulls

    def _jacobian(self, t: float, factor_q: float, factor_v: float) -> Any:
        """Tangent at the system's present state, as the engine's sparse matrix."""
        if t != self._time:
            self._begin(t)
        elif not self._stay:
            self._read()
        joints = self._joints
        if joints is not None and t != joints.time:
            joints.begin(t)
        # The engine keeps these on the left-hand side, opposite in sign to the force.
        state = self._q, self._v, -factor_q, -factor_v
        parts = [joints.tangent(*state)] if joints is not None and joints.acts else []
        if self.load.active:
            parts.append(self.load.tangent(*state))
        return self.overlay.matrix(np.concatenate(parts)) if parts else self.overlay.empty

    def _read(self) -> None:
        """Read the state anew."""
        _, self._q, self._v = self._present()

    def _begin(self, t: float) -> None:
        """A new step (or a new try of one): accept the state that it starts from, look who may be touched in it."""
        views = self.views or Views(self.mbs)
        self._q, self._v = views.q, views.v
        ended, self._time = self._time, t
        start_time = views.data.GetTime(START)
        if t <= start_time:  # the very first evaluation of a solve, before its first step
            start_time = t
            later = ended is None or not math.isclose(t, ended, rel_tol=1e-9)  # than a sum of steps comes to
            elsewhere = later and not np.array_equal(self._q, self._last)  # than where the last one ended
            self.accept_state(t, self._q, self._v, anew=elsewhere)
        elif start_time != self.load.time or self.load.table.length == 1:
            # In the first step bodies may have been moved since forces were first asked.
            self.accept_state(start_time, views.q_before, views.v_before, anew=start_time == self.load.time)
        if self.load.leaning(self._q) > MOST_TILT:
            raise scene_error("bed", f"at {t:.6g} s a body has left the x-y plane, where alone its resistance is known")
        self.load.update_active(t - start_time)
        self._under_way = self._is_under_way(t)

    def _is_under_way(self, t: float | None) -> bool:
        """Whether forces at this time (s) are those within a step, and not at the start of a solve."""
        return self.load.table.length > 1 or t != self.load.time

    # ---- accepted states ----

    def accept(self) -> None:
        """Take the current state of the system as accepted; for callers that know it is (a post-step function)."""
        self.accept_state(*self._present())

    def accept_state(self, t: float, q: Vector, v: Vector, *, anew: bool = False) -> None:
        """`accept`, for callers that have the time (s) and all coordinates and rates of the system at hand.

        q, v: float64 and contiguous, as the engine keeps them; they are read as such, unchecked. anew: whether a new
        solve begins here, as it does where time goes back: history and friction state are reset.
        """
        if t == self.load.time and not anew:
            return
        if anew or self.load.time is None or t < self.load.time:
            self._begin_at(t, q, v)
        else:
            self.load.accept(t, q, v)
        self._last = q.copy()

    def _begin_at(self, t: float, q: Vector, v: Vector) -> None:
        """Begin with an empty history in a state; one that just touches the medium as it will be at once."""
        for ahead in (np.zeros_like(v), AHEAD * v):
            self._ahead = ahead
            self.load.start(q + ahead, *self._places())
            if self.roll_in is not None:
                self.roll_in(self.load)
            self.load.accept(t, q + ahead, v)
            if abs(self.load.table.row[DEPTH]) > TOUCHES:
                return

    # ---- to go back to an earlier state ----

    def act(self, t: float, active: bool) -> None:
        """Act as it once did, at a state within a step to a time (s), whose start is accepted already.

        active: whether anything may be touched; the states of batches were brought back before.
        """
        self._read()
        self._time, self.load.active, self._under_way = t, active, True
        for batch in self.load.batches:
            batch.forget()

    @property
    def kept(self) -> CouplingState:
        """What its future depends on beside the engine's state, and its history."""
        return CouplingState(state.state(self.load), self._time, self._last, self.load_calls)

    def restore(self, kept: CouplingState) -> None:
        """Go back to what was kept; the next forces are sent, whatever was sent last."""
        state.restore(self.load, kept.load)
        self._time, self._last, self.load_calls = kept.time, kept.last, kept.load_calls
        self._under_way = self._is_under_way(kept.time)
        self._acts = True

    def present(self) -> AbstractContextManager[None]:
        """The system's current state counts as accepted within; it is taken back afterwards."""
        if not self.load.batches:
            raise scene_error("bed", "it does not act, so it has nothing to tell: call attach() before mbs.Assemble()")
        if self.load.time is None or not self.mbs.systemData.GetTime() > self.load.time:
            return nullcontext()
        return self.load.accepted(*self._present())

    def _present(self) -> tuple[float, Vector, Vector]:
        data = self.mbs.systemData
        return data.GetTime(), data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)

    def _places(self) -> tuple[NDArray[np.int64], Vector]:
        """Places of the overlay's coordinates in the assembled system; reference coordinates of it, world frame."""
        where = [place for node in self.overlay.nodes for place in self.mbs.systemData.GetNodeLTGODE2(node)]
        return np.array(where), reference(self.mbs, self.overlay.nodes, self._origin)
