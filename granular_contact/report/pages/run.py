"""The page of a single run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from granular_contact.report import PROGRAM, SCENARIO, SERIES, SUMMARY
from granular_contact.report.pages import parts
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.markup import Markup, tag
from granular_contact.report.pages.numbers import is_number, quantity
from granular_contact.report.pages.page import page as whole
from granular_contact.results import FINISHED, REST_MEASURE

_ENDS = {
    "rest": "came to rest",
    "end_time": "ran to its end time",
    "time_limit": "ran out of time",
    "failed": "failed",
    "interrupted": "interrupted",
}
# Told elsewhere on the page, or of no use as a single number.
_ELSEWHERE = ("name", "status", "message", "warnings", "columns", "energy", "cost", "versions")
FIGURES = {
    "mechanism": "The mechanism at touch, at its deepest and at the end, to scale, and its immersed part enlarged.",
    "motion": "Motion over time: angle and rate of every hinge; of a free body, where its tip is.",
    "deflection": "Deflection of the flexible link's tip over time.",
    "forces": "Forces of the medium over time, by term and in sum: horizontal, vertical, and their moment, clockwise.",
    "energy": "Where the energy is and went over time, and by how much the balance does not close.",
}
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


def page(folder: Folder) -> str:
    """HTML of a run's page."""
    summary = folder.read(SUMMARY)
    sections = [
        parts.warnings(summary.get("warnings") or []),
        parts.section("Key numbers", parts.facts(_numbers(summary)), _measure(summary)),
        parts.section("Animation", *_film(folder)),
        parts.section("Figures", parts.figures(folder.figures(), FIGURES)),
        parts.section("Energy audit", _energy(summary.get("energy") or {})),
        parts.section("Contacts", _contacts(summary.get("contacts") or {})),
        parts.section("Scenario", _scenario(folder, "run")),
        parts.section("Time series", _columns(summary.get("columns") or {})),
        parts.section("Computation", *computation(summary)),
    ]
    status = str(summary.get("status", "unknown"))
    words = f"Run, {_ENDS.get(status, status)}"
    badge = tag("span", _ENDS.get(status, status), class_="status" if status in FINISHED else "status bad")
    name = str(summary.get("name") or folder.path.name)
    version = (summary.get("versions") or {}).get(PROGRAM, "")
    return whole(name, words, badge, " ".join(_sentences(summary)), sections, version)


def _sentences(summary: dict[str, Any]) -> Iterator[str]:
    """What happened, in words, as far as it is known."""
    yield _sentence(str(summary.get("message", "")))
    stop, angle = summary.get("stopping_time_s"), summary.get("angle_at_stop_deg")
    measure = summary.get("stopping_time_measure")
    whole = measure == REST_MEASURE
    if stop is not None:
        at = f", at {quantity('angle_deg', angle)}" if angle is not None else ""
        what = "All of the mechanism was at rest" if whole else "The pendulum stopped"
        yield f"{what} {quantity('s_s', stop)} after it touched the medium{at}."
    elif measure and not (whole and summary.get("status") == "rest"):
        yield "It did not come to rest." if whole else "No stop was found."
    speed, cost = summary.get("forward_speed_m_s"), summary.get("cost_of_transport")
    if speed is not None:
        yield f"It travelled {quantity('way_m', summary.get('distance_m'))}, at {quantity('v_m_s', speed)} in the mean."
    if cost is not None:
        yield f"Its cost of transport was {quantity('cost', cost)}."
    depth, deflection = summary.get("max_depth_m"), summary.get("max_deflection_m")
    if depth is not None and depth > 0:
        yield f"It went {quantity('depth_m', depth)} deep."
    elif depth is not None:
        yield "It did not reach the medium."
    if deflection is not None:
        yield f"The flexible link bent by {quantity('deflection_m', deflection)} at most."
    imbalance = (summary.get("energy") or {}).get("imbalance_relative")
    if imbalance is not None:
        yield f"Of the energy {quantity('imbalance_relative', imbalance)} is unaccounted for."


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}." if words else ""


def _numbers(summary: dict[str, Any]) -> dict[str, Any]:
    known = {key: value for key, value in summary.items() if key not in _ELSEWHERE and is_number(value)}
    imbalance = (summary.get("energy") or {}).get("imbalance_relative")
    return known | {"energy.imbalance_relative": imbalance}


def _measure(summary: dict[str, Any]) -> Markup | None:
    measure = summary.get("stopping_time_measure")
    return tag("p", f"Stopping time: {measure}.") if measure and summary.get("stopping_time_s") is not None else None


def _film(folder: Folder) -> list[Markup]:
    film = folder.film()
    if film is None:
        return []
    still = next((path for path in folder.figures() if path.stem == "mechanism"), None)
    words = "The mechanism moving in the medium; the arrow is the force of the medium, the line the path of the tip."
    return [parts.film(film, still, words)]


def _energy(energy: dict[str, Any]) -> Markup | None:
    known = {key: energy.get(key) for key in ENERGIES if energy.get(key) is not None}
    if not known:
        return None
    rows = [[words, quantity(key, energy[key])] for key, words in ENERGIES.items() if key in known]
    table = parts.table(
        "Mechanical energy (kinetic, gravity from the start, strain, springs), and the work that changed it.",
        ["", "value"],
        rows,
    )
    relative = energy.get("imbalance_relative")
    if relative is None:
        return table
    words = (
        "What the mechanism lost and what the forces took differ by at most "
        f"{quantity('imbalance_relative', relative)} of the largest single energy, at any time of the run."
    )
    return tag("div", table, tag("p", words))


def _contacts(contacts: dict[str, list[list[float]]]) -> Markup | None:
    rows = []
    for body, spans in contacts.items():
        told = [f"{quantity('t_s', on)} to {quantity('t_s', off)}" for on, off in spans[:MOST_CONTACTS]]
        more = [f"and {len(spans) - MOST_CONTACTS} more"] if len(spans) > MOST_CONTACTS else []
        rows.append([body, len(spans), quantity("sum_s", sum(off - on for on, off in spans)), "; ".join(told + more)])
    head = ["body", "contacts", "in all", "when"]
    return parts.table("When each body was in the medium.", head, rows) if rows else None


def _scenario(folder: Folder, command: str) -> Markup | None:
    if not folder.has(SCENARIO):
        return None
    words = f"With every default in place; granular-contact {command} {SCENARIO} gives the same numbers again."
    return parts.source(folder.path / SCENARIO, words)


def _columns(columns: dict[str, str]) -> Markup | None:
    if not columns:
        return None
    caption = f"Columns of {SERIES}, a row for each accepted step."
    return parts.table(caption, ["column", "what it is"], columns.items())


def computation(summary: dict[str, Any]) -> Iterator[Markup | None]:
    """What a result took, and what its numbers depend on."""
    yield parts.listing("Cost of the solve.", summary.get("cost") or {})
    yield parts.listing("Versions that made it.", {f"{k}": v for k, v in (summary.get("versions") or {}).items()})
