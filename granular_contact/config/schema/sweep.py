"""Schema of a sweep file: one config, and the definition of its cases. `config.sweep_cases` makes the cases."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, WrapValidator, field_validator, model_validator

from granular_contact.values.strict import Faults, Names, Strict, allow, form, listed, refusal

MOST_CASES = 100_000
METHODS = ("latin_hypercube", "sobol", "one_at_a_time", "saltelli")
OUTPUTS = ("stopping_time_s",)
_BALANCED = ("sobol", "saltelli")  # methods that cover the ranges evenly only with a power of two of points
_NEARLY_WHOLE = 1e-9  # relative deviation from a whole number that is round-off
_READABLE = 10  # largest number of digits that a message writes in full

# A finite number. An integer stays an integer.
Number = Annotated[float, WrapValidator(lambda value, check: (check(value), value)[1])]
DottedKeys = Annotated[dict[str, Any], allow("a mapping from dotted keys to values")]
PathOrConfig = Annotated[
    Annotated[str, Tag("text")] | Annotated[dict[str, Any], Tag("mapping")],
    Discriminator(form),
    allow("the path of a config, or a config"),
]


class ParameterRange(Strict):
    """A range of numbers with both ends, on a linear or a logarithmic scale."""

    start: Annotated[Number, Field(alias="from")]
    """First end of the range, in the unit of the key."""
    stop: Annotated[Number, Field(alias="to")]
    """Second end of the range; it may be below the first."""
    scale: Literal["linear", "log"] = "linear"
    """Spacing of numbers in the range: equal differences, or equal ratios."""

    def _faults(self) -> Faults:
        if self.start == self.stop:
            yield ("to",), f"got {self.stop:g}, the same as from; the two must differ"
        if self.scale == "log" and min(self.start, self.stop) <= 0:
            message = f"got a range from {self.start:g} to {self.stop:g}; on a log scale both must be above 0"
            yield (), message

    def number(self, fraction: float) -> float:
        """The number at a fraction (0 to 1) of the range on its scale."""
        if self.scale == "log":
            return float(self.start * (self.stop / self.start) ** fraction)
        return float(self.start + (self.stop - self.start) * fraction)

    def numbers(self, count: int) -> list[float]:
        """`count` numbers, evenly spaced on the scale, with both ends.

        They are integers if the ends were written as integers and all numbers are whole, since keys of counts take
        integers alone.
        """
        numbers = [self.start, *(self.number(i / (count - 1)) for i in range(1, count - 1)), self.stop]
        ends_whole = isinstance(self.start, int) and isinstance(self.stop, int)
        whole = ends_whole and all(abs(x - round(x)) <= _NEARLY_WHOLE * max(1.0, abs(x)) for x in numbers)
        return [round(x) for x in numbers] if whole else numbers

    def plain(self) -> list[float] | dict[str, Any]:
        """The range in the shortest form that a file allows."""
        if self.scale == "linear":
            return [self.start, self.stop]
        return {"from": self.start, "to": self.stop, "scale": "log"}


class CountedRange(ParameterRange):
    """`count` numbers, evenly spaced on the scale, from one end of a range to the other."""

    count: Annotated[int, Field(ge=2, le=MOST_CASES)]
    """Number of values, both ends included."""


Levels = Annotated[
    Annotated[list[Any], Field(min_length=1), Tag("list")] | Annotated[CountedRange, Tag("mapping")],
    Discriminator(form),
    allow("a list of values, or a mapping with from, to, count and scale"),
]


class Sample(Strict):
    """Cases sampled from ranges of keys.

    latin_hypercube and sobol sample `count` cases. one_at_a_time takes the config as it is, then for each key `count`
    values from end to end, while the other keys keep the values of the config. saltelli is the design for Sobol
    sensitivity indices: `count` cases A, `count` other cases B, and for each key the cases A with this key from B.
    """

    method: Literal["latin_hypercube", "sobol", "one_at_a_time", "saltelli"]
    """Sampling method."""
    count: Annotated[int, Field(ge=2, le=MOST_CASES)]
    """Number of samples; with sobol and saltelli a power of two."""
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    """Seed of the random numbers; not for one_at_a_time."""
    ranges: Annotated[
        dict[str, Annotated[ParameterRange, allow("[from, to], or a mapping with from, to and scale")]],
        Field(min_length=1),
        allow("one dotted key or more, each with a range"),
    ]
    """Range of each dotted key: [from, to], or a mapping."""
    outputs: Annotated[Names, allow("a list of different names of numbers in summary.json, as stopping_time_s")] = ()
    """Numbers in summary.json for which sensitivity indices are computed; with saltelli alone. Default:
    stopping_time_s."""

    @model_validator(mode="before")
    @classmethod
    def _with_outputs(cls, value: Any) -> Any:
        """The sample with the default outputs of saltelli."""
        if isinstance(value, dict) and value.get("method") == "saltelli" and "outputs" not in value:
            return {**value, "outputs": list(OUTPUTS)}
        return value

    def _faults(self) -> Faults:
        below = 1 << (self.count.bit_length() - 1)
        if self.method in _BALANCED and self.count != below:
            message = f"got {self.count}; {self.method} is even for powers of two only: take {below} or {2 * below}"
            yield ("count",), message
        elif self.size > MOST_CASES:
            yield ("count",), f"got {self.size} cases; at most {MOST_CASES} are allowed"
        if self.method == "one_at_a_time" and "seed" in self.model_fields_set:
            yield ("seed",), "has no effect: one_at_a_time draws nothing"
        if self.method != "saltelli" and self.outputs:
            yield ("outputs",), f"has no effect with {self.method}; it needs method: saltelli"

    @property
    def size(self) -> int:
        """Number of cases."""
        keys = len(self.ranges)
        sizes = {"one_at_a_time": 1 + keys * self.count, "saltelli": (keys + 2) * self.count}
        return sizes.get(self.method, self.count)

    def plain(self) -> dict[str, Any]:
        """The sample as plain data, as a sweep file has it."""
        content: dict[str, Any] = {"method": self.method, "count": self.count}
        if self.method != "one_at_a_time":
            content["seed"] = self.seed
        content["ranges"] = {key: interval.plain() for key, interval in self.ranges.items()}
        return content | ({"outputs": list(self.outputs)} if self.outputs else {})


class ListedCase(Strict, extra="allow"):
    """A case in a list: its name, and values by dotted key."""

    name: str
    """Name of the case, and of its folder."""


class SweepFile(Strict):
    """A sweep: a config, and its cases, defined by one of `cases`, `vary` and `sample`."""

    config: PathOrConfig
    """Path of the config of a run, name of a shipped one, or the config itself."""
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Values that replace those of the config in all cases, by dotted key."""
    cases: Annotated[
        Annotated[dict[str, DottedKeys], Field(min_length=1, max_length=MOST_CASES), Tag("mapping")]
        | Annotated[
            list[Annotated[ListedCase, allow("a mapping with a name")]],
            Field(min_length=1, max_length=MOST_CASES),
            Tag("list"),
        ],
        Discriminator(form),
        allow(f"a mapping or a list of one case or more, to {MOST_CASES}"),
    ] = Field(default_factory=dict)
    """Cases one by one: for each name the values that replace those of the config, by dotted key; or a list of such
    mappings, each with its `name`."""
    vary: Annotated[
        dict[str, Levels],
        Field(min_length=1),
        allow("a mapping from dotted keys to their values, of one dotted key or more"),
    ] = Field(default_factory=dict)
    """Values of dotted keys, each a list or a range; `combine` says which values go together."""
    combine: Literal["grid", "zip"] = "grid"
    """Combination of the values of `vary`. grid: all combinations; zip: the first values of all keys, then the second
    values of all keys, and so on."""
    sample: Sample | None = None
    """Cases sampled from ranges; null: none."""

    @field_validator("vary", mode="before")
    @classmethod
    def _without_combine(cls, value: Any) -> Any:
        """Refuse the key `combine` in `vary`, a likely error of indentation."""
        if isinstance(value, dict) and "combine" in value:
            message = (
                "stands in vary, whose keys are those of a config; it belongs beside vary, at the same indentation"
            )
            raise refusal([(("combine",), message)])
        return value

    def _faults(self) -> Faults:
        given = [key for key in ("cases", "vary", "sample") if key in self.model_fields_set]
        if len(given) != 1:
            amount = {0: "none", 2: "both", 3: "all"}[len(given)]
            keys = " and ".join(given) if len(given) == 2 else "cases, vary and sample"
            yield (), f"got {amount} of {keys}; exactly one is allowed"
        elif "combine" in self.model_fields_set and given != ["vary"]:
            yield ("combine",), f"unknown key; it says how vary is combined, not {given[0]}"
        else:
            yield from self._count_faults()

    def _count_faults(self) -> Faults:
        """A fault of `vary` with too many cases, or with lists of different length to zip."""
        sizes = {
            key: levels.count if isinstance(levels, CountedRange) else len(levels) for key, levels in self.vary.items()
        }
        if self.combine == "zip" and len(set(sizes.values())) > 1:
            lengths = listed([f"{size} of {key}" for key, size in sizes.items()])
            yield ("vary",), f"got {lengths}; for combine: zip all must be equally many"
            return
        count = math.prod(sizes.values()) if self.combine == "grid" else max(sizes.values(), default=0)
        if count > MOST_CASES:
            digits = sum(map(math.log10, sizes.values()))
            number_words = count if digits < _READABLE else f"about 1e{digits:.0f}"
            parts = listed(list(map(str, sizes.values())), " x ") if self.combine == "grid" else "zip"
            yield ("vary",), f"got {number_words} cases ({parts}); at most {MOST_CASES} are allowed"
