"""Other facets on the bodies of a load, by which the error of its own is found: Richardson's extrapolation.

An error goes with the square of facets, and so with one over their number: of N facets and N* others it is
|N* / (N* - N)| of what the two differ by.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

from granular_contact.sand.space.load import SpatialLoad

# Edges of the other facets over those of the load's own: larger ones, and smaller ones of a body that has hardly fewer
# larger ones, as a mesh with triangles of its own.
SHARES = 2.0**0.5, 2.0**-0.5, 0.5, 2.0**-1.5, 0.25, 2.0**-2.5, 0.125
FEWER = 0.7  # of the number of facets, by which it is another one


class Others(NamedTuple):
    """A load with facets of a share of the size; own, there: numbers of facets of bodies that have another one."""

    load: SpatialLoad
    share: float
    own: dict[str, int]
    there: dict[str, int]

    def part_of(self, body: str) -> float:
        """What part of a difference of the forces on a body the error is."""
        return part(self.own[body], self.there[body]) if body in self.own else 0.0


def part(own: int, there: int) -> float:
    """The error with so many facets, over the difference to that with others."""
    return abs(there / (there - own))


def numbers(load: SpatialLoad, bodies: Collection[str] | None = None) -> dict[str, int]:
    """Numbers of facets of bodies, by default of all that have any."""
    found: dict[str, int] = {}
    for one in load.lines:
        if one.meets == "surface" and (bodies is None or one.body.name in bodies):
            found[one.body.name] = found.get(one.body.name, 0) + len(one.rows)
    return found


def differing(own: dict[str, int], there: dict[str, int]) -> list[str]:
    """Bodies that have another number of facets."""
    return [name for name, n in own.items() if min(n, m := there.get(name, n)) < FEWER * max(n, m)]


def others(
    load: SpatialLoad,
    load_with: Callable[[float], SpatialLoad],
    bodies: Collection[str] | None = None,
    shares: Sequence[float] = SHARES,
) -> Others | None:
    """Other facets on every one of some bodies, or on as many as there are others of; None where there are none.

    load_with: makes a load with a share of the size of facets.
    """
    own, found, most = numbers(load, bodies), None, 0
    for share in shares if own else ():
        made = load_with(share)
        there = numbers(made, bodies)
        names = differing(own, there)
        if len(names) > most:
            most, found = len(names), Others(made, share, {n: own[n] for n in names}, {n: there[n] for n in names})
        if len(names) == len(own):
            break
    return found
