"""Overrides of a config from values given in Python, checked as those of `--set` are, with the same messages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from types import NoneType
from typing import TYPE_CHECKING, Any, TypeAlias

from pydantic import BaseModel

from granular_contact.config import overrides, tree
from granular_contact.errors import Fault, of_type

if TYPE_CHECKING:
    from typing_extensions import TypedDict

    Section: TypeAlias = Mapping[str, Any]
    Named: TypeAlias = str | PathLike[str] | Mapping[str, Any] | BaseModel

    class SolverChanges(TypedDict, total=False):
        """Keys of `solver`."""

        end_time_s: float
        step_s: float | None
        rest_time_s: float | None
        rest_speed_m_s: float
        accuracy: float | None
        max_wall_s: float | None
        spectral_radius: float | None
        tolerance: float | None

    class OutputChanges(TypedDict, total=False):
        """Keys of `output`."""

        interval_s: float | None
        figures: bool
        bodies: str
        travel: str | Sequence[float]

    class LoadChanges(TypedDict, total=False):
        """Keys of `load`."""

        form: str
        end_cap: bool
        strips_per_element: int
        strips_per_rigid_part: int
        friction: Section

    class Changes(TypedDict, total=False):
        """Parts of a config, for editors; a test holds them to the schema."""

        name: str | None
        model: Named
        medium: Named | Sequence[Named] | None
        gravity_m_s2: float | None
        surface_height_m: float | None
        bed: Section | None
        wheel: Section | None
        initial: Section | None
        drives: Section | None
        signals: Section | None
        load: LoadChanges | None
        solver: SolverChanges | None
        method: str | Section | None
        output: OutputChanges | None


# A mapping with one of these keys says its kind, and replaces the whole mapping of the config.
TAGS = ("from", "law", "type")
WHOLE = (("method",),)  # paths of mappings that are always replaced as a whole


def changes(values: Mapping[str, Any], caller: str, faults: list[Fault]) -> list[overrides.Override]:
    """Convert values given in Python to overrides of a config.

    A mapping changes only the keys that it names, unless it says its kind (`type`, `law` or `from`).

    Parameters
    ----------
    values : mapping from str to object
        Values by dotted key, or in mappings as in a config.
    caller : str
        Name of the called function, which messages give in place of a file.
    faults : list of Fault
        Faults in the keys are added to it.

    Returns
    -------
    list of Override
        The overrides that take effect.
    """
    leaves = (leaf for key, value in values.items() for leaf in _leaves(key, value, caller, faults))
    return overrides.effective(list(leaves))


def merged(values: Mapping[str, Any] | None, by_key: Mapping[str, Any]) -> dict[str, Any]:
    """Values by dotted key and values by the keys of a config in one mapping; TypeError if `values` is no mapping."""
    of_type("values", values, (Mapping, NoneType), "a mapping from dotted keys to values, as {'solver.end_time_s': 1}")
    return {**(values or {}), **by_key}


def _leaves(key: str, value: Any, caller: str, faults: list[Fault]) -> Iterator[overrides.Override]:
    """Overrides for a value, and for the values in it if it is a mapping that changes single keys."""
    value = plain_data(value)
    at = tree.Position(f"{caller} {key}={value!r}"[:120], None)
    path = overrides.split(key, at, faults)
    if path is None:
        return
    if not isinstance(value, dict) or not value or path in WHOLE or any(tag in value for tag in TAGS):
        yield overrides.Override(path, tree.from_plain(value, at), at)
        return
    for below, inner in value.items():
        yield from _leaves(f"{key}.{below}", inner, caller, faults)


def plain_data(value: Any) -> Any:
    """A value of Python, numpy or pydantic in the plain types of YAML."""
    if isinstance(value, BaseModel):
        value = value.model_dump(by_alias=True)
    if isinstance(value, PathLike):
        value = str(value)
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): plain_data(inner) for key, inner in value.items()}
    return [plain_data(item) for item in value] if isinstance(value, list | tuple) else value
