"""Content of the page of a single run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from granular_contact.report import PROGRAM, SCENARIO, SUMMARY
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.live import live
from granular_contact.report.units import is_number, label, quantity
from granular_contact.results import FINISHED, REST_MEASURE

# Entries of the summary that are shown elsewhere on the page, or make no sense as a single number.
_ELSEWHERE = ("name", "status", "message", "warnings", "columns", "energy", "cost", "versions", "drives", "strides")
AT_START = 1e-9  # s: an earlier touch is at the start
MOST_CONTACTS = 8  # greatest number of contacts of a body that are listed


def content(folder: Folder) -> dict[str, Any]:
    """Values for the template."""
    summary = folder.read(SUMMARY)
    energy, measure = summary.get("energy") or {}, summary.get("stopping_time_measure")
    status, imbalance = str(summary.get("status", "unknown")), energy.get("imbalance_relative")
    pictures = folder.figures()
    numbers = {key: value for key, value in summary.items() if key not in _ELSEWHERE and is_number(value)}
    if numbers.get("touch_time_s", 1.0) < AT_START:  # the mechanism starts in the medium, or on it
        del numbers["touch_time_s"]
    wheel = {key: value for key, value in (summary.get("wheel") or {}).items() if is_number(value)}
    return {
        "title": summary.get("name") or folder.path.name,
        "version": (summary.get("versions") or {}).get(PROGRAM, ""),
        "summary": summary,
        "status": status,
        "finished": status in FINISHED and summary.get("usable", True),
        "measure": measure,
        "of_all": measure == REST_MEASURE,
        "imbalance": imbalance,
        "numbers": {f"wheel.{key}": value for key, value in wheel.items()}
        | numbers
        | {"energy.imbalance_relative": imbalance},
        "pictures": pictures,
        "energy": energy,
        "drives": list(_drives(summary.get("drives") or {})),
        "strides": list(_strides(summary.get("strides") or {})),
        "stride_count": (summary.get("strides") or {}).get("count"),
        "stride_period": (summary.get("strides") or {}).get("period_s"),
        "contacts": list(_contacts(summary.get("contacts") or {})),
        "scenario": folder.text(SCENARIO),
        **live(folder, summary),
    }


DRIVE = (
    *("largest_torque_Nm", "largest_force_N", "rms_torque_Nm", "rms_force_N", "largest_rate_rad_s"),
    *("largest_rate_m_s", "largest_power_W", "mean_power_W", "work_J"),
)


def _drives(drives: dict[str, dict[str, float]]) -> Iterator[list[Any]]:
    """Yield the headings, then a row for each drive."""
    keys = [key for key in DRIVE if any(key in numbers for numbers in drives.values())]
    if keys:
        yield ["drive", *(label(key) for key in keys)]
    for name, numbers in drives.items():
        yield [name, *(quantity(key, numbers.get(key)) for key in keys)]


def _strides(strides: dict[str, Any]) -> Iterator[list[Any]]:
    for key, statistic in strides.items():
        if isinstance(statistic, dict) and "mean" in statistic:
            deviation = quantity(key, statistic.get("standard_deviation"))
            yield [label(key), quantity(key, statistic["mean"]), deviation]


def _contacts(contacts: dict[str, list[list[float]]]) -> Iterator[list[Any]]:
    for body, spans in contacts.items():
        spans = [[on if on > AT_START else 0.0, off] for on, off in spans]
        intervals = [f"{quantity('t_s', on)} to {quantity('t_s', off)}" for on, off in spans[:MOST_CONTACTS]]
        more = [f"and {len(spans) - MOST_CONTACTS} more"] if len(spans) > MOST_CONTACTS else []
        yield [body, len(spans), quantity("sum_s", sum(off - on for on, off in spans)), "; ".join(intervals + more)]
