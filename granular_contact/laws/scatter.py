"""Scatter of a medium's static resistance: how much, over which length; its equations are in `sand.kernels.scatter`.

What is measured is how much the force on a body scatters, not the resistance of a piece as long as a grain. Pieces that
differ from grain to grain make a body's force scatter by s sqrt(L / B), B its length in the plane, and by s L / B in
space, B the root of its area: so a medium that holds measured forces with the sizes of their bodies gives s. L is a few
grains; where s would be more than USUAL a longer L, with USUAL for s, makes the force scatter as measured [ours].
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.values.strict import Faults, Positive, Text

MOST = 0.5  # of kernels.scatter, which is not loaded for a config
SEEDS = 2**53
FEW_GRAINS, USUAL = 3e-3, 0.4  # m, -


class MeasuredScatter(Coefficients):
    """How much a measured force scattered.

    Parameters
    ----------
    name : str
        By which `scatter: {measured: ...}` takes it.
    force : float
        Its standard deviation over its mean, between 0 and 1.
    size : float
        Of the body (m): along its surface in the sand; in space the root of the area there.
    standing : str
        What it was measured on, and what it rests on.
    """

    name: Text
    force: Annotated[float, Field(gt=0, lt=1)]
    size: Positive = Field(alias="size_m")
    standing: Text


class Scatter(Coefficients):
    """The static resistance times (1 + s xi), xi a random function of the path of each strip, the same for neighbours.

    Parameters
    ----------
    relative : float, optional
        Standard deviation s on a piece no longer than `length`, 0 to 0.5; a whole body, on which pieces differ,
        scatters less. 0: none at all, bit by bit; null: as `measured` says.
    length : float, optional
        Path and distance along the body (m) over which xi changes: a few grains; null: as `measured` says.
    seed : int
        Of xi, 0 or more.
    measured : str, optional
        Both numbers from a force that was measured in this medium, by its name there; null: from the two above.
    """

    relative: Annotated[float, Field(ge=0, le=MOST)] | None = None
    length: Positive | None = Field(None, alias="length_m")
    seed: Annotated[int, Field(ge=0, lt=SEEDS)] = 1
    measured: Text | None = None

    def _faults(self) -> Faults:
        given = {"relative": self.relative, "length_m": self.length}
        if self.measured is None:
            words = "missing, allowed is a number, or `measured` with the name of what was measured in this medium"
            yield from (((key,), words) for key, value in given.items() if value is None)
        else:
            words = "stands beside `measured`, which gives it; allowed is null"
            yield from (((key,), words) for key, value in given.items() if value is not None)

    def numbers(self, known: Sequence[MeasuredScatter], in_space: bool) -> tuple[float, float]:
        """s, and L (m); known: what was measured in the medium."""
        if self.relative is not None and self.length is not None:
            return self.relative, self.length
        one = next(one for one in known if one.name == self.measured)
        power = 1.0 if in_space else 0.5
        s = one.force * (one.size / FEW_GRAINS) ** power
        return (s, FEW_GRAINS) if s <= USUAL else (USUAL, one.size * (one.force / USUAL) ** (1.0 / power))
