"""How a run ends and what its status says: every reason, by every method, in one call, with a controller, in steps."""

from __future__ import annotations

import itertools
import json
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from support_runs import CONFIGS, scenario_of

from granular_contact import Results, Simulation, simulate
from granular_contact.cli import main
from granular_contact.config import Scenario

METHODS = {
    "engine": ("method=engine",),
    "engine, chosen steps": ("method=engine", "solver.accuracy=1e-3"),
    "minimal": ("method=minimal",),
    "reduced": ("method={reduced: {modes: 0}}",),
}
WAYS = ("in one call", "with a controller", "in steps")
SWINGS = ("medium=null", "solver.rest_time_s=null", "solver.step_s=1e-3")
# Without gravity and at rest from the start.
HANGS = ("medium=null", "gravity_m_s2=0", "initial.impact_speed_rad_s=0", "solver={end_time_s: 1, rest_time_s: 0.05}")
RATE = 100.0  # Hz: pieces so short that the wall time is over between two of them
CASES = {
    "rest": (*HANGS,),
    "end_time": (*SWINGS, "solver.end_time_s=0.05"),
    "time_limit": (*SWINGS, "solver.end_time_s=1e4", "solver.max_wall_s=2e-4"),
    "interrupted": (*SWINGS, "solver.end_time_s=1e4"),
    "failed": (*SWINGS, "solver.end_time_s=1e4", "drives.pivot={type: torque, torque_Nm: 1e10}"),
}
SAID = {
    "rest": "at rest: slower than",
    "end_time": "end time 0.05 s reached",
    "time_limit": "s of 10000 s: the limit of wall time, solver.max_wall_s (0.0002), was reached",
    "interrupted": "interrupted at",
    "failed": "; take a smaller solver.",
}


def _steps(simulation: Simulation, reason: str) -> Iterator[None]:
    while simulation.ended is None:
        yield
        if reason == "interrupted" and simulation.time > 0.05:
            simulation.interrupt()
        else:
            simulation.step(None, 1.0 / RATE)


def _run(scenario: Scenario, way: str, reason: str) -> Results:
    def interrupt(*_: Any) -> None:
        if reason == "interrupted":
            signal.raise_signal(signal.SIGINT)

    def control(t: float, _: Any) -> None:
        if t > 0.05:
            interrupt()

    if way == "in one call":
        return simulate(scenario, progress=interrupt)
    if way == "with a controller":
        return simulate(scenario, control=control, control_rate_Hz=RATE)
    simulation = Simulation(scenario)
    try:
        for _ in _steps(simulation, reason):
            assert simulation.results().status.code == "interrupted"  # it goes on, and says so
        return simulation.results()
    finally:
        simulation.close()


@pytest.fixture
def interruptible() -> Iterator[None]:
    """SIGINT interrupts, also where the tests are in the background of a shell, which lets them ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("reason", CASES)
def test_a_run_says_how_it_ended(reason: str, method: str, way: str) -> None:
    if (reason, method) == ("failed", "reduced"):
        pytest.skip("takes no drives")
    results = _run(scenario_of("pendulum_rigid", *CASES[reason], *METHODS[method]), way, reason)
    assert results.status.code == results.summary["status"] == reason
    assert SAID[reason] in results.status.message
    reached, end = results["time_s"][-1], results.scenario["solver"]["end_time_s"]
    assert reached < end if reason != "end_time" else reached == pytest.approx(end, rel=1e-12)


def test_wall_time_adds_up_over_the_steps_of_a_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that goes on by a millisecond whenever it is looked at, so that no machine is too slow for it."""
    clock = itertools.count(0.0, 1e-3)
    monkeypatch.setattr(time, "perf_counter", lambda: next(clock))
    more = ("method=engine", "solver.end_time_s=1e4", "solver.max_wall_s=0.2")
    simulation, pauses = Simulation(scenario_of("pendulum_rigid", *SWINGS, *more)), 0
    try:
        while simulation.ended is None and pauses < 1000:
            simulation.step(None, 1.0 / RATE)
            pauses += 1
        assert pauses > 3
        assert simulation.results().status.code == "time_limit"
    finally:
        simulation.close()


def test_a_run_at_its_end_was_not_cut_however_long_its_last_step_took() -> None:
    one_step = ("method=engine", *SWINGS, "solver={end_time_s: 1e-3, step_s: 1e-3, max_wall_s: 1e-9}")
    results = simulate(scenario_of("pendulum_rigid", *one_step))
    assert (results.status.code, results.status.message) == ("end_time", "end time 0.001 s reached")


@pytest.mark.parametrize("method", ["engine", "minimal"])
def test_a_run_cut_where_the_sign_is_too_steep_says_what_to_take(method: str) -> None:
    steep = "load.friction={type: smooth, reference_speed_m_s: 1e-6}"
    more = (f"method={method}", "solver.max_wall_s=1e-9", "solver.end_time_s=1", steep)
    results = simulate(scenario_of("pendulum_rigid", *more))
    assert results.status.code == "time_limit"
    message = "take a larger load.friction.reference_speed_m_s (now 1e-06), or type: elastoplastic"
    assert results.status.message.endswith(message)


def test_a_result_that_is_not_usable_has_an_exit_code_of_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = ["run", str(CONFIGS / "pendulum.yaml"), "--no-plots", "--quiet", "--out", str(tmp_path / "out")]
    short = ["--set", "solver.end_time_s=0.04", "--set", "solver.rest_time_s=null"]
    assert main([*run, *short, "--set", "solver.step_s=1e-2"]) == 5
    assert "not usable" in capsys.readouterr().err
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["usable"] is False
    assert main([*run, *short]) == 0
