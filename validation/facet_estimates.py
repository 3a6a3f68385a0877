"""Test of the estimated error by facets of runs in space against facets of a third of the size, over random scenes.

    python validation/facet_estimates.py [--quick] [--first SEED] [--scenes NUMBER]

The scenes are bodies of every shape, meshes, chains, legs, wheels, and hanging or pressed bodies from
`random_scenes.in_space`. They have fixed steps of 0.2 ms and the facet sizes that a run chooses by itself: it repeats
with smaller facets if its estimate is above 0.3 % of the path length. The true error is the greatest distance of any
point from a run with facets of a third of that size at the same steps, over the path length of the fastest point.
Errors and estimates below 0.1 % count as 0.1 %. With FOLLOW in the environment each result is printed as soon as it is
known. With `--first` or `--scenes` no figure is drawn.
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
SCENES = (100, 4)  # number in the full and in the quick form
FINER, FLOOR, SILENT, WITHIN = 3.0, 1e-3, 1e-2, 10.0
WALL = 600.0  # s, limit on the wall-clock time of a run, for a busy machine
TRIES = 3  # seeds for each wanted scene, as not all of them touch the medium


@dataclass(frozen=True)
class Found:
    """Result of a scene: its seed and kind, its true error and its estimate (told), both relative.

    warned: whether the run warned of facets; share: least factor on the facet size of a body.
    """

    seed: int
    kind: str
    error: float
    told: float
    warned: bool
    share: float

    @property
    def over(self) -> float:
        """Estimate over true error, each at least FLOOR."""
        return max(self.told, FLOOR) / max(self.error, FLOOR)


def judge(seed: int) -> Found | None:
    """Draw and run a scene and return its errors; None if it can't be used or no facet touches the medium."""
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
    """Compare a run with fixed steps and its own facets to one with finer facets; None if a run fails or no contact."""
    solver = {"end_time_s": tree["solver"]["end_time_s"], "rest_time_s": None, "step_s": STEP, "max_wall_s": WALL}
    inspected: list[Any] = []
    results = run(
        build(load_scenario(write(tree | {"solver": solver}, folder))), inspect=lambda *both: inspected.append(both)
    )
    ((system, trajectory),) = inspected
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
    warned = any("facets" in warning for warning in results.warnings)
    return Found(seed, kind, apart(motion, reference), strip_error(motion), warned, share)


def apart(motion: SpatialKinematics, reference: SpatialKinematics) -> float:
    """Greatest distance of any point from the reference, over the path length of the reference's fastest point."""
    track, other = facet_departure.track(motion), facet_departure.track(reference)
    at = track.time[track.time <= other.time[-1]]
    columns = other.places.reshape(len(other.time), -1).T
    places = np.column_stack([np.interp(at, other.time, column) for column in columns])
    length = max(reference.path_length, reference.scene.least_path)
    return float(np.abs(track.places[: len(at)].reshape(len(at), -1) - places).max()) / length


def every(count: int, jobs: int, first: int) -> Iterator[Found]:
    """Results of the first `count` scenes that touch the medium, from the seed `first` on."""
    with local_processes(jobs) as pool:
        results = (result for result in pool.map(judge, range(first, first + TRIES * count)) if result is not None)
        for _, result in zip(range(count), results, strict=False):
            yield result
        pool.shutdown(cancel_futures=True)  # else closing the pool waits for seeds that are no longer needed


def study(quick: bool, first: int = 0, scenes: int | None = None) -> Outcome:
    """Run the scenes from the seed `first` on; scenes: their number, by default that of the form."""
    results = []
    for result in every(scenes or SCENES[quick], 1 if quick else cores(), first):
        results.append(result)
        if os.environ.get("FOLLOW"):
            print(time.strftime("%X"), result, flush=True)
    if not quick and first == 0 and scenes is None:
        draw_figure(results)
    return told(results)


def draw_figure(results: list[Found]) -> None:
    """Draw the estimated over the true error."""
    import matplotlib.pyplot as plt

    from granular_contact.report.figures.style import DPI, FAINT, PALETTE, style

    with style():
        figure, axes = plt.subplots(figsize=(3.5, 3.2), layout="constrained")
        for warned, marker, label in ((False, "o", "no warning"), (True, "^", "warned")):
            group = [result for result in results if result.warned == warned]
            points = [[100.0 * max(value, 1e-5) for value in (result.error, result.told)] for result in group]
            axes.plot(*np.array(points).reshape(-1, 2).T, marker, color=PALETTE[warned], markersize=3, label=label)
        ends = np.array([1e-3, 20.0])
        for factor in (1.0 / WITHIN, 1.0, WITHIN):
            axes.plot(ends, factor * ends, color=FAINT, linewidth=0.8, zorder=0)
        axes.axvline(100.0 * SILENT, color=FAINT, linewidth=0.8, linestyle=":")
        axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends, xlabel="true error (%)", ylabel="told error (%)")
        axes.legend(frameon=False)
        figure.savefig(FIGURE, dpi=DPI)
        plt.close(figure)


def told(results: list[Found]) -> Outcome:
    """Table and claims of these results."""
    rows = []
    for kind in [*sorted({result.kind for result in results}), "all"]:
        group = [result for result in results if kind in (result.kind, "all")]
        errors = [100.0 * result.error for result in group]
        cells = [
            kind,
            len(group),
            f"{np.median(errors):.3f}",
            f"{max(errors):.3f}",
            sum(result.warned for result in group),
        ]
        rows.append(
            [*cells, f"{min(result.over for result in group):.2f} to {max(result.over for result in group):.2f}"]
        )
    silent = [result for result in results if not result.warned]
    worst = max(silent, key=lambda result: result.error)
    above = [result for result in silent if result.error > SILENT]
    alarms = [result for result in results if result.over > WITHIN]
    head = ["kind", "scenes", "median error %", "largest %", "warned", "estimate over true error"]
    return Outcome(
        markdown(head, rows),
        (
            Claim(
                "facet_estimates.no error above 1 % is without a warning", not above, _detail(above, len(silent), worst)
            ),
            Claim(
                "facet_estimates.no estimate is more than ten times the true error",
                not alarms,
                f"{len(results)} scenes: at most {max(result.over for result in results):.1f} times{_seeds(alarms)}",
            ),
        ),
    )


def _detail(above: list[Found], count: int, worst: Found) -> str:
    return (
        f"{len(above)} of {count} scenes without a warning are above the bound; the largest error is "
        f"{worst.error:.2%}{_seeds(above)}"
    )


def _seeds(results: list[Found]) -> str:
    return f" (seeds {', '.join(str(result.seed) for result in results)})" if results else ""


if __name__ == "__main__":
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--scenes", type=int)
    given, rest = parser.parse_known_args()
    sys.exit(script(partial(study, first=given.first, scenes=given.scenes), rest))
