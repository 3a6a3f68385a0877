"""The HTML report: complete, self-contained, safe to build, and readable in a real browser on a phone and on paper."""

from __future__ import annotations

import dataclasses
import json
import os
import re
import shutil
import time
import zlib
from base64 import b64decode, b64encode
from collections import Counter
from collections.abc import Iterator
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from support_browser import DRIVER, Browser
from support_figures import sketched
from support_results import make
from support_runs import CONFIGS, scenario_of

from granular_contact import cli, report
from granular_contact.report.figures.space_views import views
from granular_contact.report.pages import FolderError, html
from granular_contact.report.pages import write as write_page
from granular_contact.report.pages.folder import Bed, Folder
from granular_contact.report.pages.stage import stage
from granular_contact.report.units import column, label, quantity
from granular_contact.results.motion import Bedding, Motion, Part, coarser, motion_of, over_ground
from granular_contact.run import run
from granular_contact.scene import build
from granular_contact.studies import compare

KINDS = ("run", "compare", "sweep", "fit")
FIT = {
    "name": "four impacts",
    "status": "misfit",
    "converged": True,
    "warnings": ["medium.eta_d is at its upper bound"],
    "parameters": {
        "medium.eta_h": {
            "value": 8.1234567,
            "standard_error": 0.123,
            "interval_95": [7.9, 8.4],
            "bounds": [0.8, 80.0],
            "start": 8.0,
            "scale": "log",
            "at_bound": False,
        },
        "medium.eta_d": {
            "value": 65.0,
            "standard_error": None,
            "interval_95": [None, None],
            "bounds": [0.65, 65.0],
            "start": 6.5,
            "scale": "log",
            "at_bound": True,
        },
    },
    "correlation": {"labels": ["medium.eta_h", "medium.eta_d"], "matrix": [[1.0, -0.43], [-0.43, None]]},
    "directions": [{"relative_error": 0.1369, "parts": {"medium.eta_h": 0.9935, "medium.eta_d": 0.01}}],
    "goodness": {"ljung_box_probability": 2e-9, "columns": {"tip_y_m": {"noise": 1e-4, "durbin_watson": 0.4}}},
    "runs": [{"name": "slow", "data": "slow.csv", "rows": 2, "columns": ["tip_y_m"], "unused_columns": []}],
    "something_new": {"deep": {"list": [1, 2.5], "text": "of a later version"}},
    "versions": {"python": "3.11", "granular-contact": "0.1.0"},
}


def made(kind: str, folder: Path) -> Path:
    """A results folder of a kind, made by what makes them for users, as far as it is here."""
    folder.parent.mkdir()
    if kind == "run":
        scenario = scenario_of("pendulum")
        report.write(run(build(scenario), scenario, most_frames=5), folder, film="gif")
    elif kind == "compare":
        compare.write(compare.compare(CONFIGS / "pendulum.yaml", (1,), (2, 4), repeats=1), folder)
    elif kind == "sweep":
        cases = "\n".join(f"  case{i}: {{initial.impact_speed_rad_s: {2 + i}}}" for i in range(3))
        file = folder.parent / "three.yaml"
        file.write_text(f"config: {CONFIGS / 'pendulum_rigid.yaml'}\ncases:\n{cases}\n  still: {{medium: null}}\n")
        assert cli.main(["sweep", str(file), "--workers", "1", "--quiet", "--out", str(folder)]) == 0
    else:
        (folder / "figures").mkdir(parents=True)
        Figure((2.0, 1.0)).savefig(folder / "figures" / "residuals.png")
        (folder / "fit.json").write_text(json.dumps(FIT))
        head = "run,column,time_s,data,model,residual_over_noise\n"
        rows = "slow,tip_y_m,0.0,0.1003,0.1,3.0\nslow,tip_y_m,0.002,0.1,0.1004,-4.0\n"
        (folder / "residuals.csv").write_text(head + rows)
        (folder / "medium.yaml").write_text("from: play_sand\neta_h: 8.1\n")
    return folder


@pytest.fixture(scope="module", autouse=True)
def _coarse() -> Iterator[None]:
    with sketched(dpi=50):
        yield


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A page of each kind."""
    place = tmp_path_factory.mktemp("pages")
    return {kind: write_page(made(kind, place / kind / "results")) for kind in KINDS}


class Outline(HTMLParser):
    """Elements of a page in order, and whether every one of them was closed in turn."""

    VOID = ("meta", "img", "source", "input", "!doctype")

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text: list[str] = []
        self.open: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] not in ("style", "script"):
            self.text.append(data)

    def all(self, name: str) -> list[dict[str, str | None]]:
        return [attributes for element, attributes in self.elements if element == name]


# ---- what is in it ----


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_pages_are_well_formed_and_need_nothing_else(kind: str, pages: dict[str, Path]) -> None:
    outline = Outline(pages[kind].read_text(encoding="utf-8"))
    assert not outline.open
    names = Counter(name for name, _ in outline.elements)
    assert not {"link", "iframe", "object"} & set(names)
    assert not any("src" in attributes for attributes in outline.all("script"))
    for _, attributes in outline.elements:
        for key in ("src", "srcset", "href"):
            assert (attributes.get(key) or "#").startswith(("data:", "#"))
    assert "url(" not in pages[kind].read_text(encoding="utf-8")
    assert names["h1"] == 1
    assert names["table"] == names["caption"] > 0
    assert names["figure"] == names["figcaption"] > 0
    assert all(attributes["alt"] for attributes in outline.all("img"))
    targets = {attributes.get("id") for attributes in outline.all("h2")}
    assert {str(a["href"])[1:] for a in outline.all("a")} == targets
    assert len(targets) == names["h2"] > 3
    assert outline.all("html") == [{"lang": "en"}]


WORDS = {
    "run": ["stopping time", "25.45 ms", "16.31 mm", "Energy audit", "exudyn", "impact_angle_deg: 31", "0.00069 %"],
    "compare": [
        "Cheapest within 1 %",
        "1 mode",
        "FE, 4 elements",
        "error of travel (%)",
        "exudyn",
        "impact_angle_deg: 31",
    ],
    "sweep": ["4 cases: ", "case0", "still", "impact speed (rad/s)", "exudyn", "impact_angle_deg: 31"],
    "fit": [
        "misfit",
        "2 coefficients from 2 instants of 1 measured run: eta_h 8.123 \N{PLUS-MINUS SIGN} 0.12, eta_d 65 (not",
        "the model does not describe the data",
        "medium.eta_d is at",
        "\N{MINUS SIGN}0.43",
        "13.7 %",
        "353.55 µm",  # root mean square of 300 and 400
        "from: play_sand",
        "of a later version",
    ],
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_pages_state_their_purpose(kind: str, pages: dict[str, Path]) -> None:
    text = "".join(Outline(pages[kind].read_text(encoding="utf-8")).text)
    for sentence in WORDS[kind]:
        assert sentence in text


def test_a_run_shows_all_its_figures_and_its_motion_once(pages: dict[str, Path]) -> None:
    """The player shows it: a film in the folder stays there."""
    outline = Outline(pages["run"].read_text(encoding="utf-8"))
    kinds = Counter(str(attributes["src"])[:14] for attributes in outline.all("img"))
    assert kinds == {"data:image/png": 5}
    assert (pages["run"].parent / "animation.gif").exists()
    assert not outline.all("video")


def test_a_failed_run_is_shown_as_failed(tmp_path: Path) -> None:
    results = make(stopped=False)
    summary = results.summary | {"status": "failed", "message": "Newton's method did not converge at 0.01 s"}
    report.write(dataclasses.replace(results, summary=summary), tmp_path / "r", figures=False)
    page = html(tmp_path / "r")
    assert '<span class="status bad">failed</span>' in page
    assert "No stop was found." in page
    assert "Newton&#39;s method did not converge" in page


def test_a_run_that_is_not_usable_is_shown_as_such(tmp_path: Path) -> None:
    results = make()
    report.write(
        dataclasses.replace(results, summary=results.summary | {"usable": False}), tmp_path / "r", figures=False
    )
    assert '<span class="status bad">came to rest, not usable</span>' in html(tmp_path / "r")


def test_failed_cases_of_a_sweep_are_named(tmp_path: Path) -> None:
    lines = [
        "case,initial.impact_speed_rad_s,status,message,stopping_time_s",
        "a,1,rest,fine,0.02",
        "b,2,error,no <b>,",
    ]
    (tmp_path / "table.csv").write_text("\n".join(lines))
    page = html(tmp_path)
    assert '<span class="status bad">1 failed</span>' in page
    assert "no &lt;b&gt;" in page
    assert "1 came to rest, 1 crashed" in page


def test_an_ensemble_is_called_one_and_useless_runs_are_counted(tmp_path: Path) -> None:
    lines = [
        "case,medium.scatter.seed,status,message,stopping_time_s,facets.error,usable",
        "a,1,rest,fine,0.02,0.02,true",
        "b,2,rest,fine,0.03,0.03,false",
    ]
    (tmp_path / "table.csv").write_text("\n".join(lines))
    (tmp_path / "bands.csv").write_text("time_s,depth_m_q05,depth_m_q50\n0,0,0\n1,0.1,0.2\n")
    (tmp_path / "figures").mkdir()
    Image.new("RGB", (4, 4)).save(tmp_path / "figures" / "bands.png")
    page = html(tmp_path)
    assert re.search(
        r'<div class="printed">\s*<figure><img[^>]*The motion: the median', page
    )  # on paper; else as curves
    text = "".join(Outline(page).text)
    assert '<span class="status bad">1 not usable</span>' in page
    assert "Ensemble" in text
    assert "against what varies" not in text  # no figures over seeds, which have no order
    assert "error" not in text.split("Key numbers")[-1].split("Energy audit")[0]


HEAD = "case,initial.impact_speed_rad_s,status,message,stopping_time_s,energy.imbalance_relative,warnings"


def test_numbers_of_a_sweep_are_of_cases_that_came_to_an_end(tmp_path: Path) -> None:
    lines = [
        HEAD,
        "a,1,rest,fine,0.02,1e-5,",
        "b,2,end_time,fine,0.03,2e-5,",
        "c,3,failed,broke off,0.9,7e3,",
        "d,4,time_limit,too late,0.8,6e3,",
    ]
    (tmp_path / "table.csv").write_text("\n".join(lines))
    text = "".join(Outline(html(tmp_path)).text)
    assert "2 cases that did not come to an end are left out" in text
    key, audit = (
        text.split("Key numbers")[-1].split("Figures")[0],
        text.split("Energy audit")[-1].split("Cases, what")[0],
    )
    assert "30 ms" in key
    assert "900 ms" not in key
    assert "0.002 % at most, in case b" in audit


def test_numbers_that_are_the_same_in_all_cases_are_one_line(tmp_path: Path) -> None:
    """A number that one case lacks is none of them; a single case has nothing to differ from."""
    head = "case,initial.impact_speed_rad_s,status,message,stopping_time_s,max_depth_m,max_deflection_m"
    lines = ["a,1,rest,fine,0.02,0.005,0.001", "b,2,rest,fine,0.03,0.005,", "c,3,rest,fine,0.04,0.005,0.001"]
    for count, constant in ((3, "The same in all cases: largest depth 5 mm."), (1, None)):
        (tmp_path / "table.csv").write_text("\n".join([head, *lines[:count]]))
        text = "".join(Outline(html(tmp_path)).text).split("Key numbers")[-1].split("Figures")[0]
        assert ("The same in all cases" in text) == (constant is not None)
        before, _, table = text.partition("Statistics over the cases.")
        assert constant is None or constant in before
        assert ("largest depth" in table) == (constant is None)
        assert "largest deflection" in table


def test_warnings_that_differ_in_numbers_are_one_kind(tmp_path: Path) -> None:
    same = [f"s{i},1,rest,fine,0.02,1e-5,faster than 1.{i} m/s" for i in range(40)]
    others = [f"o{i},1,rest,fine,0.02,1e-5,kind {'x' * i}" for i in range(14)]
    (tmp_path / "table.csv").write_text("\n".join([HEAD, *same, *others]))
    page = html(tmp_path)
    box = re.search(r'class="warning".*?</ul>', page, re.DOTALL)
    assert box is not None
    shown = re.findall("<li>(.*?)</li>", box[0])
    assert shown[0] == "faster than 1.0 m/s (40 of 54 cases, in other cases with other numbers)"
    assert len(shown) == 11
    assert shown[-1] == "... and 5 more kinds, in table.csv"


def test_contacts_travel_and_work_of_a_mechanism_are_reported(tmp_path: Path) -> None:
    results = make()
    more = {
        "stopping_time_s": None,
        "stopping_time_measure": None,
        "distance_m": 0.3432,
        "forward_speed_m_s": 0.2288,
        "cost_of_transport": 3.25,
        "contacts": {"front": [[0.01, 0.02], [0.05, 0.09]], "rear": [[0.1 * i, 0.1 * i + 0.01] for i in range(20)]},
        "energy": {"initial_J": 0.1, "drive_work_J": 3.9, "imbalance_relative": 1e-5},
    }
    report.write(dataclasses.replace(results, summary=results.summary | more), tmp_path / "r", figures=False)
    text = "".join(Outline(html(tmp_path / "r")).text)
    for phrase in (
        "It travelled 343.2 mm, with a mean speed of 0.2288 m/s. Its cost of transport was 3.25.",
        "10 ms to 20 ms; 50 ms to 90 ms",
        "and 12 more",
        "work of drives3.9 J",
    ):
        assert phrase in text
    assert "No stop" not in text


def test_the_player_gets_rigid_parts_as_poses_and_bent_ones_as_points() -> None:
    for bends in (False, True):
        scenario = scenario_of("pendulum" if bends else "pendulum_rigid", "solver.end_time_s=0.02")
        results = run(build(scenario), most_frames=9)
        motion = motion_of(results)
        assert motion is not None
        link = next(i for i, outline in enumerate(results.frames[0].outlines) if outline.part == "link")
        assert [*motion.bent] == [link] * bends
        assert bends or np.ptp(motion.poses[:, link, 2]) > 0.05  # rad
        for i in range(len(motion.parts)):
            drawn = np.array([frame.outlines[i].points for frame in results.frames])
            np.testing.assert_allclose(motion.points(i), drawn, rtol=0.0, atol=1e-6)  # m


def test_results_without_words_of_their_own_show_tables_and_figures(tmp_path: Path, pages: dict[str, Path]) -> None:
    for name, kind in (("compare-media.csv", "Comparison of media"), ("law.png", "Media")):
        folder = tmp_path / kind
        folder.mkdir()
        if name.endswith(".csv"):
            (folder / name).write_text("medium,stopping_time_s\nplay_sand,0.025\n")
        else:
            shutil.copy(pages["run"].parent / "figures" / "joints.png", folder / name)
        page = html(folder)
        assert f'<p class="kind">{kind}</p>' in page
        assert ("stopping time (ms)" in page) == name.endswith(".csv")
        assert ("<img " in page) == name.endswith(".png")


@pytest.mark.slow
def test_several_runs_make_a_gallery(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("one", "two"):
        report.write(make(), tmp_path / name, figures=name == "one")
    write_page(tmp_path / "two")
    assert cli.main(["report", str(tmp_path / "one"), str(tmp_path / "two")]) == 0
    assert capsys.readouterr().out == f"saved in {tmp_path / 'gallery.html'}\n"
    outline = Outline((tmp_path / "gallery.html").read_text(encoding="utf-8"))
    assert not outline.open
    assert [str(element["src"])[:14] for element in outline.all("img")] == ["data:image/png"]
    assert [element["href"] for element in outline.all("a") if not str(element["href"]).startswith("#")] == [
        "two/report.html"
    ]
    assert "stopping time (ms)" in "".join(outline.text)


# ---- how it is built ----


def test_only_our_scripts_run_and_plotly_is_in_the_page(pages: dict[str, Path]) -> None:
    """The policy names the hashes of what is there; a page without curves does without plotly."""
    for kind, count in (("run", 2), ("compare", 2), ("gallery", 1)):
        page = html(pages["run"].parent) if kind == "run" else pages["compare"].read_text(encoding="utf-8")
        page = write_page([pages["run"].parent]).read_text(encoding="utf-8") if kind == "gallery" else page
        policy = re.search(r"default-src 'none'; [^\"]*script-src ([^\"]*)\"", page)
        assert policy is not None
        scripts = re.findall(r"<script([^>]*)>(.*?)</script>", page, re.DOTALL)
        texts = [text for attributes, text in scripts if not attributes]
        texts += [zlib.decompress(b64decode(text)).decode() for attributes, text in scripts if "plotly" in attributes]
        hashes = [f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'" for text in texts]
        assert policy[1].split() == hashes
        assert len(hashes) == count
    assert "unsafe-eval" not in page


def test_whatever_is_written_stays_text(tmp_path: Path) -> None:
    evil = "</p><script>alert('x')</script>\"&amp;"
    pendulum = make()
    summary = pendulum.summary | {"name": evil, "message": evil, "warnings": [evil], "versions": {evil: evil}}
    columns = tuple(dataclasses.replace(column, description=evil) for column in pendulum.columns)
    results = dataclasses.replace(pendulum, summary=summary, columns=columns, scenario={"name": evil})
    report.write(results, tmp_path / "r", figures=False)
    page = html(tmp_path / "r")
    outline = Outline(page)
    assert [pendulum.get("id") for pendulum in outline.all("script")] == ["page-data", "plotly", None]
    assert "".join(outline.text).count(evil) >= len(columns) + 4


@pytest.mark.parametrize(
    ("key", "value", "shown"),
    [
        ("stopping_time_s", 0.0254, "25.4 ms"),
        ("tip_speed_m_s", -1.25, "\N{MINUS SIGN}1.25 m/s"),
        ("max_deflection_m", 1.8889e-4, "188.9 µm"),
        ("energy.imbalance_relative", 3.34e-5, "0.0033 %"),
        ("steps", 482, "482"),
        ("at_bound", True, "yes"),
        ("medium", "play_sand", "play_sand"),
        ("angle_at_stop_deg", None, "none"),
        ("moment_Nm", 2.0, "2 N\N{MIDDLE DOT}m"),
    ],
)
def test_quantities_have_the_unit_of_their_key(key: str, value: object, shown: str) -> None:
    assert quantity(key, value) == shown


def test_keys_are_put_into_words_and_columns_get_one_unit() -> None:
    assert label("initial.impact_angle_deg") == "impact angle"
    assert label("medium.eta_h") == "eta_h"
    heading, values = column("depth_m", [0.011, 0.2, None, "?"])
    assert heading == "depth (mm)"
    assert values[:2] == pytest.approx([11.0, 200.0])
    assert values[2:] == [None, "?"]


# ---- the command ----


def test_the_page_is_saved_in_the_folder_which_stays_a_results_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report.write(make(), tmp_path / "r", figures=False)
    assert cli.main(["report", str(tmp_path / "r")]) == 0
    assert capsys.readouterr().out == f"saved in {tmp_path / 'r' / 'report.html'}\n"
    assert cli.main(["report", str(tmp_path / "r")]) == 0  # over its own
    assert not [path for path in (tmp_path / "r").iterdir() if path.name.startswith(".")]
    report.check_target(tmp_path / "r")
    report.write(make(), tmp_path / "r", figures=False)
    assert not (tmp_path / "r" / "report.html").exists()  # that of an earlier run


def test_another_file_can_be_named_and_no_foreign_one_is_overwritten(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report.write(make(), tmp_path / "r", figures=False)
    out = tmp_path / "page.html"
    assert cli.main(["report", str(tmp_path / "r"), "--out", str(out)]) == 0
    assert out.is_file()
    out.write_text("mine")
    assert cli.main(["report", str(tmp_path / "r"), "--out", str(out)]) == 2
    assert "is not a report of this program" in capsys.readouterr().err
    assert out.read_text() == "mine"
    assert cli.main(["report", str(tmp_path / "r"), "--out", str(tmp_path / "nowhere" / "page.html")]) == 2


@pytest.mark.parametrize("method", ["engine", "minimal"])
def test_a_run_is_viewed_in_the_browser_by_any_method(
    method: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shown: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: bool(shown.append(address)))  # there is none
    line = ["run", "pendulum_rigid", "--method", method, "--view", "--no-plots", "--out", str(tmp_path / "r")]
    assert cli.main([*line, "--set", "medium=null", "--set", "solver.end_time_s=0.02"]) == 0
    page = tmp_path / "r" / "report.html"
    assert shown == [page.as_uri()]
    assert 'id="motion"' in page.read_text(encoding="utf-8")
    assert capsys.readouterr().err.endswith(f"--view: no browser can be opened here; the page is {page}\n")


def broken(folder: Path) -> Iterator[str]:
    """Ways in which a folder can be no results, and what is said then."""
    yield "does not exist"
    folder.mkdir()
    yield "is not a folder of results"
    (folder / "table.csv").write_text("")
    yield "is empty"
    (folder / "table.csv").write_text("case,status\na\n")
    yield "table.csv:2: has 1 cells; 2 are allowed"
    (folder / "table.csv").unlink()
    (folder / "timeseries.csv").touch()
    yield "has no summary.json"
    (folder / "summary.json").write_text("{")
    yield "is not JSON"
    (folder / "summary.json").write_text("[1]")
    yield "is not a JSON object"


def test_broken_folders_are_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for message in broken(tmp_path / "r"):
        assert cli.main(["report", str(tmp_path / "r")]) == 2
        errors = capsys.readouterr().err
        assert message in errors
        assert errors.count("\n") == 1
        assert not (tmp_path / "r" / "report.html").exists()


PNG = "figures/forces.png"
DAMAGES: tuple[tuple[str, bytes, str], ...] = (
    (PNG, b"", "is empty"),
    (PNG, b"\x89PNG\r\n\x1a\n and then no more", "is cut short"),
    (PNG, b"<svg/>", "is not a picture"),
    ("summary.json", b'{"warnings": "none"}', "warnings is not a list"),
    ("summary.json", b'{"energy": 3}', "energy is not an object"),
    ("summary.json", b'{"contacts": []}', "contacts is not an object"),
    ("summary.json", b'{"contacts": {"foot": 3}}', "does not have the form that this program writes"),
    (
        "summary.json",
        b'{"contacts": {"foot": [[1, 2, 3]]}}',
        "does not have the form that this program writes",
    ),
    ("summary.json", b'{"max_depth_m": "deep"}', "does not have the form that this program writes"),
    ("summary.json", b'{"versions": [1]}', "versions is not an object"),
    ("summary.json", b"[" * 100_000, "is not JSON"),
    ("summary.json", b"\xff\xfe", "is not text"),
    ("timeseries.csv", b"time_s,depth_m\n\n", "has no rows"),
    ("scenario.yaml", b"\xff\xfe", "is not text"),
    ("scenario.yaml", b"name: run\nmodel: {bodies: [\n", "scenario.yaml:3: is not valid YAML"),
)


@pytest.fixture(scope="module")
def undamaged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("undamaged") / "run"
    report.write(make(), folder)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(("name", "content", "message"), DAMAGES)
def test_a_damaged_file_is_named(
    undamaged: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, content: bytes, message: str
) -> None:
    shutil.copytree(undamaged, tmp_path / "run")
    (tmp_path / "run" / name).write_bytes(content)
    assert cli.main(["report", str(tmp_path / "run")]) == 2
    errors = capsys.readouterr().err
    assert errors.startswith(f"report: {tmp_path / 'run' / name}")
    assert message in errors
    assert errors.count("\n") == 1


@pytest.mark.parametrize("key", FIT)
@pytest.mark.parametrize("value", [3, "text", [1, [2]], {"a": 1}, None])
def test_a_fit_of_other_types_is_shown_or_named(tmp_path: Path, key: str, value: object) -> None:
    (tmp_path / "fit.json").write_text(json.dumps({**FIT, key: value}))
    try:
        write_page(tmp_path)
    except FolderError as error:
        text = str(error)
    else:
        text = (tmp_path / "report.html").read_text(encoding="utf-8") and str(tmp_path / "fit.json")
    assert str(tmp_path / "fit.json") in text


# ---- in a browser ----

IN_BROWSER = pytest.mark.skipif(DRIVER is None, reason="no chromedriver on this machine (Debian: chromium-driver)")

# Every text with its contrast to what is behind it, as WCAG defines it: the least of all, and whose it is.
CONTRAST = """
const light = c => {
  const [r, g, b] = c.map(v => v / 255).map(v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const colour = text => text.match(/[\\d.]+/g).map(Number);
const behind = element => {
  for (let e = element; e; e = e.parentElement) {
    const c = colour(getComputedStyle(e).backgroundColor);
    if (c.length === 3 || c[3] === 1) return c;
  }
  return matchMedia('(prefers-color-scheme: dark)').matches ? [18, 18, 18] : [255, 255, 255];
};
let least = [99, ''];
for (const e of document.body.querySelectorAll('*')) {
  if (![...e.childNodes].some(n => n.nodeType === 3 && n.data.trim())) continue;
  const [a, b] = [light(colour(getComputedStyle(e).color)), light(behind(e))];
  const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  if (contrast < least[0]) least = [contrast, e.outerHTML.slice(0, 80)];
}
return least;
"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as session:
        yield session


@IN_BROWSER
@pytest.mark.parametrize("kind", KINDS)
def test_pages_are_read_on_every_window_by_day_by_night_and_on_paper(
    kind: str, pages: dict[str, Path], browser: Browser
) -> None:
    """Loaded once, as a reader does who turns a phone, or prints what is open."""
    browser.media()
    browser.open(pages[kind], 390)
    for width in (390, 768, 1400):
        browser.resize(width)
        assert_it_fits(browser, width)
    for scheme in ("light", "dark"):
        browser.media(prefers_color_scheme=scheme)
        contrast, where = browser.run(CONTRAST)
        assert contrast >= 4.5, where  # WCAG 2, level AA
        paper = browser.run("return getComputedStyle(document.body).backgroundColor")
        assert (sum(map(int, re.findall(r"\d+", paper)[:3])) < 200) == (scheme == "dark")
    assert_it_prints(browser)


def assert_it_fits(browser: Browser, width: int) -> None:
    """A page within a window of so many px, with all of its pictures."""
    assert browser.run("return document.documentElement.scrollWidth") <= width
    shown = browser.run("return [...document.images].map(i => i.complete && i.naturalWidth > 100 && i.width > 100)")
    assert shown
    assert all(shown)
    asked = browser.run("return performance.getEntriesByType('resource').map(e => e.name.slice(0, 5))")
    assert set(asked) <= {"data:"}
    # What a table is of is read without moving it.
    ends = browser.run(
        "return [...document.querySelectorAll('caption span')].map(e => e.getBoundingClientRect().right)"
    )
    assert ends
    assert max(ends) <= width
    # Words are large enough to read, and links to hit.
    assert browser.run("return parseFloat(getComputedStyle(document.body).fontSize)") >= 16
    links = "[...document.links].filter(a => a.offsetParent)"  # the chart has one when it is drawn
    assert min(browser.run(f"return {links}.map(a => a.getBoundingClientRect().height)")) >= 24


def assert_it_prints(browser: Browser) -> None:
    """By day though the system is dark, without what is to be clicked, all of it on the paper."""
    browser.media("print", prefers_color_scheme="dark")
    browser.resize(700)  # about what A4 leaves within its margins, in px
    contrast, where = browser.run(CONTRAST)
    assert contrast >= 4.5, where
    assert browser.run("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert browser.run("return getComputedStyle(document.querySelector('nav')).display") == "none"
    hidden = "return [...document.querySelectorAll('pre, .scroll')].map(e => e.scrollHeight - e.clientHeight)"
    assert max(browser.run(hidden)) <= 1
    wide = "return [...document.querySelectorAll('table, img')].map(e => e.getBoundingClientRect().right)"
    assert max(browser.run(wide)) <= 701
    pdf = browser.pdf()
    assert pdf.startswith(b"%PDF")
    assert len(pdf) > 20_000


def opened(browser: Browser, page: Path) -> None:
    """A page whose scripts have done their work."""
    browser.media()
    browser.faults()
    browser.open(page, 1300)
    for _ in range(200):
        if browser.run(
            "return document.documentElement.classList.contains('draws') && !document.querySelector('#plotly')"
        ):
            break
        time.sleep(0.05)
    assert browser.faults() == []


@IN_BROWSER
def test_the_player_moves_mechanism_cursor_and_numbers_together(pages: dict[str, Path], browser: Browser) -> None:
    opened(browser, pages["run"])
    table = np.genfromtxt(pages["run"].parent / "timeseries.csv", delimiter=",", names=True)
    motion = json.loads((pages["run"].parent / "motion.json").read_text(encoding="utf-8"))
    ruler, labels = browser.run(
        """return [document.querySelector('#stage .ruler path').getAttribute('d'),
                   document.querySelector('#stage > text.words').textContent]"""
    )
    px, (length, unit) = float(re.findall(r"M-([\d.]+) ", ruler)[0]), labels.split()
    scale = px / (float(length) * {"mm": 1e-3, "m": 1.0}[unit])  # px of a metre
    for share in (0.0, 0.37, 1.0):
        at = motion["time_s"][0] + share * (motion["time_s"][-1] - motion["time_s"][0])
        seen = browser.run(
            f"""const slider = document.querySelector('input[type=range]');
            slider.value = {at}; slider.dispatchEvent(new Event('input'));
            return [document.querySelectorAll('#stage .part')[1].getAttribute('transform'),
                    [...document.querySelectorAll('.panel')].map(p => [p.querySelector('h3').textContent,
                        p.querySelector('.key b').textContent.replace('\N{MINUS SIGN}', '-')])]"""
        )
        x = np.interp(at, motion["time_s"], [poses[1][0] for poses in motion["poses"]])
        assert float(re.findall(r"-?\d[-\d.e]*", seen[0])[0]) == pytest.approx(scale * x, abs=1e-3)
        numbers = dict(seen[1])
        angle = np.interp(at, table["time_s"], table["pivot_angle_deg"])
        assert float(numbers["angle of joints (deg)"]) == pytest.approx(angle, rel=1e-3)
    # Where the pointer is over a curve is the instant of all.
    last = browser.run(
        """const plot = document.querySelector('.plot.js-plotly-plot'), box = plot.getBoundingClientRect();
        const clientX = box.left + 62 + (box.width - 74) / 2; // the middle, between its margins
        plot.dispatchEvent(new PointerEvent('pointermove', {clientX, bubbles: true}));
        return Number(document.querySelector('input[type=range]').value)"""
    )
    assert last == pytest.approx(0.5 * (table["time_s"][0] + table["time_s"][-1]), rel=0.02)


@IN_BROWSER
def test_tables_sort_and_the_whole_series_is_saved(pages: dict[str, Path], browser: Browser) -> None:
    opened(browser, pages["run"])
    saved = browser.run(
        """let kept; URL.createObjectURL = blob => (kept = blob, 'blob:'); HTMLAnchorElement.prototype.click = () => {};
        [...document.querySelectorAll('#files button')].find(b => b.textContent === 'timeseries.csv').click();
        return kept.text()"""
    )
    original = (pages["run"].parent / "timeseries.csv").read_text(encoding="utf-8")
    assert saved.splitlines()[0] == original.splitlines()[0]
    numbers = [np.array([line.split(",") for line in text.splitlines()[1:]], float) for text in (saved, original)]
    np.testing.assert_allclose(*numbers, rtol=6e-7)
    sort = """const head = [...document.querySelectorAll('th')].find(h => h.textContent.startsWith('value'));
    head.querySelector('button').click();
    return [...head.closest('table').tBodies[0].rows].map(r => r.cells[1].textContent)"""
    scale = {"J": 1.0, "mJ": 1e-3, "µJ": 1e-6, "nJ": 1e-9}
    up, down = (
        [float(text.replace("\N{MINUS SIGN}", "-").split()[0]) * scale[text.split()[1]] for text in browser.run(sort)]
        for _ in range(2)
    )
    assert up == sorted(up)
    assert down == up[::-1]


@IN_BROWSER
def test_models_are_compared_on_one_clock(pages: dict[str, Path], browser: Browser) -> None:
    """Curves, differences and drawings of all models at one instant are those of the saved histories."""
    opened(browser, pages["compare"])
    table = np.genfromtxt(pages["compare"].parent / "histories.csv", delimiter=",", names=True, deletechars="")
    at = 0.6 * float(table["time_s"][np.isfinite(table["1_mode.pivot_angle_deg"])][-1])
    read = """const slider = document.querySelector('input[type=range]');
        slider.value = %r; slider.dispatchEvent(new Event('input'));
        return Object.fromEntries([...document.querySelectorAll('.panel')].map(p => [p.querySelector('h3').textContent,
            [...p.querySelectorAll('.key b')].map(b => Number(b.textContent.replaceAll('\u2212', '-')))]))"""
    browser.run("document.querySelectorAll('.panel')[1].scrollIntoView({behavior: 'instant'})")
    for _ in range(100):  # what is looked at is drawn
        seen = browser.run(read % at)
        if seen["angle of joints: pivot, less FE, 4 elements (deg)"][0]:
            break
        time.sleep(0.05)
    names = ("1_mode", "FE_2_elements", "FE_4_elements")
    angles = [np.interp(at, table["time_s"], table[f"{name}.pivot_angle_deg"]) for name in names]
    assert seen["angle of joints: pivot (deg)"] == pytest.approx(angles, rel=1e-3)
    away = np.array(angles[:2]) - angles[2]
    assert seen["angle of joints: pivot, less FE, 4 elements (deg)"] == pytest.approx(away, rel=2e-3, abs=1e-9)
    hide = """document.querySelector('#runs input').click();
        return [...document.querySelectorAll('#stage .part')].map(p => [p.dataset.run, p.style.display])"""
    parts = browser.run(hide)
    assert {run for run, _ in parts} == {"0", "1", "2"}
    assert {run for run, display in parts if display == "none"} == {"0"}
    assert browser.faults() == []


@IN_BROWSER
@pytest.mark.parametrize("kind", ["sweep", "fit"])
def test_rows_and_points_of_a_chart_belong_together(kind: str, pages: dict[str, Path], browser: Browser) -> None:
    opened(browser, pages[kind])
    drawn = browser.run("return document.querySelector('#cases-chart .plot').data[0].x.length")
    assert drawn == {"sweep": 4, "fit": 2}[kind]
    if kind == "sweep":
        pointed = """const rows = [...document.querySelectorAll('tbody tr')];
            const row = rows.find((one) => one.cells[0].textContent === 'case1');
            row.dispatchEvent(new PointerEvent('pointerenter'));
            const told = document.querySelector('#cases-chart output').textContent;
            return [document.querySelectorAll('tr.pointed').length, told]"""
        assert browser.run(pointed) == [1, "case1"]
    assert browser.faults() == []


def spun() -> Motion:
    """A block that moves ahead and turns by half a turn about the vertical, with a force on it."""
    corners = np.array([[x, y, z] for x in (-0.03, 0.03) for y in (-0.02, 0.02) for z in (-0.01, 0.01)])
    faces = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6]])
    share = np.linspace(0.0, 1.0, 11)
    half = 0.5 * np.pi * share
    flat, zero = 0.1 * share, np.zeros(11)
    poses = np.column_stack([flat, zero, zero + 0.05, np.cos(half), zero, zero, np.sin(half)])[:, None]
    force = {"block": (poses[:, 0, :3], np.column_stack([zero, zero, zero + 2.0]))}
    moved = Motion(np.linspace(0.0, 0.03, 11), (Part("block", corners, faces),), poses, {}, force)
    return over_ground(moved, lambda x, y: 0.1 * x + 0.0 * y, level=False)


def test_a_motion_in_space_is_saved_and_fine_meshes_are_made_coarser(tmp_path: Path) -> None:
    moved = spun()
    report.write(dataclasses.replace(make(), motion=moved), tmp_path / "r", figures=False)
    reread = Folder(tmp_path / "r", "run").motion()
    assert reread is not None
    assert reread.in_space
    np.testing.assert_allclose(reread.points(0), moved.points(0), atol=1e-7)
    # Half a turn about the vertical: what was behind is ahead, 0.1 m further.
    np.testing.assert_allclose(reread.points(0)[-1, 0], [0.13, 0.02, 0.04], atol=1e-6)
    turn, height = np.meshgrid(np.linspace(0, 2 * np.pi, 201), np.linspace(0, 1, 101))
    points = np.column_stack([np.cos(turn.ravel()), np.sin(turn.ravel()), height.ravel()])
    rows = np.arange(100)[:, None] * 201 + np.arange(200)
    faces = np.concatenate([np.stack([rows, rows + 1, rows + 202], -1).reshape(-1, 3)])
    fewer = coarser(Part("tube", points, faces), 500)
    assert fewer.faces is not None
    assert 50 < len(fewer.faces) <= 500
    assert np.abs(np.hypot(*fewer.points[:, :2].T) - 1.0).max() < 0.2


def test_the_ground_in_space_goes_on_to_the_margins_of_the_pictures() -> None:
    """Of a block that falls from far above: the margin is a part of the height, too."""
    moved = spun()
    poses = moved.poses.copy()
    poses[:, 0, 2] += np.linspace(1.0, 0.0, 11)
    moved = over_ground(dataclasses.replace(moved, poses=poses), lambda x, _y: 0.0 * x, level=True)
    assert moved.ground is not None
    figure = views(make(), moved)
    for axes, along in zip(figure.axes, moved.ground[:2], strict=False):
        low, high = axes.get_xlim()
        assert axes.get_xlabel().endswith("(m)")
        assert along[0] <= low < high <= along[-1]


RENDERER = """const gl = document.createElement('canvas').getContext('webgl');
const told = gl && gl.getExtension('WEBGL_debug_renderer_info');
return gl ? gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER) : ''"""


@IN_BROWSER
def test_the_player_in_space_moves_its_bodies(tmp_path: Path, browser: Browser) -> None:
    """With a graphics card, or where GC_SOFTWARE_GL is set: without one a picture takes seconds of processor time."""
    renderer = browser.run(RENDERER)
    if not renderer or ("SwiftShader" in renderer and "GC_SOFTWARE_GL" not in os.environ):
        pytest.skip(f"no WebGL by a graphics card here ({renderer or 'none at all'})")
    moved = dataclasses.replace(spun(), bedding=Bedding((0.01,), -0.05, ((0, 0.1),)))
    report.write(dataclasses.replace(make(), motion=moved, frames=()), tmp_path / "r", figures=False)
    opened(browser, write_page(tmp_path / "r"))
    browser.run(
        """const slider = document.querySelector('input[type=range]');
        slider.value = 0.03; slider.dispatchEvent(new Event('input'));"""
    )
    for _ in range(200):  # it draws when it can
        x, y, z = browser.run(
            "const one = document.querySelector('#space').data[0]; return [one.x[0], one.y[0], one.z[0]]"
        )
        if x > 0.1299:
            break
        time.sleep(0.05)
    assert [x, y, z] == pytest.approx([0.13, 0.02, 0.04], abs=1e-6)
    sizes = browser.run(
        """const scene = document.querySelector('#space')._fullLayout.scene;
        const span = ([low, high]) => high - low;
        return ['x', 'y', 'z'].map((name) => span(scene[`${name}axis`].range) / scene.aspectratio[name]);"""
    )
    assert max(sizes) == pytest.approx(min(sizes), rel=1e-9)  # one scale for all axes
    kinds = browser.run("return document.querySelector('#space').data.map(t => t.type)")
    assert kinds == ["mesh3d", "scatter3d", "scatter3d", "surface", *["surface"] * 3]
    named = "return document.querySelector('#space').data.slice(4).map(t => [t.name, t.x.flat()[0], t.z.flat()[0]])"
    # A layer 10 mm below the rising surface, the floor, and a wall from the floor up.
    (layer, x, z), (floor, _, at), (wall, place, foot) = browser.run(named)
    assert (layer, floor, wall) == ("layer", "floor", "wall")
    assert z == pytest.approx(0.1 * x - 0.01, abs=1e-6)
    assert (at, place, foot) == (-0.05, 0.1, -0.05)
    assert browser.faults() == []


@pytest.mark.slow
@IN_BROWSER
def test_a_foreign_script_is_not_run(pages: dict[str, Path], browser: Browser) -> None:
    opened(browser, pages["run"])
    add = "const s = document.createElement('script'); s.textContent = 'window.evil = 1'; document.body.append(s);"
    assert browser.run(f"{add} return window.evil === undefined") is True
    assert any("Content Security Policy" in fault for fault in browser.faults())


@pytest.mark.slow
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e3])
def test_the_player_in_the_plane_draws_any_size_in_pixels(size: float) -> None:
    """In metres browsers do not draw what is micrometres long."""
    bar = Part("rod", size * np.array([[-0.5, 0.0], [0.5, 0.0]]), None, 0.1 * size)
    poses, force = np.zeros((2, 1, 3)), (np.zeros((2, 2)), np.ones((2, 2)))
    poses[1, 0, :2] = 0.2 * size
    drawing = stage(
        Motion(np.array([0.0, 1.0]), (bar,), poses, {}, {"rod": force}), Bed(-0.1 * size), 0, poses[:, 0, :2]
    )
    (part,) = drawing["parts"]
    left, right = (float(x) for x in re.findall(r"[ML]([-\d.e]+) ", part["line"]))
    assert right - left == pytest.approx(10 * part["size"], rel=1e-5)  # six digits are written
    assert 0.6 * drawing["width"] < right - left < drawing["width"]
    assert drawing["motion"].poses[1, 0, 0] == pytest.approx(2 * part["size"])
    assert drawing["left"] < left < right < drawing["left"] + drawing["width"]
    assert float(re.findall(r" ([-\d.e]+)", drawing["sand"]["surface"])[0]) == pytest.approx(-part["size"], rel=1e-5)
    assert drawing["bar"]["words"] == {1e-6: "200 nm", 1.0: "200 mm", 1e3: "200 m"}[size]
