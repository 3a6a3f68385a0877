"""Sinkage of mechanisms after `initial.settle` against the static balance, and the CPU time of settling.

    python validation/settling.py [--quick]

Every shipped model that the sand can carry is settled by the engine, in the medium and on the bed of its config. Its
driven joints are held by PD control; bodies that hang on a hinge rotate into the sand. In the static balance the
resistance is fully mobilised: it is the resistance of a mechanism that reaches the settled pose slowly, along the last
part of the same path, with new bristles. The settled mechanism has less resistance; this difference, over the growth of
the resistance with depth, is the depth by which the mechanism stands too deep (a dropped mechanism stands too deep by
every overshoot). The resistance is also compared with the weight, along the direction in which the mechanism begins to
fall. CPU times are those of building and settling, with compiled kernels in the cache.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

sys.path.insert(0, str(Path(__file__).parents[1]))

import exudyn as exu
import numpy as np
import yaml
from numpy.typing import NDArray

from granular_contact import config, scene
from granular_contact import run as run_module
from granular_contact.config import load_scenario, scenario_to_dict
from granular_contact.engines.exudyn.balance import Balance
from granular_contact.mechanics.mass_and_gravity import mass_matrix
from granular_contact.mechanics.system import System
from validation.study import Claim, Outcome
from validation.tables import machine, markdown

ROOT = Path(__file__).parents[1]
GAIN = 20.0  # N m/rad
DEEPER = 1e-5  # m, difference of depth for the derivative of the resistance
LAST, YIELDING = 1e-4, 2e-3  # m or rad: length of the last part of the path; path on which all bristles come to yield
ALLOWED = 0.01  # error allowed, relative to the sinkage
Vector = NDArray[np.float64]
CASES = (
    "walker",
    "runner",
    "c_leg",
    "stepping_leg",
    "free_link",
    "penetrometer",
    "wheel",
    "pendulum_rigid",
    "double_pendulum",
    "chain",
    "walker_in_space",
    "hexapod",
    "snake",
    "steered_wheel",
    "grousered_wheel",
)
QUICK = ("walker", "free_link", "pendulum_rigid", "hexapod")


class Settled(NamedTuple):
    """Result of settling a mechanism.

    depth: sinkage, m; too_deep: excess of the sinkage over the static balance, m; lacking: part of the weight that the
    sand does not bear, relative to the weight; taken: CPU time, s.
    """

    depth: float
    too_deep: float
    lacking: float
    taken: float


def tree_of(name: str) -> dict[str, Any]:
    """Config of a shipped mechanism that stands still: its driven joints are held, and it is settled."""
    shipped = yaml.safe_load((ROOT / "configs" / f"{name}.yaml").read_text(encoding="utf-8"))
    model = scenario_to_dict(load_scenario(ROOT / "configs" / f"{name}.yaml"))["model"]
    joints = {key: joint for key, joint in model.get("joints", {}).items() if joint["type"] == "hinge"}
    held = {key: joint for key, joint in joints.items() if joint["parent"] != "ground" and _held(key, shipped)}
    drives = {
        key: {"type": "pd", "angle_deg": joint.get("home_deg", 0.0), "gain_Nm_per_rad": GAIN}
        | {"rate_gain_Nm_s_per_rad": 0.005 * GAIN}
        for key, joint in held.items()
    }
    tree = {key: shipped[key] for key in ("model", "medium", "bed", "surface_height_m", "load") if key in shipped}
    run = {"initial": {"settle": True}, "solver": {"end_time_s": 0.2}, "method": "engine"}
    return tree | {"drives": drives} | run


def _held(joint: str, shipped: dict[str, Any]) -> bool:
    return joint in shipped.get("drives", {}) or "wheel" in shipped


def settled(tree: dict[str, Any]) -> Settled:
    """Settle a mechanism and compare it with the static balance."""
    began = time.process_time()
    with followed() as states:
        system = run_module.begin(scene.build(config.load(tree))).system
    taken = time.process_time() - began
    assert system is not None
    assert system.bed is not None
    q = system.mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Initial)
    depth, rest = float(system.bed.load.last.depth[-1]), force(system, q)
    fall, direction = falling(system, q), last_way(states, q)
    lacking = 1.0 + float(rest @ fall[0] / (fall[1] @ fall[0]))
    full = [float(lowered(system, q + deeper * direction, direction) @ direction) for deeper in (0.0, DEEPER)]
    too_deep = (full[0] - rest @ direction) / ((full[1] - full[0]) / DEEPER)
    return Settled(depth, float(too_deep), lacking, taken)


def force(system: System, q: Vector) -> Vector:
    """Generalised forces (n,) of the medium on a system at rest."""
    assert system.bed is not None
    rows, forces = system.bed._places()[0], np.zeros(len(q))
    np.add.at(forces, rows, system.bed.load.force(q, np.zeros(len(q)), np.zeros(len(rows))))
    return forces


def lowered(system: System, q: Vector, way: Vector) -> Vector:
    """Generalised forces (n,) at q after a straight path along `way` (n,) with new bristles, which all yield."""
    assert system.bed is not None
    load = system.bed.load
    load.start(q - YIELDING * way, *system.bed._places())
    load.accept(0.0, q, np.zeros(len(q)))
    return force(system, q)


def falling(system: System, q: Vector) -> tuple[Vector, Vector]:
    """Acceleration (n,) with which a system begins to fall, and the generalised forces (n,) of its weight.

    The bristles of the system are reset.
    """
    balance = Balance(system, 1)
    weight = balance.rising(q)
    balance.at(q, 1.0)
    joined, n = balance.tangent(), len(q)
    none = np.zeros((len(joined) - n,) * 2)
    matrix = np.block([[mass_matrix(system), joined[:n, n:]], [joined[n:, :n], none]])
    acceleration: Vector = np.linalg.lstsq(matrix, np.concatenate([weight, none[:1].ravel()]), rcond=None)[0][:n]
    return acceleration, weight


@contextmanager
def followed() -> Iterator[list[Vector]]:
    """Collect the states (n,) that settling accepts within the block, in their order."""
    states: list[Vector] = []
    accept = Balance.accept

    def kept(balance: Balance, q: Vector) -> None:
        states.append(q.copy())
        accept(balance, q)

    with mock.patch.object(Balance, "accept", kept):
        yield states


def last_way(states: Sequence[Vector], q: Vector) -> Vector:
    """Direction (n,) of the last part of the path through the states to q, scaled to a largest coordinate of 1."""
    distances = [np.abs(q - state).max() for state in states]
    way = q - states[max((i for i, far in enumerate(distances) if far > LAST), default=int(np.argmax(distances)))]
    direction: Vector = way / np.abs(way).max()
    return direction


def study(quick: bool = False) -> Outcome:
    """Run all cases, or those of QUICK."""
    names = QUICK if quick else CASES
    results = {name: settled(tree_of(name)) for name in names}
    head = ["mechanism", "sinkage mm", "error of sinkage", "unsupported share of the weight", "CPU s"]
    rows = [
        [name, f"{1e3 * r.depth:.3f}", f"{r.too_deep / r.depth:.2%}", f"{r.lacking:.0e}", f"{r.taken:.2f}"]
        for name, r in results.items()
    ]
    errors = {name: abs(result.too_deep) / result.depth for name, result in results.items()}
    worst = max(errors, key=lambda name: errors[name])
    detail = f"at most {errors[worst]:.2%} ({worst})"
    claim = Claim("settling.sinkage agrees with the static balance within 1 %", errors[worst] < ALLOWED, detail)
    return Outcome(markdown(head, rows), (claim,))


def main() -> int:
    """Print the table and the claim; return 0 if it holds, else 1."""
    outcome = study("--quick" in sys.argv[1:])
    print(f"{machine('exudyn', 'numba')}\n\n{outcome.text}\n")
    for claim in outcome.claims:
        print(claim)
    return 0 if all(claim.held for claim in outcome.claims) else 1


if __name__ == "__main__":
    sys.exit(main())
