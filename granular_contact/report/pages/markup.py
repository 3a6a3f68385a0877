"""Markup that can't be broken by what is written in it: every text is escaped, except what is markup already."""

from __future__ import annotations

from html import escape

VOID = {"img", "meta", "source"}


class Markup(str):
    """Text that is HTML already."""

    __slots__ = ()


def tag(name: str, /, *content: str | None, **attributes: str | None) -> Markup:
    """An element. A content or an attribute that is None is left out; `class_` is class, `aria_label` aria-label."""
    written = "".join(
        f' {key.strip("_").replace("_", "-")}="{escape(value, quote=True)}"'
        for key, value in attributes.items()
        if value is not None
    )
    inside = join(*content)
    return Markup(f"<{name}{written}>" if name in VOID else f"<{name}{written}>{inside}</{name}>")


def join(*content: str | None) -> Markup:
    """Contents one after the other."""
    return Markup("".join(part if isinstance(part, Markup) else escape(part) for part in content if part is not None))
