"""Schema of a search for the best numbers of a config: what may change, what is best, and how it is looked for."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from granular_contact.config.schema.sweep import DottedKeys, ParameterRange, PathOrConfig
from granular_contact.values.strict import Faults, Names, Strict, allow, form

MOST_RUNS = 100_000
METHODS = ("cma", "differential_evolution")
LEAST_TO_DIFFER = 5  # runs of a population between which differential evolution takes differences, by scipy

Weights = Annotated[
    Annotated[str, Tag("text")] | Annotated[dict[str, float], Field(min_length=1), Tag("mapping")],
    Discriminator(form),
    allow("the name of a number in summary.json, or a mapping from such names to weights"),
]


class Parameter(ParameterRange):
    """What may change: from one number to another, evenly or on a log scale."""

    keys: Annotated[Names, allow("a list of different dotted keys")] = ()
    """Dotted keys that all get the number; unless given, the name of the parameter is the key."""


class Limit(Strict):
    """What a number of the summary must not leave; runs that do so rank behind all that do not."""

    at_least: float | None = None
    at_most: float | None = None

    def _faults(self) -> Faults:
        if self.at_least is None and self.at_most is None:
            yield (), "got neither at_least nor at_most; one of them is needed"
        if self.at_least is not None and self.at_most is not None and self.at_least > self.at_most:
            words = f"got {self.at_most:g}, which is below at_least, {self.at_least:g}"
            yield ("at_most",), words

    def excess(self, value: float) -> float:
        """How far a value is outside, relative to the limit; 0 inside."""
        below = 0.0 if self.at_least is None else (self.at_least - value) / (abs(self.at_least) or 1.0)
        above = 0.0 if self.at_most is None else (value - self.at_most) / (abs(self.at_most) or 1.0)
        return max(0.0, below, above)


class Objective(Strict):
    """One of maximise and minimise: a number of the summary, or the sum of several times their weights."""

    maximise: Weights | None = None
    minimise: Weights | None = None

    def _faults(self) -> Faults:
        if (self.maximise is None) == (self.minimise is None):
            amount = "neither" if self.maximise is None else "both"
            yield (), f"got {amount} of maximise and minimise; exactly one is allowed"

    @property
    def sense(self) -> str:
        """Which of both."""
        return "maximise" if self.maximise is not None else "minimise"

    @property
    def weights(self) -> dict[str, float]:
        """Weights by the names of numbers."""
        given = self.maximise if self.maximise is not None else self.minimise
        assert given is not None
        return {given: 1.0} if isinstance(given, str) else given

    @property
    def words(self) -> str:
        """The objective as people write it."""
        parts = [name if weight == 1.0 else f"{weight:g} {name}" for name, weight in self.weights.items()]
        return " + ".join(parts).replace("+ -", "- ")


class OptimiseFile(Strict):
    """A search: a config, what may change in it, and what is best."""

    config: PathOrConfig
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Dotted keys and their values in all runs."""
    parameters: Annotated[
        dict[str, Annotated[Parameter, allow("[from, to], or a mapping with from, to, scale and keys")]],
        Field(min_length=1),
        allow("one dotted key or more, each with a range"),
    ]
    objective: Objective
    constraints: dict[str, Limit] = Field(default_factory=dict)
    """Limits by the names of numbers in summary.json."""
    method: Literal["cma", "differential_evolution"] = "cma"
    evaluations: Annotated[int, Field(ge=4, le=MOST_RUNS)] = 300
    """Runs in all; the first one is of the config as it is."""
    population: Annotated[int, Field(ge=4, le=10_000)] | None = None
    """Runs between two decisions of the method; null: 12, or three times the parameters where that is more."""
    seed: Annotated[int, Field(ge=0, le=2**32 - 2)] = 0

    def _faults(self) -> Faults:
        if self.evaluations < self.size + 1:
            words = f"got {self.evaluations}; the config as it is and one population need {self.size + 1}"
            yield ("evaluations",), words
        if len(self.parameters) < 2 and self.method == "cma":
            yield ("method",), "cma needs two parameters or more; take differential_evolution"
        if self.size < LEAST_TO_DIFFER and self.method == "differential_evolution":
            yield ("population",), f"got {self.size}; differential_evolution needs {LEAST_TO_DIFFER} or more"

    @property
    def size(self) -> int:
        """The population."""
        return self.population or max(12, 3 * len(self.parameters))

    def keys(self, name: str) -> tuple[str, ...]:
        """Dotted keys that a parameter sets."""
        return tuple(self.parameters[name].keys) or (name,)

    def plain(self) -> dict[str, Any]:
        """What a file says of it, but for the config and what is set in it."""
        plain_data = self.model_dump(mode="json", by_alias=True, exclude={"config", "set_"}, exclude_none=True)
        for one in plain_data["parameters"].values():
            if not one["keys"]:
                del one["keys"]
        return plain_data
