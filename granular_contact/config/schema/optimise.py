"""Schema of an optimisation of a config: its parameters, its objective and the method of the search."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from granular_contact.config.schema.sweep import DottedKeys, ParameterRange, PathOrConfig
from granular_contact.values.strict import Faults, Names, Strict, allow, form

MOST_RUNS = 100_000
METHODS = ("cma", "differential_evolution")
LEAST_TO_DIFFER = 5  # smallest population of scipy's differential evolution, which takes differences between members

Weights = Annotated[
    Annotated[str, Tag("text")] | Annotated[dict[str, float], Field(min_length=1), Tag("mapping")],
    Discriminator(form),
    allow("the name of a number in summary.json, or a mapping from such names to weights"),
]


class Parameter(ParameterRange):
    """Range in which a parameter may vary, on a linear or a logarithmic scale."""

    keys: Annotated[Names, allow("a list of different dotted keys")] = ()
    """Dotted keys of the config that all get the value of the parameter. Default: the name of the parameter is the
    key."""


class Limit(Strict):
    """Constraint on a number of the summary. A run that breaks a constraint ranks behind all runs that keep them."""

    at_least: float | None = None
    """Smallest allowed value; null: none."""
    at_most: float | None = None
    """Largest allowed value; null: none."""

    def _faults(self) -> Faults:
        if self.at_least is None and self.at_most is None:
            yield (), "got neither at_least nor at_most; one of them is needed"
        if self.at_least is not None and self.at_most is not None and self.at_least > self.at_most:
            message = f"got {self.at_most:g}, which is below at_least, {self.at_least:g}"
            yield ("at_most",), message

    def excess(self, value: float) -> float:
        """Distance of a value from the allowed range, relative to the limit (absolute for a limit of 0); 0 inside."""
        below = 0.0 if self.at_least is None else (self.at_least - value) / (abs(self.at_least) or 1.0)
        above = 0.0 if self.at_most is None else (value - self.at_most) / (abs(self.at_most) or 1.0)
        return max(0.0, below, above)


class Objective(Strict):
    """The number to maximise or to minimise: a number of the summary, or a weighted sum of several."""

    maximise: Weights | None = None
    """Name of a number in summary.json, or a mapping from such names to weights. Give this or minimise."""
    minimise: Weights | None = None
    """Name of a number in summary.json, or a mapping from such names to weights. Give this or maximise."""

    def _faults(self) -> Faults:
        if (self.maximise is None) == (self.minimise is None):
            amount = "neither" if self.maximise is None else "both"
            yield (), f"got {amount} of maximise and minimise; exactly one is allowed"

    @property
    def sense(self) -> str:
        """Sense of the objective: maximise or minimise."""
        return "maximise" if self.maximise is not None else "minimise"

    @property
    def weights(self) -> dict[str, float]:
        """Weights by the names of the numbers in summary.json."""
        given = self.maximise if self.maximise is not None else self.minimise
        assert given is not None
        return {given: 1.0} if isinstance(given, str) else given

    @property
    def formula(self) -> str:
        """The objective as a formula, for messages and reports."""
        parts = [name if weight == 1.0 else f"{weight:g} {name}" for name, weight in self.weights.items()]
        return " + ".join(parts).replace("+ -", "- ")


class OptimiseFile(Strict):
    """An optimisation: a config, the parameters that may vary in it, and an objective."""

    config: PathOrConfig
    """Path of the config of a run, name of a shipped one, or the config itself."""
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Values that replace those of the config in all runs, by dotted key."""
    parameters: Annotated[
        dict[str, Annotated[Parameter, allow("[from, to], or a mapping with from, to, scale and keys")]],
        Field(min_length=1),
        allow("one dotted key or more, each with a range"),
    ]
    """Range of each parameter by its name, which is a dotted key of the config unless the parameter has `keys`."""
    objective: Objective
    """The number to maximise or to minimise."""
    constraints: dict[str, Limit] = Field(default_factory=dict)
    """Limits of numbers in summary.json, by the name of the number."""
    method: Literal["cma", "differential_evolution"] = "cma"
    """Method of the search: CMA-ES (covariance matrix adaptation), or differential evolution."""
    evaluations: Annotated[int, Field(ge=4, le=MOST_RUNS)] = 300
    """Number of runs in all. The first run is that of the config as it is."""
    population: Annotated[int, Field(ge=4, le=10_000)] | None = None
    """Number of runs in a generation of the method. null: the larger of 12 and three times the number of parameters."""
    seed: Annotated[int, Field(ge=0, le=2**32 - 2)] = 0
    """Seed of the random numbers of the method."""

    def _faults(self) -> Faults:
        if self.evaluations < self.size + 1:
            message = f"got {self.evaluations}; the config as it is and one population need {self.size + 1}"
            yield ("evaluations",), message
        if len(self.parameters) < 2 and self.method == "cma":
            yield ("method",), "cma needs two parameters or more; take differential_evolution"
        if self.size < LEAST_TO_DIFFER and self.method == "differential_evolution":
            yield ("population",), f"got {self.size}; differential_evolution needs {LEAST_TO_DIFFER} or more"

    @property
    def size(self) -> int:
        """Size of the population, with its default in place."""
        return self.population or max(12, 3 * len(self.parameters))

    def keys(self, name: str) -> tuple[str, ...]:
        """Dotted keys that a parameter sets."""
        return tuple(self.parameters[name].keys) or (name,)

    def plain(self) -> dict[str, Any]:
        """The content of the file as plain data, without `config` and `set`."""
        plain_data = self.model_dump(mode="json", by_alias=True, exclude={"config", "set_"}, exclude_none=True)
        for parameter in plain_data["parameters"].values():
            if not parameter["keys"]:
                del parameter["keys"]
        return plain_data
