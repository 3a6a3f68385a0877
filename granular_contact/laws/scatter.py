"""Scatter of a medium's static resistance: how much, over which length; its equations are in `kernels.scatter`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.values.strict import Positive

MOST = 0.5  # of kernels.scatter, which is not loaded for a config
SEEDS = 2**53


class Scatter(Coefficients):
    """The static resistance times (1 + s xi), xi a random function of the way of each strip, the same for neighbours.

    relative: the standard deviation s on a piece no longer than `length`; a whole body, on which pieces differ,
    scatters less. 0: none at all, bit by bit.
    """

    relative: Annotated[float, Field(ge=0, le=MOST)]
    length: Positive = Field(alias="length_m")
    """Over which xi changes, along the way and along the body: a few grains."""
    seed: Annotated[int, Field(ge=0, lt=SEEDS)] = 1

    def fill(self, record: object, terms: tuple[str, ...], dynamic: frozenset[str]) -> None:
        """Write it into the record (1,) of a run; terms of the medium, and those of them that do not scatter."""
        values = {"scatter": self.relative, "grain": self.length, "seed": self.seed}
        values["static"] = sum(1 << i for i, term in enumerate(terms) if term not in dynamic)
        for name, value in values.items():
            record[name] = value  # type: ignore[index]
