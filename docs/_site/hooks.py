"""Hooks of mkdocs: they add pages of the reference and of the project's READMEs, and copies of files, to the site.

A link from any page to a file of the repository leads to the page made from it, or to a copy of the file (configs,
models, pictures). If the site has neither, the link is replaced by the name of the file.
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
# A file with one of these endings is copied if a page links to it.
COPIED = (".yaml", ".py", ".png", ".gif", ".csv", ".json", ".urdf")
LONG = 30  # a cell with more letters counts as long text
_TD = ('<td data-of="{}"', '<td class="long" data-of="{}"')
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]*)(#[^)\s]*)?\)")


def on_files(files: Files, *, config: Any) -> Files:
    """Add generated pages, the style sheet, the script that searches pages opened from disk, and copied files."""
    for name, text in reference.pages().items():
        files.append(File.generated(config, name, content=text))
    for name, page in PAGES.items():
        files.append(File.generated(config, page, content=(ROOT / name).read_text(encoding="utf-8")))
    for name in ("style.css", "iframe-worker.js"):
        files.append(File.generated(config, name, content=(HERE / name).read_text(encoding="utf-8")))
    texts = [(file.src_uri, file.content_string) for file in files.documentation_pages()]
    for name in sorted({name for page, text in texts for name in _copied(page, text)}):
        files.append(File.generated(config, f"files/{name}", abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, *, page: Any, **_: Any) -> str:
    """The page, with links that lead to pages and files of the site."""
    return _LINK.sub(lambda match: _link(page.file.src_uri, match), markdown)


def on_page_content(html: str, **_: Any) -> str:
    """The page, with tables of text marked, so that a phone shows the cells of a row below each other."""
    return re.sub(r"<table>.*?</table>", _mark_text, html, flags=re.DOTALL)


def _mark_text(match: re.Match[str]) -> str:
    """Mark the long cells of a table of three columns or more, and name its column in each cell.

    The table as a whole is marked if more than a tenth of its cells are long. A table without long cells, with fewer
    columns or with pictures stays as it is.
    """
    head = re.findall(r"<th[^>]*>(.*?)</th>", match[0], flags=re.DOTALL)
    rows = [re.findall(r"<td[^>]*>.*?</td>", row, flags=re.DOTALL) for row in match[0].split("<tr>")[2:]]
    long = [[len(re.sub(r"<[^>]*>", "", cell)) > LONG for cell in row] for row in rows]
    if len(head) < 3 or not any(map(any, long)) or "<img" in match[0]:
        return match[0]
    body = ""
    for row, marks in zip(rows, long, strict=True):
        cells = zip(head, row, marks, strict=True)
        body += "<tr>" + "".join(cell.replace("<td", _TD[mark].format(name), 1) for name, cell, mark in cells) + "</tr>"
    table = f"<table>{match[0].partition('<tbody>')[0].removeprefix('<table>')}<tbody>{body}</tbody></table>"
    words = sum(map(sum, long)) > 0.1 * sum(map(len, long))
    return f'<div class="words">{table}</div>' if words else table


def on_post_build(*, config: Any) -> None:
    """Remove the addresses from which scripts of the theme would fetch code, for old browsers and for diagrams."""
    for script in Path(config["site_dir"]).glob("assets/javascripts/*.js"):
        text = script.read_text(encoding="utf-8")
        script.write_text(re.sub(r"https://unpkg\.com/[^\"']*", "about:blank", text), encoding="utf-8")


def _source(page: str) -> Path:
    """Folder of the repository's file from which a page is made."""
    for name, made in PAGES.items():
        if made == page:
            return (ROOT / name).parent
    return (ROOT / "docs" / page).parent


def _file_of_link(page: str, target: str) -> str | None:
    """Path in the repository of the file to which a link leads; None for addresses, missing files and files outside."""
    if not target or re.match(r"\w+:", target):
        return None
    path = (_source(page) / target).resolve()
    if not path.is_relative_to(ROOT) or not path.exists():
        return None
    return path.relative_to(ROOT).as_posix()


def _copied(page: str, text: str) -> list[str]:
    links = _LINK.findall(text)
    inner = [link for _, words, *_ in links for link in _LINK.findall(words)]
    names = [_file_of_link(page, link[2]) for link in (*links, *inner)]
    return [name for name in names if name and name.endswith(COPIED) and not name.startswith("docs/")]


def _link(page: str, match: re.Match[str]) -> str:
    sign, target, part = match[1], match[3], match[4] or ""
    words = _LINK.sub(lambda inner: _link(page, inner), match[2])  # a picture that is a link
    name = _file_of_link(page, target)
    if name is None or page.startswith("reference/"):
        return match[0]
    up = "../" * page.count("/")
    if name in PAGES:
        return f"{sign}[{words}]({up}{PAGES[name]}{part})"
    if name.startswith("docs/"):
        return f"{sign}[{words}]({up}{name.removeprefix('docs/')}{part})"
    if name.endswith(COPIED):
        return f"{sign}[{words}]({up}files/{name})"
    return words if words.strip("`") == name or "`" in words else f"{words} (`{name}`)"
