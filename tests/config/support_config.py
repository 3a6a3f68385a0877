"""A config that is right in every line, to be broken one line at a time."""

GOOD = """\
name: strike
model:
  name: arm
  bodies:
    hub:
      type: rigid
      density_kg_m3: 7700
      shapes:
        - {type: disc, diameter_m: 0.02, thickness_m: 0.01}
        - {type: cylinder, diameter_m: 0.01, end_m: [0.02, 0]}
    arm:
      type: link
      length_m: 0.2
      diameter_m: 0.006
      density_kg_m3: 7700
      flexible:
        bending_stiffness_N_m2: 15
        elements: 4
  joints:
    pivot: {type: hinge, parent: ground, child: hub}
    clamp: {type: weld, parent: hub, child: arm, parent_point_m: [0.02, 0]}
medium:
  law: lee_marghitu
  density_kg_m3: 2500
  eta_d: 6.5
  eta_h: 8
  plunging: {eta_v: 22, lambda: 1.1}
gravity_m_s2: 9.81
initial:
  impact_angle_deg: 31
  impact_speed_rad_s: 6
load:
  form: distributed
  end_cap: false
  friction: {type: smooth, reference_speed_m_s: 1e-3}
solver:
  end_time_s: 0.5
  step_s: 1e-3
output:
  interval_s: 1e-3
"""


def changed(old: str, new: str) -> str:
    """GOOD with the one occurrence of `old` replaced."""
    assert GOOD.count(old) == 1, f"{old!r} stands {GOOD.count(old)} times in GOOD"
    return GOOD.replace(old, new)
