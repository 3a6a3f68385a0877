"""Schema of a sweep file: one config, and how its cases are defined; `config.sweep_cases` draws samples."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, WrapValidator, field_validator, model_validator

from granular_contact.values.strict import Faults, Names, Strict, allow, form, listed, refusal

MOST_CASES = 100_000
METHODS = ("latin_hypercube", "sobol", "one_at_a_time", "saltelli")
OUTPUTS = ("stopping_time_s",)
_BALANCED = ("sobol", "saltelli")  # sequences that are even in powers of two only
_NEARLY_WHOLE = 1e-9
_READABLE = 10  # digits of a number that is written in full

# A finite number that stays a whole one if it was written so.
Number = Annotated[float, WrapValidator(lambda value, check: (check(value), value)[1])]
DottedKeys = Annotated[dict[str, Any], allow("a mapping from dotted keys to values")]
PathOrConfig = Annotated[
    Annotated[str, Tag("text")] | Annotated[dict[str, Any], Tag("mapping")],
    Discriminator(form),
    allow("the path of a config, or a config"),
]


class ParameterRange(Strict):
    """From one end to the other, both included; evenly spaced on the scale."""

    start: Annotated[Number, Field(alias="from")]
    stop: Annotated[Number, Field(alias="to")]
    scale: Literal["linear", "log"] = "linear"

    def _faults(self) -> Faults:
        if self.start == self.stop:
            yield ("to",), f"got {self.stop:g}, the same as from; the two must differ"
        if self.scale == "log" and min(self.start, self.stop) <= 0:
            words = f"got a range from {self.start:g} to {self.stop:g}; on a log scale both must be above 0"
            yield (), words

    def number(self, fraction: float) -> float:
        """The number at a fraction (0 to 1) of the range, on its scale."""
        if self.scale == "log":
            return float(self.start * (self.stop / self.start) ** fraction)
        return float(self.start + (self.stop - self.start) * fraction)

    def numbers(self, count: int) -> list[float]:
        """`count` evenly spaced numbers; integers if the ends and all of them are whole, as counts must be."""
        found = [self.start, *(self.number(i / (count - 1)) for i in range(1, count - 1)), self.stop]
        ends_whole = isinstance(self.start, int) and isinstance(self.stop, int)
        whole = ends_whole and all(abs(one - round(one)) <= _NEARLY_WHOLE * max(1.0, abs(one)) for one in found)
        return [round(one) for one in found] if whole else found

    def plain(self) -> list[float] | dict[str, Any]:
        """The range in its shortest form."""
        if self.scale == "linear":
            return [self.start, self.stop]
        return {"from": self.start, "to": self.stop, "scale": "log"}


class CountedRange(ParameterRange):
    """`count` numbers, evenly spaced from one end to the other."""

    count: Annotated[int, Field(ge=2, le=MOST_CASES)]


Levels = Annotated[
    Annotated[list[Any], Field(min_length=1), Tag("list")] | Annotated[CountedRange, Tag("mapping")],
    Discriminator(form),
    allow("a list of values, or a mapping with from, to, count and scale"),
]


class Sample(Strict):
    """Cases drawn from ranges.

    latin_hypercube and sobol draw `count` cases. one_at_a_time takes the config as it is, then `count` values of each
    key from end to end while the others keep theirs. saltelli is the design for Sobol's sensitivity indices: `count`
    cases A, as many others B, and for each key the cases A with that key from B.
    """

    method: Literal["latin_hypercube", "sobol", "one_at_a_time", "saltelli"]
    count: Annotated[int, Field(ge=2, le=MOST_CASES)]
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    ranges: Annotated[
        dict[str, Annotated[ParameterRange, allow("[from, to], or a mapping with from, to and scale")]],
        Field(min_length=1),
        allow("one dotted key or more, each with a range"),
    ]
    outputs: Annotated[Names, allow("a list of different names of numbers in summary.json, as stopping_time_s")] = ()
    """Numbers of the summary whose variance saltelli explains; stopping_time_s unless given."""

    @model_validator(mode="before")
    @classmethod
    def _explain_something(cls, value: Any) -> Any:
        if isinstance(value, dict) and value.get("method") == "saltelli" and "outputs" not in value:
            return {**value, "outputs": list(OUTPUTS)}
        return value

    def _faults(self) -> Faults:
        below = 1 << (self.count.bit_length() - 1)
        if self.method in _BALANCED and self.count != below:
            words = f"got {self.count}; {self.method} is even for powers of two only: take {below} or {2 * below}"
            yield ("count",), words
        elif self.size > MOST_CASES:
            yield ("count",), f"got {self.size} cases; at most {MOST_CASES} are allowed"
        if self.method == "one_at_a_time" and "seed" in self.model_fields_set:
            yield ("seed",), "has no effect: one_at_a_time draws nothing"
        if self.method != "saltelli" and self.outputs:
            yield ("outputs",), f"has no effect with {self.method}; it needs method: saltelli"

    @property
    def size(self) -> int:
        """How many cases there are."""
        keys = len(self.ranges)
        sizes = {"one_at_a_time": 1 + keys * self.count, "saltelli": (keys + 2) * self.count}
        return sizes.get(self.method, self.count)

    def plain(self) -> dict[str, Any]:
        """What a sweep file says of it."""
        said: dict[str, Any] = {"method": self.method, "count": self.count}
        if self.method != "one_at_a_time":
            said["seed"] = self.seed
        said["ranges"] = {key: held.plain() for key, held in self.ranges.items()}
        return said | ({"outputs": list(self.outputs)} if self.outputs else {})


class ListedCase(Strict, extra="allow"):
    """A case in a list: its name, and dotted keys with their values."""

    name: str


class SweepFile(Strict):
    """A sweep: a config, and one of cases, vary and sample, which say what is replaced in it."""

    config: PathOrConfig
    set_: DottedKeys = Field(default_factory=dict, alias="set")
    """Dotted keys and their values in all cases."""
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
    """Dotted keys and their values by the name of the case; or a list of such mappings, each with a name."""
    vary: Annotated[
        dict[str, Levels],
        Field(min_length=1),
        allow("a mapping from dotted keys to their values, of one dotted key or more"),
    ] = Field(default_factory=dict)
    """Values of dotted keys: a list, or a range."""
    combine: Literal["grid", "zip"] = "grid"
    """All combinations of the values of `vary`, or the first of each, the second of each, and so on."""
    sample: Sample | None = None

    @field_validator("vary", mode="before")
    @classmethod
    def _combine_stands_beside(cls, value: Any) -> Any:
        if isinstance(value, dict) and "combine" in value:
            words = "stands in vary, whose keys are those of a config; it belongs beside vary, at the same indentation"
            raise refusal([(("combine",), words)])
        return value

    def _faults(self) -> Faults:
        given = [key for key in ("cases", "vary", "sample") if key in self.model_fields_set]
        if len(given) != 1:
            amount = {0: "none", 2: "both", 3: "all"}[len(given)]
            of = " and ".join(given) if len(given) == 2 else "cases, vary and sample"
            yield (), f"got {amount} of {of}; exactly one is allowed"
        elif "combine" in self.model_fields_set and given != ["vary"]:
            yield ("combine",), f"unknown key; it says how vary is combined, not {given[0]}"
        else:
            yield from self._count_faults()

    def _count_faults(self) -> Faults:
        sizes = {key: one.count if isinstance(one, CountedRange) else len(one) for key, one in self.vary.items()}
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
