"""Scatter of the static resistance of a medium: standard deviation and length.

Its equations are in `sand.kernels.scatter`.

Experiments measure the scatter of the force on a body, not that of the resistance of a piece as long as a few grains.
If the resistance of pieces of the length L scatters by s, the force on a body scatters by s sqrt(L / B) in the plane, B
being the length of the body. In space it scatters by s L / B, B being the root of the area of the body. So measured
forces of a medium give s, if the sizes of the bodies are known. L is a few grains. Where that would need an s above
USUAL, s is USUAL and L is longer, so that the force scatters as measured [ours].
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.values.strict import Faults, Positive, Text

MOST = 0.5  # equal to MOST of kernels.scatter, which is not loaded when a config is read
SEEDS = 2**53
FEW_GRAINS, USUAL = 3e-3, 0.4  # length L (m) and greatest s (-) with that length


class MeasuredScatter(Coefficients):
    """Measured scatter of a force.

    Parameters
    ----------
    name : str
        Name by which `scatter: {measured: ...}` selects it.
    force : float
        Standard deviation of the force divided by its mean, between 0 and 1.
    size : float
        Size of the body (m): length of its surface in the sand; in space the root of the area in the sand.
    standing : str
        What was measured, and the evidence.
    """

    name: Text
    force: Annotated[float, Field(gt=0, lt=1)]
    size: Positive = Field(alias="size_m")
    standing: Text


class Scatter(Coefficients):
    """Scatter: static resistance times (1 + s xi).

    xi is a random function of the path of each strip, shared by neighbours.

    Parameters
    ----------
    relative : float, optional
        Standard deviation s of pieces no longer than `length`, 0 to 0.5. A whole body has several pieces and scatters
        less. 0: no scatter, bit by bit; null: from `measured`.
    length : float, optional
        Path and distance along the body (m) over which xi changes: a few grains; null: from `measured`.
    seed : int
        Seed of xi, 0 or more.
    measured : str, optional
        Name of a measured scatter of this medium, from which both numbers follow; null: from the two above.
    """

    relative: Annotated[float, Field(ge=0, le=MOST)] | None = None
    length: Positive | None = Field(None, alias="length_m")
    seed: Annotated[int, Field(ge=0, lt=SEEDS)] = 1
    measured: Text | None = None

    def _faults(self) -> Faults:
        given = {"relative": self.relative, "length_m": self.length}
        if self.measured is None:
            sentence = "missing, allowed is a number, or `measured` with the name of what was measured in this medium"
            yield from (((key,), sentence) for key, value in given.items() if value is None)
        else:
            sentence = "stands beside `measured`, which gives it; allowed is null"
            yield from (((key,), sentence) for key, value in given.items() if value is not None)

    def numbers(self, measurements: Sequence[MeasuredScatter], in_space: bool) -> tuple[float, float]:
        """Standard deviation and length of the scatter.

        Parameters
        ----------
        measurements : sequence of MeasuredScatter
            Measured scatter of forces in the medium.
        in_space : bool
            Whether bodies are in space.

        Returns
        -------
        tuple of float
            s (-) and L (m).
        """
        if self.relative is not None and self.length is not None:
            return self.relative, self.length
        chosen = next(measurement for measurement in measurements if measurement.name == self.measured)
        power = 1.0 if in_space else 0.5
        s = chosen.force * (chosen.size / FEW_GRAINS) ** power
        return (s, FEW_GRAINS) if s <= USUAL else (USUAL, chosen.size * (chosen.force / USUAL) ** (1.0 / power))
