"""Connection of a granular load to an Exudyn system: coordinates in, generalised forces out, accepted steps.

One call computes the forces on all bodies; an `Overlay` on the nodes of the bodies applies them. The friction state and
the work belong to accepted steps. A post-step function may advance them by `accept_state`. Otherwise the coupling does
so when the engine asks for the first force of the next step, with the initial state of that step, which the engine
keeps. So a step that the engine rejects and repeats leaves no trace.
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
from granular_contact.engines.exudyn.engine_checks import abilities, vector_notices
from granular_contact.engines.exudyn.overlay import Overlay
from granular_contact.engines.exudyn.views import START, Views, reference
from granular_contact.errors import scene_error
from granular_contact.sand import state
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.kernels.lines import DEPTH
from granular_contact.sand.load import TOUCH_DISTANCE, TOUCH_TIME, GranularLoad

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.joint_actions import JointActions

Vector = NDArray[np.float64]
MOST_TILT = 0.01  # sine of the largest tilt, 0.6 degrees; the error of forces in the plane grows with its square


class CouplingState(NamedTuple):
    """Saved state of a coupling.

    load: state of the load. step_time: time (s) of the step of the last evaluation. accepted_q: coordinates of the last
    accepted state. load_calls: number of evaluations.
    """

    load: state.LoadState
    step_time: float | None
    accepted_q: Vector
    load_calls: int


class Coupling:
    """A granular load on bodies of an Exudyn system.

    origin (2,) m: origin of the engine's coordinates in the world frame. load_calls: number of evaluations of the
    forces. nodes: nodes that carry contact lines. roll_in: called with the load when a solve starts, to shape the
    medium as a motion before the start has left it.
    """

    def __init__(self, mbs: Any, load: GranularLoad, origin: Vector | None = None) -> None:
        self.mbs, self.load = mbs, load
        self._origin = np.zeros(2) if origin is None else origin
        self.load_calls = 0
        self._start_shift: Vector = np.zeros(0)  # added to the coordinates of the initial state, see `_start_at`
        self.nodes: tuple[int, ...] = ()
        self.overlay = Overlay(mbs)
        self._joints: JointActions | None = None
        self._forces_sent = False  # whether the forces sent last were more than the constant ones
        self._within_step = False  # whether the last evaluation was within a step, not at the start of a solve
        self._step_time: float | None = None  # time (s) of the step of the last evaluation
        self._accepted_q = np.zeros(0)  # coordinates of the last accepted state
        self.views: Views | None = None  # of the present part of a solve; None in a system that others solve
        self.roll_in: Callable[[GranularLoad], None] | None = None

    # ---- before the system is assembled ----

    def body(self, number: Any, name: str | None = None, *, in_space: bool = False) -> Body:
        """Add a rigid body of the system to the overlay; name: that of the Exudyn object unless given.

        in_space: whether the body moves freely in space. Errors are those of `bodies.rigid_node`, in space those of
        `bodies.spatial_node`.
        """
        node, size = (spatial_node if in_space else rigid_node)(self.mbs, number)
        object_name = self.mbs.GetObject(number)["name"]
        return Body(object_name if name is None else name, self._coordinates([node], size)[0])

    def cables(
        self, elements: Sequence[Any], name: str | None, strips: int, free_end: bool, *, in_space: bool, **size: Any
    ) -> None:
        """Let the load act on a row of beam elements.

        name: that of the first element unless given. Other arguments and errors are those of `beams.in_plane` and
        `beams.in_space`.
        """
        row = beams.row(self.mbs, elements, beams.IN_SPACE if in_space else beams.IN_PLANE)
        self.nodes += tuple(node for node in row.nodes if node not in self.nodes)
        arguments = (row, row.name if name is None else name, self.load, self.overlay, strips, free_end)
        if in_space:
            beams.in_space(*arguments, **size)
        else:
            self.load.add(beams.in_plane(*arguments, **size))

    def _coordinates(self, nodes: Sequence[int], size: int) -> NDArray[np.int64]:
        """Places (nodes, size) of the coordinates of nodes in the overlay, to which the nodes are added."""
        self.nodes += tuple(node for node in nodes if node not in self.nodes)
        return self.overlay.coordinates(nodes, size)

    def attach(
        self, constant: Mapping[int, ArrayLike], joints: JointActions | None = None, *, warns: bool = False
    ) -> None:
        """Put the load into the system, with constant generalised forces by node number and with the actions of joints.

        joints: on the overlay of this coupling. warns: whether to warn the user if this version of Exudyn makes the
        load slower; a run has the same warning in the notices of its results.
        """
        for notice in vector_notices(abilities(self.overlay.mbs)) if warns else ():
            warnings.warn(notice, stacklevel=3)
        self.load.close()
        self._joints = joints
        self.overlay.attach(constant, self._force, self._jacobian)
        self._set_parameter, self._force_object = self.overlay.set_parameter, self.overlay.force_object
        self._live = abilities(self.overlay.mbs).views  # whether `_q` and `_v` follow the engine's state

    # ---- called by the engine ----

    def _force(self, _mbs: Any, t: float, _item: Any, _q: list[float], _v: list[float]) -> list[float]:
        """Force function of the trigger object: `apply` at the time t (s)."""
        self.apply(t)
        return self.overlay.no_force

    def apply(self, t: float) -> None:
        """Compute the forces at the system's present state and the time t (s), and pass them to the engine.

        This is the only function of the load that most iterations call. A call from the engine into Python takes as
        long as the law on a few strips. So a function that the engine calls before each residual anyway calls `apply`,
        and `Overlay.untriggered` keeps the engine from calling it once more.
        """
        self.load_calls += 1
        if t != self._step_time:
            self._begin_step(t)
        elif not self._live:
            self._read_state()
        joints, overlay, active, joints_act = self._joints, self.overlay, self.load.active, False
        if joints is not None:
            joints_act = joints.has_forces
            if t != joints.time:
                joints.set_time(t)
        if active or joints_act or self._forces_sent:
            forces = overlay.forces
            forces[:] = overlay.constant
            if joints is not None and joints_act:
                joints.add_forces(self._q, self._v, forces)
            if active:
                self.load.add_forces(self._q if self._within_step else self._q + self._start_shift, self._v, forces)
            self._set_parameter(self._force_object, "forceVector", forces)  # as `Overlay.send`
            self._forces_sent = active or joints_act

    def _jacobian(self, t: float, factor_q: float, factor_v: float) -> Any:
        """Tangent of the left-hand side, -(factor_q df/dq + factor_v df/dv), as the engine's sparse matrix."""
        if t != self._step_time:
            self._begin_step(t)
        elif not self._live:
            self._read_state()
        joints = self._joints
        if joints is not None and t != joints.time:
            joints.set_time(t)

        arguments = self._q, self._v, -factor_q, -factor_v
        triplets = [joints.tangent(*arguments)] if joints is not None and joints.has_forces else []
        if self.load.active:
            triplets.append(self.load.tangent(*arguments))
        return self.overlay.matrix(np.concatenate(triplets)) if triplets else self.overlay.zero_matrix

    def _read_state(self) -> None:
        """Read the system's present coordinates and rates from the engine."""
        _, self._q, self._v = self._present_state()

    def _begin_step(self, t: float) -> None:
        """Begin a step to t (s), or a new attempt: accept its initial state, and mark what can touch the surface."""
        views = self.views or Views(self.mbs)
        self._q, self._v = views.q, views.v
        previous, self._step_time = self._step_time, t
        start_time = views.data.GetTime(START)
        if t <= start_time:  # the first evaluation of a solve, before its first step
            start_time = t
            # A solve continues the last one if it starts at its end time, up to the round-off of a sum of steps, or in
            # its final state.
            other_time = previous is None or not math.isclose(t, previous, rel_tol=1e-9)
            new_solve = other_time and not np.array_equal(self._q, self._accepted_q)
            self.accept_state(t, self._q, self._v, anew=new_solve)
        elif start_time != self.load.time or self.load.table.length == 1:
            # Bodies may have been moved between the first evaluation of a solve and its first step.
            self.accept_state(start_time, views.q_before, views.v_before, anew=start_time == self.load.time)
        if self.load.lean(self._q) > MOST_TILT:
            raise scene_error("bed", f"at {t:.6g} s a body has left the x-y plane, where alone its resistance is known")
        self.load.update_active(t - start_time)
        self._within_step = self._is_within_step(t)

    def _is_within_step(self, t: float | None) -> bool:
        """Whether an evaluation at the time t (s) is within a step, not at the start of a solve."""
        return self.load.table.length > 1 or t != self.load.time

    # ---- accepted states ----

    def accept(self) -> None:
        """Accept the current state of the system as the end of a step; for a post-step function, which knows that."""
        self.accept_state(*self._present_state())

    def accept_state(self, t: float, q: Vector, v: Vector, *, anew: bool = False) -> None:
        """Accept a given state, as `accept` does, without reading it from the engine.

        t: time (s). q, v (m,): all coordinates and rates of the system, float64 and contiguous, as the engine keeps
        them; not checked. anew: whether a new solve begins in this state, so that history and friction state are reset.
        They are also reset if t is earlier than the last accepted time.
        """
        if t == self.load.time and not anew:
            return
        if anew or self.load.time is None or t < self.load.time:
            self._start_at(t, q, v)
        else:
            self.load.accept(t, q, v)
        self._accepted_q = q.copy()

    def _start_at(self, t: float, q: Vector, v: Vector) -> None:
        """Start the load in a state, with an empty history.

        If the deepest point lies at the surface within TOUCH_DISTANCE, the state TOUCH_TIME (s) later is taken: whether
        the body touches the medium then follows from its velocity.
        """
        for shift in (np.zeros_like(v), TOUCH_TIME * v):
            self._start_shift = shift
            self.load.start(q + shift, *self._places())
            if self.roll_in is not None:
                self.roll_in(self.load)
            self.load.accept(t, q + shift, v)
            if abs(self.load.table.row[DEPTH]) > TOUCH_DISTANCE:
                return

    # ---- saved states ----

    def evaluate_again(self, t: float, active: bool) -> None:
        """Prepare an evaluation as in an earlier step to the time t (s), whose initial state is accepted already.

        active: whether anything could touch the surface in that step. The caller has restored the states of the batches
        and the engine's coordinates.
        """
        self._read_state()
        self._step_time, self.load.active, self._within_step = t, active, True
        for batch in self.load.batches:
            batch.forget()

    @property
    def kept(self) -> CouplingState:
        """Copy of the state: with the engine's state, all that later forces and the history depend on."""
        return CouplingState(state.state(self.load), self._step_time, self._accepted_q, self.load_calls)

    def restore(self, kept: CouplingState) -> None:
        """Return to a saved state; the next evaluation sends its forces in any case."""
        state.restore(self.load, kept.load)
        self._step_time, self._accepted_q, self.load_calls = kept.step_time, kept.accepted_q, kept.load_calls
        self._within_step = self._is_within_step(kept.step_time)
        self._forces_sent = True

    def present(self) -> AbstractContextManager[None]:
        """Context within which the system's current state counts as accepted; afterwards the load is as before."""
        if not self.load.batches:
            raise scene_error("bed", "it does not act, so it has nothing to tell: call attach() before mbs.Assemble()")
        if self.load.time is None or not self.mbs.systemData.GetTime() > self.load.time:
            return nullcontext()
        return self.load.accepted(*self._present_state())

    def _present_state(self) -> tuple[float, Vector, Vector]:
        """Present time (s), coordinates and rates of the system; the vectors are views where the engine offers them."""
        data = self.mbs.systemData
        return data.GetTime(), data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)

    def _places(self) -> tuple[NDArray[np.int64], Vector]:
        """Places of the overlay's coordinates in the system's, and the system's reference coordinates (world frame)."""
        places = [place for node in self.overlay.nodes for place in self.mbs.systemData.GetNodeLTGODE2(node)]
        return np.array(places), reference(self.mbs, self.overlay.nodes, self._origin)
