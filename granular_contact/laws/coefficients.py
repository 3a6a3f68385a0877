"""Coefficients that Python gives in order or by name, and YAML by keys that are the names with their units."""

from __future__ import annotations

from dataclasses import make_dataclass
from keyword import iskeyword
from operator import attrgetter
from typing import Any, Literal, cast, get_args, get_origin

from pydantic import ValidationError

from granular_contact.values.strict import FAULTS, Strict

_BOUNDS = {"exclusiveMinimum": "above", "minimum": "of at least", "maximum": "of at most"}


_Strict: Any = Strict  # which type checkers would give an __init__ by keys, though Coefficients has its own


class Coefficients(_Strict):  # type: ignore[misc]
    """A field is named as in Python; its alias, if it has one, is the key in YAML. A tag is for YAML alone."""

    def __init__(self, *numbers: Any, **named: Any) -> None:
        """Take numbers in the order of the fields, or by name.

        Raises
        ------
        ValueError
            A number is not allowed; with what is.
        TypeError
            One is missing, unknown or given twice.
        """
        cls, names = type(self), self.positions()
        given = dict(zip(names, numbers, strict=False)) | named
        if len(given) < len(numbers) + len(named):
            raise TypeError(f"{cls.__name__}: got too many numbers, or one twice; allowed are {', '.join(names)}")
        keys = {name: field.alias or name for name, field in cls.model_fields.items()}
        try:
            super().__init__(**cls._tags() | {keys.get(name, name): _plain(one) for name, one in given.items()})
        except ValidationError as error:
            raise _refused(cls, error) from None

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]  # what is read from YAML does not pass here

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Let every coefficient be read by its key, too, and `dataclasses.replace` make another of the class."""
        super().__pydantic_init_subclass__(**kwargs)
        fields: Any = make_dataclass(cls.__name__, cls.positions(), init=False, repr=False, eq=False)
        cls.__dataclass_fields__ = fields.__dataclass_fields__
        for name, field in cls.model_fields.items():
            if field.alias is not None:
                setattr(cls, f"{field.alias}{'_' * iskeyword(field.alias)}", property(attrgetter(name)))

    @classmethod
    def positions(cls) -> list[str]:
        """Names of the numbers in the order in which Python gives them."""
        return [name for name in cls.model_fields if name not in cls._tags()]

    @classmethod
    def _tags(cls) -> dict[str, Any]:
        """Fields that have one value only, and no default: they name the class in YAML."""
        one = {name: get_args(field.annotation) for name, field in cls.model_fields.items() if field.is_required()}
        literal = [name for name in one if get_origin(cls.model_fields[name].annotation) is Literal]
        return {name: one[name][0] for name in literal if len(one[name]) == 1}


def _plain(value: Any) -> Any:
    """A number of numpy, which is not loaded for this, as one of Python."""
    return value.item() if hasattr(value, "item") else value


def _refused(cls: type[Coefficients], error: ValidationError) -> Exception:
    """The error of a call from Python: `LeeMarghitu.density: got -1.0, allowed is a number above 0`."""
    names = {field.alias: name for name, field in cls.model_fields.items()}
    properties = cls.model_json_schema()["properties"]
    lines, kind = [], cast("type[Exception]", ValueError)
    for one in error.errors(include_url=False):
        key, *below = one["loc"] or ("",)
        path = ".".join(str(part) for part in (cls.__name__, names.get(str(key), key), *below) if part != "")
        if one["type"] in ("missing", "extra_forbidden"):
            lines.append(f"{path} is {'missing' if one['type'] == 'missing' else 'not known'}")
            kind = TypeError
        elif one["type"] == FAULTS:
            lines.append(f"{path}: {one['msg']}")
        else:
            lines.append(f"{path}: got {one['input']!r}, allowed is {_allowed(properties.get(key, {}))}")
    return kind("; ".join(lines))


def _allowed(schema: dict[str, Any]) -> str:
    schema = next((one for one in schema.get("anyOf", ()) if one.get("type") != "null"), schema)
    if "$ref" in schema:
        return f"a {schema['$ref'].rsplit('/', 1)[1]}"
    if schema.get("type") != "number":
        return f"a value of the type {schema.get('type', 'of its field')}"
    bounds = [f"{words} {schema[key]:g}" for key, words in _BOUNDS.items() if key in schema]
    return f"a number {' and '.join(bounds)}" if bounds else "a finite number"
