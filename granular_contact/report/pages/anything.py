"""Whatever JSON can hold, as markup: for entries of which no page knows more than their names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from granular_contact.report.pages import parts
from granular_contact.report.pages.markup import Markup, join, tag
from granular_contact.report.pages.numbers import label, plain


def shown(name: str, value: Any) -> Iterator[Markup | None]:
    """A text as a paragraph, records alike as a table, other mappings as lists with what is deeper below them."""
    if isinstance(value, dict):
        yield from _mapping(name, value)
    elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
        head = list(dict.fromkeys(key for one in value for key in one))
        yield parts.keyed_table(_caption(name), head, [[flat(one.get(key)) for key in head] for one in value])
    elif isinstance(value, list) and value:
        yield tag("ul", *(tag("li", str(flat(one))) for one in value))
    elif value is not None and value != []:
        yield tag("p", str(flat(value)))


def _mapping(name: str, value: dict[str, Any]) -> Iterator[Markup | None]:
    if value and all(isinstance(one, dict) for one in value.values()):
        head = list(dict.fromkeys(key for one in value.values() for key in one))
        rows = [[key, *(flat(one.get(column)) for column in head)] for key, one in value.items()]
        yield parts.keyed_table(_caption(name), [name, *head], rows)
        return
    simple = {k: flat(v) for k, v in value.items() if not _is_deep(v)}
    yield parts.listing(_caption(name), simple)
    for key, deeper in value.items():
        if key not in simple:
            yield join(tag("h3", label(key)), *shown(label(key), deeper))


def _caption(name: str) -> str:
    """A sentence of a name, which is all that is known."""
    return f"{name[:1].upper()}{name[1:]}, as recorded."


def _is_deep(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and any(isinstance(one, dict | list) for one in value))


def flat(value: Any) -> Any:
    """A value that fits into a cell."""
    if isinstance(value, list):
        return ", ".join(plain(flat(one)) for one in value)
    if isinstance(value, dict):
        return ", ".join(f"{key}: {plain(flat(one))}" for key, one in value.items())
    return value
