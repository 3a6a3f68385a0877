"""Every config runs and gives the number that the gallery shows; every model has its picture there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from PIL import Image

from granular_contact.config import is_fit, is_optimise, is_run, is_sweep, load_sweep
from validation import gallery

PAGE = gallery.PAGE.read_text(encoding="utf-8")
SHOWN = dict(re.findall(r"^\| \[(\w+)\]\(\1\.yaml\) \| .* \| (.*) \|$", PAGE, flags=re.M))
SHOWN |= dict(re.findall(r"<br>\*\*\[(\w+)\]\(\1\.yaml\)\*\*: [^|]*<br>([^|]*) (?=\|)", PAGE))  # below small pictures
ADVICE = "run python validation/gallery.py, and look at what it changed"


# Runs that are repeated with finer facets until they are as right as they ask for: up to their greatest depth alone,
# over which the facets that are chosen are others, so that it is as right as that.
EARLY = {"dropped": ("solver.end_time_s=0.08", 3e-3), "thin_sand": ("solver.end_time_s=0.05", 3e-3)}


@pytest.mark.slow
@pytest.mark.parametrize("name", gallery.names(is_run))
def test_a_config_gives_the_number_shown(name: str) -> None:
    assert name in SHOWN, ADVICE
    # Four digits are shown, good to 5e-4. Round-off of another machine is no more: gravity changed by 1e-9 of itself
    # changes none of these numbers by more than 5e-9, also where a mechanism walks for two seconds.
    *overrides, allowed = EARLY.get(name, (6e-4,))
    entry = gallery.entry(name, overrides=overrides)
    assert entry.results.status.code in ("rest", "end_time")
    # Ours: a tenth of what a run warns of. The works are trapezoidal sums over the accepted steps.
    assert entry.results.summary["energy"]["imbalance_relative"] <= 1e-3
    label, value, unit = split(SHOWN[name])
    now_words, computed, now_unit = split(entry.number)
    assert (label, unit) == (now_words, now_unit), ADVICE
    assert computed == pytest.approx(value, rel=allowed), ADVICE


def split(number: str) -> tuple[str, float, str]:
    label, value, unit = number.rsplit(" ", 2)
    return label, float(value), unit


@pytest.mark.slow
@pytest.mark.parametrize("name", gallery.names(is_sweep))
def test_a_sweep_comes_to_its_end(name: str) -> None:
    """One in eleven, of inputs in which neighbours differ; tests/docs/test_blocks.py runs all of the sensitivity's."""
    done, of = (int(number) for number in re.findall(r"\d+", SHOWN[name]))
    assert done == of == len(load_sweep(gallery.CONFIGS / f"{name}.yaml").cases), ADVICE
    done, of = (int(number) for number in re.findall(r"\d+", gallery.cases(name, every=11)))
    assert done == of


@pytest.mark.slow
def test_the_page_shows_what_there_is_and_no_more() -> None:
    kinds = (is_run, is_sweep, is_optimise, is_fit)
    assert set(SHOWN) == {name for kind in kinds for name in gallery.names(kind)}, ADVICE
    assert {name: SHOWN[name] for name in gallery.names(is_optimise)} == {
        name: gallery.runs(name) for name in gallery.names(is_optimise)
    }
    assert {SHOWN[name] for name in gallery.names(is_fit)} == {gallery.rows(name) for name in gallery.names(is_fit)}
    pictures = re.findall(r"\[!\[([^\]]+)\]\(\.\./(validation/figures/gallery_\w+\.png)\)\]\(\.\./\2\)", PAGE)
    assert len(pictures) == len(gallery.names(is_run))  # a picture each
    assert {name for _, name in pictures} == {
        path.relative_to(gallery.HERE.parent).as_posix() for path in gallery.FIGURES.glob("gallery_*.png")
    }
    for caption, name in pictures:
        path = gallery.HERE.parent / name
        assert caption.endswith(".")
        assert path.stat().st_size < 75_000  # those of space have shades
        with Image.open(path) as image:
            assert image.width >= gallery.WIDTH


def test_the_picture_drawn_now_is_of_the_size_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gallery, "FIGURES", tmp_path)
    entry = gallery.entry("pendulum", gallery.FRAMES)
    path = gallery.draw(entry)
    with Image.open(path) as drawn, Image.open(gallery.HERE / "figures" / path.name) as shown:
        assert drawn.size == pytest.approx(shown.size, rel=0.01)  # versions of Matplotlib measure texts differently


def test_the_comment_of_a_config_is_cut_at_its_first_sentence(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("# Strikes at 61.5 degrees\n# or so. And more.\n#\nmodel: x\n# not this\n")
    assert gallery.comment(path) == "Strikes at 61.5 degrees or so."
    path.write_text("model: x\n")
    assert gallery.comment(path) == ""
