"""A whole page: head, style, title, table of contents. It asks nothing of the network and runs no script."""

from __future__ import annotations

import re
from datetime import datetime, timezone
from html import unescape
from importlib import resources

from granular_contact.report.pages.markup import Markup, join, tag

GENERATOR = "granular-contact"
# What the browser is told to allow: what is in the page itself.
POLICY = "default-src 'none'; img-src data:; media-src data:; style-src 'unsafe-inline'"
_HEADING = re.compile(r'<h2 id="([^"]*)">(.*?)</h2>')


def page(title: str, kind: str, status: Markup | None, lead: str, sections: list[Markup | None], version: str) -> str:
    """HTML of a page: a title, what kind of results it shows, how they ended, a few sentences, and sections."""
    content = join(*sections)
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("meta", name="generator", content=GENERATOR),
        tag("meta", http_equiv="Content-Security-Policy", content=POLICY),
        tag("title", f"{title}: {kind}"),
        tag("style", Markup(resources.files(__package__).joinpath("page.css").read_text(encoding="utf-8"))),
    )
    made = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    body = tag(
        "body",
        tag("header", tag("p", kind, class_="kind"), tag("h1", title), status, tag("p", lead, class_="lead")),
        tag("nav", tag("ul", *_contents(content)), aria_label="Contents"),
        tag("main", content),
        tag("footer", f"Written by granular-contact {version}, {made}."),
    )
    return f"<!DOCTYPE html>\n{tag('html', head, body, lang='en')}\n"


def _contents(content: Markup) -> list[Markup]:
    return [tag("li", tag("a", unescape(words), href=f"#{name}")) for name, words in _HEADING.findall(content)]
