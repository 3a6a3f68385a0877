"""Base of all schema classes: strictness, kinds of values, unions by tag, faults of several keys."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from difflib import get_close_matches
from functools import lru_cache
from typing import Annotated, Any, get_args

import yaml
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, GetCoreSchemaHandler, model_validator
from pydantic import Strict as StrictnessOf
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from granular_contact.values.scalars import resolve

FAULTS = "faults"
ALLOWED = "x-allowed"  # key of the JSON Schema
MOST_LISTED = 6
_MOST_NAMES = 12
_FORMS: dict[str, Any] = {"text": str, "number": int | float, "list": list | tuple, "mapping": Mapping}
_RESOLVER: Any = yaml.resolver.Resolver()
Path = tuple[str | int, ...]
LocalFault = tuple[Path, str]
Faults = Iterator[LocalFault]


class Strict(BaseModel):
    """Frozen, without unknown keys, finite numbers only, and no value ever converted but whole numbers to floats.

    The text under a field is its description in the JSON Schema for editors, see `config.export`.
    """

    model_config = ConfigDict(
        strict=True,
        frozen=True,
        extra="forbid",
        allow_inf_nan=False,
    )

    @model_validator(mode="after")
    def _agrees(self) -> Strict:
        """Refuse values that do not go together."""
        if faults := list(self._faults()):
            raise refusal(faults)
        return self

    def _faults(self) -> Faults:
        """What is wrong with values that are each allowed: paths below this one, and sentences."""
        yield from ()


def refusal(faults: Sequence[LocalFault]) -> PydanticCustomError:
    """The error a validator raises for `faults`, each a path below the validated value and a sentence."""
    text = "; ".join(f"{'.'.join(map(str, path))}: {message}" if path else message for path, message in faults)
    return PydanticCustomError(FAULTS, "{text}", {"text": text, FAULTS: list(faults)})


def allow(words: str) -> Any:
    """Mark a field or a type with the words for what is allowed, where those from the schema are unclear."""
    return Field(json_schema_extra={ALLOWED: words})


def listed(words: Sequence[str], between: str = ", ") -> str:
    """Words in a list; only the first few of many, and how many more there are."""
    if len(words) <= MOST_LISTED:
        return between.join(words)
    return f"{between.join(words[:MOST_LISTED])}{between}... and {len(words) - MOST_LISTED} more"


def did_you_mean(word: str, known: Collection[str]) -> str:
    """Which of `known` the unknown `word` may have meant, as a question; empty if it is like none."""
    near = get_close_matches(word, known, 1) or [one for one in known if one.startswith(f"{word}_")]  # without its unit
    return f"did you mean {near[0]}?" if near else ""


def no_such(what: str, name: str, known: Collection[str]) -> str:
    """That there is no body, joint or signal of a name, and which ones there are."""
    there = ", ".join([*known][:_MOST_NAMES]) + ", ..." * (len(known) > _MOST_NAMES) or "none"
    return f"there is no {what} {name!r}; {did_you_mean(name, known) or f'there are {there}'}"


def form(value: Any) -> str | None:
    """YAML form of a value, the tag of a union of forms: pydantic puts it between two keys of a location.

    An empty mapping has none, so that one fault says what it may be, and not one for each key that it lacks.
    """
    if isinstance(value, bool) or value == {}:
        return None
    return next((name for name, kind in _FORMS.items() if isinstance(value, kind)), None)


@lru_cache(maxsize=1024)
def _is_lost(text: str) -> bool:
    """Whether PyYAML writes a text without quotes that this package reads as something else."""
    written_plain = _RESOLVER.resolve(yaml.ScalarNode, text, (True, False)) == "tag:yaml.org,2002:str"
    return written_plain and not isinstance(resolve(text), str)


def _survives_a_file(text: str) -> str:
    """Refuse a text such as `1e3`, which PyYAML writes without quotes and this package would read as a number."""
    if _is_lost(text):
        raise refusal([((), f"got the text {text!r}, which reads as a number without its quotes; add a letter")])
    return text


Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Text = Annotated[str, AfterValidator(_survives_a_file)]
# A YAML list is a list; frozen values are tuples.
Point = Annotated[tuple[float, float], StrictnessOf(False)]
Listed = StrictnessOf(False)


def directed(allowed: str) -> AfterValidator:
    """Validator of a vector that has to point somewhere; allowed: what is, in words."""

    def points_somewhere(axis: tuple[float, ...]) -> tuple[float, ...]:
        if not 0.0 < math.hypot(*axis) < math.inf:
            raise refusal([((), f"got {list(axis)}; allowed is {allowed}")])
        return axis

    return AfterValidator(points_somewhere)


def _once(names: tuple[str, ...]) -> tuple[str, ...]:
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    if twice:
        raise refusal([((), f"names {name} twice; once is allowed") for name in twice])
    return names


Names = Annotated[tuple[Text, ...], Listed, Field(min_length=1), AfterValidator(_once)]


class OrNull:
    """Marks a field that may be null in a file; its class puts another value in its place, so it is never None."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema of the value or null."""
        return core_schema.nullable_schema(handler(source))


class OrName:
    """Marks a field for which a file may name another file that has it, and that is put in its place."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: Any) -> dict[str, Any]:
        """Schema of the value, or a name."""
        found = handler(core)
        default = {key: found.pop(key) for key in ("default", "title") if key in found}
        return {"anyOf": [found, {"type": "string"}], ALLOWED: "a list, or the name of what has it", **default}


class Tagged:
    """Marks a union whose member is named by the value of one key.

    pydantic's own `discriminator` refuses a union of one member, which is what a map of laws starts as.
    """

    def __init__(self, key: str, choices: Mapping[str, type[BaseModel]]) -> None:
        self.key, self.choices = key, choices

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema of the union, whatever `source` says for the type checker."""
        del source
        choices = {tag: handler.generate_schema(choice) for tag, choice in self.choices.items()}
        return core_schema.tagged_union_schema(choices, discriminator=self.key)


def by_type(*classes: type[Strict]) -> dict[str, type[Strict]]:
    """Classes by the one value that their field `type` may have."""
    return {get_args(one.model_fields["type"].annotation)[0]: one for one in classes}


ONE, MANY = "one", "list"


class OneOrMore:
    """Marks a field that holds one value of a kind, or a list of them."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema of the two forms; the source is a tuple of the kind."""
        (one, *_) = get_args(source)
        single = handler.generate_schema(one)
        return core_schema.tagged_union_schema(
            {
                ONE: single,
                MANY: core_schema.tuple_variable_schema(single, min_length=1, strict=False),
            },
            discriminator=lambda value: MANY if form(value) == MANY else ONE,
        )
