"""What mkdocs does beside its own: pages of the reference and of the project's READMEs, files of the repository.

A link from any page to a file of the repository goes to the page made of it, or to a copy of the file (configs, models,
pictures); a file that the site has neither of is named in place of a link.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT)]

import reference

# Files of the repository that are pages of the site.
PAGES = {
    "configs/README.md": "gallery.md",
    "examples/README.md": "examples.md",
    "models/README.md": "howto/mechanisms.md",
    "validation/README.md": "studies/index.md",
    "README.md": "index.md",
    "CHANGELOG.md": "about/changes.md",
    "CONTRIBUTING.md": "about/contributing.md",
}
COPIED = (".yaml", ".py", ".png", ".gif", ".csv", ".json", ".urdf")  # of other files of the repository that pages name
LONG = 30  # letters of a cell from which on it is of words
_TD = ('<td data-of="{}"', '<td class="long" data-of="{}"')
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]*)(#[^)\s]*)?\)")


def on_files(files: Files, *, config: Any) -> Files:
    """Add the pages that are made, the style, and the script that lets pages from the disk be searched."""
    for name, text in reference.pages().items():
        files.append(File.generated(config, name, content=text))
    for name, page in PAGES.items():
        files.append(File.generated(config, page, content=(ROOT / name).read_text(encoding="utf-8")))
    for name in ("style.css", "iframe-worker.js"):
        files.append(File.generated(config, name, content=(HERE / name).read_text(encoding="utf-8")))
    texts = [(file.src_uri, file.content_string) for file in files.documentation_pages()]
    for name in sorted({one for page, text in texts for one in _copied(page, text)}):
        files.append(File.generated(config, f"files/{name}", abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, *, page: Any, **_: Any) -> str:
    """The page with links that lead to what the site has."""
    return _LINK.sub(lambda found: _link(page.file.src_uri, found), markdown)


def on_page_content(html: str, **_: Any) -> str:
    """The page with tables of words marked, so that a phone shows the cells of a row below each other."""
    return re.sub(r"<table>.*?</table>", _of_words, html, flags=re.DOTALL)


def _of_words(found: re.Match[str]) -> str:
    """A table of three columns and more with long texts, each cell with the name of its column; others as they are.

    Of numbers beside a few long texts only these are marked.
    """
    head = re.findall(r"<th[^>]*>(.*?)</th>", found[0], flags=re.DOTALL)
    rows = [re.findall(r"<td[^>]*>.*?</td>", row, flags=re.DOTALL) for row in found[0].split("<tr>")[2:]]
    long = [[len(re.sub(r"<[^>]*>", "", cell)) > LONG for cell in row] for row in rows]
    if len(head) < 3 or not any(map(any, long)) or "<img" in found[0]:
        return found[0]
    body = ""
    for row, marks in zip(rows, long, strict=True):
        cells = zip(head, row, marks, strict=True)
        body += "<tr>" + "".join(cell.replace("<td", _TD[mark].format(name), 1) for name, cell, mark in cells) + "</tr>"
    table = f"<table>{found[0].partition('<tbody>')[0].removeprefix('<table>')}<tbody>{body}</tbody></table>"
    words = sum(map(sum, long)) > 0.1 * sum(map(len, long))
    return f'<div class="words">{table}</div>' if words else table


def on_post_build(*, config: Any) -> None:
    """Take the addresses out of the theme's scripts: for old browsers and diagrams they would fetch from there."""
    for script in Path(config["site_dir"]).glob("assets/javascripts/*.js"):
        text = script.read_text(encoding="utf-8")
        script.write_text(re.sub(r"https://unpkg\.com/[^\"']*", "about:blank", text), encoding="utf-8")


def _source(page: str) -> Path:
    """Folder of the file of the repository that a page is made of."""
    for name, made in PAGES.items():
        if made == page:
            return (ROOT / name).parent
    return (ROOT / "docs" / page).parent


def _meant(page: str, target: str) -> str | None:
    """The file of the repository that a link means, relative to its root; None for one within the docs, or none."""
    if not target or re.match(r"\w+:", target):
        return None
    path = (_source(page) / target).resolve()
    if not path.is_relative_to(ROOT) or not path.exists():
        return None
    return path.relative_to(ROOT).as_posix()


def _copied(page: str, text: str) -> list[str]:
    links = _LINK.findall(text)
    found = [_meant(page, one[2]) for one in (*links, *(inner for one in links for inner in _LINK.findall(one[1])))]
    return [name for name in found if name and name.endswith(COPIED) and not name.startswith("docs/")]


def _link(page: str, found: re.Match[str]) -> str:
    sign, target, part = found[1], found[3], found[4] or ""
    words = _LINK.sub(lambda inner: _link(page, inner), found[2])  # a picture that is a link
    name = _meant(page, target)
    if name is None or page.startswith("reference/"):
        return found[0]
    up = "../" * page.count("/")
    if name in PAGES:
        return f"{sign}[{words}]({up}{PAGES[name]}{part})"
    if name.startswith("docs/"):
        return f"{sign}[{words}]({up}{name.removeprefix('docs/')}{part})"
    if name.endswith(COPIED):
        return f"{sign}[{words}]({up}files/{name})"
    return words if words.strip("`") == name or "`" in words else f"{words} (`{name}`)"
