"""Forward speed of the planar runner over its limb frequency, and limits of the model.

    python validation/runner.py [--quick]

The runner of configs/runner.yaml runs on three grounds: with its own clock on close-packed poppy seeds; with a short
stance (`SHORT`) on loose seeds; and, with its own clock on loose seeds, with a trunk so heavy (`HEAVY`) that it rests
on its belly and the legs lift it for a moment only. Speeds are mean speeds of the trunk over whole strides in the
second half of a run; the stride length is speed over limb frequency. The real-time factor is solve time over simulated
time for the shipped config.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import load_scenario
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIG, FIGURE = HERE.parent / "configs" / "runner.yaml", HERE / "figures" / "runner.png"
FREQUENCIES = (0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0)  # Hz
LEG = 0.04  # m, length of a leg from hip to toe
SHORT = {"medium": "poppy_seeds_loose", "signals.stride.stance_sweep_deg": 40, "signals.stride.duty_factor": 0.35}
HEAVY = {"medium": "poppy_seeds_loose", "model.bodies.trunk.density_kg_m3": 1700}
GROUNDS: dict[str, dict[str, object]] = {  # changes of the config by name of the ground
    "close-packed, stance of 90 deg": {},
    "loose, stance of 40 deg": SHORT,
    "loose, trunk of 460 g": HEAVY,
}
LEAST_TIME, STRIDES = 1.0, 4  # least duration of a run in s and in strides
# The quick form: for each ground the frequencies that its claims need, and half the strides.
QUICK, QUICK_STRIDES = ((1.0, 8.0), (1.0, 8.0), (1.0, 2.0, 8.0)), 2
MOST_IMBALANCE = 1e-3
NOT_SHOWN = """What the model can't show: The resistance is that of a flat, undisturbed bed at every step. There are no
craters, no heaps, no footprints that the next leg falls into and no sand that flows back, so that faster legs do not
meet ground which earlier ones loosened. The law knows no rate: grains that are thrown have no inertia (the law `drft`
has that, with coefficients that were not measured for seeds). The legs follow their clock whatever torque it takes. The
motion is in the plane: no roll, no yaw, and both sides of the runner have the same sand."""


@dataclass(frozen=True)
class Gait:
    """Results of a run.

    frequency: limb frequency, Hz; speed: forward, m/s; rise: range of the trunk's height, m; depth: greatest, m; cost:
    cost of transport; imbalance: relative error of the energy balance.
    """

    frequency: float
    speed: float
    rise: float
    depth: float
    cost: float
    imbalance: float

    @property
    def stride(self) -> float:
        """Stride length (m)."""
        return self.speed / self.frequency


def simulate(frequency: float, changes: dict[str, object], end_time: float) -> Results:
    """Run the runner at a limb frequency (Hz) on a ground, given by changes of the config, to an end time (s)."""
    sets = [f"signals.stride.frequency_Hz={frequency}", f"solver.end_time_s={end_time}"]
    scenario = load_scenario(CONFIG, [*sets, *(f"{key}={value}" for key, value in changes.items())])
    return run(build(scenario), scenario)


def gait(frequency: float, changes: dict[str, object], strides: int = STRIDES) -> Gait:
    """Measure the gait at a limb frequency (Hz), over at least `strides` strides."""
    end = max(LEAST_TIME, strides / frequency)
    results = simulate(frequency, changes, end)
    time_s, x = results["time_s"], results["trunk_x_m"]
    lasted = math.floor(0.5 * end * frequency + 1e-9) / frequency
    speed = float(x[-1] - np.interp(time_s[-1] - lasted, time_s, x)) / lasted
    summary = results.summary
    return Gait(
        frequency,
        speed,
        rise=float(np.ptp(results["trunk_y_m"][time_s > time_s[-1] - lasted])),
        depth=summary["max_depth_m"],
        cost=summary["cost_of_transport"],
        imbalance=summary["energy"]["imbalance_relative"],
    )


def rows(gaits: list[Gait]) -> list[list[str]]:
    """Cells of the table."""
    return [
        [
            f"{g.frequency:g}",
            f"{g.speed:.3f}",
            f"{1e3 * g.stride:.1f}",
            f"{1e3 * g.rise:.2f}",
            f"{1e3 * g.depth:.1f}",
            f"{g.cost:.2f}",
            f"{g.imbalance:.0e}",
        ]
        for g in gaits
    ]


def claims(close: list[Gait], loose: list[Gait], heavy: list[Gait]) -> tuple[Claim, ...]:
    """Claims on the gaits on the three grounds, each in the order of frequency."""
    every = [*close, *loose, *heavy]
    least = min(float(np.diff([g.speed for g in gaits]).min()) for gaits in (close, loose))
    shares = [gaits[-1].stride / max(g.stride for g in gaits) for gaits in (close, loose)]
    fastest = max(heavy, key=lambda g: g.speed)
    worst = max(g.imbalance for g in every)
    sunk = max(g.depth for g in every)
    top = close[-1].frequency
    return (
        Claim(
            "runner.speed rises with limb frequency while legs carry the trunk",
            least > 0.0,
            f"smallest rise between two frequencies {least:.3f} m/s",
        ),
        Claim(
            "runner.legs keep their footing on close-packed seeds",
            shares[0] > 0.8,
            f"at {top:g} Hz a stride is {shares[0]:.0%} of the longest (required: 80 %)",
        ),
        Claim(
            "runner.legs lose footing on loose seeds with a short stance",
            shares[1] < 0.75,
            f"at {top:g} Hz a stride is {shares[1]:.0%} of the longest (required: below 75 %)",
        ),
        Claim(
            "runner.a heavy trunk gets faster, then slower",
            heavy[0].frequency < fastest.frequency < top and heavy[-1].speed < 0.5 * fastest.speed,
            f"{heavy[0].speed:.3f} m/s at {heavy[0].frequency:g} Hz, {fastest.speed:.3f} at {fastest.frequency:g}, "
            f"{heavy[-1].speed:.3f} at {top:g} (required: below half)",
        ),
        Claim(
            "runner.the heavy trunk slows down where legs no longer lift it",
            heavy[-1].rise < 0.2 * heavy[0].rise,
            f"the trunk goes up and down by {1e3 * heavy[0].rise:.2f} mm at {heavy[0].frequency:g} Hz, "
            f"{1e3 * heavy[-1].rise:.2f} at {top:g} (required: less than a fifth)",
        ),
        Claim(
            "runner.bodies do not sink without limit",
            sunk < LEG,
            f"at most {1e3 * sunk:.0f} mm deep (required: the leg's {1e3 * LEG:.0f} mm)",
        ),
        Claim(
            "runner.energy is balanced", worst <= MOST_IMBALANCE, f"{worst:.1e} at most (required: {MOST_IMBALANCE:g})"
        ),
    )


def real_time(repeats: int) -> str:
    """Sentence with the real-time factor of the shipped config by wall clock, and by processor time of whole runs."""
    walls, processor = [], []
    for _ in range(repeats):
        scenario = load_scenario(CONFIG)
        began = time.process_time()
        results = run(build(scenario), scenario)
        processor.append((time.process_time() - began) / scenario.solver.end_time_s)
        walls.append(results.summary["cost"]["solve_s"] / scenario.solver.end_time_s)
    cost = results.summary["cost"]
    return (
        f"Real-time factor of configs/runner.yaml, default settings: {statistics.median(walls):.2f} by wall clock "
        f"(smallest {min(walls):.2f}), {statistics.median(processor):.2f} by processor time, with building and "
        f"reporting; {cost['steps']} steps, {cost['newton_iterations'] / cost['steps']:.1f} iterations per step, "
        f"{repeats} runs. Below 1 is faster than real time."
    )


def draw(by_ground: dict[str, list[Gait]]) -> None:
    """Draw speed and stride length over limb frequency."""
    import matplotlib.pyplot as plt

    from granular_contact.report.figures.style import DPI, PALETTE, style

    with style():
        figure, (left, right) = plt.subplots(1, 2, figsize=(7.1, 2.7), layout="constrained")
        for (name, gaits), color in zip(by_ground.items(), PALETTE, strict=False):
            f = [g.frequency for g in gaits]
            left.plot(f, [g.speed for g in gaits], "o-", color=color, label=name)
            right.plot(f, [1e3 * g.stride for g in gaits], "o-", color=color, label=name)
        left.set(xlabel="limb frequency (Hz)", ylabel="forward speed (m/s)", yscale="log", xlim=(0, None))
        right.set(xlabel="limb frequency (Hz)", ylabel="stride length (mm)", yscale="log", xlim=(0, None))
        figure.legend(
            *left.get_legend_handles_labels(), frameon=False, ncols=len(by_ground), loc="outside upper center"
        )
        figure.savefig(FIGURE, dpi=DPI)
        plt.close(figure)


def gaits(quick: bool) -> dict[str, list[Gait]]:
    """Gaits for all frequencies, by ground."""
    if not quick:
        return {name: [gait(f, ground) for f in FREQUENCIES] for name, ground in GROUNDS.items()}
    return {
        name: [gait(f, ground, QUICK_STRIDES) for f in frequencies]
        for (name, ground), frequencies in zip(GROUNDS.items(), QUICK, strict=True)
    }


def study(quick: bool) -> Outcome:
    """Run all grounds over the frequencies."""
    by_ground = gaits(quick)
    head = [
        "limb Hz",
        "speed m/s",
        "stride length mm",
        "trunk's rise mm",
        "deepest mm",
        "cost of transport",
        "energy imbalance",
    ]
    parts = [
        f"{name[0].upper()}{name[1:]}.\n\n{markdown(head, rows(measured))}" for name, measured in by_ground.items()
    ]
    if not quick:
        draw(by_ground)
        parts += [f"![Forward speed and stride length against limb frequency](figures/{FIGURE.name})", real_time(5)]
    return Outcome("\n\n".join([*parts, NOT_SHOWN]), claims(*by_ground.values()))


if __name__ == "__main__":
    sys.exit(script(study))
