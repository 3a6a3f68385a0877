"""How a run ended that did not fail, in the same words for every method of solution."""

from __future__ import annotations

from granular_contact.results import Status, StatusCode
from granular_contact.scene.types import Solver


def ended(code: StatusCode, reached: float, solver: Solver) -> Status:
    """Status of a run that came to a time (s): at rest, at its end, over its wall time or interrupted."""
    kept = "the results up to there were kept"
    if code == "rest":
        words = f"at rest: slower than {solver.rest_speed_m_s:g} m/s in every coordinate for {solver.rest_time_s:g} s"
    elif code == "time_limit":
        limit = f"solver.max_wall_s ({solver.max_wall_s:g}) is over"
        words = f"stopped at {reached:.6g} s of {solver.end_time_s:g} s: {limit}; {kept}"
    elif code == "interrupted":
        words = f"interrupted at {reached:.6g} s; {kept}"
    else:
        words = f"end time {solver.end_time_s:g} s reached"
    return Status(code, words)


def paused(reached: float, solver: Solver) -> Status:
    """Status of a run that is stepped and stands at a time (s) before its end."""
    return Status("interrupted", f"stopped at {reached:.6g} s of {solver.end_time_s:g} s, from where it can go on")
