"""Run time of a load call by law, and a bound on that of lee_marghitu.

    python validation/law_cost.py

The script times one call of the kernels that the engine calls in a run: force, and force with tangent as in a Newton
step. The load is a line of 16 strips (a ball for the scalar laws) that pierces the surface. The laws take turns; each
number is the least of many rounds, since noise can only add to a time.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from granular_contact import preset
from granular_contact.jit.compiled import ready
from granular_contact.laws.law import Law
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.sand.kernels import batches, kinematics, planar_sand
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.law import LINE
from validation.laws import every_medium
from validation.tables import machine, markdown

STRIPS, CALLS, ROUNDS = 16, 400, 60
MOST = 1.5


def calls(medium: Law) -> tuple[Callable[[], None], Callable[[], None]]:
    """Functions that make a force call and a tangent call on a rigid body in a medium."""
    run = np.zeros(1, LINE)
    run["width"], run["mass"] = 0.00635, 0.07
    ((geometry, _),) = kinematics.curved_stations(np.array([[-0.1, 0.0], [0.1, 0.0]]), np.zeros(1), STRIPS)
    if "ball" in medium.takes:
        run["drop"] = 0.5 * run["width"]
        geometry = kinematics.ball_stations(np.zeros(2))
    q, v, where = np.array([0.0, -0.02, -0.7]), np.array([0.3, -1.0, 2.0]), np.column_stack([np.arange(3)] * 2)
    n = len(geometry)
    ends, active, out, triplets = np.array([[0, 0], [n, 3]]), np.ones(1, dtype=bool), np.zeros(3), np.zeros((9, 3))
    anchors = np.zeros((n, 2))
    room, body = batches.work(ends, anchors)
    arrays = {
        **{"reference": np.zeros(3), "active": active, "ends": ends, "places": where, "geometry": geometry},
        **{
            "lines": run,
            "profile": np.array([[0.0, 0.0]]),
            "medium": medium_record(medium.record(Elastoplastic(), 9.81)),
        },
        **{"anchors": anchors, "room": room, "body": body},
        **{"columns": np.zeros((1, 3), np.int64), "proximity": np.zeros((1, 3))},
    }
    addresses = planar_sand.LINES.addresses(arrays)[None, :]
    force, tangent = (
        ready(planar_sand.force, addresses, q, v, out),
        ready(planar_sand.tangent, addresses, q, v, 1.0, 1.0, triplets),
    )

    def forces() -> None:
        force(addresses, q, v, out)

    def tangents() -> None:
        assert arrays  # keeps the arrays alive, which kernels read by address
        tangent(addresses, q, v, 1.0, 1.0, triplets)

    return forces, tangents


def least(calls_by_name: dict[str, Callable[[], None]], rounds: int = ROUNDS) -> dict[str, float]:
    """Least time (s) of each call by name; the calls take turns after a warm-up."""
    for call in calls_by_name.values():
        call()
    best = dict.fromkeys(calls_by_name, float("inf"))
    for _ in range(rounds):
        for name, call in calls_by_name.items():
            began = time.perf_counter()
            for _ in range(CALLS):
                call()
            best[name] = min(best[name], (time.perf_counter() - began) / CALLS)
    return best


def main() -> int:
    """Print the table; return 0 if every law keeps its bound, else 1."""
    media = {"lee_marghitu": preset("play_sand")} | {medium.name: medium for medium in every_medium()}
    both = {name: calls(medium) for name, medium in media.items()}
    force = least({name: pair[0] for name, pair in both.items()})
    tangent = least({name: pair[1] for name, pair in both.items()})
    rows, worst = [], 0.0
    for name in media:
        ratios = [cost[name] / cost["lee_marghitu"] for cost in (force, tangent)]
        worst = max(worst, *ratios)
        rows.append(
            [name, f"{1e6 * force[name]:.2f}", f"{ratios[0]:.2f}", f"{1e6 * tangent[name]:.2f}", f"{ratios[1]:.2f}"]
        )
    print(f"{machine('numba')}; least of {ROUNDS} rounds of {CALLS} calls, laws in turn\n")
    print(markdown(["law", "force us", "ratio to lee_marghitu", "force and tangent us", "ratio to lee_marghitu"], rows))
    print(f"\nmost expensive law: {worst:.2f} times lee_marghitu; at most {MOST}")
    return 0 if worst <= MOST else 1


if __name__ == "__main__":
    sys.exit(main())
