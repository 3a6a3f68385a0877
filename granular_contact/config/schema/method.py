"""Schema of how a run is computed: by the engine, or by a reduced model of the pendulum."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_serializer, model_validator

from granular_contact.config.schema.base import Strict, refusal

ENGINE, REDUCED = "engine", "reduced"
WORDS: dict[Any, dict[str, Any]] = {ENGINE: {}, REDUCED: {REDUCED: {}}}


class Reduced(Strict):
    """The link as clamped-free modes on its rigid root."""

    modes: Annotated[int, Field(ge=0, le=20)] = 1
    """0: the link is rigid; 1: the reduction of the source paper."""
    static: Literal["auto", "true_sign", "elastoplastic", "smooth"] = "auto"
    """Static resistance: the sign of the velocity with its reversals located, or what load.friction has. auto: the
    sign for a rigid link, load.friction for one that bends, which is the faster of the two at equal error."""
    rtol: Annotated[float, Field(ge=1e-13, le=1e-2)] = 1e-6
    """Error of a step, relative to the size and the speed of the mechanism."""
    integrator: Literal["dormand_prince", "RK23", "RK45", "DOP853", "LSODA", "Radau", "BDF"] = "dormand_prince"
    """The project's own, or one of scipy's."""


class Method(Strict):
    """How a run is computed: `engine`, `reduced`, or a mapping whose key reduced holds options."""

    reduced: Reduced | None = None
    """null: the engine."""

    @model_validator(mode="before")
    @classmethod
    def _spelled_out(cls, value: Any) -> Any:
        """A single word may stand in place of the mapping."""
        if not isinstance(value, str):
            return value
        if value not in WORDS:
            allowed = f"{', '.join(WORDS)}, and a mapping with the key {REDUCED}"
            raise refusal([((), f"got the text {value!r}; allowed are {allowed}")])
        return WORDS[value]

    @model_serializer
    def _spelled(self) -> Any:
        return ENGINE if self.reduced is None else {REDUCED: self.reduced.model_dump(mode="json")}
