"""Differences of plain data: of scenarios, of the sweeps of two work folders."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from granular_contact.config.tree import Path, dotted
from granular_contact.values.strict import listed

MISSING = object()


def differences(one: Any, other: Any, path: Path = (), whole: bool = False) -> Iterator[tuple[Path, Any, Any]]:
    """Paths at which two pieces of plain data differ, with both values; MISSING where there is none.

    whole: give a mapping with other keys, or a list, as one difference, as `--set` replaces it.
    """
    if isinstance(one, dict) and isinstance(other, dict) and not (whole and set(one) != set(other)):
        for key in dict.fromkeys((*one, *other)):
            yield from differences(one.get(key, MISSING), other.get(key, MISSING), (*path, key), whole)
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other) and not whole:
        for i, (held, another) in enumerate(zip(one, other, strict=True)):
            yield from differences(held, another, (*path, i))
    elif one != other:
        yield path, one, other


def same_but(one: BaseModel, other: BaseModel, *keys: str) -> bool:
    """Whether two checked parts of configs have all in common but these keys; parts that they share cost nothing."""
    mine, theirs = vars(one), vars(other)
    fields = type(one).model_fields
    return type(one) is type(other) and all(
        mine[key] is theirs[key] or mine[key] == theirs[key] for key in fields if key not in keys
    )


def differing_keys(one: Any, other: Any) -> str:
    """The first dotted keys under which two scenarios, as plain data, differ."""
    return listed([dotted(path) for path, *_ in differences(one, other)])
