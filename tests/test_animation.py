"""Animations: frames even in time with the forces in them, pictures that show both, films that decode."""

from __future__ import annotations

import dataclasses
import shutil
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image
from support_runs import CONFIGS, scenario_of

from granular_contact import cli, report
from granular_contact.errors import FigureWarning
from granular_contact.report.figures import animation, film
from granular_contact.report.figures.outlines import edge
from granular_contact.report.figures.stage import stage_of
from granular_contact.report.figures.style import VERMILION
from granular_contact.results import Outline, Results, Snapshot
from granular_contact.results.frames import RATE, immersed, instants, pace, point_of_action, resample, surface_height
from granular_contact.run import run
from granular_contact.scene import build
from validation import stills

WAYS = ("pendulum", "reduced")


@cache
def filmed(way: str = "pendulum", *overrides: str) -> Results:
    """The pendulum with frames, by the engine or by two modes."""
    if way == "reduced":
        overrides = (*overrides, "method={reduced: {modes: 2}}")
    scenario = scenario_of("pendulum", *overrides)
    return run(build(scenario), scenario, most_frames=31)


@cache
def drawn() -> list[animation.Picture]:
    """The pictures of the pendulum by the engine."""
    return list(animation.pictures(filmed()))


# ---- frames ----


@pytest.mark.parametrize("duration", [3.7e-4, 0.0964, 1.0, 4.0, 59.0])
@pytest.mark.parametrize("most", [2, 61, 151])
def test_instants_are_even_few_enough_and_cover_the_run(duration: float, most: int) -> None:
    at = instants(1.0, 1.0 + duration, most)
    assert len(at) <= most
    steps = np.diff(at)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-6)
    assert at[0] == 1.0
    assert 1.0 + duration <= at[-1] * (1 + 1e-12)
    assert at[-1] < 1.0 + duration + steps[0]
    # Paces are 2.5 apart at the most, so 40 % of the frames at the least are used (and one, and round-off).
    assert len(at) >= 0.4 * (most - 1)


@pytest.mark.parametrize(("duration", "factor"), [(0.0964, 50.0), (0.24, 20.0), (6.0, 1.0), (12.0, 0.5)])
def test_pace_is_what_playing_takes(duration: float, factor: float) -> None:
    at = instants(0.0, duration, 151)
    assert pace(at) == factor
    assert (len(at) - 1) / RATE == pytest.approx(at[-1] * factor, rel=1e-9)


def test_a_run_of_one_row_has_one_frame() -> None:
    assert instants(0.0, 0.0, 151).tolist() == [0.0]
    assert resample(np.zeros(1), np.array([[1.0, 2.0]]), np.zeros(1)).tolist() == [[1.0, 2.0]]
    assert pace([0.0]) == 1.0


def test_resampling_is_exact_for_straight_lines_and_constant_beyond_ends() -> None:
    time = np.array([0.0, 0.1, 0.4, 1.0])
    at = np.array([-1.0, 0.0, 0.05, 0.4, 0.9, 1.0, 2.0])
    resampled = resample(time, np.column_stack([2 * time, -time]), at)
    inside = np.clip(at, 0.0, 1.0)
    np.testing.assert_allclose(resampled, np.column_stack([2 * inside, -inside]), atol=1e-15)


@pytest.mark.parametrize("way", WAYS)
def test_frames_show_the_motion_of_the_table(way: str) -> None:
    results = filmed(way)
    assert len(results.frames) > 10
    time, end = results["time_s"], results["time_s"][-1]
    for frame in results.frames:
        tip = frame.outlines[-1].points[-1]
        at = min(frame.time, end)
        table = [np.interp(at, time, results[name]) for name in ("tip_x_m", "tip_y_m")]
        # Frames follow cubics, the line here is the chord of a step of 0.2 ms, from which an arc of 6 rad/s leaves it
        # by 0.26 m x (1.2e-3)^2 / 8 = 5e-8 m, and vibration of 0.1 mm at 1e3 rad/s by 1e-4 m x 0.2^2 / 8 = 5e-7 m.
        np.testing.assert_allclose(tip, table, atol=6e-7)
    assert results.frames[0].outlines[-1].points[-1][1] - results.frames[-1].outlines[-1].points[-1][1] > 1e-2


@pytest.mark.parametrize("way", WAYS)
def test_forces_are_those_of_the_table_and_act_on_their_line(way: str) -> None:
    results = filmed(way)
    names = ("drag", "horizontal_static", "vertical_static")
    columns = [sum(results[f"{n}_{component}"] for n in names) for component in ("force_x_N", "force_y_N", "moment_Nm")]
    seen = [frame for frame in results.frames if frame.forces]
    assert len(seen) > 10
    checked = 0
    for frame in seen:
        (force,) = frame.forces
        fx, fy, moment = (np.interp(frame.time, results["time_s"], np.asarray(c)) for c in columns)
        np.testing.assert_allclose(force.force, [fx, fy], atol=1e-9)
        assert force.point[1] < results.surface + 1e-9
        # The pivot is the origin. The point is the one of the link's immersed points, 1/32 of it apart, that is nearest
        # to the line of action: off by half of that, and by a tenth of its distance from the middle of some 5 cm.
        if np.hypot(fx, fy) > 0.2:
            beside = (force.point[1] * fx - force.point[0] * fy - moment) / np.hypot(fx, fy)  # moments are clockwise
            assert abs(beside) < 0.5 * 0.24 / 32 + 5e-3
            checked += 1
    assert checked > 10


def test_height_is_level_or_straight_between_corners_and_beyond() -> None:
    np.testing.assert_array_equal(surface_height(-0.1, [0.0, 5.0]), [-0.1, -0.1])
    corners = [[0.0, 0.0], [1.0, 0.5], [2.0, 0.5]]
    np.testing.assert_allclose(surface_height(corners, [-3.0, 0.5, 1.5, 9.0]), [-1.5, 0.25, 0.5, 0.5])
    inclined = Outline("bar", np.array([[0.0, 0.2], [1.0, 0.2]]), 0.01)
    under = immersed([inclined], corners)
    assert 0.4 <= under[:, 0].min() < 0.44  # it enters the slope at 0.4; points are 1/32 apart


def test_an_arrow_starts_at_the_body_where_its_line_of_action_meets_it() -> None:
    bar = np.linspace([0.1, -0.02], [0.14, -0.01], 65)
    for x in bar[:, 0]:
        point = point_of_action(np.array([0.0, 2.0, 2.0 * x]), bar)
        assert point in bar
        # Off by a twentieth of the distance from the middle at the most, see CENTERED, and half a step of the points.
        assert abs(point[0] - x) < 0.05 * 0.0207 + 3.2e-4
    far = point_of_action(np.array([1e-9, 2e-9, -3e-2]), bar)  # the line passes 1e4 km away
    assert far in bar


def test_no_arrow_hangs_in_the_sand_between_two_feet() -> None:
    """The weight of a body on two feet acts in the middle between them, where there is nothing but sand."""
    feet = np.array([[x, y] for x in (0.0, 0.01, 0.2, 0.21) for y in (-0.01, 0.0)])
    point = point_of_action(np.array([0.0, 5.0, 5.0 * 0.105]), feet)
    assert np.min(np.linalg.norm(feet - point, axis=1)) == 0.0


@pytest.mark.parametrize("way", WAYS)
def test_every_arrow_of_a_run_starts_at_a_body_below_the_surface(way: str) -> None:
    results = filmed(way)
    forces = [(frame, force) for frame in results.frames for force in frame.forces]
    assert len(forces) > 10
    for frame, force in forces:
        assert results.surface is not None
        outlines = [outline for outline in frame.outlines if outline.part in force.body.split("+")] or frame.outlines
        assert np.min(np.linalg.norm(immersed(outlines, results.surface) - force.point, axis=1)) == 0.0


def test_a_run_keeps_no_frames_unless_asked_and_is_the_same_with_them() -> None:
    scenario = scenario_of("pendulum")
    plain = run(build(scenario), scenario)
    assert plain.frames == ()
    np.testing.assert_array_equal(plain.table, filmed().table)


def test_frames_in_vacuum_have_no_forces() -> None:
    results = filmed("pendulum", "medium=null", "solver.end_time_s=0.05")
    assert len(results.frames) > 10
    assert not any(frame.forces for frame in results.frames)


# ---- pictures ----


def near(picture: animation.Picture, colour: str, within: int = 12) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Which pixels have a colour."""
    target = np.round(255 * np.array(to_rgb(colour)))
    return np.asarray(np.abs(picture.astype(int) - target).max(axis=2) <= within)


@pytest.mark.slow
@pytest.mark.parametrize("overrides", [(), ("medium=null", "solver.end_time_s=0.05"), ("surface_height_m=-0.2",)])
def test_pictures_are_to_scale(overrides: tuple[str, ...]) -> None:
    """The centre of every part is where the stage says, in its colour."""
    whole = filmed("pendulum", *overrides)
    results = dataclasses.replace(whole, frames=whole.frames[:: len(whole.frames) // 5])
    stage = stage_of(results)
    for frame, picture in zip(results.frames, animation.pictures(results), strict=True):
        assert picture.shape == (stage.height, stage.width, 3)
        middle = frame.outlines[1].points.mean(axis=0)  # RB2, well above the sand
        column = int((middle[0] - stage.left) * stage.scale)
        row = int((stage.top - middle[1]) * stage.scale)
        assert near(picture, animation.STEEL[1])[row, column]
        corners = np.concatenate([edge(outline) for outline in frame.outlines])
        assert np.all(corners > [stage.left, stage.bottom])
        assert np.all(corners < [stage.right, stage.top])
    assert stage.height % 2 == 0


def test_a_slope_is_drawn_where_it_is() -> None:
    results = dataclasses.replace(filmed(), surface=np.array([[0.0, -0.2], [0.3, -0.1]]))
    stage = stage_of(results)
    picture = next(animation.pictures(results))
    for x, aside in ((0.05, -6), (0.05, 6), (0.1, -6), (0.1, 6)):  # px above and below, left and right of the link
        row = int((stage.top - surface_height(results.surface, x)) * stage.scale) + aside
        is_sand = picture[row, int((x - stage.left) * stage.scale), 2] < 225  # blue; of the sky 250
        assert is_sand == (aside > 0)


def test_layers_and_floor_are_drawn_at_their_depths() -> None:
    results = dataclasses.replace(filmed(), layers=(0.02,), floor=float(filmed().surface) - 0.03)
    stage = stage_of(results)
    picture = next(animation.pictures(results)).astype(int)

    def brightness(depth: float) -> float:
        row = int((stage.top - (results.surface - depth)) * stage.scale)
        return float(picture[row - 1 : row + 2, : stage.width // 2].mean())

    assert brightness(-0.01) > brightness(0.01) + 10 > brightness(0.025) + 10 > brightness(0.033) + 30


def long_way(width: float) -> Results:
    """A bar that moves by so many of its lengths."""
    frames = tuple(
        Snapshot("frame", 0.04 * i, (Outline("bar", np.array([[x, 0.1], [x + 0.1, 0.2]]), 0.01),))
        for i, x in enumerate(np.linspace(0.0, 0.1 * width, 21))
    )
    return dataclasses.replace(filmed(), frames=frames, snapshots=frames[:1], surface=0.05)


@pytest.mark.parametrize(("width", "columns"), [(0.2, 2), (3.0, 2), (12.0, 1)])
def test_strips_have_as_many_pictures_in_a_row_as_fit(width: float, columns: int) -> None:
    strip = stills.strip(long_way(width), 4, 1000)
    rows = 4 // columns
    assert strip.shape[1] == columns * (1000 // columns) + (columns - 1) * stills.GAP
    # Between pictures, and nowhere else, there are white lines from side to side.
    white = np.all(strip == 255, axis=(1, 2))
    assert np.sum(white) == (rows - 1) * stills.GAP


def test_a_strip_shows_instants_between_which_the_way_is_equal() -> None:
    frames = long_way(3.0).frames
    hurried = [*frames[:2], *frames[2::6]]
    times = [frame.time for frame in stills.evenly_moved(hurried, 4)]
    assert times[0] == 0.0
    assert times[-1] == hurried[-1].time
    np.testing.assert_allclose(np.diff(times), 0.8 / 3, atol=0.25)  # steps of 0.24 s are all there are


def test_a_strip_is_a_small_png(tmp_path: Path) -> None:
    stills.write_strip(filmed(), tmp_path / "s.png")
    assert (tmp_path / "s.png").stat().st_size < 60_000
    with Image.open(tmp_path / "s.png") as image:
        assert near(np.asarray(image.convert("RGB")), VERMILION).sum() > 50  # the arrows keep their colour


def test_arrows_are_as_long_as_forces_are_strong() -> None:
    results = filmed()
    key = near(drawn()[0], VERMILION).sum()  # nothing has touched yet
    pixels = [near(p, VERMILION).sum() - key for p in drawn()]
    forces = [np.linalg.norm(f.forces[0].force) if f.forces else 0.0 for f in results.frames]
    strongest, mild = int(np.argmax(forces)), int(np.argmin(np.abs(np.array(forces) - 0.5 * max(forces))))
    # A shaft of 4 px and a head of the same size: area grows by the shaft only.
    assert pixels[0] == 0
    assert pixels[strongest] > 1.2 * pixels[mild] > 0


@pytest.mark.slow
def test_a_picture_does_not_depend_on_those_before_it() -> None:
    results = filmed()
    alone = dataclasses.replace(results, frames=(results.frames[0], *results.frames[-1:]))
    # The pace in the corner and the view are another; the sand and the body are not where they differ in nothing.
    last = list(animation.pictures(results))[-1]
    np.testing.assert_array_equal(drawn()[-1], last)
    assert len(list(animation.pictures(alone))) == 2


def wheel(at: float, height: float) -> tuple[Outline, ...]:
    """A closed outline, an arc and a disc, all of which move along."""
    turn = np.linspace(0, 2 * np.pi, 41)
    foot = np.column_stack([at + 0.03 * np.cos(turn), height + 0.02 * np.sin(turn)])
    foot[-1] = foot[0]
    arc = np.column_stack([at + 0.05 * np.cos(turn[:20]), height + 0.1 + 0.05 * np.sin(turn[:20])])
    return Outline("foot", foot, 0.0), Outline("leg", arc, 0.006), Outline("hub", np.array([[at, height + 0.1]]), 0.02)


def test_areas_arcs_and_discs_are_drawn() -> None:
    frames = tuple(Snapshot("frame", 0.04 * i, wheel(0.01 * i, 0.0)) for i in range(5))
    results = dataclasses.replace(filmed(), frames=frames, snapshots=frames[:1], surface=0.0)
    *_, last = animation.pictures(results)
    stage = stage_of(results)
    for outline, (dx, dy), tone in zip(frames[-1].outlines, [(0, 0.01), (0, 0.05), (0, 0)], (0, 1, 0), strict=True):
        x, y = (0.04 + dx, dy) if outline.part == "foot" else (0.04 + dx, 0.1 + dy)
        column, row = int((x - stage.left) * stage.scale), int((stage.top - y) * stage.scale)
        assert near(last, animation.STEEL[tone])[row, column], outline.part


def test_a_corner_keeps_the_width_of_a_bar() -> None:
    """Both legs of a right angle are 2 cm wide; its outer corner is where their outer edges meet."""
    ring = edge(Outline("boom", np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), 0.02))
    corners = {tuple(np.round(point, 12)) for point in ring}
    assert {(0.99, 0.01), (1.01, -0.01)} <= corners
    x, y = np.append(ring, ring[:1], axis=0).T
    assert 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) == pytest.approx(0.04, rel=1e-12)


# ---- films ----


@pytest.mark.slow
def test_a_gif_decodes_to_all_frames_and_is_small(tmp_path: Path) -> None:
    results = filmed()
    film.write(results, tmp_path / "a.gif")
    assert (tmp_path / "a.gif").stat().st_size < 0.6e6  # 3 MB is allowed for twice as many frames
    with Image.open(tmp_path / "a.gif") as image:
        durations = []
        for i, picture in enumerate(drawn()):
            image.seek(i)
            durations.append(image.info["duration"])
            if i % 4:
                continue
            decoded = np.asarray(image.convert("RGB")).astype(int)
            # A palette of a hundred colours: seldom off by much, and by little on average.
            assert np.abs(decoded - picture).mean() < 3.0
            assert np.mean(np.abs(decoded - picture).max(axis=2) > 40) < 1e-2
            assert near(decoded.astype(np.uint8), VERMILION).sum() >= 0.5 * near(picture, VERMILION).sum()
        assert getattr(image, "n_frames", 1) == len(results.frames)
        assert image.info["loop"] == 0
    assert durations[:-1] == [1000 // RATE] * (len(durations) - 1)


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg on this machine")
def test_an_mp4_decodes_to_all_frames(tmp_path: Path) -> None:
    results = filmed()
    film.write(results, tmp_path / "a.mp4")
    ask = ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames,r_frame_rate"]
    printed = subprocess.run(
        [*ask, "-of", "csv=p=0", str(tmp_path / "a.mp4")], capture_output=True, text=True, check=True
    )
    assert printed.stdout.strip() == f"{RATE}/1,{len(results.frames)}"


def test_a_film_of_one_frame_has_one_picture(tmp_path: Path) -> None:
    still = dataclasses.replace(filmed(), frames=filmed().frames[:1])
    film.write(still, tmp_path / "a.gif")
    with Image.open(tmp_path / "a.gif") as image:
        assert getattr(image, "n_frames", 1) == 1


# ---- the command ----


def test_run_animates_and_a_later_run_takes_the_folder_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("granular_contact.results.frames.MOST", 8)
    config = str(CONFIGS / "pendulum_rigid.yaml")
    assert cli.main(["run", config, "--animate", "--no-plots", "--quiet", "--out", str(tmp_path / "r")]) == 0
    assert sorted(p.name for p in (tmp_path / "r").iterdir()) == [
        "animation.gif",
        "motion.json",
        "scenario.yaml",
        "summary.json",
        "timeseries.csv",
    ]
    assert cli.main(["run", config, "--no-plots", "--quiet", "--out", str(tmp_path / "r")]) == 0
    assert not (tmp_path / "r" / "animation.gif").exists()


def test_a_failing_film_costs_only_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(film, "write", fail)
    with pytest.warns(FigureWarning, match=r"animation\.gif is missing, as drawing it failed \(OSError: No space left"):
        report.write(filmed(), tmp_path / "r", figures=False, film="gif")
    assert sorted(p.name for p in (tmp_path / "r").iterdir()) == [
        "motion.json",
        "scenario.yaml",
        "summary.json",
        "timeseries.csv",
    ]


def test_mp4_without_ffmpeg_is_refused_before_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    config = str(CONFIGS / "pendulum_rigid.yaml")
    assert cli.main(["run", config, "--animate-mp4", "--out", str(tmp_path / "r")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "r").exists()
    with pytest.raises(OSError, match="needs ffmpeg, which is not on the path"):
        film.write(filmed(), tmp_path / "a.mp4")
