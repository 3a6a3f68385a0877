"""What the page of a single run shows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from granular_contact.report import PROGRAM, SCENARIO, SUMMARY
from granular_contact.report.pages.folder import Folder
from granular_contact.report.units import is_number, quantity
from granular_contact.results import FINISHED, REST_MEASURE

# Told elsewhere on the page, or of no use as a single number.
_ELSEWHERE = ("name", "status", "message", "warnings", "columns", "energy", "cost", "versions")
ENERGIES = {
    "initial_J": "energy at the start",
    "final_J": "energy at the end",
    "granular_work_J": "work of the medium",
    "damping_work_J": "work of the links' internal damping",
    "joint_damping_work_J": "work of dampers in joints",
    "friction_work_J": "work of dry friction in joints",
    "drive_work_J": "work of drives",
    "floor_work_J": "work of the floor",
}
MOST_CONTACTS = 8  # of a body, that are told one by one


def content(folder: Folder) -> dict[str, Any]:
    """Content for its template."""
    summary = folder.read(SUMMARY)
    energy, measure = summary.get("energy") or {}, summary.get("stopping_time_measure")
    status, imbalance = str(summary.get("status", "unknown")), energy.get("imbalance_relative")
    pictures = folder.figures()
    known = {key: value for key, value in summary.items() if key not in _ELSEWHERE and is_number(value)}
    return {
        "title": summary.get("name") or folder.path.name,
        "version": (summary.get("versions") or {}).get(PROGRAM, ""),
        "summary": summary,
        "status": status,
        "finished": status in FINISHED,
        "measure": measure,
        "of_all": measure == REST_MEASURE,
        "imbalance": imbalance,
        "numbers": known | {"energy.imbalance_relative": imbalance},
        "pictures": pictures,
        "film": folder.film(),
        "still": next((path for path in pictures if path.stem == "mechanism"), None),
        "energies": [[words, quantity(k, energy[k])] for k, words in ENERGIES.items() if energy.get(k) is not None],
        "contacts": list(_contacts(summary.get("contacts") or {})),
        "scenario": folder.text(SCENARIO),
    }


def _contacts(contacts: dict[str, list[list[float]]]) -> Iterator[list[Any]]:
    for body, spans in contacts.items():
        told = [f"{quantity('t_s', on)} to {quantity('t_s', off)}" for on, off in spans[:MOST_CONTACTS]]
        more = [f"and {len(spans) - MOST_CONTACTS} more"] if len(spans) > MOST_CONTACTS else []
        yield [body, len(spans), quantity("sum_s", sum(off - on for on, off in spans)), "; ".join(told + more)]
