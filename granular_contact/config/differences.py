"""Differences between plain data, for example between two scenarios or the sweeps of two work folders."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from granular_contact.config.tree import Path, dotted
from granular_contact.values.strict import listed

MISSING = object()


def differences(first: Any, second: Any, path: Path = (), whole: bool = False) -> Iterator[tuple[Path, Any, Any]]:
    """Paths at which two pieces of plain data differ, with both values; MISSING stands for a value that is not there.

    whole: give a list, or a mapping whose keys differ, as one difference, since `--set` replaces these as a whole.
    """
    if isinstance(first, dict) and isinstance(second, dict) and not (whole and set(first) != set(second)):
        for key in dict.fromkeys((*first, *second)):
            yield from differences(first.get(key, MISSING), second.get(key, MISSING), (*path, key), whole)
    elif isinstance(first, list) and isinstance(second, list) and len(first) == len(second) and not whole:
        for i, (item, other_item) in enumerate(zip(first, second, strict=True)):
            yield from differences(item, other_item, (*path, i))
    elif first != second:
        yield path, first, second


def same_but(first: BaseModel, second: BaseModel, *keys: str) -> bool:
    """Whether two checked parts of configs agree in all but these keys. Shared values are not compared again."""
    first_values, second_values = vars(first), vars(second)
    return type(first) is type(second) and all(
        first_values[key] is second_values[key] or first_values[key] == second_values[key]
        for key in type(first).model_fields
        if key not in keys
    )


def differing_keys(first: Any, second: Any) -> str:
    """The first dotted keys under which two scenarios, as plain data, differ."""
    return listed([dotted(path) for path, *_ in differences(first, second)])
