"""Group the warnings of many runs: sentences that differ only in their numbers are of one kind."""

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
    """Kinds of the sentences added so far: the first sentence of each kind, its count, and whether numbers differ."""

    by_pattern: dict[str, _Kind] = field(default_factory=dict)

    def add(self, sentence: str) -> None:
        """Count a sentence under its kind."""
        kind = self.by_pattern.setdefault(_NUMBER.sub("#", sentence), _Kind(sentence))
        kind.count += 1
        kind.differs |= sentence != kind.first

    def lines(self, count: int, runs: str, most: int, place: str) -> list[str]:
        """List the first sentence of each kind and in how many of the `count` runs it occurs, most frequent first.

        runs: name of the runs in the text, for example "cases"; most: greatest number of kinds to list; place: where
        the user finds the kinds that are not listed.
        """
        ordered = sorted(self.by_pattern.values(), key=lambda kind: -kind.count)
        lines = [
            f"{kind.first} ({kind.count} of {count} {runs}{f', in other {runs} with other numbers' * kind.differs})"
            for kind in ordered[:most]
        ]
        more = len(ordered) - most
        return [*lines, f"... and {more} more kind{'s' * (more > 1)}, in {place}"] if more > 0 else lines
