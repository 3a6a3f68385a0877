"""Schema of how a run is computed: by the engine, in minimal coordinates, or by a reduced model of the pendulum."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_serializer, model_validator

from granular_contact.values.strict import Faults, Strict, refusal

AUTO = "auto"


class Engine(Strict):
    """Exudyn, for every mechanism."""


class Minimal(Strict):
    """Trees of rigid bodies on hinges, sliders and ball joints or free, in one coordinate per degree of freedom."""


class Reduced(Strict):
    """A link as clamped-free modes on its rigid root; in space all links that bend."""

    modes: Annotated[int, Field(ge=0, le=20)] = 1
    """0: the link is rigid; 1: the reduction of the source paper. In space so many in each plane,
    and of torsion."""
    static: Literal["auto", "true_sign", "elastoplastic", "smooth"] = "auto"
    """Static resistance: true_sign, the set-valued sign of the velocity with its reversals located, or that of
    load.friction. auto: the faster one at equal error, true_sign for a rigid link, load.friction for one that bends.
    In space auto alone."""
    rtol: Annotated[float, Field(ge=1e-13, le=1e-2)] = 1e-6
    """Error of a step, relative to the size and the speed of the mechanism. In space steps follow `solver`."""


AnyMethod = Minimal | Reduced  # options of all but the engine, which has none


class Method(Strict):
    """How a run is computed: `auto`, `engine`, `minimal`, `reduced`, or a mapping whose key names one of the last three
    and holds its options. auto: minimal coordinates where they serve, else the engine.
    """

    engine: Engine | None = None
    minimal: Minimal | None = None
    reduced: Reduced | None = None

    @model_validator(mode="before")
    @classmethod
    def _spelled_out(cls, value: Any) -> Any:
        """A single word may stand in place of the mapping."""
        if not isinstance(value, str):
            return value
        if value not in WORDS:
            allowed = f"{', '.join(WORDS)}, and a mapping whose key is one of the last three"
            raise refusal([((), f"got the text {value!r}; allowed are {allowed}")])
        return {} if value == AUTO else {value: {}}

    @property
    def name(self) -> str:
        """Its word."""
        return next((name for name in OPTIONS if getattr(self, name) is not None), AUTO)

    @property
    def chosen(self) -> AnyMethod | None:
        """Its options; None for the engine and for auto."""
        return None if self.name in (AUTO, "engine") else getattr(self, self.name)

    def _faults(self) -> Faults:
        given = [name for name in OPTIONS if getattr(self, name) is not None]
        if len(given) > 1:
            yield (), f"got {' and '.join(given)}; one of them is allowed"

    @model_serializer
    def _spelled(self) -> Any:
        options = getattr(self, self.name, None)
        written = {} if options is None else options.model_dump(mode="json")
        return {self.name: written} if written else self.name


OPTIONS = tuple(Method.model_fields)
WORDS = AUTO, *OPTIONS
