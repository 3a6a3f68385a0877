"""Test of the estimated error by strips against runs with strips of an eighth of the length, over random scenes.

    python validation/strip_estimates.py [--quick]

The scenes are rods, bent bars, solids, chains, swimmers, legs with feet, wheels and loops from `random_scenes`, and
carts whose wheels are driven for a second. The true error is the greatest distance of any point from a run with eight
times as many strips at the same fixed steps, relative to the path length of the fastest point. Errors and estimates
below 0.01 % count as 0.01 %. Where 16 strips are not enough for an accuracy of 0.1 %, the scene also runs with adaptive
steps and strips for that accuracy; the reference of that run has 128 strips and steps for 0.01 %.
"""

from __future__ import annotations

import copy
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from granular_contact.config import load_scenario
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.strip_error import strip_error
from granular_contact.run import begin, run
from granular_contact.scene import build
from granular_contact.scene.types import Reduced
from validation.random_scenes.scenes import draw, write
from validation.random_scenes.tracks import apart, track
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Tree = dict[str, Any]
DEFAULT, TIMES, STEP = 16, 8, 1e-4
ACCURACY, FLOOR, WITHIN = 1e-3, 1e-4, 10.0
SCENES, CARTS = (100, 8), (10, 2)  # number in the full and in the quick form
MEDIA = ("quikrete_play_sand_rft", "poppy_seeds_close", "rft3d_sand")


@dataclass(frozen=True)
class Found:
    """Result of a scene: its kind, true and estimated error.

    chosen: error and number of strips of a run with adaptive strips; None if there is no such run.
    """

    kind: str
    error: float
    estimate: float
    chosen: tuple[float, int] | None

    @property
    def ratio(self) -> float:
        """Estimate over error."""
        return max(self.estimate, FLOOR) / max(self.error, FLOOR)


def cart(seed: int) -> Tree:
    """Config of a cart on two driven wheels, as a dict."""
    rng = Random(seed)
    radius, apart_m, medium = rng.uniform(0.05, 0.15), rng.uniform(0.15, 0.3), rng.choice(MEDIA)
    shape = {"type": "wheel", "radius_m": radius, "width_m": rng.uniform(0.08, 0.2)}
    wheel = {"type": "rigid", "mass_kg": rng.uniform(0.3, 1.5), "inertia_kg_m2": 0.005, "shapes": [shape]}
    hull = {"type": "rigid", "mass_kg": rng.uniform(2.0, 8.0), "inertia_kg_m2": 0.2, "shapes": []}
    drive = {"type": "pd", "rate_rad_s": rng.uniform(-4.0, 4.0), "rate_gain_Nm_s_per_rad": 20.0}
    joints: Tree = {"flight": {"type": "free", "parent": "ground", "child": "hull"}}
    for name, x in (("front", apart_m), ("rear", -apart_m)):
        joints[f"{name}_axle"] = {"type": "hinge", "parent": "hull", "child": name, "parent_point_m": [x, 0.0]}
    bodies = {"hull": hull, "front": wheel, "rear": dict(wheel)}
    model = {"name": "cart", "bodies": bodies, "joints": joints}
    drives = {"front_axle": drive, "rear_axle": dict(drive)}
    return {"model": model, "medium": medium, "drives": drives, "solver": {"end_time_s": 1.0}}


def trees(scenes: int, carts: int, folder: Path) -> Iterator[tuple[str, Tree]]:
    """Generate the kind and the config of the carts and of random scenes that have strips."""
    yield from (("cart", cart(seed)) for seed in range(carts))
    seed, accepted = 0, 0
    while accepted < scenes:
        drawn = draw(seed, folder)
        seed += 1
        scene = build(load_scenario(write(drawn.tree, folder)))
        if drawn.kind == "ball" or isinstance(scene.method, Reduced):
            continue
        accepted += 1
        yield drawn.kind, drawn.tree


def settings(tree: Tree, strips: int, **solver: float) -> Tree:
    """Config with another number of strips a part and other solver keys; an element has a quarter of the strips."""
    changed = copy.deepcopy(tree)
    changed["solver"] = {"end_time_s": tree["solver"]["end_time_s"], "rest_time_s": None, **solver}
    load = {"strips_per_rigid_part": strips, "strips_per_element": strips // 4}
    changed["load"] = changed.get("load", {}) | load
    changed["output"] = {"bodies": "all", "figures": False}
    return changed


def solved(tree: Tree, folder: Path) -> Kinematics:
    """Solve a scene and return its motion."""
    begun = begin(build(load_scenario(write(tree, folder))))
    begun.solving.advance()
    assert begun.system is not None
    return Kinematics(begun.system, begun.solving.trajectory())


def places(motion: Kinematics, at: np.ndarray) -> np.ndarray:
    """Centres of all bodies (m), and rotations times the radius of a body (m), (n, k) at times (n,) s."""
    columns, scene = [], motion.scene
    for body in scene.bodies:
        columns += [*motion.center(body.name)[0].T]
        if body.name in motion.system.rigid:
            columns.append(scene.radius(body) * motion.angle(body.name, np.zeros(2))[0])
    return np.column_stack([np.interp(at, motion.trajectory.time, column) for column in columns])


def difference(motion: Kinematics, other: Kinematics) -> float:
    """Greatest distance of any point from a reference motion, relative to the path length of its fastest point."""
    at = np.linspace(0.0, min(motion.trajectory.time[-1], other.trajectory.time[-1]), 1000)
    length = max(other.path_length, other.scene.least_path)
    return float(np.abs(places(motion, at) - places(other, at)).max()) / length


def judge(kind: str, tree: Tree, folder: Path) -> Found | None:
    """Run a scene and return its errors; None if no body touches the medium."""
    motion = solved(settings(tree, DEFAULT, step_s=STEP), folder)
    load = motion.trajectory.load
    if load is None or not (load.depth > 0.0).any():
        return None
    estimate = strip_error(motion, ACCURACY)
    error = difference(motion, solved(settings(tree, TIMES * DEFAULT, step_s=STEP), folder))
    chosen = None
    if max(error, estimate) > ACCURACY:
        chosen = _chosen(tree, folder)
    return Found(kind, error, estimate, chosen)


def _chosen(tree: Tree, folder: Path) -> tuple[float, int]:
    """Relative error of a run with adaptive steps and strips, and its number of strips."""
    asked, fine = settings(tree, DEFAULT, accuracy=ACCURACY), settings(tree, TIMES * DEFAULT, accuracy=ACCURACY / 10.0)
    results, reference = (run(build(load_scenario(write(config, folder)))) for config in (asked, fine))
    off = apart(track(results, tree, FLOOR), track(reference, tree, FLOOR))
    return off, results.summary["strips"]["per_rigid_part"]


def study(quick: bool) -> Outcome:
    """Run all scenes, or those of the quick form."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        results = [judge(kind, tree, folder) for kind, tree in trees(SCENES[quick], CARTS[quick], folder)]
    return told([result for result in results if result is not None])


def told(results: list[Found]) -> Outcome:
    """Table and claims of these results."""
    rows = []
    for kind in dict.fromkeys(result.kind for result in results):
        of_kind = [result for result in results if result.kind == kind]
        errors, ratios = [100.0 * result.error for result in of_kind], [result.ratio for result in of_kind]
        cells = [kind, len(of_kind), f"{max(errors):.3f}", f"{np.median(errors):.3f}"]
        rows.append([*cells, f"{min(ratios):.2f} to {max(ratios):.2f}"])
    ratios = np.array([result.ratio for result in results])
    beyond = int(((ratios > WITHIN) | (ratios < 1.0 / WITHIN)).sum())
    chosen = [result.chosen for result in results if result.chosen is not None]
    worst, strips = max(chosen, default=(0.0, DEFAULT))
    above = sum(off > ACCURACY for off, _ in chosen)
    head = ["kind", "scenes", "largest error %", "median %", "estimate over error"]
    ratio_detail = (
        f"{len(results)} scenes: estimate over error {ratios.min():.2f} to {ratios.max():.2f}, {beyond} outside"
    )
    chosen_detail = (
        f"{len(chosen)} scenes that need more than 16 strips: error at most {worst / ACCURACY:.2f} times {ACCURACY:g}"
    )
    return Outcome(
        markdown(head, rows),
        (
            Claim(
                "strip_estimates.at most 1 % of the estimates are wrong by more than a factor of ten",
                100 * beyond <= len(results),
                ratio_detail,
            ),
            Claim(
                "strip_estimates.chosen steps and strips keep the accuracy",
                worst <= 2.0 * ACCURACY,
                f"{chosen_detail} ({strips} strips), {above} above 1 (required: 2)",
            ),
        ),
    )


if __name__ == "__main__":
    sys.exit(script(study))
