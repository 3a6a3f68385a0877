"""Chains of rigid links at equal tip error: minimal coordinates and the engine beside MuJoCo; part of `against_peers`.

A chain of 1 to 64 links, as long as the paper's pendulum, strikes play sand in five ways. The error of a run is the
largest distance of its tip from the converged path over 40 ms, that of a setting the root mean square over the five;
its time is that of the time steps alone, summed over the five, the median of repeats. The converged path is our own at
its finest, and has to be MuJoCo's at its finest.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.solve import solve
from granular_contact.engines.tree.solve import solve as solve_tree
from granular_contact.engines.tree.tree import tree
from granular_contact.mechanics.kinematics import Kinematics
from validation.chains import LENGTH, chain, strips
from validation.peers import Path, mujoco_chain
from validation.tables import markdown

SIZES = (1, 4, 16, 64)
STARTS = ((22.0, 3.38), (31.0, 3.31), (31.0, 6.24), (45.0, 6.47), (61.5, 6.54))  # deg, rad/s: impacts of the paper
LEVELS = (30.0, 5.0)  # micrometres
END = 0.04  # s

# From coarse to fine. Minimal coordinates: accuracy; the engine: steps, tolerance.
MINIMAL = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
ENGINE = ((100, 1e-3), (200, 1e-3), (400, 1e-4), (800, 1e-4), (1600, 1e-5))
PLAIN = (400, 800, 1600, 3200, 4800, 6400, 9600)
LEAPFROG = (40, 80, 120, 160, 240, 400, 640, 800, 1200, 1600)
OURS, THEIRS = "granular-contact, minimal coordinates", "MuJoCo, Python call per step"
LEAPFROG_TOOL = f"{THEIRS}, leapfrog"
FINEST = 1e-6
AGREE = 0.5  # micrometres between the two finest


def minimal(links: int, accuracy: float, start: tuple[float, float]) -> Path:
    """In minimal coordinates."""
    scene = chain(links, *start, method="minimal", end_time_s=END, accuracy=accuracy)
    made = tree(scene)
    trajectory = solve_tree(made)
    tip, _ = Kinematics(made.system, trajectory).position(*scene.tip)
    return Path(trajectory.time, tip, trajectory.cost.solve_s)


def engine(links: int, setting: tuple[int, float], start: tuple[float, float]) -> Path:
    """By the engine; setting: steps, tolerance."""
    steps, tolerance = setting
    scene = chain(links, *start, end_time_s=END, step_s=END / steps, tolerance=tolerance)
    system = build(scene)
    trajectory = solve(system)
    tip, _ = Kinematics(system, trajectory).position(*scene.tip)
    return Path(trajectory.time, tip, trajectory.cost.solve_s)


def mujoco(links: int, steps: int, start: tuple[float, float], **options: object) -> Path:
    """By MuJoCo."""
    scene = chain(links, *start, end_time_s=END)
    masses = np.array([body.mass for body in scene.rigid])
    assert scene.surface is not None
    return mujoco_chain.run(
        links,
        strips(links),
        masses,
        scene.rigid[0].inertia,
        LENGTH / links,
        float(scene.surface),
        (math.radians(start[0]), start[1]),
        steps,
        END,
        **options,  # type: ignore[arg-type]
    )


def distance(path: Path, truth: Path) -> float:
    """Largest distance (micrometres) of a tip from the converged path."""
    at = np.column_stack([np.interp(path.time, truth.time, truth.tip[:, i]) for i in range(2)])
    return 1e6 * float(np.max(np.linalg.norm(path.tip - at, axis=1)))


@dataclass(frozen=True)
class Point:
    """One setting of one tool on one chain: error (micrometres) and median time of all starts (ms)."""

    links: int
    tool: str
    setting: str
    error: float
    milliseconds: float


Tool = tuple[str, Callable[..., Path], tuple[object, ...]]
TOOLS: tuple[Tool, ...] = (
    (OURS, minimal, MINIMAL),
    ("granular-contact, engine", engine, ENGINE),
    (THEIRS, mujoco, PLAIN),
    (LEAPFROG_TOOL, partial(mujoco, leapfrog=True), LEAPFROG),
)


def measure(links: int, tools: tuple[Tool, ...], starts: tuple[tuple[float, float], ...], repeats: int) -> list[Point]:
    """All tools on a chain. Settings of a tool are tried from coarse to fine until the finest level is met."""
    truths = [minimal(links, FINEST, start) for start in starts]
    found = []
    for tool, run, settings in tools:
        for setting in settings:
            first = [run(links, setting, start) for start in starts]
            errors = [distance(path, truth) for path, truth in zip(first, truths, strict=True)]
            error = math.sqrt(sum(e * e for e in errors) / len(errors))
            seconds = [sum(run(links, setting, start).seconds for start in starts) for _ in range(repeats)]
            found.append(Point(links, tool, str(setting), error, 1e3 * statistics.median(seconds)))
            if error <= min(LEVELS):
                break
    return found


def best(found: list[Point], links: int, tool: str, level: float) -> Point | None:
    """Fastest setting of a tool on a chain whose error is within a level (micrometres); None: none is."""
    fit = [p for p in found if p.links == links and p.tool == tool and p.error <= level]
    return min(fit, key=lambda p: p.milliseconds, default=None)


def agreement(links: int, start: tuple[float, float] = STARTS[2]) -> float:
    """Distance (micrometres) of MuJoCo's finest path from ours: two programs, one law."""
    finest = mujoco(links, 6400, start, integrator="RK4", native=True)
    return distance(minimal(links, FINEST, start), finest)


def tables(found: list[Point], sizes: tuple[int, ...]) -> str:
    """All settings, and what each tool takes for each level."""
    rows = [[p.links, p.tool, p.setting, f"{p.error:.1f}", f"{p.milliseconds:.2f}"] for p in found]
    names = list(dict.fromkeys(p.tool for p in found))
    short = []
    for level in LEVELS:
        for links in sizes:
            times = [best(found, links, name, level) for name in names]
            short.append(
                [f"{level:g} um", links, *("not reached" if t is None else f"{t.milliseconds:.2f}" for t in times)]
            )
    every = markdown(["links", "tool", "setting", "error um", "ms"], rows)
    return every + "\n\n" + markdown(["error at most", "links", *(f"{name}, ms" for name in names)], short)


def ratios(found: list[Point], sizes: tuple[int, ...], other: str = THEIRS) -> dict[tuple[float, int], float]:
    """Our time in minimal coordinates to that of another tool, at each level and size; infinite: not reached by us."""
    out = {}
    for level in LEVELS:
        for links in sizes:
            mine, theirs = best(found, links, OURS, level), best(found, links, other, level)
            if theirs is not None:
                out[level, links] = math.inf if mine is None else mine.milliseconds / theirs.milliseconds
    return out


def points(repeats: int, sizes: tuple[int, ...] = SIZES) -> list[Point]:
    """All tools on all chains."""
    return [point for links in sizes for point in measure(links, TOOLS, STARTS, repeats)]
