"""Numbers of the summary are those of the motion: none of them depends on which instants of it were stored."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from support_runs import CONFIGS

from granular_contact import run as run_module
from granular_contact.config import Scenario, is_run, load_scenario
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.system import Trajectory
from granular_contact.results import FINISHED, REST_MEASURE, Results
from granular_contact.results.interpolation import Track, above_zero, at_times, greatest, positive_part, rates
from granular_contact.results.observation import results
from granular_contact.run import Begun
from granular_contact.scene import build

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
# Of every config so much as takes seconds: the impacts whole, of gaits the first stride.
LONG = (
    "c_leg",
    "dragged_plate",
    "four_bar_leg",
    "stepping_leg",
    "flexible_leg",
    "flexible_leg_rigid",
    "runner",
    "wheel",
)
SHORT = {name: ("solver.end_time_s=0.2",) for name in (*LONG, "walker", "chain", "chain_flexible")}
# Of configs that choose their steps, fixed ones (s).
FIXED = {
    "free_link": 2e-4,
    "wheel": 5e-4,
    "c_leg": 2e-4,
    "runner": 2e-4,
    "stepping_leg": 5e-4,
    "walker": 5e-4,
    "four_bar_leg": 5e-4,
    "chain": 1e-4,
    "chain_flexible": 1e-4,
}
NAMES = sorted(  # in the plane; the impacts at other angles are the pendulum's
    path.stem
    for path in CONFIGS.glob("*.yaml")
    if is_run(path)
    and not path.stem.startswith("impact_")
    and not getattr(load_scenario(path).model, "in_space", False)
)
_OF_THE_STEPS = ("cost", "versions", "warnings", "message", "status")
VIBRATES = ("hub_stopping_time_s", "max_deflection_time_s", "energy.damping_work_J")


def in_fixed_steps(name: str) -> list[str]:
    """Overrides by which a config has fixed steps."""
    return ["solver.accuracy=null", f"solver.step_s={FIXED[name]}"] if name in FIXED else []


def test_extremes_and_crossings_of_a_cubic_are_exact() -> None:
    """The cubic of an interval is the quantity itself: all that is left is round-off."""
    time = np.array([0.0, 0.3, 0.35, 1.1, 2.0])
    values, slopes = time**3 - 1.9 * time**2 + 0.8 * time, 3 * time**2 - 3.8 * time + 0.8
    roots, turns = np.sort(np.roots([1.0, -1.9, 0.8])), np.sort(np.roots([3.0, -3.8, 0.8]))
    track = Track(values - values[-1], slopes)
    assert greatest(time, [Track(values[:-1], slopes[:-1])][:0])[0] == -np.inf
    best, when = greatest(time[:-1], [Track(values[:-1], slopes[:-1])])
    assert (best, when) == (pytest.approx(np.polyval([1, -1.9, 0.8, 0], turns[0]), abs=1e-14), pytest.approx(turns[0]))
    spans = above_zero(time, [Track(values, slopes)])
    assert np.ravel(spans) == pytest.approx([0.0, roots[0], roots[1], 2.0], abs=1e-14)
    assert above_zero(time, [track]) == []
    at = np.linspace(0.0, 2.0, 41)
    assert at_times(time, values, slopes, at) == pytest.approx(at**3 - 1.9 * at**2 + 0.8 * at, abs=1e-13)
    assert at_times(time, values, slopes, np.array([-1.0, 3.0])) == pytest.approx([values[0], values[-1]])


def test_an_excursion_between_two_steps_is_detected() -> None:
    time, low = np.array([0.0, 1.0]), Track(np.array([-0.1, -0.1]), np.array([1.0, -1.0]))
    # x (1 - x) - 0.1: above zero between its roots; and two of them that overlap are one span.
    a, b = np.sort(np.roots([-1.0, 1.0, -0.1]))
    assert np.ravel(above_zero(time, [low])) == pytest.approx([a, b], abs=1e-14)
    both = above_zero(time, [low, Track(np.array([-0.5, 0.5]), np.array([1.0, 1.0]))])
    assert np.ravel(both) == pytest.approx([a, 1.0], abs=1e-14)
    assert greatest(time, [low]) == (pytest.approx(0.15), pytest.approx(0.5))


def test_error_by_a_jump_of_acceleration_keeps_its_bound() -> None:
    """h^2 / 60 of the jump at most, wherever in its step it comes."""
    x = np.linspace(0.0, 1.0, 1001)
    worst = 0.0
    for s in np.linspace(0.01, 0.99, 99):
        exact = 0.5 * np.maximum(x - s, 0.0) ** 2
        cubic = at_times(np.array([0.0, 1.0]), exact[[0, -1]], np.array([0.0, 1.0 - s]), x)
        worst = max(worst, float(np.abs(cubic - exact).max()))
    assert 1 / 65 < worst <= 1 / 60


def test_integral_of_the_positive_part_is_exact_for_lines() -> None:
    assert positive_part(np.array([0.0, 1.0, 3.0, 4.0]), np.array([1.0, -1.0, 3.0, 3.0])) == pytest.approx(
        0.25 + 0.5 * 3.0 * 1.5 + 3.0
    )
    assert positive_part(np.array([0.0]), np.array([1.0])) == 0.0
    assert rates(np.array([0.0, 1.0, 3.0]), np.array([0.0, 1.0, 9.0])) == pytest.approx([0.0, 2.0, 6.0])


# ---- whole runs ----


def thinned(trajectory: Trajectory, kept: Any) -> Trajectory:
    """The same motion with some of its instants (indices) alone."""

    def of(thing: Any) -> Any:
        arrays = {k: v for k, v in vars(thing).items() if isinstance(v, np.ndarray) and k != "mass"}
        return replace(thing, **{key: values[kept] for key, values in arrays.items()})

    load = None if trajectory.load is None else of(trajectory.load)
    return replace(of(trajectory), load=load, multipliers={k: v[kept] for k, v in trajectory.multipliers.items()})


def summary_of(begun: Begun, trajectory: Trajectory) -> dict[str, Any]:
    return results(begun.observe(trajectory), {}, 0).summary


def run_and_motion(scenario: Scenario) -> tuple[Results, Kinematics]:
    motions = []
    results = run_module.run(build(scenario), scenario, inspect=lambda *solved: motions.append(Kinematics(*solved)))
    return results, motions[0]


def numbers(summary: dict[str, Any]) -> dict[str, float]:
    """All numbers of a summary that tell of the motion, those in mappings by dotted names; contacts as sums."""
    selected = {key: value for key, value in summary.items() if key not in _OF_THE_STEPS}
    selected |= {f"energy.{key}": value for key, value in summary["energy"].items() if key != "imbalance_relative"}
    selected |= {f"{key} in contact, s": sum(b - a for a, b in v) for key, v in summary.get("contacts", {}).items()}
    return {key: value for key, value in selected.items() if isinstance(value, int | float)}


def size_of(key: str, way: float, speed: float, energy: float, lasted: float) -> float:
    """How far a number moves while all goes on for the time of `way` at `speed`: the unit of its error."""
    if key.endswith("_m_s"):
        return 2.0 * way / lasted
    if key.endswith((".s", ", s", "_s")):
        return way / speed
    if key.endswith("_J"):
        return energy
    return np.degrees(way) if key.endswith("_deg") else way  # of a length of 1 m; the mechanisms are shorter


@pytest.mark.parametrize("name", NAMES)
def test_instants_left_out_change_no_number(name: str) -> None:
    """Of one motion instants are dropped at random, so that up to four steps lie between two in the first half.

    What moves then is only how numbers are read. In a gap of length H everything moves by speed x H, and all work by
    its share of the time; what is read to the second order is off by the share that H is of the time constants of the
    motion, tens of gaps: 5 % of a gap. What vibrates has ten steps a period: half a gap.
    """
    scenario = load_scenario(
        CONFIGS / f"{name}.yaml", [*SHORT.get(name, ()), *in_fixed_steps(name), "output.figures=false"]
    )
    scene = build(scenario)
    begun = run_module.begin(scene)
    begun.solving.advance()
    whole = begun.solving.trajectory()
    last, draw, kept = len(whole.time) - 1, np.random.default_rng(1), [0]
    while kept[-1] < last:
        kept.append(min(last, kept[-1] + int(draw.integers(1, 5 if kept[-1] < last // 2 else 3))))
    exact, got = numbers(summary_of(begun, whole)), numbers(summary_of(begun, thinned(whole, kept)))
    assert got.keys() == exact.keys()
    motion, gap = Kinematics(begun.system, whole), 4.0 * scene.solver.step_s
    speed, lasted = float(motion.speeds.max()), float(whole.time[-1])
    energy = 10.0 * max(abs(value) for key, value in exact.items() if key.endswith("_J")) * gap / lasted
    for key, value in exact.items():
        share = 0.5 if scene.links and key in VIBRATES else 0.05
        if key == "energy.granular_work_J":  # made of the steps themselves: what lies in a gap is known to first order
            share = 1.0
        if key == "cost_of_transport":
            allowed = value * share * energy / exact["drive_work_put_in_J"]
        else:
            allowed = share * size_of(key, speed * gap, speed, energy, lasted)
        assert got[key] == pytest.approx(value, abs=allowed), (key, abs(got[key] - value) / allowed)


@pytest.mark.parametrize("name", ["pendulum", "free_link", "double_pendulum", "walker", "wheel", "chain_flexible"])
def test_rows_at_an_interval_change_no_number(name: str) -> None:
    """The table has fewer rows; the summary is made of all steps, and is the same to the last digit."""
    short = ["solver.end_time_s=0.06"]
    runs = []
    for more in ([], ["output.interval_s=0.007"]):
        scenario = load_scenario(CONFIGS / f"{name}.yaml", [*short, *more])
        runs.append(run_module.run(build(scenario), scenario))
    assert len(runs[1].table) < len(runs[0].table)
    assert numbers(runs[1].summary) == numbers(runs[0].summary)
    assert runs[1].warnings == runs[0].warnings


ACCURACY = 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_chosen_steps_give_the_numbers_of_fixed_steps(name: str) -> None:
    """A run with `solver.accuracy` a promises positions to a times the distance D travelled.

    docs/howto/accuracy.md has up to 2.3 times that, and the fixed steps have an error of their own: 4 a D. So speeds of
    the mean are off by 4 a D over their time, instants by 4 a D over the speed, works by the share 4 a of all that is
    done. What is the time of a run's end, or counted to it, is left out where the run ends at rest.
    """
    runs = []
    for more in (in_fixed_steps(name), [f"solver.accuracy={ACCURACY}"]):
        scenario = load_scenario(CONFIGS / f"{name}.yaml", [*SHORT.get(name, ()), *more])
        runs.append(run_and_motion(scenario))
        assert runs[-1][0].status.code in FINISHED
    (fixed, motion), (chosen, _) = runs
    way, speed = 4.0 * ACCURACY * motion.path_length, float(motion.speeds.max())
    exact, got = numbers(fixed.summary), numbers(chosen.summary)
    assert got.keys() == exact.keys()
    energy = 4.0 * ACCURACY * max(abs(value) for key, value in exact.items() if key.endswith("_J"))
    for key, value in exact.items():
        if key in ("max_deflection_time_s", "hub_stopping_time_s") and fixed.summary["max_deflection_m"] is not None:
            continue  # of a vibration, which has several peaks nearly as large, and shakes the hub about the mean
        if key.endswith(", s") and fixed.status.code == "rest":
            continue
        if key == "cost_of_transport":
            allowed = value * (energy / exact["drive_work_put_in_J"] + way / abs(exact["distance_m"]))
        else:
            allowed = size_of(key, way, speed, energy, fixed["time_s"][-1])
            # Near rest the static resistance acts alone, a quarter or so of that of the strike.
            rests = fixed.summary["stopping_time_measure"] == REST_MEASURE
            allowed *= 4.0 if key == "stopping_time_s" and rests else 1.0
        assert got[key] == pytest.approx(value, abs=allowed), (key, abs(got[key] - value) / allowed)
