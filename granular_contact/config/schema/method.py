"""Schema of how a run is computed: by the engine, in minimal coordinates, or by a reduced model of the pendulum."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_serializer, model_validator

from granular_contact.values.strict import Faults, Strict, refusal

ENGINE, MINIMAL, REDUCED = "engine", "minimal", "reduced"
WORDS: dict[Any, dict[str, Any]] = {ENGINE: {}, MINIMAL: {MINIMAL: {}}, REDUCED: {REDUCED: {}}}


class Reduced(Strict):
    """The link as clamped-free modes on its rigid root."""

    modes: Annotated[int, Field(ge=0, le=20)] = 1
    """0: the link is rigid; 1: the reduction of the source paper."""
    static: Literal["auto", "true_sign", "elastoplastic", "smooth"] = "auto"
    """Static resistance: true_sign, the set-valued sign of the velocity with its reversals located, or that of
    load.friction. auto: the faster one at equal error, true_sign for a rigid link, load.friction for one that bends."""
    rtol: Annotated[float, Field(ge=1e-13, le=1e-2)] = 1e-6
    """Error of a step, relative to the size and the speed of the mechanism."""
    integrator: Literal["tsitouras", "dormand_prince", "RK23", "RK45", "DOP853", "LSODA", "Radau", "BDF"] = "tsitouras"
    """The project's own, tsitouras and dormand_prince, or one of scipy's."""


class Minimal(Strict):
    """Trees of rigid bodies on hinges and sliders or free, in one coordinate per degree of freedom."""

    rtol: Annotated[float, Field(ge=1e-12, le=1e-1)] = 1e-5
    """Error of a step, relative to the size and the speed of the mechanism."""


class Method(Strict):
    """How a run is computed: `engine`, `minimal`, `reduced`, or a mapping whose key names one and holds its options."""

    reduced: Reduced | None = None
    minimal: Minimal | None = None
    """Both null: the engine."""

    @model_validator(mode="before")
    @classmethod
    def _spelled_out(cls, value: Any) -> Any:
        """A single word may stand in place of the mapping."""
        if not isinstance(value, str):
            return value
        if value not in WORDS:
            allowed = f"{', '.join(WORDS)}, and a mapping with the key {MINIMAL} or {REDUCED}"
            raise refusal([((), f"got the text {value!r}; allowed are {allowed}")])
        return WORDS[value]

    def _faults(self) -> Faults:
        if self.reduced is not None and self.minimal is not None:
            yield (), f"got {MINIMAL} and {REDUCED}; one of them is allowed"

    @model_serializer
    def _spelled(self) -> Any:
        for word, options in ((MINIMAL, self.minimal), (REDUCED, self.reduced)):
            if options is not None:
                return {word: options.model_dump(mode="json")}
        return ENGINE
