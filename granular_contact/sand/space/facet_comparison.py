"""Error of a load by its facets, from a comparison with other facets: Richardson's extrapolation.

The error grows with the square of the size of facets, so with the inverse of their number. With N facets and N* other
facets it is |N* / (N* - N)| times the difference of the two.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

from granular_contact.sand.space.load import SpatialLoad

# Edges of other facets divided by the edges of the original ones. Smaller facets are for bodies on which larger ones
# are hardly fewer, such as a mesh with given triangles.
SHARES = 2.0**0.5, 2.0**-0.5, 0.5, 2.0**-1.5, 0.25, 2.0**-2.5, 0.125
FEWER = 0.7  # ratio of two numbers of facets below which they count as different


class FacetComparison(NamedTuple):
    """Load with facets of another size, for comparison.

    Parameters
    ----------
    load : SpatialLoad
        The load with other facets.
    share : float
        Edge of its facets divided by the edge of the original ones.
    counts : dict of str to int
        Number of original facets, of each body that has another number of facets in `load`.
    other_counts : dict of str to int
        Number of other facets of the same bodies.
    """

    load: SpatialLoad
    share: float
    counts: dict[str, int]
    other_counts: dict[str, int]

    def error_factor(self, body: str) -> float:
        """Error of the force on a body divided by the difference of both loads; 0 if its facets are the same.

        Parameters
        ----------
        body : str
            Name of the body.
        """
        return richardson_factor(self.counts[body], self.other_counts[body]) if body in self.counts else 0.0


def richardson_factor(count: int, other_count: int) -> float:
    """Error divided by the difference to the result with other facets.

    Parameters
    ----------
    count : int
        Number of facets.
    other_count : int
        Number of other facets.
    """
    return abs(other_count / (other_count - count))


def facet_counts(load: SpatialLoad, bodies: Collection[str] | None = None) -> dict[str, int]:
    """Number of facets of each body.

    Parameters
    ----------
    load : SpatialLoad
        The load.
    bodies : collection of str, optional
        Names of bodies; by default all that have facets.
    """
    counts: dict[str, int] = {}
    for elements in load.lines:
        if elements.element_kind == "surface" and (bodies is None or elements.body.name in bodies):
            counts[elements.body.name] = counts.get(elements.body.name, 0) + len(elements.rows)
    return counts


def changed_bodies(counts: dict[str, int], other_counts: dict[str, int]) -> list[str]:
    """Bodies whose number of facets differs.

    Parameters
    ----------
    counts, other_counts : dict of str to int
        Numbers of facets in two loads.
    """
    return [name for name, n in counts.items() if min(n, m := other_counts.get(name, n)) < FEWER * max(n, m)]


def comparison_with_others(
    load: SpatialLoad,
    load_with: Callable[[float], SpatialLoad],
    bodies: Collection[str] | None = None,
    shares: Sequence[float] = SHARES,
) -> FacetComparison | None:
    """Load with other facets on all bodies, or on as many as possible.

    Parameters
    ----------
    load : SpatialLoad
        The load.
    load_with : callable
        Makes a load whose facets have a given share of the size.
    bodies : collection of str, optional
        Names of bodies; by default all that have facets.
    shares : sequence of float
        Shares that are tried in turn.

    Returns
    -------
    FacetComparison or None
        None if no share changes the number of facets of any body.
    """
    counts, best, most = facet_counts(load, bodies), None, 0
    for share in shares if counts else ():
        candidate = load_with(share)
        candidate_counts = facet_counts(candidate, bodies)
        names = changed_bodies(counts, candidate_counts)
        if len(names) > most:
            most = len(names)
            original, other = ({name: each[name] for name in names} for each in (counts, candidate_counts))
            best = FacetComparison(candidate, share, original, other)
        if len(names) == len(counts):
            break
    return best
