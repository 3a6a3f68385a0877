"""Pages of several runs draw each quantity once and in one sense, and print no number as zero that is not zero."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from granular_contact.cli.common import print_numbers
from granular_contact.cli.run import _summary
from granular_contact.report.figures import fits, studies
from granular_contact.report.figures.style import style
from granular_contact.report.histories import Curve, Group, Panel, distinct, groups
from granular_contact.report.overlay import History, panels, table
from granular_contact.report.pages.folder import Folder
from granular_contact.report.pages.sweep import content
from granular_contact.results import Results, Status

TIME = np.linspace(0.0, 1.0, 21)


def wheel(slip: float, speed: float = 0.02) -> dict[str, np.ndarray]:
    """Columns of a wheel on a rail and a post: the same motion is told by carriage, rail, post, wheel and sand."""
    wave = np.sin(20.0 * TIME)
    sinkage, pull, load = 0.02 + 0.01 * slip + 1e-3 * wave, slip + 0.1 * wave, 24.0 + 0.2 * wave
    still = np.zeros_like(TIME)
    return {
        "time_s": TIME,
        "rail_position_m": speed * TIME,
        "rail_speed_m_s": still + speed,
        "post_position_m": -sinkage,
        "post_speed_m_s": -0.02 * np.cos(20.0 * TIME),
        "carriage_x_m": speed * TIME,
        "carriage_y_m": still,
        "carriage_vx_m_s": still + speed,
        "carriage_vy_m_s": still,
        "wheel_granular_x_N": pull,
        "wheel_granular_y_N": load,
        "wheel_depth_m": sinkage,
        "wheel_x_m": speed * TIME,
        "wheel_vx_m_s": still + speed,
        "wheel_slip": still + slip,
        "wheel_sinkage_m": sinkage,
        "wheel_drawbar_pull_N": pull,
        "wheel_load_N": load,
        "wheel_torque_Nm": still + 0.1 * slip,
        "static_force_x_N": pull,
        "static_force_y_N": load,
        "depth_m": sinkage,
    }


def test_repeated_columns_are_drawn_once_and_sinkage_in_one_sense() -> None:
    runs = [History(name, wheel(slip)) for name, slip in (("a", 0.2), ("b", 0.5))]
    columns = table(runs)
    shown = {group.name: [panel.title for panel in group.panels] for group in panels(["a", "b"], columns)}
    assert shown["wheel"] == ["slip", "sinkage", "drawbar pull", "load", "torque"]
    assert shown["travel"] == ["carriage, ahead: x"]  # at a constant speed, the same for both
    assert shown["joints"] == ["speed of sliders: post"]
    assert set(shown) == {"wheel", "travel", "joints"}


def test_a_run_in_space_that_stays_in_a_plane_has_the_panels_of_the_others() -> None:
    def body(up: float) -> dict[str, np.ndarray]:
        moved, still = 0.1 * TIME, np.zeros_like(TIME)
        places = {"trunk_x_m": moved, "trunk_y_m": moved**2, "trunk_z_m": still + up * moved}
        velocities = {"trunk_vx_m_s": still + 0.1, "trunk_vy_m_s": 0.2 * moved, "trunk_vz_m_s": still + 0.1 * up}
        return {"time_s": TIME, **places, **velocities, "trunk_yaw_deg": 3.0 * moved}

    for heights in ((0.0, 0.5), (0.0, 0.0)):
        runs = [History(name, body(up)) for name, up in zip("ab", heights, strict=True)]
        (travel,) = panels(["a", "b"], table(runs))
        titles = [panel.title for panel in travel.panels]
        assert titles[:2] == ["trunk, ahead: x", "trunk, to the left: y"]
        assert ("trunk, height: z" in titles) is any(heights)


def test_constant_columns_of_a_run_are_kept_beside_new_ones() -> None:
    results = wheel(0.2)
    column = results.__getitem__
    every = groups(list(results), ["static"], column)
    titles = [panel.title for group in distinct(every, column) for panel in group.panels]
    assert titles == [
        "slip",
        "sinkage",
        "drawbar pull",
        "load",
        "torque",
        "carriage, ahead",
        "carriage, speed",
        "speed of sliders",
    ]
    two = Panel("two", "m", tuple(Curve(name, ((name, 1.0),)) for name in ("wheel_sinkage_m", "carriage_x_m")))
    panel = Panel("one", "m", two.curves[:1])
    assert [p.title for p in distinct([Group("x", "", "", (panel, two))], column)[0].panels] == ["one", "two"]
    assert [p.title for p in distinct([Group("x", "", "", (two, panel))], column)[0].panels] == ["two"]


def sweep(folder: Path, slips: np.ndarray) -> Folder:
    """A folder of a sweep of a wheel, whose speed is given."""
    header = "max_depth_m,forward_speed_m_s,cost_of_transport,wheel.drawbar_pull_N,wheel.sinkage_m"
    head = f"case,wheel.slip,name,status,message,{header}"
    rows = [
        f"c{i},{slip},w,end_time,ended,{0.02 + slip**2},{0.02 * (1 + 1e-15 * i)!r},{1 + slip},{slip},{0.02 + slip**2}"
        for i, slip in enumerate(slips)
    ]
    (folder / "table.csv").write_text("\n".join([head, *rows]) + "\n")
    return Folder(folder, "sweep")


@pytest.mark.slow
def test_page_of_a_wheel_over_slip_omits_repeated_and_constant_curves(tmp_path: Path) -> None:
    folder = sweep(tmp_path, np.array([-0.5, 0.0, 0.5]))
    (tmp_path / "figures").mkdir()
    studies.draw_slip(
        {"": np.array([[-0.5, 0, 0.5], [-1, 0, 1], [0, 1, 2], [0.02, 0.01, 0.02]])},
        tmp_path / "figures" / "wheel_over_slip.png",
    )
    made = content(folder, tmp_path)
    titles = [caption.partition(" of every case")[0] for _, caption in made["pictures"][1:]]
    assert titles == ["Cost of transport"]
    assert [column["label"] for column in made["cases"]["columns"]][:2] == ["slip", "largest depth (mm)"]
    assert made["cases"]["joined"]


def drawn(monkeypatch: pytest.MonkeyPatch, draw, *given, **options):  # type: ignore[no-untyped-def]
    """The figure that a drawing saves."""
    kept = []
    monkeypatch.setattr("granular_contact.report.figures.panels.drawn", nullcontext)
    monkeypatch.setattr("granular_contact.report.figures.panels.save", lambda figure, _: kept.append(figure))
    draw(*given, Path("none.png"), **options)
    return kept[0]


def test_sinkage_grows_upward_in_a_unit_that_suits_it(monkeypatch: pytest.MonkeyPatch) -> None:
    points = np.array([[0.0, 0.5], [1.0, 2.0], [0.1, 0.2], [2e-6, 4e-6]])
    axes = drawn(monkeypatch, studies.draw_slip, {"": points}).axes[2]
    assert axes.get_ylabel() == "sinkage (µm)"
    assert not axes.yaxis_inverted()


@pytest.mark.parametrize("joined", [False, True])
def test_points_are_joined_in_the_order_of_what_was_varied(joined: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    along = np.array([3.0, 1.0, 2.0])
    axes = drawn(monkeypatch, studies.draw, {"bed.x": along}, ("max_depth_m", along), joined=joined).axes[0]
    assert [line.get_xdata().tolist() for line in axes.lines] == ([[1.0, 2.0, 3.0]] if joined else [])


@pytest.mark.parametrize(
    ("varied", "joined"), [("wheel.slip", True), ("wheel.slip,medium.zeta", False), ("medium.scatter.seed", False)]
)
def test_a_page_joins_points_over_one_quantity_that_is_no_seed(varied: str, joined: bool, tmp_path: Path) -> None:
    rows = [f"c{i},{','.join(str(i + k) for k in range(varied.count(',') + 1))},w,end_time,e,{i}" for i in range(3)]
    (tmp_path / "table.csv").write_text("\n".join([f"case,{varied},name,status,message,max_depth_m", *rows]) + "\n")
    assert content(Folder(tmp_path, "sweep"), tmp_path)["cases"]["joined"] is joined


@pytest.mark.parametrize("outliers", [0, 3])
def test_single_residuals_far_off_change_neither_axis_nor_bins(outliers: int) -> None:
    values = np.random.default_rng(1).normal(size=(400, 1))
    values[:outliers] = 40.0
    zero = np.zeros_like(values)
    time = np.linspace(0.0, 1.0, len(values))
    run = fits.RunPicture("a", ("x_m",), np.ones(1), 1.96, values, values, zero, zero, time, time, "time", "s")
    with style():
        left, right = fits.residuals([run], misfit=False).axes
    assert left.get_ylim()[1] == pytest.approx(4.5, rel=0.2)
    assert 15 <= len(right.patches) <= 60  # Freedman and Diaconis: 2 * 1.35 / 400^(1/3) = 0.37 wide, on 9
    assert left.get_title(loc="left") == ("all runs; crosses: 3 beyond these axes" if outliers else "all runs")


def test_no_number_is_zero_to_the_eye(capsys: pytest.CaptureFixture[str]) -> None:
    """A rod of 1 µm."""
    summary = {
        "max_depth_m": 2.6e-7,
        "stopping_time_s": 4e-6,
        "stopping_time_measure": "mean rate",
        "forward_speed_second_half_m_s": 1e-7,
        "links": {"rod": {"strain": 1e-9, "stress_Pa": 2.0}, "wire": {"strain": 2e-9, "stress_Pa": None}},
    }
    results = Results("rod", Status("rest", "at rest"), (), np.zeros((0, 0)), summary, {}, (), None)
    printed = "\n".join(_summary(results, False, "1 s", Path("r")))
    for line in (
        "largest depth   260.0 nm",
        "stopping time   4.000 µs",
        "forward speed   1.000e-07 m/s",
        "2e-07 % at most, at the skin of wire\n",
    ):
        assert line in printed
    print_numbers(
        ["case"],
        [("max_depth_m", "depth mm", 1e3, ".2f"), ("x", "x", 1.0, ".1f")],
        [(["a"], {"max_depth_m": 2.6e-7, "x": 0.0})],
    )
    assert capsys.readouterr().out.split()[-2:] == ["0.00026", "0.0"]
