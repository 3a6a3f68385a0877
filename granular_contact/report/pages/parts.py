"""Parts of a page: sections, lists of facts, tables, figures."""

from __future__ import annotations

import re
import struct
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from granular_contact.report.pages.folder import FolderError, picture
from granular_contact.report.pages.markup import Markup, join, tag
from granular_contact.report.pages.numbers import column, is_number, label, plain, quantity

WIDE = 2.4  # width to height of pictures that get a row of their own
_QUANTITY = re.compile(r"[\N{MINUS SIGN}+]?\d[\d.e\N{MINUS SIGN}+]*( \S+)?")
_TYPES = {".png": "image/png", ".gif": "image/gif", ".mp4": "video/mp4", ".svg": "image/svg+xml"}


def section(title: str, *content: str | None) -> Markup | None:
    """A section with a heading, which the table of contents finds; None if it has no content."""
    inside = join(*content)
    name = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")
    return tag("section", tag("h2", title, id=name), inside, aria_labelledby=name) if inside else None


def facts(values: Mapping[str, Any]) -> Markup | None:
    """Numbers that stand out, each with its name; what there is none of is left out."""
    items = [
        tag("div", tag("dt", label(key)), tag("dd", quantity(key, value)))
        for key, value in values.items()
        if value is not None
    ]
    return tag("dl", *items, class_="facts") if items else None


def warnings(found: Sequence[str]) -> Markup | None:
    """A box with what a reader must know before the numbers."""
    if not found:
        return None
    words = "Warning" if len(found) == 1 else "Warnings"
    return tag(
        "div", tag("strong", words), tag("ul", *(tag("li", one) for one in found)), class_="warning", role="note"
    )


def keyed_table(caption: str, keys: Sequence[str], rows: Sequence[Sequence[Any]]) -> Markup:
    """A table whose columns are named by keys: these in words, numbers in a unit that suits the whole column."""
    columns = [column(key, [row[i] for row in rows]) for i, key in enumerate(keys)]
    return table(caption, [words for words, _ in columns], list(zip(*(values for _, values in columns), strict=True)))


def table(caption: str, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> Markup:
    """A table with a caption; numbers stand right."""
    columns = tag("tr", *(tag("th", name, scope="col") for name in head))
    body = [tag("tr", *(_cell(value, first=i == 0) for i, value in enumerate(row))) for row in rows]
    whole = tag("table", tag("caption", tag("span", caption)), tag("thead", columns), tag("tbody", *body))
    return tag("div", whole, class_="scroll", tabindex="0", role="region", aria_label=caption)


def _cell(value: Any, *, first: bool) -> Markup:
    name, scope = ("th", "row") if first else ("td", None)
    if value is None or value == "":
        return tag(name, "\N{EN DASH}", scope=scope, class_="empty")
    if is_number(value) or (not first and _QUANTITY.fullmatch(str(value))):
        return tag(name, plain(value), scope=scope, class_="number")
    return tag(name, "yes" if value is True else "no" if value is False else str(value), scope=scope)


def listing(caption: str, values: Mapping[str, Any]) -> Markup | None:
    """A table of two columns: names in words, and values with their units."""
    rows = [tag("tr", tag("th", label(k), scope="row"), tag("td", quantity(k, v))) for k, v in values.items()]
    whole = tag("table", tag("caption", tag("span", caption)), tag("tbody", *rows), class_="listing")
    return tag("div", whole, class_="scroll", tabindex="0", role="region", aria_label=caption) if rows else None


def source(path: Path, words: str) -> Markup:
    """A text file as it is, under a line of words."""
    try:
        content = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        raise FolderError(f"{path}: can't be read as text") from None
    text = tag("pre", tag("code", content), tabindex="0", aria_label=path.name, role="region")
    return join(tag("p", words), text)


def embedded(path: Path) -> str:
    """A file as a data URI."""
    return f"data:{_TYPES[path.suffix]};base64,{b64encode(picture(path)).decode()}"


def figure(path: Path, words: str) -> Markup:
    """A PNG, with words that serve as its caption and for those who can't see it."""
    image = tag("img", src=embedded(path), alt=words)
    width, height = struct.unpack(">II", picture(path)[16:24])
    wide = width > WIDE * height
    if wide:  # too small to read on a phone, unless it can be moved
        image = tag("div", image, class_="scroll", tabindex="0", role="region", aria_label=path.stem)
    return tag("figure", image, tag("figcaption", words), class_="wide" if wide else None)


def figures(paths: Sequence[Path], captions: Mapping[str, str]) -> Markup | None:
    """Pictures beside each other: those with captions by their names first, then the others, which tell their names."""
    found = {path.stem: path for path in paths}
    order = [*(name for name in captions if name in found), *(name for name in found if name not in captions)]
    shown = [figure(found[name], captions.get(name, name.replace("_", " "))) for name in order]
    return tag("div", *shown, class_="figures") if shown else None


def film(path: Path, still: Path | None, words: str) -> Markup:
    """An animation; who wants no motion gets the still picture, as the system's settings say."""
    if path.suffix == ".mp4":
        shown = tag("video", src=embedded(path), controls="", loop="", muted="", playsinline="", aria_label=words)
    else:
        calm = None
        if still is not None:
            calm = tag("source", media="(prefers-reduced-motion: reduce)", srcset=embedded(still))
        shown = tag("picture", calm, tag("img", src=embedded(path), alt=words))
    return tag("figure", shown, tag("figcaption", words), class_="wide")
