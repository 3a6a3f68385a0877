"""March of a tree through time by the generalised-alpha method: its records and arrays.

`kernels.tree_march` changes the arrays, which `kernels.tree_arrays` explains.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.tree.kernels import tree_march as kernels
from granular_contact.engines.tree.kernels.tree import SLIDER
from granular_contact.engines.tree.kernels.tree_arrays import (
    CLOCK,
    CONTROL,
    COUNTS,
    NEWTON,
    SCHEME,
    addresses,
)
from granular_contact.engines.tree.kernels.tree_calls import record as calls
from granular_contact.engines.tree.kernels.tree_newton import attempt
from granular_contact.engines.tree.tree import Tree
from granular_contact.jit.compiled import ready
from granular_contact.mechanics.kernels import step_error
from granular_contact.mechanics.kernels.iterations import ITERATIONS, room
from granular_contact.mechanics.kernels.numerics import SHORTEST
from granular_contact.mechanics.scheme import spectral_radius, tolerance_by_accuracy
from granular_contact.mechanics.stepping import choice, learn, most_steps, usual_step
from granular_contact.sand.history import HistoryTable
from granular_contact.sand.kernels.lines import DEPTH
from granular_contact.sand.load import TOUCH_DISTANCE, TOUCH_TIME
from granular_contact.sand.rolling import take_rolled_state
from granular_contact.sand.state import restore_batches
from granular_contact.scene.types import FASTEST, Scene, Vector

SHARE = 1024  # steps between two updates of the progress bar
# Arrays that determine the future of a march, besides those of the iterations and of the choice of steps.
LASTING = (
    *("s", "rates", "s2", "lagged", "factors", "state", "clock", "counts", "newton", "home"),
    "inverse",
)
SLOW = 1e-3  # times the speed of rest: least speed for a tolerance that is relative to the greatest speed
ANY = 1e-3  # accuracy that a record of CHOICE has where steps are fixed, which do not use it


class March:
    """March of a tree. arrays: by the names of `kernels.tree_arrays`; they include the arrays of the tree itself."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree  # kept, as the load of its bed owns arrays of the medium
        nodes, table = len(tree.arrays["nodes"]), HistoryTable() if tree.load is None else tree.load.table
        self.arrays = arrays = {
            **tree.arrays,
            **_step_records(tree.scene),
            "blank": table.blank,
            "calls": calls(tree.kernels, attempt, tree.sand_kernels, tree.joint_kernels),
        }
        shown = sum(arrays[name].size for name in ("pose", "pose_rates", "acceleration"))
        arrays["states"] = np.zeros((1 + SHARE, shown + 2 * nodes))
        arrays["table"] = np.zeros((1 + SHARE, len(table.blank)))
        self._newton, self._changes = _iterations(arrays), _changes(arrays)
        arrays["iterations"], arrays["changes"] = (
            ITERATIONS.addresses(self._newton),
            step_error.CHANGES.addresses(self._changes),
        )
        self._addresses = addresses(arrays)
        self._start, self._march = ready(kernels.start, True, self._addresses), ready(kernels.march, 0, self._addresses)
        self.begin()

    def begin(self) -> None:
        """Find the accelerations at the start, and write the first row.

        Where a body just touches the surface, the accelerations are those a moment later, when it is in the medium.
        A march from static equilibrium begins with the friction state there.
        """
        self._start(True, self._addresses)
        if (rest := self.tree.rest) is not None:
            if self.tree.load is not None:
                restore_batches(self.tree.load.batches, rest.batches)
            self._start(False, self._addresses)
            return
        if abs(self.rows[0, DEPTH]) <= TOUCH_DISTANCE:
            placed, poses = self._placed(), self.states[0, : self.arrays["pose"].size].copy()
            self.arrays["s"] += TOUCH_TIME * self.arrays["rates"]
            self._start(True, self._addresses)
            for array, before in zip(self._placed(copied=False), placed, strict=True):
                array[:] = before
            self.states[0, : len(poses)] = poses
        if self.tree.load is not None and (test := self.tree.scene.wheel_test) is not None and test.begins:
            take_rolled_state(self.tree.scene, self.tree.load)
            self._start(False, self._addresses)

    def _placed(self, *, copied: bool = True) -> list[NDArray[Any]]:
        """Coordinates, and in space also the home orientations of the charts of ball joints."""
        arrays = [self.arrays[name] for name in ("s", "home") if name in self.arrays]
        return [array.copy() for array in arrays] if copied else arrays

    def plan(self, until: float) -> None:
        """Set the time (s) to march to next; fixed steps divide the way evenly, none longer than the scene's step."""
        solver = self.tree.scene.solver
        self.arrays["control"]["end"] = until
        if solver.accuracy is None:
            left, clock = until - self.time, self.arrays["clock"]
            clock["step"] = left / max(1, math.ceil(left / solver.step_s - 1e-9))
            clock["origin"], clock["whole"] = self.time, 0.0

    def proceed(self) -> int:
        """March on by a share of steps; return the code of the reason to return, see `kernels.tree_march`."""
        if len(self.rows) - 1 - self.last < SHARE:
            self._enlarge(max(SHARE, self.last // 2))
        return int(self._march(SHARE, self._addresses))

    def _enlarge(self, rows: int) -> None:
        for name in ("states", "table"):
            old = self.arrays[name]
            self.arrays[name] = np.concatenate([old, np.zeros((rows, old.shape[1]))])
        self._addresses[:] = addresses(self.arrays)

    @property
    def states(self) -> Vector:
        """Motion, residuals and targets of all nodes (rows, numbers); the first `last` + 1 rows are filled."""
        return self.arrays["states"]

    @property
    def rows(self) -> Vector:
        """History of the medium (rows, columns); the first `last` + 1 rows are filled."""
        return self.arrays["table"]

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return float(self.arrays["clock"]["now"][0])

    @property
    def tried(self) -> float:
        """Length (s) of the last step that was tried."""
        return float(self.arrays["clock"]["tried"][0])

    @property
    def last(self) -> int:
        """Index of the row of the present state."""
        return int(self.arrays["counts"]["steps"][0])

    @property
    def cost(self) -> dict[str, int]:
        """Counts of steps, iterations and matrices, by the names of `results.Cost`."""
        counts, newton = self.arrays["counts"][0], self.arrays["newton"][0]
        return {
            "steps": self.last,
            "newton_iterations": int(newton["iterations"]),
            "jacobians": int(newton["matrices"]),
            "shortened_steps": int(counts["shortened"]),
            "refused_steps": int(counts["refused"]),
        }

    @property
    def _lasting(self) -> list[NDArray[Any]]:
        """All arrays that determine the future of the march, but for rows and the state of the bed."""
        lasting = (self.arrays[name] for name in LASTING if name in self.arrays)
        return [*lasting, *self._newton.values(), *self._changes.values()]

    def kept(self) -> tuple[list[NDArray[Any]], Vector, Vector]:
        """Copies of all arrays that determine the future of the march, and of the rows so far."""
        used = self.last + 1
        return [array.copy() for array in self._lasting], self.states[:used].copy(), self.rows[:used].copy()

    def restore(self, kept: tuple[list[NDArray[Any]], Vector, Vector]) -> None:
        """Return to a state from `kept`."""
        lasting, states, rows = kept
        for array, old in zip(self._lasting, lasting, strict=True):
            array[:] = old
        if len(rows) > len(self.rows):
            self._enlarge(len(rows) - len(self.rows))
        self.states[: len(rows)], self.rows[: len(rows)] = states, rows


def _step_records(scene: Scene) -> dict[str, NDArray[Any]]:
    """Records of the time scheme, the choice of steps and the limits of a march, its clock and its counts."""
    solver, scheme = scene.solver, _scheme(scene)
    record, speed, *follows = choice(scene, ANY if solver.accuracy is None else solver.accuracy)
    learn(record, scene, float(scheme["beta"][0]), SHORTEST * usual_step(scene))
    first = solver.step_s if solver.accuracy is None else min(solver.step_s, float(record["longest"][0]))
    arrays = dict(zip(("bends", "followed", "arms"), follows, strict=True))
    clock = np.zeros(1, CLOCK)
    clock["step"], clock["fastest"] = first, speed
    arrays |= {"clock": clock, "counts": np.zeros(1, COUNTS), "newton": np.zeros(1, NEWTON)}
    return arrays | {"scheme": scheme, "choice": record, "control": _limits(scene)}


def _limits(scene: Scene) -> NDArray[np.void]:
    """Record (1,) of CONTROL."""
    solver, control = scene.solver, np.zeros(1, CONTROL)
    control["end"], control["rest_speed"] = solver.end_time_s, solver.rest_speed_m_s
    control["rest_time"] = math.inf if scene.rest_time is None else scene.rest_time
    control["away"], control["most"] = FASTEST, most_steps(scene)
    tolerance = tolerance_by_accuracy(scene)
    control["tolerance"] = tolerance * scene.force_scale / scene.mass
    control["share"], control["slow"] = tolerance, SLOW * solver.rest_speed_m_s
    return control


def _scheme(scene: Scene) -> NDArray[np.void]:
    """Record (1,) of SCHEME: generalised-alpha method with the spectral radius at infinite frequency."""
    solver, scheme = scene.solver, np.zeros(1, SCHEME)
    radius = spectral_radius(scene) if solver.spectral_radius is None else solver.spectral_radius
    alpha_m, alpha_f = (2.0 * radius - 1.0) / (radius + 1.0), radius / (radius + 1.0)
    gamma = 0.5 + alpha_f - alpha_m
    scheme["alpha_m"], scheme["alpha_f"] = alpha_m, alpha_f
    scheme["beta"], scheme["gamma"] = 0.25 * (gamma + 0.5) ** 2, gamma
    scheme["fixed"] = solver.accuracy is None
    return scheme


def _iterations(arrays: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Arrays of `mechanics.kernels.iterations`; a tree has no Lagrange multipliers."""
    unknowns = {"q": "s", "v": "rates", "a": "s2", "a_before": "s2_before"}
    shared = {name: arrays[of_tree] for name, of_tree in unknowns.items()}
    return shared | {"lever": _levers(arrays)} | room(len(arrays["nodes"]), 0)


def _levers(arrays: dict[str, NDArray[Any]]) -> Vector:
    """Factors (n,) from rates of coordinates to speeds of points (m/s); 0 for prescribed coordinates."""
    nodes = arrays["nodes"]
    reach = nodes["radius"] + np.linalg.norm(nodes["point"], axis=1)  # of a joint: over all nodes that it carries
    for i in range(len(nodes) - 1, -1, -1):
        parent = nodes[i]["parent"]
        if parent >= 0:
            to_parent = np.linalg.norm(nodes[i]["on_parent"]) + np.linalg.norm(nodes[parent]["point"])
            reach[parent] = max(reach[parent], reach[i] + to_parent)
    lever: Vector = np.where(nodes["kind"] == SLIDER, 1.0, reach)
    lever[arrays["prescribed"] != 0] = 0.0
    return lever


def _changes(arrays: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Arrays of `mechanics.kernels.step_error`, for the accelerations of nodes that have a mass."""
    lever = arrays["lever"]
    counts = np.repeat(arrays["nodes"]["mass"] > 0.0, arrays["twist"].shape[1])
    group = np.where(counts, step_error.EACH, step_error.NONE).astype(np.int64)
    motion = {"a": arrays["acceleration"].reshape(-1), "v": arrays["twist"].reshape(-1), "lever": lever.copy()}
    start, change, slope = np.zeros((3, len(lever)))
    return motion | {
        "group": group,
        "start": start,
        "change": change,
        "slope": slope,
        "means": np.zeros(0, step_error.MEAN),
    }
