"""The lines of --explain about the bed."""

from __future__ import annotations

import pytest
from support_runs import scene_of

from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.solve import solve
from granular_contact.mechanics.omissions import left_out

PAIR = """
model:
  name: pair
  bodies:
    arm:
      type: rigid
      density_kg_m3: 7700
      shapes:
        - {type: cylinder, start_m: [0, 0], end_m: [0.2, 0], diameter_m: 0.006}
        - {type: cylinder, start_m: [0, 0], end_m: [0.01, 0], diameter_m: 0.006}
        - {type: cylinder, start_m: [0, 0], end_m: [0.2, 0], diameter_m: 0.006, in_sand: false}
  joints: {pivot: {type: hinge, parent: ground, child: arm}}
medium: play_sand
initial: {impact_angle_deg: 30, impact_speed_rad_s: 2}
solver: {end_time_s: 0.002}
"""


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ((), "load on arm: 1 of its 3 shapes cannot reach the surface"),
        ((), "load on arm: 1 of its 3 shapes meet no medium (in_sand: false)"),
        (
            ("medium.plunging.eta_v=0",),
            "terms of play_sand: plunging.eta_v, withdrawing.eta_v = 0, so they add nothing",
        ),
        (("medium={law: drft, lambda: 0, density_kg_m3: 1}",), "terms of drft: lambda = 0, so they add nothing"),
        (("medium=rft_generic", "load.end_cap=true"), "end caps: rft_generic have no force on end faces"),
    ],
)
def test_shapes_left_out_of_the_bed_are_reported(more: tuple[str, ...], message: str) -> None:
    system = build(scene_of(PAIR, *more))
    assert message in list(left_out(system, solve(system)))
