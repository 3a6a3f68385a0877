"""Every study works with every kind of model, or is refused in one sentence."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from support_figures import sketched
from support_studies import MODELS, PAGE, REFUSALS, STUDIES, Case, Refused, page

from granular_contact.cli import many
from granular_contact.errors import GranularContactError
from granular_contact.studies.sweep import WorkerPool

pytestmark = pytest.mark.slow

MOST = 400  # letters of a sentence


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a model, in which its run is made once."""
    root = tmp_path_factory.mktemp("models")

    def folder(model: str) -> Path:
        made = root / model.replace(" ", "_")
        made.mkdir(exist_ok=True)
        return made

    return folder


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("study", STUDIES)
def test_every_study_of_every_model_works_or_is_refused_clearly(
    study: str,
    model: str,
    folders: Callable[[str], Path],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(many, "pool", lambda *_: WorkerPool(1, ThreadPoolExecutor))  # processes would take seconds
    monkeypatch.setattr("granular_contact.results.frames.MOST", 2)  # pictures of a film
    case = Case(model, folders(model), lambda: capsys.readouterr().err)
    wanted = REFUSALS.get((study, model))
    try:
        with sketched():
            STUDIES[study](case)
        sentence = None
    except (Refused, GranularContactError) as refused:
        sentence = str(refused)
    if wanted is None:
        assert sentence is None
    else:
        assert sentence is not None
        assert wanted in sentence
        assert len(sentence.splitlines()) == 1
        assert len(sentence) < MOST


def test_the_page_shows_this_table() -> None:
    """After a change: python tests/support_studies.py."""
    assert PAGE.read_text(encoding="utf-8") == page()
