"""Chains of rigid links at equal tip error: minimal coordinates, the engine and MuJoCo; part of `against_peers`.

A chain of 1 to 64 links, as long as the paper's pendulum, strikes play sand in five impacts. The error of a run is the
largest distance of the tip from the converged path over 40 ms; the error of a setting is the root mean square over the
five impacts. The run time of a setting is that of the time steps alone, summed over the five impacts, the median of
repeats. The converged path is this package's finest run; it must agree with MuJoCo's finest run.
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
STARTS = ((22.0, 3.38), (31.0, 3.31), (31.0, 6.24), (45.0, 6.47), (61.5, 6.54))  # deg, rad/s; impacts of the paper
LEVELS = (30.0, 5.0)  # micrometres
END = 0.04  # s

# Settings from coarse to fine. Minimal coordinates: accuracy; the engine: steps, tolerance.
MINIMAL = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
ENGINE = ((100, 1e-3), (200, 1e-3), (400, 1e-4), (800, 1e-4), (1600, 1e-5))
PLAIN = (400, 800, 1600, 3200, 4800, 6400, 9600)
LEAPFROG = (40, 80, 120, 160, 240, 400, 640, 800, 1200, 1600)
OURS, THEIRS = "granular-contact, minimal coordinates", "MuJoCo, Python call per step"
LEAPFROG_TOOL = f"{THEIRS}, leapfrog"
FINEST = 1e-6
AGREE = 0.5  # micrometres, distance allowed between the finest paths of both programs


def minimal(links: int, accuracy: float, start: tuple[float, float]) -> Path:
    """Solve a chain in minimal coordinates."""
    scene = chain(links, *start, method="minimal", end_time_s=END, accuracy=accuracy)
    built = tree(scene)
    trajectory = solve_tree(built)
    tip, _ = Kinematics(built.system, trajectory).position(*scene.tip)
    return Path(trajectory.time, tip, trajectory.cost.solve_s)


def engine(links: int, setting: tuple[int, float], start: tuple[float, float]) -> Path:
    """Solve a chain by the engine; setting: steps, tolerance."""
    steps, tolerance = setting
    scene = chain(links, *start, end_time_s=END, step_s=END / steps, tolerance=tolerance)
    system = build(scene)
    trajectory = solve(system)
    tip, _ = Kinematics(system, trajectory).position(*scene.tip)
    return Path(trajectory.time, tip, trajectory.cost.solve_s)


def mujoco(links: int, steps: int, start: tuple[float, float], **options: object) -> Path:
    """Solve a chain in MuJoCo."""
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
    """Largest distance (micrometres) of the tip from the converged path."""
    at = np.column_stack([np.interp(path.time, truth.time, truth.tip[:, i]) for i in range(2)])
    return 1e6 * float(np.max(np.linalg.norm(path.tip - at, axis=1)))


@dataclass(frozen=True)
class Point:
    """A setting of a tool on a chain: error (micrometres), and median run time of all starts together (ms)."""

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
    """Measure all tools on a chain. Each tool runs its settings from coarse to fine until it meets the finest level."""
    truths = [minimal(links, FINEST, start) for start in starts]
    points = []
    for tool, run, settings in tools:
        for setting in settings:
            first = [run(links, setting, start) for start in starts]
            errors = [distance(path, truth) for path, truth in zip(first, truths, strict=True)]
            error = math.sqrt(sum(e * e for e in errors) / len(errors))
            seconds = [sum(run(links, setting, start).seconds for start in starts) for _ in range(repeats)]
            points.append(Point(links, tool, str(setting), error, 1e3 * statistics.median(seconds)))
            if error <= min(LEVELS):
                break
    return points


def best(points: list[Point], links: int, tool: str, level: float) -> Point | None:
    """Fastest setting of a tool on a chain with an error within a level (micrometres); None if there is none."""
    eligible = [p for p in points if p.links == links and p.tool == tool and p.error <= level]
    return min(eligible, key=lambda p: p.milliseconds, default=None)


def agreement(links: int, start: tuple[float, float] = STARTS[2]) -> float:
    """Distance (micrometres) of MuJoCo's finest path from that of this package, with the same law."""
    finest = mujoco(links, 6400, start, integrator="RK4", native=True)
    return distance(minimal(links, FINEST, start), finest)


def tables(measured: list[Point], sizes: tuple[int, ...]) -> str:
    """Table of all settings, and table of the run time of each tool by level."""
    rows = [[p.links, p.tool, p.setting, f"{p.error:.1f}", f"{p.milliseconds:.2f}"] for p in measured]
    names = list(dict.fromkeys(p.tool for p in measured))
    short = []
    for level in LEVELS:
        for links in sizes:
            times = [best(measured, links, name, level) for name in names]
            short.append(
                [f"{level:g} um", links, *("not reached" if t is None else f"{t.milliseconds:.2f}" for t in times)]
            )
    every = markdown(["links", "tool", "setting", "error um", "ms"], rows)
    return every + "\n\n" + markdown(["error at most", "links", *(f"{name}, ms" for name in names)], short)


def ratios(measured: list[Point], sizes: tuple[int, ...], other: str = THEIRS) -> dict[tuple[float, int], float]:
    """Run time in minimal coordinates over that of another tool, by level and size.

    It is infinite if minimal coordinates do not reach the level.
    """
    out = {}
    for level in LEVELS:
        for links in sizes:
            minimal_point, peer_point = best(measured, links, OURS, level), best(measured, links, other, level)
            if peer_point is not None:
                out[level, links] = (
                    math.inf if minimal_point is None else minimal_point.milliseconds / peer_point.milliseconds
                )
    return out


def points(repeats: int, sizes: tuple[int, ...] = SIZES) -> list[Point]:
    """Measure all tools on all chains."""
    return [point for links in sizes for point in measure(links, TOOLS, STARTS, repeats)]
