"""Templates and their filters: numbers as text, tables and pictures. Every text is escaped.

A page runs small scripts of this package, and the script of plotly, which draws curves and motions in space. The
content security policy of the page names the hashes of its scripts, so that the browser runs no others. The script of
plotly comes with its Python package; it is compressed into the page, so that the page is a single file, and the browser
unpacks it.
"""

from __future__ import annotations

import json
import re
import struct
import zlib
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime, timezone
from functools import cache
from hashlib import sha256
from importlib.metadata import distribution
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from granular_contact.report.pages.folder import picture
from granular_contact.report.pages.stage import turned
from granular_contact.report.units import column, is_number, label, plain, quantity

GENERATOR = "granular-contact"
WIDE = 2.4  # ratio of width to height above which a picture has its own row
_HEADING = re.compile(r'<h2 id="([^"]*)">(.*?)</h2>')
_QUANTITY = re.compile(r"[\N{MINUS SIGN}+]?\d[\d.e\N{MINUS SIGN}+]*( \S+)?")
_DRAWING = ("tables", "data", "player", "histories", "space", "cases", "run")
_SCRIPTS = dict.fromkeys(("run", "compare", "compare-media", "sweep", "optimise", "fit"), _DRAWING)
Rows = Iterable[Sequence[Any]]


def rendered(kind: str, content: dict[str, Any], data: dict[str, Any], *, draws: bool = False) -> str:
    """Render the page of a kind of results by its template, or by the template of tables and figures.

    data: for the scripts; the page is readable without scripts. draws: whether the scripts need plotly.
    """
    template = _templates().select_template([f"{kind}.html", "fallback.html"])
    made = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    script, drawing = own(*_SCRIPTS.get(kind, ("tables", "files"))), plotly() if draws else None
    hashes = Markup(" ".join(resource.hash for resource in (script, drawing) if resource))
    more = {"script": script.text, "plotly": drawing and drawing.text, "hashes": hashes, "data_block": data_block(data)}
    return template.render(content, results=kind, generator=GENERATOR, made=made, draws=draws, **more)


@cache
def _templates() -> Environment:
    environment = Environment(loader=PackageLoader(__package__), autoescape=True, undefined=StrictUndefined)
    environment.trim_blocks = environment.lstrip_blocks = True
    own = (label, quantity, plain, flat, cell, keyed, records, headings, squeezed, uri, is_wide, turned, run_of)
    environment.filters |= {function.__name__: function for function in own}
    environment.tests["deep"] = is_deep
    return environment


def headings(content: Markup) -> list[tuple[str, Markup]]:
    """Names and headings of the sections of a page."""
    return [(Markup(name), Markup(heading)) for name, heading in _HEADING.findall(content)]


def run_of(part: str, runs: Sequence[Mapping[str, str]]) -> Markup:
    """HTML attribute of a part `RUN: part` with the index of its run."""
    place = next((i for i, run in enumerate(runs) if part.startswith(f"{run['name']}: ")), None)
    return Markup("") if place is None else Markup(f' data-run="{place}"')


def squeezed(text: Markup) -> Markup:
    """Replace white space by single spaces."""
    return Markup(" ").join(text.split())


# ---- tables ----


def keyed(rows: Sequence[Sequence[Any]], keys: Sequence[str]) -> tuple[list[str], list[tuple[Any, ...]]]:
    """Headings and rows of a table whose columns are named by keys: labels, and numbers in a suitable unit.

    Columns without any value are left out.
    """
    cells = [(key, [row[i] for row in rows]) for i, key in enumerate(keys)]
    columns = [column(key, values) for key, values in cells if any(value is not None for value in values) or not rows]
    return [heading for heading, _ in columns], list(zip(*(values for _, values in columns), strict=True))


def cell(value: Any, first: bool) -> tuple[str, str]:
    """CSS class and text of a cell; first: whether the cell names its row."""
    if value is None or value == "":
        return "empty", "\N{EN DASH}"
    if is_number(value) or (not first and _QUANTITY.fullmatch(str(value))):
        return "number", plain(value)
    return "", "yes" if value is True else "no" if value is False else str(value)


# ---- JSON values ----


def records(value: Any, name: str) -> tuple[list[str], list[list[Any]]] | None:
    """Headings and rows of a list or mapping of mappings; None for other values. name: heading of mapping keys."""
    mappings = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(mappings, list) or not mappings or not all(isinstance(record, dict) for record in mappings):
        return None
    keys = list(dict.fromkeys(key for record in mappings for key in record))
    rows = [[flat(record.get(key)) for key in keys] for record in mappings]
    if isinstance(value, dict):
        return [name, *keys], [[key, *row] for key, row in zip(value, rows, strict=True)]
    return keys, rows


def is_deep(value: Any) -> bool:
    """Return whether a value does not fit into a cell."""
    return isinstance(value, dict) or (isinstance(value, list) and any(isinstance(item, dict | list) for item in value))


def flat(value: Any) -> Any:
    """Convert a value to one that fits into a cell."""
    if isinstance(value, list):
        return ", ".join(plain(flat(item)) for item in value)
    if isinstance(value, dict):
        return ", ".join(f"{key}: {plain(flat(item))}" for key, item in value.items())
    return value


# ---- pictures ----


def uri(path: Path) -> str:
    """A PNG as a data URI."""
    return f"data:image/png;base64,{b64encode(picture(path)).decode()}"


def is_wide(path: Path) -> bool:
    """Return whether a PNG is too wide to be shown beside another one, or on a phone without scrolling."""
    width, height = struct.unpack(">II", picture(path)[16:24])
    return bool(width > WIDE * height)


_SOURCES = Path(__file__).parent / "scripts"
LEVEL = 4  # of compression: 0.1 s for the script of plotly, 4 % larger than at the best level
_ESCAPES = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


class Script(NamedTuple):
    """A script, and its hash in the form of content security policies."""

    text: Markup
    hash: str


def packed(content: bytes) -> str:
    """Compress bytes to text for scripts: zlib, base64."""
    return b64encode(zlib.compress(content, LEVEL)).decode()


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


@cache
def own(*names: str) -> Script:
    """Scripts of this package by name, joined to one."""
    text = "".join((_SOURCES / f"{name}.js").read_text(encoding="utf-8") for name in names)
    text = f'"use strict";\n(() => {{\n{text}}})();\n'
    return Script(Markup(text), _hash(text))


@cache
def plotly() -> Script:
    """Script of plotly, compressed."""
    # plotly is not imported, because the import would take longer than the whole page.
    file = distribution("plotly").locate_file("plotly/package_data/plotly.min.js")
    text = Path(str(file)).read_text(encoding="utf-8")
    return Script(Markup(packed(text.encode())), _hash(text))


def data_block(content: Any) -> Markup:
    """JSON for a script element, escaped so that no text in it can end the element."""
    text = json.dumps(content, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    for sign, escape in _ESCAPES.items():
        text = text.replace(sign, escape)
    return Markup(text)
