"""Base class of all schema classes: strict types, kinds of values, unions by tag, faults of several keys."""

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
ALLOWED, MEANT = "x-allowed", "x-meant"  # keys of the JSON Schema
MOST_LISTED = 6
_MOST_NAMES = 12
_FORMS: dict[str, Any] = {"text": str, "number": int | float, "list": list | tuple, "mapping": Mapping}
_RESOLVER: Any = yaml.resolver.Resolver()
Path = tuple[str | int, ...]
LocalFault = tuple[Path, str]
Faults = Iterator[LocalFault]


class Strict(BaseModel):
    """Frozen class without unknown keys, with finite numbers only.

    Values are not converted, but for whole numbers to floats.

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
        """Refuse values that do not fit together."""
        if faults := list(self._faults()):
            raise refusal(faults)
        return self

    def _faults(self) -> Faults:
        """Faults of values that are each allowed by themselves: a path below this value, and a sentence."""
        yield from ()


def refusal(faults: Sequence[LocalFault]) -> PydanticCustomError:
    """Error that a validator raises for faults.

    Parameters
    ----------
    faults : sequence of LocalFault
        Paths below the validated value, with a sentence each.
    """
    text = "; ".join(f"{'.'.join(map(str, path))}: {message}" if path else message for path, message in faults)
    return PydanticCustomError(FAULTS, "{text}", {"text": text, FAULTS: list(faults)})


def allow(words: str) -> Any:
    """Annotation with the text for what is allowed, where the text from the schema is unclear.

    Parameters
    ----------
    words : str
        The text.
    """
    return Field(json_schema_extra={ALLOWED: words})


def likely_mistakes(**sentences: str) -> ConfigDict:
    """Configuration of a class that has sentences for keys that it does not have, but that users may expect.

    Parameters
    ----------
    **sentences : str
        By the unknown key: the message in place of one that lists similar keys.
    """
    return ConfigDict(json_schema_extra={MEANT: dict(sentences)})


def listed(words: Sequence[str], between: str = ", ") -> str:
    """Texts in a list, with the first few of many and the number of the others.

    Parameters
    ----------
    words : sequence of str
        The texts.
    between : str
        Separator.
    """
    if len(words) <= MOST_LISTED:
        return between.join(words)
    return f"{between.join(words[:MOST_LISTED])}{between}... and {len(words) - MOST_LISTED} more"


def did_you_mean(word: str, known: Collection[str]) -> str:
    """Question for the known name that an unknown name probably means; empty if none is similar.

    Parameters
    ----------
    word : str
        The unknown name.
    known : collection of str
        The known names.
    """
    near = [name for name in get_close_matches(word, known) if not _similar_by_unit_alone(word, name)]
    near = near or [name for name in known if name.startswith(f"{word}_") or name.endswith(f".{word}")]  # or last key
    return f"did you mean {near[0]}?" if near else ""


def _similar_by_unit_alone(word: str, name: str) -> bool:
    """Return whether two names end with the same unit, `_m`, and differ in what stands before it."""
    (stem, _, unit), (other_stem, _, other_unit) = word.rpartition("_"), name.rpartition("_")
    return unit == other_unit and not get_close_matches(stem, [other_stem])


def no_such(kind: str, name: str, known: Collection[str]) -> str:
    """Sentence that there is no body, joint or signal of a name, and which ones there are.

    Parameters
    ----------
    what : str
        Kind of the thing.
    name : str
        The unknown name.
    known : collection of str
        The known names.
    """
    names = ", ".join([*known][:_MOST_NAMES]) + ", ..." * (len(known) > _MOST_NAMES) or "none"
    return f"there is no {kind} {name!r}; {did_you_mean(name, known) or f'there are {names}'}"


def form(value: Any) -> str | None:
    """YAML form of a value, the tag of a union of forms, which pydantic puts between two keys of a location.

    An empty mapping has no form, so that one fault lists all that it may be, and not a fault for each missing key.

    Parameters
    ----------
    value
        The value.

    Returns
    -------
    str or None
        A key of `_FORMS`.
    """
    if isinstance(value, bool) or value == {}:
        return None
    return next((name for name, kind in _FORMS.items() if isinstance(value, kind)), None)


@lru_cache(maxsize=1024)
def _is_lost(text: str) -> bool:
    """Return whether PyYAML writes a text without quotes that this package reads as another value."""
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
    """Validator of a vector that must have a direction.

    Parameters
    ----------
    allowed : str
        Text for what is allowed.
    """

    def points_somewhere(axis: tuple[float, ...]) -> tuple[float, ...]:
        if not 0.0 < math.hypot(*axis) < math.inf:
            raise refusal([((), f"got {list(axis)}; allowed is {allowed}")])
        return axis

    return AfterValidator(points_somewhere)


def _once(names: tuple[str, ...]) -> tuple[str, ...]:
    """Refuse a name that is listed twice."""
    duplicates = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    if duplicates:
        raise refusal([((), f"names {name} twice; once is allowed") for name in duplicates])
    return names


Names = Annotated[tuple[Text, ...], Listed, Field(min_length=1), AfterValidator(_once)]


class OrNull:
    """Marks a field that may be null in a file. Its class sets another value, so the attribute is never None."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema of the value or null."""
        return core_schema.nullable_schema(handler(source))


class OrName:
    """Marks a field for which a file may name another file, whose value is used."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: Any) -> dict[str, Any]:
        """JSON Schema of the value, or a name."""
        schema = handler(core)
        default = {key: schema.pop(key) for key in ("default", "title") if key in schema}
        return {"anyOf": [schema, {"type": "string"}], ALLOWED: "a list, or the name of what has it", **default}


class Tagged:
    """Marks a union whose member is selected by the value of one key.

    pydantic's own `discriminator` refuses a union of one member.

    Parameters
    ----------
    key : str
        The key.
    choices : mapping of str to type
        Classes by the value of the key.
    """

    def __init__(self, key: str, choices: Mapping[str, type[BaseModel]]) -> None:
        self.key, self.choices = key, choices

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema of the union; `source`, the annotation, is for type checkers."""
        del source
        choices = {tag: handler.generate_schema(choice) for tag, choice in self.choices.items()}
        return core_schema.tagged_union_schema(choices, discriminator=self.key)


def by_type(*classes: type[Strict]) -> dict[str, type[Strict]]:
    """Classes by the single allowed value of their field `type`.

    Parameters
    ----------
    *classes : type
        The classes.
    """
    return {get_args(each.model_fields["type"].annotation)[0]: each for each in classes}


ONE, MANY = "one", "list"


class OneOrMore:
    """Marks a field that holds one value of a kind, or a list of such values."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Core schema of the two forms; the source is a tuple of the kind."""
        (kind, *_) = get_args(source)
        single = handler.generate_schema(kind)
        return core_schema.tagged_union_schema(
            {
                ONE: single,
                MANY: core_schema.tuple_variable_schema(single, min_length=1, strict=False),
            },
            discriminator=lambda value: MANY if form(value) == MANY else ONE,
        )
