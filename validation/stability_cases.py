"""Cases of `stability.py`: one factor varied at a time, from gentle to absurd, and combinations of extreme values."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

FLEXIBLE = "model.bodies.link.flexible"
EI, EA, DIAMETER, DENSITY = 15.1642, 6.017e6, 0.00635, 7700.0
STEP = 2e-4
FACTORS = (0.0, 1e-3, 1e-2, 1e-1, 1.0, 10.0, 1e2, 1e3)
SPEEDS = (0.0, 1e-6, 1e-3, 0.1, 1.0, 6.24, 20.0, 50.0, 100.0)


@dataclass(frozen=True)
class Case:
    """A run.

    overrides: changes of configs/pendulum.yaml, or of `config`; step: time step, s, of which the reference has a
    fraction; finer: further overrides of the reference; quick: whether the case is in the quick form; until: end time,
    s.
    """

    factor: str
    value: str
    overrides: tuple[str, ...]
    step: float = STEP
    finer: tuple[str, ...] = ()
    quick: bool = False
    until: float = 0.05
    config: str = "pendulum"


def cases() -> list[Case]:
    """All cases in the order of the table."""
    return [*_structure(), *_numbers(), *_medium(), *_motion(), *_events(), *_adaptive(), *_corners()]


def _stiff(factor: float) -> tuple[str, ...]:
    return (f"{FLEXIBLE}.bending_stiffness_N_m2={EI * factor:.9g}",)


def _elements(count: int) -> tuple[str, ...]:
    return (f"{FLEXIBLE}.elements={count}",)


def _structure() -> Iterator[Case]:
    for power in range(-6, 7):
        yield Case("EI and EA", f"1e{power}", _stiff(10.0**power), finer=_elements(16), quick=power % 3 == 0)
    for power in (-6, -3, 0, 3, 6):
        overrides = (*_stiff(10.0**power), *_elements(64))
        yield Case("EI and EA, 64 elements", f"1e{power}", overrides, quick=power == 6)
    for power in range(-6, 7):
        overrides = (f"{FLEXIBLE}.axial_stiffness_N={EA * 10.0**power:.9g}",)
        yield Case("EA alone", f"1e{power}", overrides, finer=_elements(16), quick=power in (-6, 6))
    for count in (1, 2, 4, 8, 16, 32, 64, 128):
        yield Case("elements", f"{count}", _elements(count), finer=_elements(32), quick=count in (1, 128))
    for damping in (0.0, 1e-4, 1e-2, 1.0, 100.0):
        yield Case("bending damping", f"{damping:g}", (f"{FLEXIBLE}.bending_damping_N_m2_s={damping}",))
    for damping in (1.0, 1e3, 1e6):
        yield Case("axial damping", f"{damping:g}", (f"{FLEXIBLE}.axial_damping_N_s={damping}",), quick=damping == 1e6)
    for size in (1e-4, 1e-3, 3e-3, 0.02, 0.05, 0.1):
        overrides = (f"model.bodies.link.diameter_m={size}", *_stiff((size / DIAMETER) ** 4))
        yield Case("link diameter", f"{size:g} m", overrides, finer=_elements(16), quick=size in (1e-4, 0.1))
    for ratio in (1e-3, 1e-1, 10.0, 1e3):
        yield Case("link density", f"{ratio:g}", (f"model.bodies.link.density_kg_m3={DENSITY * ratio}",), quick=True)
    for ratio in (1e-4, 1e-2, 1e2, 1e4):
        overrides = tuple(f"model.bodies.{name}.density_kg_m3={DENSITY * ratio}" for name in ("RB1", "RB2"))
        yield Case("root density", f"{ratio:g}", overrides, quick=ratio in (1e-4, 1e4))


def _numbers() -> Iterator[Case]:
    for step in (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 1e-4, 5e-5, 2e-5, 1e-5):
        yield Case("step", f"{step:g} s", (), step=step, quick=step >= 1e-3)
    yield Case("step", "1e-06 s", (), step=1e-6, until=5e-3)
    yield Case("step", "1e-07 s", (), step=1e-7, until=5e-4)
    for radius in (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0):
        yield Case("spectral radius", f"{radius:g}", (f"solver.spectral_radius={radius}",), quick=radius in (0.0, 1.0))
    for tolerance in (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10):
        overrides = (f"solver.tolerance={tolerance}",)
        yield Case("tolerance", f"{tolerance:g}", overrides, quick=tolerance in (1e-2, 1e-10))
    for tolerance in (1e-7, 1e-9):
        overrides = (f"solver.tolerance={tolerance}", *_elements(64))
        yield Case("tolerance, 64 elements", f"{tolerance:g}", overrides, step=4e-5)


def _medium() -> Iterator[Case]:
    for power in range(-8, -1):
        overrides = (f"load.friction={{type: elastoplastic, yield_displacement_m: 1e{power}}}",)
        yield Case("yield displacement", f"1e{power} m", overrides, quick=power in (-8, -2))
    for tau in (0.0, 1e-5, 1e-4, 1e-2, 0.1):
        overrides = (f"load.friction={{type: elastoplastic, damping_time_s: {tau}}}",)
        yield Case("bristle damping time", f"{tau:g} s", overrides, quick=tau == 0.0)
    for speed in (1e-6, 1e-4, 1e-2, 1.0):
        overrides = (f"load.friction={{type: smooth, reference_speed_m_s: {speed}}}",)
        yield Case("smooth reference speed", f"{speed:g} m/s", overrides, quick=speed == 1e-6)
    for key, value in (("eta_d", 6.5), ("eta_h", 8.0), ("plunging.eta_v", 22.0)):
        for factor in FACTORS:
            overrides = (f"medium.{key}={value * factor:g}",)
            yield Case(key.removeprefix("plunging."), f"{factor:g} times", overrides, quick=factor in (0.0, 1e3))
    for power in (0.0, 0.3, 0.7, 1.1, 1.5, 2.0, 3.0):
        yield Case("lambda", f"{power:g}", (f"medium.plunging.lambda={power}",), quick=power in (0.0, 3.0))
    for density in (1.0, 10.0, 100.0, 1e3, 1e4, 1e5):
        yield Case("grain density", f"{density:g}", (f"medium.density_kg_m3={density}",), quick=density == 1e5)


def _motion() -> Iterator[Case]:
    for speed in SPEEDS:
        quick = speed in (0.0, 1e-6, 20.0, 100.0)
        yield Case("impact speed", f"{speed:g} rad/s", (f"initial.impact_speed_rad_s={speed}",), quick=quick)
    for angle in (0.0, 0.01, 1.0, 5.0, 15.0, 45.0, 75.0, 89.99, 90.0):
        quick = angle in (0.0, 0.01, 89.99, 90.0)
        yield Case("impact angle", f"{angle:g} deg", (f"initial.impact_angle_deg={angle}",), quick=quick)
    for angle, surface in (
        (-10.0, 0.0),
        (-45.0, 0.1),
        (-90.0, 0.2),
        (-90.0, 0.3),
        (31.0, 0.0),
        (0.0, 0.0),
        (0.0, 1e-3),
    ):
        overrides = (f"initial.impact_angle_deg={angle}", f"surface_height_m={surface}")
        yield Case("starts above or immersed", f"{angle:g} deg, {surface:g} m", overrides, quick=angle <= 0.0)
    for gravity in (0.0, 0.1, 1.62, 30.0, 100.0, -1.0, -9.81, -100.0):
        yield Case("gravity", f"{gravity:g}", (f"gravity_m_s2={gravity}",), quick=gravity in (0.0, 100.0, -9.81))


def _events() -> Iterator[Case]:
    for depth in (1e-6, 1e-4, 1e-3, 5e-3, 0.02):
        overrides = (f"surface_height_m={-0.263525 + depth:.9g}", "initial.impact_speed_rad_s=8")
        yield Case(
            "grazes and leaves at the lowest point", f"{depth:g} m", overrides, until=0.3, quick=depth in (1e-6, 5e-3)
        )
    for speed in (1.0, 3.0, 8.0):
        overrides = ("surface_height_m=-0.2", "initial.impact_angle_deg=5", f"initial.impact_speed_rad_s={speed}")
        yield Case("falls, then strikes", f"{speed:g} rad/s", overrides, until=0.25)
    for frequency in (5.0, 50.0, 200.0):
        wave = f"{{type: sine, amplitude: 1, frequency_Hz: {frequency}, offset: 30, phase_deg: 90}}"
        overrides = (f"drives={{pivot: {{type: motion, angle_deg: {wave}}}}}", "initial.impact_speed_rad_s=0")
        yield Case("forced through the surface", f"{frequency:g} Hz", overrides, until=0.1, quick=frequency == 50.0)
    for friction in ("elastoplastic", "smooth"):
        overrides = (f"load.friction={{type: {friction}}}", "initial.impact_speed_rad_s=0")
        yield Case("long rest", f"60 s, {friction}", overrides, step=5e-3, until=60.0)
    overrides = ("solver.accuracy=1e-3", "initial.impact_speed_rad_s=0")
    yield Case("long rest", "60 s, accuracy 1e-3", overrides, until=60.0, quick=True)
    yield Case("rigid", "6.24 rad/s", (), config="pendulum_rigid", quick=True)
    yield Case("in vacuum", "", ("medium=null",), quick=True)


def _adaptive() -> Iterator[Case]:
    for accuracy in (0.1, 1e-2, 1e-3, 1e-4, 1e-5):
        yield Case("accuracy", f"{accuracy:g}", (f"solver.accuracy={accuracy}",), quick=accuracy in (0.1, 1e-3))
    chosen = ("solver.accuracy=1e-3",)
    for power in (-6, -3, 3, 6):
        yield Case("accuracy 1e-3, EI and EA", f"1e{power}", (*chosen, *_stiff(10.0**power)), finer=_elements(16))
    for speed in SPEEDS:
        overrides = (*chosen, f"initial.impact_speed_rad_s={speed}")
        yield Case("accuracy 1e-3, impact speed", f"{speed:g} rad/s", overrides, quick=speed == 100.0)
    for angle in (0.0, 0.01, 45.0, 89.99, 90.0):
        yield Case("accuracy 1e-3, impact angle", f"{angle:g} deg", (*chosen, f"initial.impact_angle_deg={angle}"))
    for step in (1e-2, 1e-5):
        yield Case("accuracy 1e-3, first step", f"{step:g} s", chosen, step=step, quick=True)


def _corners() -> Iterator[Case]:
    stiff, counts, steps = (1e-3, 1e3), (2, 32), (5e-5, 2e-3)
    speeds, angles = (0.1, 50.0), (5.0, 85.0)
    for i, (f, n, h, v, a) in enumerate(itertools.product(stiff, counts, steps, speeds, angles)):
        overrides = (*_stiff(f), *_elements(n), f"initial.impact_speed_rad_s={v}", f"initial.impact_angle_deg={a}")
        value = f"EI {f:g}, {n} elements, {h:g} s, {v:g} rad/s, {a:g} deg"
        yield Case("corner: structure", value, overrides, step=h, finer=_elements(32), quick=i % 16 == 3)
    for i, (u, e, h, v) in enumerate(itertools.product((1e-7, 1e-3), (1e-2, 1e2), steps, speeds)):
        overrides = (
            f"load.friction={{type: elastoplastic, yield_displacement_m: {u}}}",
            f"medium.plunging.eta_v={22 * e:g}",
        )
        overrides = (*overrides, f"initial.impact_speed_rad_s={v}")
        value = f"u_y {u:g} m, eta_v {e:g} times, {h:g} s, {v:g} rad/s"
        yield Case("corner: medium", value, overrides, step=h, quick=i % 8 == 3)
    for rho, d, g, v in itertools.product((10.0, 1e5), (1e-3, 0.03), (1.0, 100.0), speeds):
        overrides = (f"medium.density_kg_m3={rho}", f"model.bodies.link.diameter_m={d}", *_stiff((d / DIAMETER) ** 4))
        overrides = (*overrides, f"gravity_m_s2={g}", f"initial.impact_speed_rad_s={v}")
        value = f"grains {rho:g}, diameter {d:g} m, gravity {g:g}, {v:g} rad/s"
        yield Case("corner: sizes", value, overrides, finer=_elements(16))


def heat() -> list[tuple[str, float, float, Case]]:
    """Points of the maps as (map, x, y, case): speed and step, and stiffness and step."""
    points = []
    for h, v in itertools.product((1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5), SPEEDS[1:]):
        overrides = (f"initial.impact_speed_rad_s={v}",)
        points.append(("speed", v, h, Case("map: speed, step", f"{v:g} rad/s, {h:g} s", overrides, step=h)))
    for f, h in itertools.product([10.0**p for p in range(-6, 7, 2)], (1e-2, 2e-3, 5e-4, 1e-4)):
        case = Case("map: stiffness, step", f"{f:g}, {h:g} s", _stiff(f), step=h, finer=_elements(16))
        points.append(("stiffness", f, h, case))
    assert all(math.isfinite(x) for _, x, _, _ in points)
    return points
