"""Pages of the reference, generated from the schema of files and from the parser of the command line.

Each class of the schema has a section. Its page follows from its module, so that a new class has a page as well.
"""

from __future__ import annotations

import argparse
import inspect
import re
from collections.abc import Iterator
from functools import cache
from typing import Any, Literal, get_args, get_origin

import pictures
from pydantic import BaseModel

from granular_contact.config import allowed, load_medium, medium_names
from granular_contact.config.export import _texts
from granular_contact.config.schema.fit import FitFile
from granular_contact.config.schema.joints import SYNONYMS
from granular_contact.config.schema.optimise import OptimiseFile
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.schema.space import SpatialScenario
from granular_contact.config.schema.sweep import SweepFile
from granular_contact.laws.gravity import key_of, scalings
from granular_contact.laws.kinds import SHAPE_NAMES
from granular_contact.laws.law import Law
from granular_contact.values.strict import Strict

FILES = (Scenario, SpatialScenario, SweepFile, FitFile, OptimiseFile)
ABOUT_MEDIA = (  # the same for every law
    *("name", "source", "standing", "provenance", "range"),
    *("measured_gravity_m_s2", "angle_of_repose_deg"),
)
# Beginning of the name of a module -> page of its classes. The first entry that matches counts; the last matches all.
PAGES = (
    ("laws", "reference/media"),
    ("schema.space.shapes", "reference/shapes_in_space"),
    ("schema.space", "reference/space"),
    ("schema.shapes", "reference/shapes"),
    ("schema.joints", "reference/joints"),
    ("schema.drives", "reference/drives"),
    ("schema.signals", "reference/drives"),
    ("schema.mechanism", "reference/bodies"),
    ("schema.model", "reference/bodies"),
    ("schema.sweep", "reference/many_runs"),
    ("schema.optimise", "reference/many_runs"),
    ("schema.fit", "reference/many_runs"),
    ("", "reference/run"),
)
TITLES = {
    "reference/run": (
        "Run",
        "A config describes one run: mechanism, medium, initial state, drives, solver and output. Every key except "
        "`model` has a default. `granular-contact check FILE` reports every fault with its line; "
        "`granular-contact schema --of run` prints this page for editors.",
    ),
    "reference/bodies": (
        "Bodies and chains",
        "The mechanism, under `model` in a config, or in a file of its own in `models/`. Positions are in the frame of "
        "a body; the x axis of a link's frame points along the link.",
    ),
    "reference/shapes": (
        "Shapes",
        "Shapes of a rigid body give its mass, its outline, and the surfaces on which the medium acts. x points ahead, "
        "y up; angles are clockwise.",
    ),
    "reference/joints": (
        "Joints",
        "The joints form a tree with the ground as its root; `closures` close loops. Angles, rates and torques are "
        "positive clockwise; the angle of a hinge on the ground is measured from the horizontal.",
    ),
    "reference/drives": (
        "Drives and signals",
        "`drives` act at joints, by the name of the joint. A signal gives the value of a drive over time: a number, "
        "the name of one of the run's `signals`, or a mapping with a `type`.",
    ),
    "reference/media": (
        "Media and laws",
        "`medium` is the name of a preset, a path to a YAML file, or a mapping with the tag `law`; the forces of "
        "several media in a list add. `granular-contact media` lists the presets, `granular-contact media NAME` draws "
        "the forces of one.",
    ),
    "reference/space": (
        "Mechanisms in space",
        "A model with `in_space: true` has bodies, joints, initial state and bed in three dimensions. World: x ahead, "
        "y left, z up. Angles, rates and torques are right-handed about their axes, as in URDF. All other keys of a "
        "config are those of the plane.",
    ),
    "reference/shapes_in_space": (
        "Shapes in space",
        "Shapes of a rigid body in space. Each is divided into facets, for an error of about 0.3 % of the path.",
    ),
    "reference/many_runs": (
        "Sweeps, searches, fits",
        "Files of many runs: `granular-contact sweep`, `optimise` and `fit` read them.",
    ),
}
# Last words of a key -> unit. The longest match counts.
UNITS = {
    "m": "m", "mm": "mm", "um": "µm", "s": "s", "ms": "ms", "deg": "deg", "rad": "rad", "kg": "kg", "N": "N",
    "Nm": "N m", "J": "J", "W": "W", "Pa": "Pa", "GPa": "GPa", "Hz": "Hz", "m_s": "m/s", "m_s2": "m/s²",
    "rad_s": "rad/s", "deg_s": "deg/s", "kg_m": "kg/m", "kg_m2": "kg m²", "kg_m3": "kg/m³", "N_m": "N/m",
    "N_m2": "N/m²", "N_m3": "N/m³",
    "Nm2": "N m²", "N_s_m": "N s/m", "kg_s": "kg/s", "N_per_m": "N/m", "N_s_per_m": "N s/m", "Nm_per_rad": "N m/rad",
    "Nm_s_per_rad": "N m s/rad", "s_per_m": "s/m", "s_m": "s/m", "s_per_rad": "s/rad", "N_cm3": "N/cm³", "MPa": "MPa",
    "kPa": "kPa", "m2": "m²",
    "bending_stiffness_N_m2": "N m²", "bending_damping_N_m2_s": "N m² s", "axial_damping_N_s": "N s",
}  # fmt: skip


# ---- classes ----


@cache
def classes() -> dict[str, type[BaseModel]]:
    """All classes that a file may contain, by name, in the order in which the schemas refer to them."""
    found: dict[str, type[BaseModel]] = {}
    known: dict[str, type[BaseModel]] = {}
    waiting: list[type[BaseModel]] = [Strict]
    while waiting:
        waiting += (cls := waiting.pop()).__subclasses__()
        known[cls.__name__] = cls
    queue = [cls.__name__ for cls in FILES]
    while queue:
        name = queue.pop(0)
        if name not in found:
            found[name] = known[name]
            queue += _named(schema(name))
    return found


def _named(node: Any) -> list[str]:
    """Names of the classes to which a part of a schema refers."""
    if isinstance(node, list):
        return [name for item in node for name in _named(item)]
    if not isinstance(node, dict):
        return []
    direct = [node["$ref"].rsplit("/", 1)[1]] if isinstance(node.get("$ref"), str) else []
    return direct + [name for key, item in node.items() if key != "discriminator" for name in _named(item)]


def schema(name: str) -> dict[str, Any]:
    """JSON Schema of a class."""
    return allowed.definitions()[name]


def page_of(name: str) -> str:
    """Page of a class, without suffix."""
    module = classes()[name].__module__.removeprefix("granular_contact.").removeprefix("config.")
    return next(page for start, page in PAGES if module.startswith(start))


def tag(cls: type[BaseModel]) -> str | None:
    """Value of `type` or `law` that names a class in YAML; None for a class without such a key."""
    for key in ("type", "law"):
        if key in cls.model_fields and get_origin(cls.model_fields[key].annotation) is Literal:
            return str(get_args(cls.model_fields[key].annotation)[0])
    return None


@cache
def places() -> dict[str, str]:
    """Dotted key at which a file contains each class; the first of several keys."""
    found = {cls.__name__: "" for cls in FILES}
    queue = list(found)
    while queue:
        name = queue.pop(0)
        for key, field in schema(name).get("properties", {}).items():
            mapped = "additionalProperties" in field or any("additionalProperties" in o for o in field.get("anyOf", []))
            for below in dict.fromkeys(_named(field)):
                if below not in found:
                    found[below] = ".".join(filter(None, (found[name], key, "NAME" if mapped else "")))
                    queue.append(below)
    return found


def heading(name: str) -> str:
    """Heading of the section of a class."""
    cls = classes()[name]
    if cls in FILES:
        return {"SweepFile": "Sweep", "FitFile": "Fit", "OptimiseFile": "Search"}.get(name, "All keys")
    word = tag(cls)
    if word is None:
        return f"`{places()[name].removesuffix('.NAME').split('.')[-1]}`"
    closure = " as a closure" if "Closure" in name else ""
    joint = page_of(name).endswith("joints")
    others = [f"`{synonym}`" for synonym, kind in SYNONYMS.items() if kind == word and joint]
    return f"`{word}`{closure}" + (f" ({', '.join(others)})" if others and not closure else "")


def anchor(name: str) -> str:
    """Anchor of the section of a class."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", name).lower()


def link(name: str, page: str) -> str:
    """A link to the section of a class, from a page."""
    other = page_of(name)
    target = "" if other == page else f"{other.rpartition('/')[2]}.md"
    word = tag(classes()[name]) or places()[name].removesuffix(".NAME").split(".")[-1]
    return f"[{word}]({target}#{anchor(name)})"


# ---- sections ----


def section(name: str, page: str) -> Iterator[str]:
    """Lines of the section of a class."""
    cls = classes()[name]
    yield f"## {heading(name)} {{ #{anchor(name)} }}"
    yield ""
    if places()[name]:
        yield f"*At `{places()[name]}`.*"
        yield ""
    if issubclass(cls, Law):
        yield f"`{cls.equation}`" if hasattr(cls, "equation") else ""
        yield ""
        yield f"Takes {', '.join(words for kind, words in SHAPE_NAMES.items() if kind in cls.takes)}."
        yield ""
    if cls.__doc__ and "!!! abstract" not in cls.__doc__:
        yield prose(cls.__doc__.partition("Parameters\n")[0])  # the table describes the parameters
        yield ""
    if (picture := pictures.of(name)) is not None:
        yield f'<figure class="shape">{picture}</figure>'
        yield ""
    yield from table(name, page)
    if issubclass(cls, Law):
        yield "With gravity g:"
        yield ""
        yield from (f"- `{key_of(cls, field)}` {scaling}" for field, scaling in scalings(cls).items())
        yield ""


def prose(text: str) -> str:
    """Text of a docstring as Markdown in one piece."""
    return inspect.cleandoc(text).replace("\n", " ").replace("  ", "\n\n").replace("|", "\\|").replace("<", "&lt;")


def texts(cls: type[BaseModel]) -> dict[str, str]:
    """Descriptions of the fields of a class, by key."""
    descriptions: dict[str, str] = {}
    for owner in reversed(cls.__mro__):
        if issubclass(owner, Strict):
            for name, text in _texts(owner):
                if name in cls.model_fields:
                    descriptions[cls.model_fields[name].alias or name] = text
    return descriptions


def table(name: str, page: str) -> Iterator[str]:
    """Lines of the table of a class: for each key the allowed values, the default and the meaning."""
    descriptions, class_schema = texts(classes()[name]), schema(name)
    hidden = ABOUT_MEDIA if issubclass(classes()[name], Law) else ()
    properties = class_schema.get("properties", {})
    rows = [(key, field) for key, field in properties.items() if key not in (*hidden, "type", "law")]
    fields, annotated = classes()[name].model_fields.items(), _annotated(classes()[name])
    own = {field.alias or key for key, field in fields if key in annotated}
    needed = class_schema.get("required", ())
    rows.sort(key=lambda row: (row[0] not in needed, row[0] not in own))  # inherited keys last
    if not rows:
        yield "It has no keys of its own."
        yield ""
        return
    yield "| key | allowed | default | meaning |"
    yield "| --- | --- | --- | --- |"
    for key, field in rows:
        default = "needed" if key in needed else _default(field.get("default", []))
        yield f"| `{key}` | {value(key, field, page)} | {default} | {prose(descriptions.get(key, ''))} |"
    yield ""


def _annotated(cls: type[BaseModel]) -> set[str]:
    """Names of the fields that a class declares itself, without inherited ones."""
    return set(vars(cls).get("__annotations__", {}))


def value(key: str, field: dict[str, Any], page: str) -> str:
    """Allowed values at a key, with its unit, or links to the allowed classes."""
    names = list(dict.fromkeys(_named(field)))
    if names:
        many = " of any names" if "additionalProperties" in field else ""
        several = ", or a list of such" if "array" in str(field) and len(names) == 1 else ""
        null = ", or null" if "'null'" in str(field) else ""
        if key in ("model", "medium"):
            many = " (or a name, a path, or a mapping with `from`)"
            names = [name for name in names if key == "medium" or name.endswith("Model")]
        listed = ", ".join(link(name, page) for name in names)
        return f"{listed}{many}{several}{null}"
    words = allowed.describe(allowed._resolved(field)).replace("|", "\\|")
    unit = unit_of(key)
    return f"{words}, in {unit}" if unit else words


def unit_of(key: str) -> str:
    """Unit in the last words of a key; empty for a key without unit."""
    parts = key.split("_")
    for first in range(len(parts)):
        if unit := UNITS.get("_".join(parts[first:])):
            return unit
    return ""


def _default(default: Any) -> str:
    """Default of a key as text."""
    if default is None:
        return "null"
    if isinstance(default, dict):
        return f"`{default['type']}`" if "type" in default else "see there"
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, list) and default:
        return f"`[{', '.join(map(_default, default))}]`"
    return f"{default:g}" if isinstance(default, int | float) else "none" if default in ([], ()) else f"{default}"


def page(name: str) -> str:
    """A page of the reference as Markdown."""
    title, introduction = TITLES[name]
    lines = [f"# {title}", "", introduction, ""]
    if name.endswith("media"):
        lines += [*presets(), *_about_media()]
    for cls in (cls for cls in classes() if page_of(cls) == name):
        lines += section(cls, name)
    return "\n".join(lines)


# ---- media ----


def presets() -> Iterator[str]:
    """Lines of the table of presets."""
    yield "## Presets"
    yield ""
    yield "| name | law | rests on | source of the numbers |"
    yield "| --- | --- | --- | --- |"
    for name in medium_names():
        spec = load_medium(name)
        source, standing = (prose(text or "not stated") for text in (spec.source, spec.standing))
        yield f"| `{name}` | [{spec.law}](#{anchor(type(spec).__name__)}) | {standing} | {source} |"
    yield ""


def _about_media() -> Iterator[str]:
    """Lines on the keys that all media have."""
    descriptions = texts(Law)
    descriptions |= {"name": "For messages and columns.", "range": "Speeds, depths and sizes measured."}
    yield "Every medium may also have these keys, beside the numbers of its law:"
    yield ""
    for key in ABOUT_MEDIA:
        yield f"- `{key}`: {prose(descriptions.get(key, 'published, fitted or own.'))}"
    yield ""


# ---- commands ----


def commands() -> str:
    """Page of the command line."""
    from granular_contact.cli.main import _parser

    parser = _parser()
    (action,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    summaries = {choice.dest: choice.help or "" for choice in action._choices_actions}
    lines = ["# Commands", ""]
    lines += [
        "Exit codes: 0 fine, 2 faulty input, 3 a solve failed, 4 time limit reached, 5 the result is not usable, "
        "130 interrupted ([more](../howto/accuracy.md)). With codes from 3 on, the results up to the end of "
        "the run are saved. A figure or an animation that can't be drawn gives a warning on stderr, after all data are "
        "saved.",
        "",
    ]
    for name, command in action.choices.items():
        lines += [f"## {name}", "", f"{summaries[name][:1].upper()}{summaries[name][1:]}.", ""]
        usage = command.format_usage().removeprefix("usage: ").strip()
        lines += ["```text", " ".join(usage.split()), "```", ""]
        rows = [option for option in command._actions if option.help != argparse.SUPPRESS and option.dest != "help"]
        if rows:
            lines += ["| argument | meaning |", "| --- | --- |"]
        for option in rows:
            names = ", ".join(f"`{name}`" for name in option.option_strings) or f"`{option.metavar or option.dest}`"
            has_argument = option.option_strings and option.nargs != 0
            argument = f" `{option.metavar or option.dest.upper()}`" if has_argument else ""
            choices = f"; one of {', '.join(map(str, option.choices))}" if option.choices else ""
            words = (option.help or "").replace("|", "\\|").replace("%%", "%")
            lines.append(f"| {names}{argument} | {words}{choices} |")
        lines.append("")
    return "\n".join(lines)


def pages() -> dict[str, str]:
    """All generated pages, by path."""
    return {f"{name}.md": page(name) for name in TITLES} | {"reference/commands.md": commands()}
