"""Base class of coefficients: in Python by position or name, in YAML by keys that end with the unit."""

from __future__ import annotations

from dataclasses import make_dataclass
from keyword import iskeyword
from operator import attrgetter
from typing import Any, Literal, cast, get_args, get_origin

from pydantic import ValidationError

from granular_contact.values.strict import FAULTS, Strict

_BOUNDS = {"exclusiveMinimum": "above", "minimum": "of at least", "maximum": "of at most"}


_Strict: Any = Strict  # as Any, so that type checkers do not expect the __init__ by keys that pydantic makes


class Coefficients(_Strict):  # type: ignore[misc]
    """A set of coefficients. A field has its name in Python; its alias, if it has one, is the key in YAML.

    A field with a single allowed value and no default is a tag. Only YAML has tags.
    """

    def __init__(self, *numbers: Any, **named: Any) -> None:
        """Make a set of coefficients.

        Parameters
        ----------
        *numbers : float
            Values in the order of `positions`.
        **named
            Values by their names in Python.

        Raises
        ------
        ValueError
            A value is not allowed. The message says what is allowed.
        TypeError
            A value is missing, unknown or given twice.
        """
        cls, names = type(self), self.positions()
        given = dict(zip(names, numbers, strict=False)) | named
        if len(given) < len(numbers) + len(named):
            raise TypeError(f"{cls.__name__}: got too many numbers, or one twice; allowed are {', '.join(names)}")
        keys = {name: field.alias or name for name, field in cls.model_fields.items()}
        try:
            super().__init__(**cls._tags() | {keys.get(name, name): _plain(value) for name, value in given.items()})
        except ValidationError as error:
            raise _refused(cls, error) from None

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]  # values from YAML do not pass through it

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Make each coefficient readable by its key in YAML, and let `dataclasses.replace` copy the class."""
        super().__pydantic_init_subclass__(**kwargs)
        fields: Any = make_dataclass(cls.__name__, cls.positions(), init=False, repr=False, eq=False)
        cls.__dataclass_fields__ = fields.__dataclass_fields__
        for name, field in cls.model_fields.items():
            if field.alias is not None:
                setattr(cls, f"{field.alias}{'_' * iskeyword(field.alias)}", property(attrgetter(name)))

    @classmethod
    def positions(cls) -> list[str]:
        """Names of the coefficients in the order of positional arguments, without tags."""
        return [name for name in cls.model_fields if name not in cls._tags()]

    @classmethod
    def _tags(cls) -> dict[str, Any]:
        """Fields with a single allowed value and no default, with that value: they name the class in YAML."""
        values = {name: get_args(field.annotation) for name, field in cls.model_fields.items() if field.is_required()}
        literal = [name for name in values if get_origin(cls.model_fields[name].annotation) is Literal]
        return {name: values[name][0] for name in literal if len(values[name]) == 1}


def _plain(value: Any) -> Any:
    """Convert a NumPy scalar to a Python number, without importing NumPy; return other values unchanged."""
    return value.item() if hasattr(value, "item") else value


def _refused(cls: type[Coefficients], error: ValidationError) -> Exception:
    """Convert pydantic's error to that of a Python call: `Rft.zeta: got -1.0, allowed is a number above 0`."""
    names = {field.alias: name for name, field in cls.model_fields.items()}
    properties = cls.model_json_schema()["properties"]
    lines, kind = [], cast("type[Exception]", ValueError)
    for fault in error.errors(include_url=False):
        key, *inner = fault["loc"] or ("",)
        path = ".".join(str(part) for part in (cls.__name__, names.get(str(key), key), *inner) if part != "")
        if fault["type"] in ("missing", "extra_forbidden"):
            lines.append(f"{path} is {'missing' if fault['type'] == 'missing' else 'not known'}")
            kind = TypeError
        elif fault["type"] == FAULTS:
            lines.append(f"{path}: {fault['msg']}")
        else:
            lines.append(f"{path}: got {fault['input']!r}, allowed is {_allowed(properties.get(key, {}))}")
    return kind("; ".join(lines))


def _allowed(schema: dict[str, Any]) -> str:
    """Describe the allowed values of a field by its JSON Schema."""
    schema = next((option for option in schema.get("anyOf", ()) if option.get("type") != "null"), schema)
    if "$ref" in schema:
        return f"a {schema['$ref'].rsplit('/', 1)[1]}"
    if schema.get("type") != "number":
        return f"a value of the type {schema.get('type', 'of its field')}"
    bounds = [f"{bound} {schema[keyword]:g}" for keyword, bound in _BOUNDS.items() if keyword in schema]
    return f"a number {' and '.join(bounds)}" if bounds else "a finite number"
