"""CPU time of long chains in the engine, with and without sand: 1 to 256 links, rigid and flexible.

    python validation/scaling.py [--quick]

A straight chain of equal links of 25 mm, whose tip moves at 1 m/s, makes 200 steps of 0.2 ms. The cases are: no sand;
no sand, but a Python function without effect that the engine calls; the tip strikes sand; the lowest quarter, or all of
the chain, is in the sand from the start. A longer chain lies flatter, so that its links meet the same sand for any
number of links: the tip of the immersed part is 20 mm deep. Run times are processor times (equal to wall times on an
idle machine), the least of the repeats.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.overlay import Overlay
from granular_contact.engines.exudyn.solve import solve
from granular_contact.mechanics.observe import observe
from granular_contact.mechanics.system import RigidHandle, System
from granular_contact.scene import Scene
from validation.chains import chain
from validation.study import Claim, Outcome, script
from validation.tables import markdown

SIZES = (1, 4, 16, 64, 256)
LINEAR_FROM = 16
SLOPE, LOAD, ITERATION = 1.1, 1.5, 400.0  # us
STEPS, STEP = 200, 2e-4
LINK, DEPTH, STEEPEST = 0.025, 0.02, 31.0  # m, m, deg
SPEED = 1.0  # m/s
BARE, EMPTY = "no sand", "empty call"
# Share of the chain that determines its angle (see `set_up`), by case.
CASES = {BARE: 0.25, EMPTY: 0.25, "strikes": 0.25, "lowest quarter": 0.25, "all": 1.0}
KINDS = {"rigid": False, "flexible": True}


@dataclass(frozen=True)
class Cost:
    """Cost of a case.

    solve: least time of the solver, s; whole: least time from scene to columns, with the estimate of the error by
    strips, s, infinite if it was not measured. Steps, iterations and Jacobians are those of the solve.
    """

    solve: float
    whole: float
    steps: int
    iterations: int
    jacobians: int

    @property
    def step(self) -> float:
        """Microseconds per step."""
        return 1e6 * self.solve / self.steps

    @property
    def iteration(self) -> float:
        """Microseconds per Newton iteration."""
        return 1e6 * self.solve / self.iterations


def once(scene: Scene, empty: bool, whole: bool = False) -> Cost:
    """Time one run; empty: with a user function without effect; whole: including the columns of the results."""
    began = time.process_time()
    system = build(scene)
    if empty:
        add_empty_call(system)
    ready = time.process_time()
    trajectory = solve(system)
    solved = time.process_time()
    if whole:
        observe(system, trajectory).columns()
    done = time.process_time() if whole else math.inf
    cost = trajectory.cost
    return Cost(solved - ready, done - began, cost.steps, cost.newton_iterations, cost.jacobians)


def add_empty_call(system: System) -> None:
    """Add a Python function that the engine calls for forces and that returns none: the least cost of a load."""
    handles = [*system.rigid.values(), *system.links.values()]
    node = handles[0].node if isinstance(handles[0], RigidHandle) else handles[0].nodes[0]
    size = len(system.mbs.systemData.GetNodeLTGODE2(node))
    Overlay(system.mbs).attach({node: np.zeros(size)}, lambda *_: [0.0] * size)
    system.mbs.Assemble()


def set_up(kind: str, case: str, links: int) -> Scene:
    """Build the scene of a case on a chain."""
    length, share = links * LINK, CASES[case]
    angle = min(STEEPEST, math.degrees(math.asin(min(1.0, DEPTH / (share * length)))))
    return chain(
        links,
        angle,
        SPEED / length,
        length=length,
        strips_per_link=1,
        flexible=KINDS[kind],
        immersed=share if case in ("lowest quarter", "all") else 0.0,
        medium=None if case in (BARE, EMPTY) else "play_sand",
        end_time_s=STEPS * STEP,
        step_s=STEP,
    )


def measure(kind: str, links: int, repeats: int) -> dict[str, Cost]:
    """Measure all cases on a chain after a warm-up, in turn, since the speed of a processor changes; costs by case."""
    scenes = {case: set_up(kind, case, links) for case in CASES}
    rounds = [
        {case: once(scene, case == EMPTY, whole=i == repeats) for case, scene in scenes.items()}
        for i in range(repeats + 1)
    ]
    by_case = {}
    for case in CASES:
        costs = [costs[case] for costs in rounds[1:]]
        least = min(costs, key=lambda cost: cost.solve)
        whole = min(cost.whole for cost in costs)
        by_case[case] = Cost(least.solve, whole, least.steps, least.iterations, least.jacobians)
    return by_case


Costs = dict[tuple[str, str, int], Cost]


def slope(costs: Costs, kind: str, case: str, whole: bool = False) -> float:
    """Slope of log cost of a step (or of a whole run) over log size, from LINEAR_FROM links on."""
    sizes = [n for k, c, n in costs if (k, c) == (kind, case) and n >= LINEAR_FROM]
    selected = [costs[kind, case, n] for n in sizes]
    times = [cost.whole if whole else cost.solve / cost.steps for cost in selected]
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])


def tables(costs: Costs) -> str:
    """Table with a row for each chain and case, and table of the fitted slopes."""
    rows = []
    for (kind, case, links), cost in costs.items():
        bare = costs[kind, BARE, links]
        rows.append(
            [
                kind, links, case, f"{1e3 * cost.solve:.1f}", f"{cost.solve / bare.solve:.2f}", f"{cost.step:.1f}",
                f"{cost.iteration:.1f}", f"{cost.iteration / bare.iteration:.2f}", cost.steps, cost.iterations,
                cost.jacobians, f"{1e3 * cost.whole:.1f}",
            ]
        )  # fmt: skip
    head = [
        "links", "number", "sand", "solve ms", "ratio to no sand", "us per step", "us per iteration",
        "ratio to no sand", "steps", "iterations", "Jacobians", "whole run ms",
    ]  # fmt: skip
    fits = [
        [kind, case, f"{slope(costs, kind, case):.2f}", f"{slope(costs, kind, case, whole=True):.2f}"]
        for kind in KINDS
        for case in CASES
    ]
    return markdown(head, rows) + "\n\n" + markdown(["links", "sand", "slope of a step", "slope of a whole run"], fits)


def claims(costs: Costs) -> tuple[Claim, ...]:
    """Claims on the slopes, and on the cost of the load and of an iteration."""
    sizes = sorted({n for _, _, n in costs})
    slopes = {(k, c): slope(costs, k, c) for k in KINDS for c in CASES}
    (kind, case), worst = max(slopes.items(), key=lambda item: item[1])
    sand = {key: cost for key, cost in costs.items() if key[1] not in (BARE, EMPTY)}
    loads = {key: cost.solve / costs[key[0], BARE, key[2]].solve for key, cost in sand.items()}
    (load_kind, load_case, load_size), load = max(loads.items(), key=lambda item: item[1])
    most = sizes[-1]
    quarter, bare = (costs["rigid", case, most].iteration for case in ("lowest quarter", BARE))
    floor = costs["rigid", EMPTY, sizes[0]].solve / costs["rigid", BARE, sizes[0]].solve
    return (
        Claim(
            "scaling.cost per step is linear",
            worst <= SLOPE,
            f"slope at most {worst:.2f} ({kind}, {case}) from {LINEAR_FROM} to {most} links, required: at most {SLOPE}",
        ),
        Claim(
            "scaling.an iteration of 256 links is short",
            quarter <= ITERATION,
            f"{quarter:.0f} us for {most} rigid links, a quarter in sand, required: at most {ITERATION:g}; "
            f"{bare:.0f} without sand",
        ),
        Claim(
            "scaling.sand adds at most half of the run time without sand",
            load <= LOAD,
            f"at most {load:.2f} times ({load_size} {load_kind}, {load_case}), required: at most {LOAD}; "
            f"an empty call alone makes the run of {sizes[0]} rigid link {floor:.2f} times as long",
        ),
    )


def study(quick: bool) -> Outcome:
    """Measure all chains; quick: up to 64 links, with fewer repeats."""
    sizes, repeats = ((16, 64), 4) if quick else (SIZES, 5)
    costs: Costs = {}
    for kind in KINDS:
        for links in sizes:
            for case, cost in measure(kind, links, repeats).items():
                costs[kind, case, links] = cost
    return Outcome(tables(costs), claims(costs))


if __name__ == "__main__":
    sys.exit(script(study))
