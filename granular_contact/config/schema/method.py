"""Schema of the method of solution: Exudyn, minimal coordinates, or a reduced model in modal coordinates."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_serializer, model_validator

from granular_contact.values.strict import Faults, Strict, refusal

AUTO = "auto"


class Engine(Strict):
    """The multibody engine Exudyn, for every mechanism."""


class Minimal(Strict):
    """Minimal coordinates: one coordinate per degree of freedom.

    For trees of rigid bodies on hinges, sliders and ball joints, or free; in space also with links that bend.
    """


class Reduced(Strict):
    """Reduced model of flexible links: a few modes of a clamped-free beam on a rigid root.

    In the plane for a pendulum: a rigid body on a hinge on the ground, with at most one flexible link. In space for all
    flexible links.
    """

    modes: Annotated[int, Field(ge=0, le=20)] = 1
    """Number of modes. 0: the link is rigid; 1: the reduction of the source paper. In space the number of bending modes
    in each of the two planes, and of torsion modes."""
    static: Literal["auto", "true_sign", "elastoplastic", "smooth"] = "auto"
    """Static resistance. true_sign: set-valued sign of the velocity, whose reversals are located in time; elastoplastic
    or smooth: as load.friction, which must have this type. auto: the faster of both at equal error, which is true_sign
    for a rigid link and load.friction for a flexible one. In space auto alone."""
    rtol: Annotated[float, Field(ge=1e-13, le=1e-2)] = 1e-6
    """Error tolerance of a step, relative to the size and the speed of the mechanism. In space `solver` decides the
    steps."""


AnyMethod = Minimal | Reduced  # options of all methods but the engine, which has none


class Method(Strict):
    """Method of solution: `auto`, `engine`, `minimal` or `reduced`.

    A mapping from one of the last three to its options is allowed too. auto: minimal coordinates if the mechanism
    allows them, else the engine.
    """

    engine: Engine | None = None
    """The multibody engine Exudyn."""
    minimal: Minimal | None = None
    """Minimal coordinates."""
    reduced: Reduced | None = None
    """Reduced model in modal coordinates."""

    @model_validator(mode="before")
    @classmethod
    def _spelled_out(cls, value: Any) -> Any:
        """The mapping for a single word, which may stand in its place."""
        if not isinstance(value, str):
            return value
        if value not in WORDS:
            allowed = f"{', '.join(WORDS)}, and a mapping whose key is one of the last three"
            raise refusal([((), f"got the text {value!r}; allowed are {allowed}")])
        return {} if value == AUTO else {value: {}}

    @property
    def name(self) -> str:
        """Name of the method, one of WORDS."""
        return next((name for name in OPTIONS if getattr(self, name) is not None), AUTO)

    @property
    def chosen(self) -> AnyMethod | None:
        """Options of the method; None for the engine and for auto."""
        return None if self.name in (AUTO, "engine") else getattr(self, self.name)

    def _faults(self) -> Faults:
        given = [name for name in OPTIONS if getattr(self, name) is not None]
        if len(given) > 1:
            yield (), f"got {' and '.join(given)}; one of them is allowed"

    @model_serializer
    def _spelled(self) -> Any:
        """The shortest form: a word, or a mapping if there are options."""
        options = getattr(self, self.name, None)
        written = {} if options is None else options.model_dump(mode="json")
        return {self.name: written} if written else self.name


OPTIONS = tuple(Method.model_fields)
WORDS = AUTO, *OPTIONS
