"""Sentences of many runs, those that differ only in their numbers as one kind."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", re.IGNORECASE)


@dataclass
class _Kind:
    first: str
    count: int = 0
    differs: bool = False


@dataclass
class Kinds:
    """The kinds of the sentences that were added: the first of each, how many are alike, whether numbers differ."""

    found: dict[str, _Kind] = field(default_factory=dict)

    def add(self, sentence: str) -> None:
        """Count a sentence."""
        kind = self.found.setdefault(_NUMBER.sub("#", sentence), _Kind(sentence))
        kind.count += 1
        kind.differs |= sentence != kind.first

    def lines(self, count: int, runs: str, most: int, place: str) -> list[str]:
        """The first of each kind and in how many of the `count` runs, the most frequent first.

        runs: what the runs are called, as "cases"; most: kinds; place: of all others.
        """
        ordered = sorted(self.found.values(), key=lambda one: -one.count)
        found = [
            f"{one.first} ({one.count} of {count} {runs}{f', in other {runs} with other numbers' * one.differs})"
            for one in ordered[:most]
        ]
        more = len(ordered) - most
        return [*found, f"... and {more} more kind{'s' * (more > 1)}, in {place}"] if more > 0 else found
