"""Pages of the reference, written from the schema of files and from the command line as they are.

A class of the schema is a section; which page it stands on follows from its module, so that a new one has a place.
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
# Page of the classes of a module, the first that fits; what fits none stands with the run.
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
        "A config is one run: what moves, in what, from which start, and how it is computed and saved. Every key has a "
        "default but `model`. `granular-contact check FILE` reports every fault with its line; "
        "`granular-contact schema --of run` prints this page for editors.",
    ),
    "reference/bodies": (
        "Bodies and chains",
        "The mechanism, under `model` in a config, or in a file of its own in `models/`. Lengths in the "
        "frame of a body, "
        "whose x axis points along a link.",
    ),
    "reference/shapes": (
        "Shapes",
        "What a rigid body is made of: its mass, its outline, and what the medium meets. x ahead, y up; "
        "angles clockwise.",
    ),
    "reference/joints": (
        "Joints",
        "A tree of joints with the ground as its root; `closures` close loops. "
        "Angles, rates and torques are positive clockwise, on the ground below the horizontal.",
    ),
    "reference/drives": (
        "Drives and signals",
        "`drives` act at joints, by the name of the joint. What they do over time is a signal: a number, "
        "the name of one "
        "of the run's `signals`, or a mapping with a `type`.",
    ),
    "reference/media": (
        "Media and laws",
        "`medium` is the name of a preset, a path to a YAML file, or a mapping with the tag `law`; in a "
        "list the forces of "
        "several add. `granular-contact media` lists the presets, `granular-contact media NAME` draws "
        "the forces of one.",
    ),
    "reference/space": (
        "Mechanisms in space",
        "A model with `in_space: true` has bodies, joints, start and bed of three dimensions. World: x "
        "ahead, y left, z "
        "up. Angles, rates and torques are right-handed about their axes, as in URDF. All else of a "
        "config is as in the "
        "plane.",
    ),
    "reference/shapes_in_space": (
        "Shapes in space",
        "What a rigid body in space is made of. A shape is cut into facets, for an error of about 0.3 % of the path.",
    ),
    "reference/many_runs": (
        "Sweeps, searches, fits",
        "Files of many runs: `granular-contact sweep`, `optimise` and `fit` read them.",
    ),
}
# Last words of a key, and the unit that they say; the longest that fits counts.
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
    """All classes that a file may hold, by name, in the order in which one meets them."""
    found: dict[str, type[BaseModel]] = {}
    known: dict[str, type[BaseModel]] = {}
    more: list[type[BaseModel]] = [Strict]
    while more:
        more += (one := more.pop()).__subclasses__()
        known[one.__name__] = one
    queue = [one.__name__ for one in FILES]
    while queue:
        name = queue.pop(0)
        if name not in found:
            found[name] = known[name]
            queue += _named(schema(name))
    return found


def _named(node: Any) -> list[str]:
    """Names of the classes that a piece of a schema refers to."""
    if isinstance(node, list):
        return [name for item in node for name in _named(item)]
    if not isinstance(node, dict):
        return []
    own = [node["$ref"].rsplit("/", 1)[1]] if isinstance(node.get("$ref"), str) else []
    return own + [name for key, item in node.items() if key != "discriminator" for name in _named(item)]


def schema(name: str) -> dict[str, Any]:
    """JSON Schema of a class."""
    return allowed.definitions()[name]


def page_of(name: str) -> str:
    """Page that a class stands on, without its suffix."""
    module = classes()[name].__module__.removeprefix("granular_contact.").removeprefix("config.")
    return next(page for start, page in PAGES if module.startswith(start))


def tag(cls: type[BaseModel]) -> str | None:
    """The word that names a class in YAML; None where a key alone does."""
    for key in ("type", "law"):
        if key in cls.model_fields and get_origin(cls.model_fields[key].annotation) is Literal:
            return str(get_args(cls.model_fields[key].annotation)[0])
    return None


@cache
def places() -> dict[str, str]:
    """Where in a file each class stands, as a dotted key; of several the first."""
    found = {one.__name__: "" for one in FILES}
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
    others = [f"`{other}`" for other, one in SYNONYMS.items() if one == word and joint]
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
        yield prose(cls.__doc__.partition("Parameters\n")[0])  # what its parameters mean is in the table
        yield ""
    if (picture := pictures.of(name)) is not None:
        yield f'<figure class="shape">{picture}</figure>'
        yield ""
    yield from table(name, page)
    if issubclass(cls, Law):
        yield "With gravity g:"
        yield ""
        yield from (f"- `{key_of(cls, one)}` {scaling}" for one, scaling in scalings(cls).items())
        yield ""


def prose(text: str) -> str:
    """Text of a docstring as Markdown in one piece."""
    return inspect.cleandoc(text).replace("\n", " ").replace("  ", "\n\n").replace("|", "\\|").replace("<", "&lt;")


def texts(cls: type[BaseModel]) -> dict[str, str]:
    """What is said of the fields of a class, by their keys."""
    found: dict[str, str] = {}
    for owner in reversed(cls.__mro__):
        if issubclass(owner, Strict):
            for name, text in _texts(owner):
                if name in cls.model_fields:
                    found[cls.model_fields[name].alias or name] = text
    return found


def table(name: str, page: str) -> Iterator[str]:
    """The keys of a class: what is allowed, the default, and what each means."""
    said, found = texts(classes()[name]), schema(name)
    hidden = ABOUT_MEDIA if issubclass(classes()[name], Law) else ()
    rows = [(key, field) for key, field in found.get("properties", {}).items() if key not in (*hidden, "type", "law")]
    fields, brought = classes()[name].model_fields.items(), _annotated(classes()[name])
    own = {field.alias or key for key, field in fields if key in brought}
    needed = found.get("required", ())
    rows.sort(key=lambda row: (row[0] not in needed, row[0] not in own))  # before what it shares with its kind
    if not rows:
        yield "It has no keys of its own."
        yield ""
        return
    yield "| key | allowed | default | meaning |"
    yield "| --- | --- | --- | --- |"
    for key, field in rows:
        default = "needed" if key in needed else _default(field.get("default", []))
        yield f"| `{key}` | {value(key, field, page)} | {default} | {prose(said.get(key, ''))} |"
    yield ""


def _annotated(cls: type[BaseModel]) -> set[str]:
    """Names of the fields that a class brings itself."""
    return set(vars(cls).get("__annotations__", {}))


def value(key: str, field: dict[str, Any], page: str) -> str:
    """What is allowed at a key, with its unit, and links to the classes that may stand there."""
    names = list(dict.fromkeys(_named(field)))
    if names:
        many = " of any names" if "additionalProperties" in field else ""
        several = ", or a list of such" if "array" in str(field) and len(names) == 1 else ""
        null = ", or null" if "'null'" in str(field) else ""
        if key in ("model", "medium"):
            many = " (or a name, a path, or a mapping with `from`)"
            names = [one for one in names if key == "medium" or one.endswith("Model")]
        listed = ", ".join(link(one, page) for one in names)
        return f"{listed}{many}{several}{null}"
    words = allowed.describe(allowed._resolved(field)).replace("|", "\\|")
    unit = unit_of(key)
    return f"{words}, in {unit}" if unit else words


def unit_of(key: str) -> str:
    """Unit that a key names with its last words; nothing for one without."""
    parts = key.split("_")
    for first in range(len(parts)):
        if unit := UNITS.get("_".join(parts[first:])):
            return unit
    return ""


def _default(held: Any) -> str:
    if held is None:
        return "null"
    if isinstance(held, dict):
        return f"`{held['type']}`" if "type" in held else "see there"
    if isinstance(held, bool):
        return str(held).lower()
    if isinstance(held, list) and held:
        return f"`[{', '.join(_default(one) for one in held)}]`"
    return f"{held:g}" if isinstance(held, int | float) else "none" if held in ([], ()) else f"{held}"


def page(name: str) -> str:
    """A page of the reference as Markdown."""
    title, words = TITLES[name]
    lines = [f"# {title}", "", words, ""]
    here = [one for one in classes() if page_of(one) == name]
    if name.endswith("media"):
        lines += [*presets(), *_about_media()]
    for one in here:
        lines += section(one, name)
    return "\n".join(lines)


# ---- media ----


def presets() -> Iterator[str]:
    """The shipped media."""
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
    said = texts(Law)
    said |= {"name": "For messages and columns.", "range": "Speeds, depths and sizes measured."}
    yield "Every medium may also say, beside the numbers of its law:"
    yield ""
    for key in ABOUT_MEDIA:
        yield f"- `{key}`: {prose(said.get(key, 'published, fitted or own.'))}"
    yield ""


# ---- commands ----


def commands() -> str:
    """Page of the command line."""
    from granular_contact.cli.main import _parser

    parser = _parser()
    (action,) = (one for one in parser._actions if isinstance(one, argparse._SubParsersAction))
    summaries = {one.dest: one.help or "" for one in action._choices_actions}
    lines = ["# Commands", ""]
    lines += [
        "Exit codes: 0 fine, 2 faulty input, 3 a solve failed, 4 time limit reached, 5 the result is not usable, "
        "130 interrupted ([more](../howto/accuracy.md)). From 3 on, what was reached is saved. A figure or an "
        "animation that can't be drawn gives a warning on stderr, after all data is saved.",
        "",
    ]
    for name, command in action.choices.items():
        lines += [f"## {name}", "", f"{summaries[name][:1].upper()}{summaries[name][1:]}.", ""]
        usage = command.format_usage().removeprefix("usage: ").strip()
        lines += ["```text", " ".join(usage.split()), "```", ""]
        rows = [one for one in command._actions if one.help != argparse.SUPPRESS and one.dest != "help"]
        if rows:
            lines += ["| argument | meaning |", "| --- | --- |"]
        for one in rows:
            names = ", ".join(f"`{option}`" for option in one.option_strings) or f"`{one.metavar or one.dest}`"
            takes = f" `{one.metavar or one.dest.upper()}`" if one.option_strings and one.nargs != 0 else ""
            chosen = f"; one of {', '.join(map(str, one.choices))}" if one.choices else ""
            words = (one.help or "").replace("|", "\\|").replace("%%", "%")
            lines.append(f"| {names}{takes} | {words}{chosen} |")
        lines.append("")
    return "\n".join(lines)


def pages() -> dict[str, str]:
    """All generated pages, by path."""
    return {f"{name}.md": page(name) for name in TITLES} | {"reference/commands.md": commands()}
