"""Error and run time in space over the size of facets, over the accuracy, and in MuJoCo.

    python validation/facet_fronts.py [--quick]

The scenes are hexapod, walker and snake (see `space_fronts`), and a thrown ball and a thrown box, with adaptive steps.
*Facets*: one solve with steps for an accuracy of 1e-3, and with facets of a fraction of the size that a run of this
accuracy starts with. *Accuracy*: a run as a user starts it, which repeats with smaller facets if its own estimate asks
for that; its time is that of all solves. *MuJoCo*: the facets that a run with an accuracy of 1e-2 starts with, in a
compiled loop. The error is the largest distance of the tip from a reference path, over the length of that path; the
reference has an accuracy of 3e-4 and facets of a quarter of the size that it would start with. Run times are processor
times, the least of repeats in turn.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact import load
from granular_contact.run import run
from granular_contact.scene import build
from validation import space_fronts
from validation.space_fronts import NATIVE, Found, Run, by_mujoco, chosen, in_turn, path, solved
from validation.study import Claim, Outcome, script
from validation.tables import markdown

SECONDS = {"hexapod": 1.0, "walker_in_space": 0.75, "snake": 0.75, "ball": 0.3, "box": 0.3}
THROWN = {"ball": {"type": "sphere", "diameter_m": 0.04}, "box": {"type": "box", "size_m": [0.06, 0.04, 0.03]}}
SHARES = (2.8, 2.0, 1.4, 1.0, 0.7)
ACCURACIES, OF_FACETS, REFERENCE = (1e-2, 3e-3, 1e-3), 1e-3, (3e-4, 0.25)
STEPS = (2e-3, 1e-3, 5e-4, 2e-4)  # s, of MuJoCo
WITHIN = 1.5  # error allowed, relative to the accuracy, as the errors of steps and of facets add up
FIGURE = Path(__file__).parent / "figures" / "facet_fronts.png"


def scene_of(name: str, accuracy: float) -> Any:
    """Build a scene with an accuracy."""
    if name not in THROWN:
        return space_fronts.scene_of(name, SECONDS[name], *chosen(accuracy))
    bodies = {"thrown": {"type": "rigid", "density_kg_m3": 2000, "shapes": [THROWN[name]]}}
    start = {"z_m": 0.06, "rpy_deg": [20, 35, 10], "vx_m_s": 0.5, "vz_m_s": -1, "spin_rad_s": [5, 0, 3]}
    joints = {"flight": {"type": "free", "parent": "ground", "child": "thrown"}}
    solver = {"end_time_s": SECONDS[name], "rest_time_s": None, "accuracy": accuracy}
    model = {"in_space": True, "name": name, "bodies": bodies, "joints": joints}
    tree = {"model": model, "medium": "rft3d_sand", "surface_height_m": 0.0, "solver": solver}
    return build(load(tree | {"initial": {"joints": {"flight": start}}}))


def by_facets(name: str, accuracy: float, share: float) -> Run:
    """Solve once with facets of a fraction of the size that a run of this accuracy starts with."""
    return solved(scene_of(name, accuracy).with_facets(share))


def by_accuracy(name: str, accuracy: float) -> Run:
    """Run a scene as a user does, with all repetitions."""
    inspected: list[Any] = []
    scene, began = scene_of(name, accuracy), time.process_time()
    run(scene, inspect=lambda *both: inspected.append((time.process_time() - began, *both)))
    return path(*inspected[0])


def front(name: str, quick: bool) -> list[Found]:
    """Run all methods with all their settings."""
    reference, solvers = by_facets(name, *REFERENCE), dict[tuple[str, str], Callable[[], Run]]()
    for share in SHARES[1:4] if quick else SHARES:
        solvers["facets", f"{share:g} times"] = partial(by_facets, name, OF_FACETS, share)
    for accuracy in ACCURACIES[:2] if quick else ACCURACIES:
        solvers["accuracy", f"{accuracy:g}"] = partial(by_accuracy, name, accuracy)
    for step in STEPS[1:2] if quick else STEPS:
        solvers[NATIVE, f"{1e3 * step:g} ms"] = partial(by_mujoco, scene_of(name, ACCURACIES[0]), step)
    return in_turn(solvers, reference, 1 if quick else 3)


def study(quick: bool) -> Outcome:
    """Run all scenes."""
    rows, claims = [], []
    every = {name: front(name, quick) for name in (("box",) if quick else SECONDS)}
    if not quick:
        draw(every)
    for name, runs in every.items():
        rows += [[name, *entry[:2], f"{entry[2]:.3%}", f"{entry[3]:.3f}"] for entry in runs]
        off = {float(setting): far for method, setting, far, _ in runs if method == "accuracy"}
        detail = ", ".join(f"{far:.2%} at {accuracy:g}" for accuracy, far in off.items())
        kept = all(far <= WITHIN * accuracy for accuracy, far in off.items())
        claims.append(Claim(f"facet_fronts.{name} keeps its accuracy", kept, detail))
    return Outcome(markdown(["scene", "tool", "setting", "error", "CPU s"], rows), tuple(claims))


def draw(every: dict[str, list[Found]]) -> None:
    """Draw error against run time, one panel for each scene."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(every), figsize=(2.6 * len(every), 3.2), sharey=True, layout="constrained")
    for panel, (name, runs) in zip(axes, every.items(), strict=True):
        for method, style in (("facets", "o-"), ("accuracy", "s-"), (NATIVE, "v:")):
            errors, seconds = zip(*[entry[2:] for entry in runs if entry[0] == method], strict=True)
            panel.loglog(seconds, [1e2 * error for error in errors], style, ms=4, label=method)
        panel.set(title=name.replace("_", " "), xlabel="CPU s", xlim=(1e-3, 4.0))
        panel.grid(alpha=0.3)
    axes[0].set_ylabel("error, % of the path")
    axes[-1].legend(fontsize=7)
    figure.savefig(FIGURE, dpi=110)


if __name__ == "__main__":
    raise SystemExit(script(study))
