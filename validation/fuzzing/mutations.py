"""Random damage to YAML: to its tree (keys, types, magnitudes, sizes) and to its text (characters, lines)."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from random import Random
from typing import Any

import yaml

PIECES = (
    *"{}[]:,&*!|>'\"%@#-?~\n\t ",
    *("<<", "null", "true", "1e400", ".nan", ".inf", "-1", "from: ", "{}", "[[", "*a", "&a ", "\0", "é", "\ufeff"),
)
WORDS = ("", "none", "ground", "é\u202e\U0001f980", "a" * 300, "1e3", "yes", "a\nb", "../..", "play_sand", "\u0007")
NUMBERS = (0, -1, 1e308, -1e308, 1e-308, 5e-324, float("nan"), float("inf"), float("-inf"), 10**30, 2**63, 0.1 + 0.2)


def damaged(rng: Random, text: str, times: int | None = None) -> str:
    """Return `text` after one to four mutations of its tree, as long as it can be parsed, or of its characters."""
    for _ in range(times or rng.choice((1, 1, 1, 2, 3, 4))):
        text = _by_text(rng, text) if rng.random() < 0.3 else _by_tree(rng, text)
    return text


def rescaled(rng: Random, tree: Any, times: int) -> Any:
    """Return `tree` with some of its numbers changed in magnitude, by up to 12 decades."""
    tree = copy.deepcopy(tree)
    places = [(holder, key) for holder, key in _places(tree) if type(holder[key]) is float]
    for holder, key in rng.sample(places, min(times, len(places))):
        holder[key] = float(holder[key] * 10.0 ** rng.uniform(-12, 12))
    return tree


def _by_text(rng: Random, text: str) -> str:
    """Replace some adjacent characters, or one line, by something else."""
    piece = rng.choice(PIECES)
    if rng.random() < 0.5:
        lines = text.splitlines(keepends=True) or [""]
        at = rng.randrange(len(lines))
        return "".join([*lines[:at], piece, *lines[at + 1 :]])
    at = rng.randint(0, len(text))
    return text[:at] + piece + text[at + rng.randint(0, 12) :]


def _by_tree(rng: Random, text: str) -> str:
    try:
        tree = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError):
        return _by_text(rng, text)
    places = list(_places(tree))
    if not places:
        return _by_text(rng, text)
    holder, key = rng.choice(places)
    _MUTATIONS[rng.randrange(len(_MUTATIONS))](rng, holder, key)
    try:
        return str(yaml.safe_dump(tree, allow_unicode=rng.random() < 0.5, sort_keys=False, width=120))
    except RecursionError:  # the tree is deeper than PyYAML can write
        return _by_text(rng, text)


def _places(node: Any) -> Iterator[tuple[Any, Any]]:
    """Generate the holder and the key or index of every value in a tree; a shared holder is visited once."""
    visited, waiting = set(), [node]
    while waiting:
        holder = waiting.pop()
        if not isinstance(holder, dict | list) or id(holder) in visited:
            continue
        visited.add(id(holder))
        for key in list(holder) if isinstance(holder, dict) else range(len(holder)):
            yield holder, key
            waiting.append(holder[key])


def _drop(_: Random, holder: Any, key: Any) -> None:
    del holder[key]


def _rename(rng: Random, holder: Any, key: Any) -> None:
    if isinstance(holder, dict):
        new = rng.choice((f"{key}x", f"{key}"[:-1], f"{key}".upper(), rng.choice(WORDS), 7, None, True))
        holder[new] = holder.pop(key)


def _duplicate(rng: Random, holder: Any, key: Any) -> None:
    if isinstance(holder, dict):
        holder[f"{key}_2"] = holder[key]
    else:
        holder.insert(rng.randint(0, len(holder)), holder[key])


def _number(rng: Random, holder: Any, key: Any) -> None:
    held = holder[key]
    factor = 10.0 ** rng.uniform(-12, 12)
    scaled = held * factor if isinstance(held, int | float) and abs(held) < 1e290 else factor
    holder[key] = rng.choice((rng.choice(NUMBERS), scaled, scaled, -scaled, int(min(1e15, max(-1e15, scaled)))))


def _kind(rng: Random, holder: Any, key: Any) -> None:
    held = holder[key]
    replacements: tuple[Any, ...] = (
        None,
        True,
        [],
        {},
        [held],
        {"type": held},
        str(held),
        rng.choice(WORDS),
        [0.0, 0.0],
    )
    holder[key] = rng.choice(replacements)


def _swap(rng: Random, holder: Any, key: Any) -> None:
    second = rng.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
    holder[key], holder[second] = holder[second], holder[key]


def _long(rng: Random, holder: Any, key: Any) -> None:
    holder[key] = [holder[key]] * rng.choice((2, 100, 2000))


def _deep(rng: Random, holder: Any, key: Any) -> None:
    for _ in range(rng.choice((3, 40, 100))):
        holder[key] = {key if isinstance(key, str) else "a": holder[key]} if rng.random() < 0.5 else [holder[key]]


_MUTATIONS = (_drop, _drop, _rename, _duplicate, _number, _number, _number, _kind, _kind, _swap, _long, _deep)
