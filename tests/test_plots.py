"""Figures: which there are, that they show the data, and that their labels neither overlap nor leave the page."""

from __future__ import annotations

import dataclasses
import itertools
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from support_figures import sketched
from support_results import REACH, make

from granular_contact.report import figures
from granular_contact.report.figures.mechanism import mechanism
from granular_contact.report.figures.outlines import edge
from granular_contact.report.figures.panels import thin
from granular_contact.report.figures.style import style
from granular_contact.report.units import unit_for
from granular_contact.results import Column, Outline, Results, Snapshot

pytestmark = pytest.mark.slow

CASES: dict[str, dict[str, Any]] = {
    "shallow": {"angle_deg": 22, "rate": 1.75, "flexible": True, "before": 0.008},
    "vacuum": {"medium": False, "stopped": False},
    "failed_1_row": {"rows": 1, "stopped": False},
}
MEDIUM = {"joints", "forces", "energy", "mechanism"}


def two_hinges() -> Results:
    """A second hinge that does as the first one does, mirrored in x so that the link points left."""
    results = make(flexible=True)
    extra = np.column_stack([2 * results["pivot_angle_deg"] + 100, -results["pivot_rate_rad_s"]])
    knee = Column("knee_angle_deg", "angle of shin at knee, relative to thigh, clockwise positive")
    columns = (*results.columns, knee, Column("knee_rate_rad_s", ""))
    mirrored = tuple(
        dataclasses.replace(
            shot, outlines=tuple(dataclasses.replace(o, points=o.points * [-1, 1]) for o in shot.outlines)
        )
        for shot in results.snapshots
    )
    return dataclasses.replace(results, columns=columns, table=np.hstack([results.table, extra]), snapshots=mirrored)


def free_disc() -> Results:
    """A dropped disc: no hinge, no mean rate."""
    results = make()
    keep = [i for i, column in enumerate(results.columns) if "_deg" not in column.name and "rad_s" not in column.name]
    depth = results.summary["max_depth_m"]
    shots = tuple(
        Snapshot(label, at, (Outline("ball", np.array([[0.3, results.surface + 0.01 - sunk]]), 0.02),))
        for label, at, sunk in (("touch", 0.0, 0.0), ("deepest", 0.03, depth), ("end", 0.03, depth))
    )
    columns = tuple(results.columns[i] for i in keep)
    summary = {**results.summary, "angle_at_stop_deg": None}
    return dataclasses.replace(results, columns=columns, table=results.table[:, keep], snapshots=shots, summary=summary)


def walker() -> Results:
    """A body on four legs of arcs with feet, all of which walk up a slope; the medium has a profile."""
    results = make()
    surface = np.array([[0.0, -0.1], [1.0, 0.1]])
    sunk = results.summary["max_depth_m"]
    turn = np.linspace(0.0, np.pi, 12)
    shots = []
    for label, at, x in (("touch", 0.0, 0.2), ("deepest", 0.02, 0.5), ("end", 0.03, 0.8)):
        low = 0.2 * x - 0.1 - (sunk if label == "deepest" else 0.0)
        outlines = [Outline("body", np.array([[x, low + 0.1], [x + 0.2, low + 0.14]]), 0.03)]
        for i, place in enumerate((0.0, 0.05, 0.15, 0.2)):
            hip = np.array([x + place, low + 0.1 + 0.2 * place])
            leg = hip + 0.05 * np.column_stack([np.sin(turn), np.cos(turn) - 1])
            foot = hip - [0, 0.1] + 0.01 * np.array([[-1, 0.5], [1, 0.5], [1, 0], [-1, 0], [-1, 0.5]])
            outlines += [Outline(f"leg{i}", leg, 0.004), Outline(f"foot{i}", foot, 0.0)]
        shots.append(Snapshot(label, at, tuple(outlines)))
    keep = [i for i, column in enumerate(results.columns) if "_deg" not in column.name and "rad_s" not in column.name]
    columns = tuple(results.columns[i] for i in keep)
    return dataclasses.replace(
        results, surface=surface, snapshots=tuple(shots), columns=columns, table=results.table[:, keep]
    )


def chain() -> Results:
    """A pendulum of nine hinges in a medium of two layers on a floor, with six terms of its force."""
    results = make()
    extra, columns = [], list(results.columns)
    for i in range(2, 10):
        extra += [results["pivot_angle_deg"] / i, -results["pivot_rate_rad_s"] / i]
        columns.append(
            Column(f"hinge_{i}_angle_deg", f"angle of link_{i} at hinge_{i}, relative to link_{i - 1}, clockwise")
        )
        columns.append(Column(f"hinge_{i}_rate_rad_s", ""))
    for term in results.terms:
        for component in ("force_x_N", "force_y_N", "moment_Nm"):
            extra.append(0.5 * results[f"{term}_{component}"])
            columns.append(Column(f"second_{term}_{component}", ""))
    table = np.column_stack([results.table, *extra])
    terms = (*results.terms, *(f"second_{term}" for term in results.terms))
    floor = float(results.surface) - 0.04
    return dataclasses.replace(results, columns=tuple(columns), table=table, terms=terms, layers=(0.01,), floor=floor)


def over_time(results: Results, name: str) -> Figure:
    return figures.makers(results)[name]()


def build(case: str) -> Results:
    return {"two_hinges": two_hinges, "free_disc": free_disc, "walker": walker, "chain": chain}.get(
        case, lambda: make(**CASES[case])
    )()


# Each with something that no other has, and the figures that show it; a layout takes a fifth of a second.
SHOWN = {
    "shallow": MEDIUM | {"deflection"},
    "two_hinges": {"joints", "mechanism"},
    "free_disc": {"path", "mechanism"},
    "walker": {"path", "mechanism"},
    "chain": {"joints", "forces", "mechanism"},
}


@pytest.fixture(scope="module", params=SHOWN)
def drawn(request: pytest.FixtureRequest) -> dict[str, Figure]:
    with figures.style(), warnings.catch_warnings():
        warnings.simplefilter("error")
        makers = figures.makers(build(request.param))
        made = {name: makers[name]() for name in SHOWN[request.param]}
        for figure in made.values():
            figure.draw_without_rendering()  # type: ignore[no-untyped-call]
    assert set(makers) == SHOWN[request.param] | {"forces", "energy"} | ({"deflection"} & set(makers))
    return made


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("case", "expected"),
    [
        ("vacuum", {"joints", "energy", "mechanism"}),
        ("failed_1_row", {"mechanism"}),
    ],
)
def test_figures_are_those_with_data_and_pngs_of_printed_width(case: str, expected: set[str], tmp_path: Path) -> None:
    figures.draw(build(case), tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {f"{name}.png" for name in expected}
    for path in tmp_path.iterdir():
        assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
        pixels = imread(path)
        wide = path.stem == "mechanism" and case not in ("vacuum", "failed_1_row")
        assert pixels.shape[1] == int((180 if wide else 88) / 25.4 * 200)  # mm at 200 dpi
        assert 40 / 25.4 * 200 < pixels.shape[0] < 125 / 25.4 * 200
        assert np.ptp(pixels[..., 0]) > 0.5  # something is drawn


def test_nothing_recorded_draws_nothing(tmp_path: Path) -> None:
    results = make()
    figures.draw(dataclasses.replace(results, table=results.table[:0], snapshots=()), tmp_path)
    assert not list(tmp_path.iterdir())


def tick_labels(axis: Axis) -> list[Text]:
    low, high = sorted(axis.get_view_interval())
    ticks = axis.get_major_ticks()
    return [tick.label1 for tick in ticks if low <= tick.get_loc() <= high and tick.label1.get_visible()]


def words_of(figure: Figure) -> list[Text]:
    texts: list[Text] = [text for legend in figure.legends for text in legend.get_texts()]
    for axes in figure.axes:
        texts += tick_labels(axes.xaxis) if axes.xaxis.get_tick_params().get("labelbottom", True) else []
        texts += tick_labels(axes.yaxis)
        texts += [axes.xaxis.label, axes.yaxis.label, axes.title, axes._left_title, *axes.texts]  # type: ignore[attr-defined]
        texts += [axes.xaxis.get_offset_text(), axes.yaxis.get_offset_text()]
        legend = axes.get_legend()
        texts += legend.get_texts() if legend else []
    return [text for text in texts if text.get_text() and text.get_visible()]


def test_words_do_not_overlap_nor_leave_the_page(drawn: dict[str, Figure]) -> None:
    for name, figure in drawn.items():
        page = Bbox.from_bounds(0, 0, *figure.canvas.get_width_height())
        labelled = [(text.get_text(), text.get_window_extent()) for text in words_of(figure)]
        assert len(labelled) > 6
        for text, box in labelled:
            inside = box.x0 >= page.x0 and box.y0 >= page.y0 and box.x1 <= page.x1 and box.y1 <= page.y1
            assert inside, f"{name}: {text!r} leaves the page"
        for (label, box), (other, box2) in itertools.combinations(labelled, 2):
            assert not box.overlaps(box2), f"{name}: {label!r} lies over {other!r}"


def test_overlapping_labels_are_detected() -> None:
    with figures.style():
        figure = over_time(make(), "joints")
        figure.axes[0].text(0, 47, "stray")
        figure.axes[0].text(0, 47, "stray too")
        figure.canvas.draw()  # type: ignore[attr-defined]
        with pytest.raises(AssertionError, match="lies over"):
            test_words_do_not_overlap_nor_leave_the_page({"joints": figure})


def test_the_depth_stands_within_its_panel(drawn: dict[str, Figure]) -> None:
    for axes in drawn["mechanism"].axes[1:]:
        box, frame = axes.texts[-1].get_window_extent(), axes.get_window_extent()
        assert axes.texts[-1].get_text().startswith("depth")
        assert frame.x0 < box.x0
        assert box.x1 < frame.x1
        assert box.y1 < frame.y1


def curve_points(axes: Axes) -> np.ndarray[Any, Any]:
    shown = [line.get_path().vertices for line in axes.lines if line.get_transform() == axes.transData]
    return axes.transData.transform(np.concatenate(shown))


def test_legends_hide_no_data(drawn: dict[str, Figure]) -> None:
    for name in drawn.keys() - {"mechanism"}:
        for axes in drawn[name].axes:
            legend = axes.get_legend()
            if legend is not None:
                box = legend.get_window_extent()
                assert not box.count_contains(curve_points(axes)), f"{name}: legend over a curve"


def test_axes_are_named_with_units_and_have_no_offsets(drawn: dict[str, Figure]) -> None:
    for figure in drawn.values():
        assert figure.axes[-1].get_xlabel().endswith(")")
        for axes in figure.axes:
            assert "(" in axes.get_ylabel()
            assert axes.get_ylabel().endswith(")")
            assert all("e" not in text.get_text() for text in tick_labels(axes.yaxis))
            assert not axes.yaxis.get_offset_text().get_text()


@pytest.mark.parametrize(("speed", "label"), [(1.0, "time (ms)"), (0.01, "time (s)")])
def test_time_unit_follows_the_span(speed: float, label: str) -> None:
    with figures.style():
        assert over_time(make(speed=speed), "joints").axes[-1].get_xlabel() == label


def test_stop_is_drawn_at_its_instant_and_written() -> None:
    results = make(before=0.008)
    with figures.style():
        upper = over_time(results, "joints").axes[0]
    instant = (results.summary["touch_time_s"] + results.summary["stopping_time_s"]) * 1e3
    assert any(np.allclose(line.get_xdata(), instant) for line in upper.lines)
    stop_ms, angle = results.summary["stopping_time_s"] * 1e3, results.summary["angle_at_stop_deg"]
    assert [text.get_text() for text in upper.texts] == ["touch", f"stops after {stop_ms:.4g} ms at {angle:.2f}°"]


def legend_words(axes: Axes) -> list[str]:
    legend = axes.get_legend()
    return [] if legend is None else [text.get_text() for text in legend.get_texts()]


def test_first_and_last_of_many_hinges_are_named() -> None:
    with figures.style():
        upper = over_time(chain(), "joints").axes[0]
    assert legend_words(upper) == ["pivot", "hinge_9"]
    assert len({line.get_color() for line in upper.lines}) >= 9


def test_captions_state_the_pivot_angle_from_any_column() -> None:
    original = two_hinges()
    order = sorted(range(len(original.columns)), key=lambda i: "pivot" in original.columns[i].name)
    moved = dataclasses.replace(
        original, columns=tuple(original.columns[i] for i in order), table=original.table[:, order]
    )
    with figures.style():
        captions = [
            [text.get_text() for text in mechanism(results).legends[0].get_texts()] for results in (original, moved)
        ]
    assert captions[0][0] == "touch: 0 ms, 45.00°"
    assert captions[1] == captions[0]


@pytest.mark.parametrize("flexible", [False, True])
def test_damping_is_drawn_for_a_flexible_link_only(flexible: bool) -> None:
    with figures.style():
        labels = legend_words(over_time(make(flexible=flexible), "energy").axes[0])
    assert "kinetic" in labels
    assert ("dissipated by damping" in labels) == flexible


def test_long_names_of_hinges_stay_within_the_panel() -> None:
    results = two_hinges()
    name = "a_hinge_with_a_rather_long_name"
    columns = tuple(dataclasses.replace(c, name=c.name.replace("knee", name)) for c in results.columns)
    with figures.style():
        figure = over_time(dataclasses.replace(results, columns=columns), "joints")
        figure.canvas.draw()  # type: ignore[attr-defined]
        test_words_do_not_overlap_nor_leave_the_page({"joints": figure})
        test_legends_hide_no_data({"joints": figure})


def test_mechanism_is_to_scale_and_dimensions_the_largest_depth() -> None:
    results = make()
    with figures.style():
        whole, tip = mechanism(results).axes
    depth = results.summary["max_depth_m"] * 1e3
    assert f"depth\n{depth:.2f} mm" in [text.get_text() for text in tip.texts]
    for axes in (whole, tip):
        inch = axes.figure.get_size_inches() * axes.get_position().size  # type: ignore[union-attr]
        scales = np.array([np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())]) / inch
        assert scales[0] == pytest.approx(scales[1], rel=1e-9)
    deepest = [patch for patch in tip.patches if patch.get_zorder() == 5 and isinstance(patch, Polygon)]
    low = min(patch.get_path().vertices[:, 1].min() for patch in deepest)
    assert low == pytest.approx(results.surface * 1e3 - depth, abs=6.35 / 2)  # its rim, by the radius at the most


def test_edge_of_a_bar_has_its_diameter_and_length() -> None:
    slope = np.array([np.cos(0.7), -np.sin(0.7)])
    ring = edge(Outline("bar", np.array([0.0, 0.3, 1.0])[:, None] * slope * REACH, 0.02))
    x, y = np.append(ring, ring[:1], axis=0).T
    area = 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    assert area == pytest.approx(0.02 * REACH, rel=1e-12)


@pytest.mark.parametrize("rows", [10, 2800, 2801, 300_000])
def test_thin_keeps_ends_and_extremes_and_is_small(rows: int) -> None:
    times = np.sort(np.random.default_rng(1).random(rows) ** 6)  # steps of very uneven length
    values = np.random.default_rng(2).normal(size=rows)
    kept = thin(times, values)
    assert len(kept) <= 2800
    assert np.all(np.diff(kept) > 0)
    assert {0, rows - 1, int(values.argmin()), int(values.argmax())} <= set(kept.tolist())
    late = times > 0.5 * times[-1]  # half of the axis, a tenth of the rows: 350 spans keep three or four rows each
    assert late[kept].sum() >= min(350 * 3, 0.9 * late.sum())


@pytest.mark.parametrize(
    ("largest", "name", "factor"),
    [(0.2, "mm", 1e3), (4.5e-5, "µm", 1e6), (1.0, "m", 1.0), (999.0, "m", 1.0), (1e3, "km", 1e-3), (0.0, "m", 1.0)],
)
def test_unit_brings_the_largest_into_one_to_a_thousand(largest: float, name: str, factor: float) -> None:
    unit = unit_for(np.array([0.0, -largest, np.nan]), "m")
    assert unit.name == name
    assert unit.factor == pytest.approx(factor, rel=1e-12)


def test_a_long_run_with_a_gap_is_drawn_by_few_of_its_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a figure costs is its points: curves of 30 000 rows are drawn with as many as can be seen."""
    results = make(flexible=True, rows=30_000)
    results.table[-1, 1:] = np.nan
    points: list[int] = []
    drawn = Line2D.draw

    def counted(line: Line2D, renderer: Any) -> None:
        points.append(len(line.get_xdata()))
        drawn(line, renderer)

    monkeypatch.setattr(Line2D, "draw", counted)
    with sketched():
        figures.draw(results, tmp_path)
    assert {path.stem for path in tmp_path.iterdir()} == MEDIUM | {"deflection"}
    assert len(points) > 20
    assert max(points) <= 3000


# ---- round-off ----


def with_round_off(columns: tuple[str, ...], size: float) -> Results:
    """Results in which these columns are round-off of this size."""
    results = make(flexible=True)
    table, random = results.table.copy(), np.random.default_rng(1)
    for i, column in enumerate(results.columns):
        if column.name.endswith(columns):
            table[:, i] = size * random.normal(size=len(table))
    return dataclasses.replace(results, table=table)


@pytest.mark.parametrize("column", ["imbalance_J", "deflection_m"])
def test_columns_of_round_off_are_not_drawn(column: str) -> None:
    with style():
        shown, true = (
            {axes.get_ylabel() for figure in figures.figures(results).values() for axes in figure.axes}
            for results in (with_round_off((column,), 1e-17), make(flexible=True))
        )
    (lost,) = true - shown
    assert column.split("_")[0] in lost


@pytest.mark.parametrize(
    ("end", "curve", "size"), [("_moment_Nm", "moment", 1e-18), ("force_x_N", "horizontal", 1e-15)]
)
def test_forces_that_are_round_off_have_no_panel(end: str, curve: str, size: float) -> None:
    with style():
        shown, true = (
            [axes.get_ylabel() for axes in over_time(results, "forces").axes]
            for results in (with_round_off((end,), size), make(flexible=True))
        )
    assert shown == [label for label in true if not label.startswith(curve)]
    assert len(shown) == len(true) - 1


def test_energies_that_are_round_off_have_no_curve() -> None:
    with style():
        labels = [
            over_time(results, "energy").axes[0].get_legend_handles_labels()[1]
            for results in (make(flexible=True), with_round_off(("elastic_J",), 1e-17))
        ]
    assert "elastic" in labels[0]
    assert "elastic" not in labels[1]
