"""Requirements of a release: one version, in changelog and citation too."""

from __future__ import annotations

import re
import subprocess

import pytest
import yaml
from support_runs import ROOT

from granular_contact import __version__


def test_changelog_and_citation_are_of_this_version() -> None:
    """On the way to a version, which `.dev0` marks, the changelog has it without a day and the citation as it is."""
    first = re.search(r"^## (\S+) \((.+)\)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert re.fullmatch(r"\d+\.\d+\.\d+(\.dev0)?", __version__)
    assert first is not None
    assert first[1] == __version__.removesuffix(".dev0")
    assert citation["version"] == __version__
    if __version__.endswith(".dev0"):
        assert first[2] == "not yet released"
        assert "date-released" not in citation
    else:
        assert str(citation["date-released"]) == first[2]


def test_citation_has_its_required_keys_and_the_licence_of_the_project() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= citation.keys()
    (author,) = citation["authors"]
    assert f"(c) 2026, {author['name']}" in (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert f'license = "{citation["license"]}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_links_of_the_package_description_are_absolute() -> None:
    (name,) = re.findall(r'^readme = "(.+?)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.M)
    links = re.findall(r"\]\((.*?)\)", (ROOT / name).read_text(encoding="utf-8"))
    assert links
    assert all(link.startswith("https://") for link in links)


def test_version_differs_from_released_tags_after_a_release() -> None:
    command = ["git", "tag", "--no-contains", "HEAD"]
    tags = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if tags.returncode:
        pytest.skip("no git here, as in a source package")
    assert f"v{__version__}" not in tags.stdout.split()
