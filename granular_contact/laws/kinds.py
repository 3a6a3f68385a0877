"""What every medium tells about itself, whatever its law."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import Validity

# What the medium meets: a thin round bar along a line, a thin plate along a line (both faces can lead), the closed
# outline of a body (only its outside leads), or a ball.
Kind = Literal["round", "flat", "outline", "ball"]
WORDS: dict[Kind, str] = {
    "round": "round bars (cylinder, arc or polyline with a diameter)",
    "flat": "plates (plate, arc or polyline with a width)",
    "outline": "outlines (disc, foot, polygon)",
    "ball": "spheres",
}


@runtime_checkable
class Medium(Protocol):
    """A law with its coefficients.

    name: for messages and columns; equation: the published resultant or stress; terms: names of the law's terms, three
    at most; takes: kinds of shape it is for; validity: where its coefficients were measured; by_component: whether its
    static force opposes each component of the velocity by itself, and not the motion as a whole.
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def equation(self) -> str: ...  # noqa: D102

    @property
    def terms(self) -> tuple[str, ...]: ...  # noqa: D102

    @property
    def takes(self) -> Collection[str]: ...  # noqa: D102

    @property
    def by_component(self) -> bool: ...  # noqa: D102

    @property
    def validity(self) -> Validity: ...  # noqa: D102

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """Coefficients as the (1,) record that the kernels read; gravity in m/s2, its sense does not matter."""
        ...


def what_it_takes(medium: Medium) -> str:
    """Sentence on the shapes that a medium acts on."""
    return f"{medium.name} takes {', '.join(words for kind, words in WORDS.items() if kind in medium.takes)}"


def term_names(media: Collection[Medium]) -> tuple[str, ...]:
    """Names of the terms of media that act together: those of one alone, else each after its medium."""
    if len(media) == 1:
        return tuple(next(iter(media)).terms)
    names = [medium.name for medium in media]
    labels = [name if names.count(name) == 1 else f"{name}_{i + 1}" for i, name in enumerate(names)]
    return tuple(f"{label}_{term}" for label, medium in zip(labels, media, strict=True) for term in medium.terms)
