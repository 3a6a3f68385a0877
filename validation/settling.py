"""How deep mechanisms stand that `initial.settle` has set down, against the static balance, and what that costs.

    python validation/settling.py [--quick]

Every shipped model that the sand can carry is settled in the medium and on the bed of its config, with its driven
joints held by PD control; what hangs on a hinge turns into the sand. In the static balance the resistance is fully
mobilised: it is that of what comes to the settled pose slowly, on the last part of the same way, with new bristles.
What the resistance of the settled mechanism is short of it, over how fast it grows with depth, is how much too deep it
stands (what is dropped stands too deep by every overshoot). The resistance is compared with the weight besides, along
the way in which the mechanism begins to fall under it. CPU time of building and settling with compiled kernels in the
cache.
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
DEEPER = 1e-5  # m: how fast the resistance grows
LAST, YIELDING = 1e-4, 2e-3  # m or rad: the last part of the way; what of it is gone so that all bristles yield
ALLOWED = 0.01  # of the sinkage
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
    """Sinkage m, by how much it is too deep (m), weight that the sand lacks (of it), CPU time s."""

    depth: float
    too_deep: float
    lacking: float
    taken: float


def tree_of(name: str) -> dict[str, Any]:
    """The config of a name that stands in place of what it does."""
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
    return tree | {"drives": drives, "initial": {"settle": True}, "solver": {"end_time_s": 0.2}}


def _held(joint: str, shipped: dict[str, Any]) -> bool:
    return joint in shipped.get("drives", {}) or "wheel" in shipped


def settled(tree: dict[str, Any]) -> Settled:
    """Settle a mechanism and compare it with its static balance."""
    began = time.process_time()
    with followed() as states:
        system = run_module.begin(scene.build(config.load(tree))).system
    taken = time.process_time() - began
    assert system is not None
    assert system.bed is not None
    q = system.mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Initial)
    depth, rest = float(system.bed.load.last.depth[-1]), force(system, q)
    down, way = falling(system, q), last_way(states, q)
    lacking = 1.0 + float(rest @ down[0] / (down[1] @ down[0]))
    full = [float(lowered(system, q + deeper * way, way) @ way) for deeper in (0.0, DEEPER)]
    too_deep = (full[0] - rest @ way) / ((full[1] - full[0]) / DEEPER)
    return Settled(depth, float(too_deep), lacking, taken)


def force(system: System, q: Vector) -> Vector:
    """Generalised forces (n,) of the medium on a system at rest."""
    assert system.bed is not None
    where, found = system.bed._places()[0], np.zeros(len(q))
    np.add.at(found, where, system.bed.load.force(q, np.zeros(len(q)), np.zeros(len(where))))
    return found


def lowered(system: System, q: Vector, way: Vector) -> Vector:
    """The same where it comes to q with new bristles, straight along a way (n,) on which they all yield."""
    assert system.bed is not None
    load = system.bed.load
    load.start(q - YIELDING * way, *system.bed._places())
    load.accept(0.0, q, np.zeros(len(q)))
    return force(system, q)


def falling(system: System, q: Vector) -> tuple[Vector, Vector]:
    """How a system begins to fall (n,), and the generalised forces of its weight (n,); its bristles are new then."""
    balance = Balance(system, 1)
    weight = balance.rising(q)
    balance.at(q, 1.0)
    joined, n = balance.tangent(), len(q)
    none = np.zeros((len(joined) - n,) * 2)
    matrix = np.block([[mass_matrix(system), joined[:n, n:]], [joined[n:, :n], none]])
    found: Vector = np.linalg.lstsq(matrix, np.concatenate([weight, none[:1].ravel()]), rcond=None)[0][:n]
    return found, weight


@contextmanager
def followed() -> Iterator[list[Vector]]:
    """The states (n,) that settling accepts within the block, in their order."""
    states: list[Vector] = []
    accept = Balance.accept

    def kept(balance: Balance, q: Vector) -> None:
        states.append(q.copy())
        accept(balance, q)

    with mock.patch.object(Balance, "accept", kept):
        yield states


def last_way(states: Sequence[Vector], q: Vector) -> Vector:
    """Direction (n,) of the last part of a way that ends in q, its fastest coordinate 1."""
    away = [np.abs(q - one).max() for one in states]
    way = q - states[max((i for i, far in enumerate(away) if far > LAST), default=int(np.argmax(away)))]
    found: Vector = way / np.abs(way).max()
    return found


def study(quick: bool = False) -> Outcome:
    """All cases, or four of them."""
    names = QUICK if quick else CASES
    found = {name: settled(tree_of(name)) for name in names}
    head = ["mechanism", "sinkage mm", "too deep, of it", "weight that the sand lacks, of it", "CPU s"]
    rows = [
        [name, f"{1e3 * one.depth:.3f}", f"{one.too_deep / one.depth:.2%}", f"{one.lacking:.0e}", f"{one.taken:.2f}"]
        for name, one in found.items()
    ]
    off = {name: abs(one.too_deep) / one.depth for name, one in found.items()}
    worst = max(off, key=lambda name: off[name])
    told = f"at most {off[worst]:.2%} ({worst})"
    claim = Claim("settling.sinkage is that of the static balance within 1 %", off[worst] < ALLOWED, told)
    return Outcome(markdown(head, rows), (claim,))


def main() -> int:
    """Print the table and the claim; 0 where it holds."""
    made = study("--quick" in sys.argv[1:])
    print(f"{machine('exudyn', 'numba')}\n\n{made.text}\n")
    for claim in made.claims:
        print(claim)
    return 0 if all(claim.held for claim in made.claims) else 1


if __name__ == "__main__":
    sys.exit(main())
