"""Sweeps for the tests: the command line, tables without times, and functions that replace the engine."""

from __future__ import annotations

import csv
import dataclasses
import io
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

from support_results import make
from support_runs import CONFIGS, ROOT

from granular_contact.config import Scenario
from granular_contact.results import Results

SPEED, ANGLE = "initial.impact_speed_rad_s", "initial.impact_angle_deg"
TIME = "cost.solve_s"  # the only number that differs between equal runs
ENVIRONMENT = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests'}"}


def arguments(*parameters: object) -> list[str]:
    return [sys.executable, "-m", "granular_contact", *map(str, parameters)]


def read(folder: Path) -> list[dict[str, str]]:
    with (folder / "table.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def timeless_bytes(folder: Path) -> bytes:
    """Bytes of the table without the column of times."""

    def written(rows: list[list[str]]) -> bytes:
        csv.writer(text := io.StringIO(), lineterminator="\n").writerows(rows)
        return text.getvalue().encode()

    raw = (folder / "table.csv").read_bytes()
    rows = list(csv.reader(io.StringIO(raw.decode(), newline="")))
    assert written(rows) == raw
    place = rows[0].index(TIME)
    return written([[cell for i, cell in enumerate(row) if i != place] for row in rows])


def write(folder: Path, cases: str, name: str = "many.yaml") -> Path:
    """Write a sweep of the rigid pendulum, which runs fast."""
    path = folder / name
    path.write_text(f"config: {CONFIGS / 'pendulum_rigid.yaml'}\n{cases}")
    return path


def until(condition: Callable[[], bool], seconds: float) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


# Functions that workers call instead of the engine; the impact speed of a case decides what happens.


def of_speed(scenario: Scenario) -> Results:
    speed = scenario.initial.impact_speed_rad_s
    # Without NaN, which is not equal to itself.
    return dataclasses.replace(make(), summary={"status": "rest", "energy": {"initial_J": speed**2}, "speed": speed})


def dying(scenario: Scenario) -> Results:
    if scenario.initial.impact_speed_rad_s in (3, 17):
        os._exit(1)
    return of_speed(scenario)


def dying_at_three(scenario: Scenario) -> Results:
    if scenario.initial.impact_speed_rad_s == 3:
        os._exit(1)
    return of_speed(scenario)
