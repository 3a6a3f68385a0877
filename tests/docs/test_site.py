"""The documentation builds without a warning and without network, and its reference is complete."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support_browser import DRIVER, Browser
from support_runs import ROOT

import granular_contact
from granular_contact.cli.main import COMMANDS
from granular_contact.config.schema import shapes
from granular_contact.config.schema.space import shapes as shapes_in_space
from granular_contact.laws.catalogue import LAWS

pytestmark = pytest.mark.slow  # building it takes ten seconds
BUILD = "from mkdocs.__main__ import cli; cli(['build', '--strict', '-d', {!r}])"  # (with -q warnings do not count)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site. Strict: a lost link or anchor, or a page in no menu, ends the build."""
    pytest.importorskip("mkdocs")
    pytest.importorskip("mkdocstrings")
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-c", BUILD.format(str(folder))], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def site(built: Path) -> dict[str, str]:
    """Its pages and scripts, by their paths."""
    files = [*built.rglob("*.html"), *built.glob("assets/javascripts/*.js")]
    return {path.relative_to(built).as_posix(): path.read_text(encoding="utf-8") for path in files}


def ids(html: str) -> set[str]:
    return set(re.findall(r'id="([^"]+)"', html))


@pytest.mark.slow
def test_every_public_name_is_in_the_reference(site: dict[str, str]) -> None:
    page = site["reference/python.html"]
    shown = {identifier.rpartition(".")[2] for identifier in ids(page)} | set(re.findall(r"<code>(\w+)</code>", page))
    assert set(granular_contact.__all__) - shown == set()


def test_every_shape_has_a_section_with_a_picture(site: dict[str, str]) -> None:
    for page, kinds in (("shapes", shapes.SHAPES), ("shapes_in_space", shapes_in_space.SHAPES)):
        html = site[f"reference/{page}.html"]
        assert html.count("<svg viewBox=") == len(kinds)
        for cls in kinds.values():
            assert re.sub(r"(?<=[a-z])(?=[A-Z])", "-", cls.__name__).lower() in ids(html)


def test_every_law_key_and_command_has_its_place(site: dict[str, str]) -> None:
    media, run, commands = (site[f"reference/{name}.html"] for name in ("media", "run", "commands"))
    for tag, law in LAWS.items():
        assert f"<code>{tag}</code>" in media
        assert all(f"<code>{field.alias or name}</code>" in media for name, field in law.model_fields.items())
    for key in granular_contact.load("pendulum").scenario.model_dump():
        assert f"<code>{key}</code>" in run
    assert set(COMMANDS) <= ids(commands)


def test_pages_fetch_nothing_from_elsewhere(site: dict[str, str]) -> None:
    assert len(site) > 30
    for name, html in site.items():
        fetched = re.findall(r"""<(?:script|img|iframe|video)[^>]*src=["']?(?:https?:)?//[^"' >]+""", html)
        fetched += re.findall(r"""<link[^>]*href=["']?(?:https?:)?//[^"' >]+""", html)
        assert fetched == [], name
        assert "unpkg.com" not in html, name  # where the theme's scripts would fetch more
    assert any(name.endswith(".js") for name in site)


def test_pages_of_readmes_lead_to_pages_and_copies(site: dict[str, str]) -> None:
    """Links to files of the repository: to the page made of one, to a copy of a config, or none."""
    index, gallery = site["index.html"], site["gallery.html"]
    assert 'href="howto/mechanisms.html"' in index
    assert 'href="files/configs/runner.yaml"' in gallery
    assert all(f'{key}="files/validation/figures/gallery_runner.png"' in gallery for key in ("href", "src"))
    assert Path("README.md").name not in "".join(re.findall(r'href="([^"]*)"', index))


@pytest.mark.slow
@pytest.mark.skipif(DRIVER is None, reason="no chromedriver")
@pytest.mark.parametrize("page", ["index.html", "howto/plate.html"])
def test_pages_opened_from_the_disk_are_searched(built: Path, page: str) -> None:
    typed = """const field = document.querySelector('[data-md-component=search-query]');
        if (!document.querySelector('#__search').checked) document.querySelector('#__search').click();
        field.focus(); field.value = %r;
        for (const kind of ['focus', 'keyup', 'input']) field.dispatchEvent(new Event(kind, {bubbles: true}));"""
    links = "return [...document.querySelectorAll('.md-search-result__link')].map(one => one.href)"
    with Browser() as browser:
        browser.open(built / page, 1200)
        for query in ("grouser", "grousers") * 20:  # what is typed before the index is there is not looked for again
            browser.run(typed % query)
            time.sleep(0.4)
            if addresses := browser.run(links):
                break
        assert (built / "reference/shapes.html").as_uri() in {
            address.partition("?")[0].partition("#")[0] for address in addresses
        }
        assert browser.faults() == []
