"""Templates and their filters: numbers in words, tables and pictures. Every text is escaped.

Scripts are our own, which are small, and plotly's, which draws curves and what is in space. A page names the hashes of
its scripts in its policy, so that nothing else that looks like one is run. Plotly's script comes with its Python
package; it is packed into the page, so that one file can be passed on; the browser unpacks it.
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
WIDE = 2.4  # width to height of pictures that get a row of their own
_HEADING = re.compile(r'<h2 id="([^"]*)">(.*?)</h2>')
_QUANTITY = re.compile(r"[\N{MINUS SIGN}+]?\d[\d.e\N{MINUS SIGN}+]*( \S+)?")
_DRAWING = ("tables", "data", "player", "histories", "space", "cases", "run")
_SCRIPTS = dict.fromkeys(("run", "compare", "compare-media", "sweep", "optimise", "fit"), _DRAWING)
Rows = Iterable[Sequence[Any]]


def rendered(kind: str, content: dict[str, Any], data: dict[str, Any], *, draws: bool = False) -> str:
    """The page of results of a kind by its template, or by that of tables and figures.

    It runs our scripts alone, on the data given, and is readable without them; draws: whether they need plotly's.
    """
    template = _templates().select_template([f"{kind}.html", "fallback.html"])
    made = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    script, drawing = own(*_SCRIPTS.get(kind, ("tables", "files"))), plotly() if draws else None
    hashes = Markup(" ".join(one.hash for one in (script, drawing) if one))
    more = {"script": script.text, "plotly": drawing and drawing.text, "hashes": hashes, "data_block": data_block(data)}
    return template.render(content, results=kind, generator=GENERATOR, made=made, draws=draws, **more)


@cache
def _templates() -> Environment:
    found = Environment(loader=PackageLoader(__package__), autoescape=True, undefined=StrictUndefined)
    found.trim_blocks = found.lstrip_blocks = True
    own = (label, quantity, plain, flat, cell, keyed, records, headings, squeezed, uri, is_wide, turned, run_of)
    found.filters |= {one.__name__: one for one in own}
    found.tests["deep"] = is_deep
    return found


def headings(content: Markup) -> list[tuple[str, Markup]]:
    """Names and words of the sections of a page."""
    return [(Markup(name), Markup(words)) for name, words in _HEADING.findall(content)]


def run_of(part: str, runs: Sequence[Mapping[str, str]]) -> Markup:
    """The attribute of a part `RUN: part` that names the place of its run."""
    place = next((i for i, run in enumerate(runs) if part.startswith(f"{run['name']}: ")), None)
    return Markup("") if place is None else Markup(f' data-run="{place}"')


def squeezed(text: Markup) -> Markup:
    """Words with one space between them."""
    return Markup(" ").join(text.split())


# ---- tables ----


def keyed(rows: Sequence[Sequence[Any]], keys: Sequence[str]) -> tuple[list[str], list[tuple[Any, ...]]]:
    """Head and rows of a table whose columns are named by keys: in words, numbers in a unit that suits the column.

    Columns without any value are left out.
    """
    cells = [(key, [row[i] for row in rows]) for i, key in enumerate(keys)]
    columns = [column(key, values) for key, values in cells if any(value is not None for value in values) or not rows]
    return [words for words, _ in columns], list(zip(*(values for _, values in columns), strict=True))


def cell(value: Any, first: bool) -> tuple[str, str]:
    """Class and words of a cell; numbers stand right. first: whether it names its row."""
    if value is None or value == "":
        return "empty", "\N{EN DASH}"
    if is_number(value) or (not first and _QUANTITY.fullmatch(str(value))):
        return "number", plain(value)
    return "", "yes" if value is True else "no" if value is False else str(value)


# ---- whatever JSON can hold ----


def records(value: Any, name: str) -> tuple[list[str], list[list[Any]]] | None:
    """Keys and rows of a table, of a list or a mapping of mappings; None of anything else. name: of mapped keys."""
    ones = list(value.values()) if isinstance(value, dict) else value
    if not isinstance(ones, list) or not ones or not all(isinstance(one, dict) for one in ones):
        return None
    keys = list(dict.fromkeys(key for one in ones for key in one))
    rows = [[flat(one.get(key)) for key in keys] for one in ones]
    if isinstance(value, dict):
        return [name, *keys], [[key, *row] for key, row in zip(value, rows, strict=True)]
    return keys, rows


def is_deep(value: Any) -> bool:
    """Whether a value does not fit into a cell."""
    return isinstance(value, dict) or (isinstance(value, list) and any(isinstance(one, dict | list) for one in value))


def flat(value: Any) -> Any:
    """A value that fits into a cell."""
    if isinstance(value, list):
        return ", ".join(plain(flat(one)) for one in value)
    if isinstance(value, dict):
        return ", ".join(f"{key}: {plain(flat(one))}" for key, one in value.items())
    return value


# ---- pictures ----


def uri(path: Path) -> str:
    """A PNG as a data URI."""
    return f"data:image/png;base64,{b64encode(picture(path)).decode()}"


def is_wide(path: Path) -> bool:
    """Whether a PNG is too wide to be read beside another, or on a phone unless it can be moved."""
    width, height = struct.unpack(">II", picture(path)[16:24])
    return bool(width > WIDE * height)


_SOURCES = Path(__file__).parent / "scripts"
LEVEL = 4  # of packing: 0.1 s for plotly's script, and 4 % more than the best
_ESCAPES = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


class Script(NamedTuple):
    """A script, and its hash as policies name it."""

    text: Markup
    hash: str


def packed(content: bytes) -> str:
    """Bytes as text that scripts unpack: zlib, base64."""
    return b64encode(zlib.compress(content, LEVEL)).decode()


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


@cache
def own(*names: str) -> Script:
    """Scripts of ours by name, as one."""
    text = "".join((_SOURCES / f"{name}.js").read_text(encoding="utf-8") for name in names)
    text = f'"use strict";\n(() => {{\n{text}}})();\n'
    return Script(Markup(text), _hash(text))


@cache
def plotly() -> Script:
    """Plotly's script, packed."""
    # Not imported, which would take longer than all else.
    file = distribution("plotly").locate_file("plotly/package_data/plotly.min.js")
    text = Path(str(file)).read_text(encoding="utf-8")
    return Script(Markup(packed(text.encode())), _hash(text))


def data_block(content: Any) -> Markup:
    """JSON for a script, that no text in it can end."""
    text = json.dumps(content, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    for sign, escape in _ESCAPES.items():
        text = text.replace(sign, escape)
    return Markup(text)
