"""Is the error by facets that a run in space tells true: against a third of its facets' size, over random scenes.

    python validation/facet_estimates.py [--quick] [--first SEED] [--scenes NUMBER]

Bodies of every shape, meshes, chains, legs, wheels and what hangs or is pressed, from `random_scenes.in_space`, at
fixed steps of 0.2 ms, with the sizes of facets that a run chooses by itself: it is repeated with smaller ones where its
estimate is above 0.3 % of the way. The true error is the greatest distance of any point from a run with facets of a
third of that size, at the same steps, over the way of the fastest point. An error or an estimate below 0.1 % counts as
that. With FOLLOW in the environment each scene is printed as it is done. Scenes from another seed on change no
figure.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from granular_contact.config import load_scenario
from granular_contact.errors import GranularContactError
from granular_contact.mechanics.space import facet_departure
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.strip_error import strip_error
from granular_contact.run import begin, run
from granular_contact.scene import build
from granular_contact.studies.processes import cores, local_processes
from validation.random_scenes.in_space import KINDS, draw
from validation.random_scenes.scenes import STEP, write
from validation.stability import GOOD
from validation.study import Claim, Outcome, script
from validation.tables import markdown

FIGURE = Path(__file__).parent / "figures" / "facet_estimates.png"
SCENES = (100, 4)  # in the whole and in the quick form
FINER, FLOOR, SILENT, WITHIN = 3.0, 1e-3, 1e-2, 10.0
WALL = 600.0  # s of the clock for any run, on a busy machine
TRIES = 3  # seeds looked at for each scene that is wanted: not all touch the medium


@dataclass(frozen=True)
class Found:
    """Of a scene: its seed and kind; true and told error, whether it warned, least share of the size of facets."""

    seed: int
    kind: str
    error: float
    told: float
    warned: bool
    share: float

    @property
    def over(self) -> float:
        """What is told, over the true error, each at least the floor."""
        return max(self.told, FLOOR) / max(self.error, FLOOR)


def judge(seed: int) -> Found | None:
    """Errors of a scene; None where no facet touches the medium."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            drawn = draw(seed, folder)
            if KINDS[drawn.kind][2] != "plate":
                return None
            return compared(seed, drawn.kind, drawn.tree, folder)
        except GranularContactError:
            return None


def compared(seed: int, kind: str, tree: dict[str, Any], folder: Path) -> Found | None:
    """Errors of a run as the user gets it, at fixed steps, and of that with finer facets."""
    solver = {"end_time_s": tree["solver"]["end_time_s"], "rest_time_s": None, "step_s": STEP, "max_wall_s": WALL}
    kept: list[Any] = []
    results = run(
        build(load_scenario(write(tree | {"solver": solver}, folder))), inspect=lambda *both: kept.append(both)
    )
    ((system, trajectory),) = kept
    if results.status.code not in GOOD or not (trajectory.load.depth > 0.0).any():
        return None
    motion = SpatialKinematics(system, trajectory)
    share = min(system.scene.facet_shares.values(), default=1.0)
    limited = system.scene.solver.model_copy(update={"max_wall_s": WALL})
    begun = begin(replace(system.scene, solver=limited).with_facets(1.0 / FINER))
    begun.solving.advance()
    if begun.system is None or begun.solving.status().code not in GOOD:
        return None
    reference = SpatialKinematics(begun.system, begun.solving.trajectory())  # type: ignore[arg-type]
    warned = any("facets" in one for one in results.warnings)
    return Found(seed, kind, apart(motion, reference), strip_error(motion), warned, share)


def apart(motion: SpatialKinematics, reference: SpatialKinematics) -> float:
    """Greatest distance of any point, over the way of the fastest one."""
    one, other = facet_departure.track(motion), facet_departure.track(reference)
    at = one.time[one.time <= other.time[-1]]
    columns = other.places.reshape(len(other.time), -1).T
    places = np.column_stack([np.interp(at, other.time, column) for column in columns])
    way = max(reference.path_length, reference.scene.least_path)
    return float(np.abs(one.places[: len(at)].reshape(len(at), -1) - places).max()) / way


def every(count: int, jobs: int, first: int) -> Iterator[Found]:
    """So many scenes that touch the medium, from a seed on."""
    with local_processes(jobs) as pool:
        found = (one for one in pool.map(judge, range(first, first + TRIES * count)) if one is not None)
        for _, one in zip(range(count), found, strict=False):
            yield one
        pool.shutdown(cancel_futures=True)  # seeds that nobody needs any more would be waited for


def study(quick: bool, first: int = 0, scenes: int | None = None) -> Outcome:
    """All scenes, or a few of them; so many from a seed on."""
    found = []
    for one in every(scenes or SCENES[quick], 1 if quick else cores(), first):
        found.append(one)
        if os.environ.get("FOLLOW"):
            print(time.strftime("%X"), one, flush=True)
    if not quick and first == 0 and scenes is None:
        draw_figure(found)
    return told(found)


def draw_figure(found: list[Found]) -> None:
    """The told error over the true one."""
    import matplotlib.pyplot as plt

    from granular_contact.report.figures.style import DPI, FAINT, PALETTE, style

    with style():
        figure, axes = plt.subplots(figsize=(3.5, 3.2), layout="constrained")
        for warned, marker, words in ((False, "o", "no warning"), (True, "^", "warned")):
            mine = [one for one in found if one.warned == warned]
            places = [[100.0 * max(value, 1e-5) for value in (one.error, one.told)] for one in mine]
            axes.plot(*np.array(places).reshape(-1, 2).T, marker, color=PALETTE[warned], markersize=3, label=words)
        ends = np.array([1e-3, 20.0])
        for factor in (1.0 / WITHIN, 1.0, WITHIN):
            axes.plot(ends, factor * ends, color=FAINT, linewidth=0.8, zorder=0)
        axes.axvline(100.0 * SILENT, color=FAINT, linewidth=0.8, linestyle=":")
        axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends, xlabel="true error (%)", ylabel="told error (%)")
        axes.legend(frameon=False)
        figure.savefig(FIGURE, dpi=DPI)
        plt.close(figure)


def told(found: list[Found]) -> Outcome:
    """The table and the claims."""
    rows = []
    for kind in [*sorted({one.kind for one in found}), "all"]:
        mine = [one for one in found if kind in (one.kind, "all")]
        errors = [100.0 * one.error for one in mine]
        cells = [kind, len(mine), f"{np.median(errors):.3f}", f"{max(errors):.3f}", sum(one.warned for one in mine)]
        rows.append([*cells, f"{min(one.over for one in mine):.2f} to {max(one.over for one in mine):.2f}"])
    silent = [one for one in found if not one.warned]
    worst = max(silent, key=lambda one: one.error)
    above = [one for one in silent if one.error > SILENT]
    alarms = [one for one in found if one.over > WITHIN]
    head = ["kind", "scenes", "median error %", "largest %", "warned", "told over true"]
    return Outcome(
        markdown(head, rows),
        (
            Claim("facet_estimates.no silent error above 1 %", not above, _said(above, len(silent), worst)),
            Claim(
                "facet_estimates.none told above ten times the true one",
                not alarms,
                f"{len(found)} scenes: at most {max(one.over for one in found):.1f} times{_seeds(alarms)}",
            ),
        ),
    )


def _said(above: list[Found], count: int, worst: Found) -> str:
    return f"{len(above)} of {count} silent scenes are above it, the greatest error is {worst.error:.2%}{_seeds(above)}"


def _seeds(some: list[Found]) -> str:
    return f" (seeds {', '.join(str(one.seed) for one in some)})" if some else ""


if __name__ == "__main__":
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--scenes", type=int)
    given, rest = parser.parse_known_args()
    sys.exit(script(partial(study, first=given.first, scenes=given.scenes), rest))
