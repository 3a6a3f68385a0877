"""The engine's viewer: refused without a display, and showing the run with one."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import exudyn as exu
import numpy as np
import pytest
from exudyn.basicUtilities import SetSolutionState
from support_runs import CONFIGS, ROOT, scene_of

from granular_contact import cli
from granular_contact.engines.exudyn import viewer
from granular_contact.engines.exudyn.build import System, build
from granular_contact.engines.exudyn.solve import solve
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.system import Trajectory
from granular_contact.results import Outline
from granular_contact.scene.parts import InitialMotion

CONFIG = str(CONFIGS / "pendulum.yaml")


@pytest.fixture(scope="module")
def solved() -> tuple[System, Trajectory]:
    system = build(scene_of("pendulum"))
    return system, solve(system)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere there is always a display")
@pytest.mark.parametrize("display", [None, ":987"])
def test_viewing_without_a_display_is_refused_before_the_run(
    display: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    if display is not None:
        monkeypatch.setenv("DISPLAY", display)
    assert cli.main(["run", CONFIG, "--exudyn-viewer", "--out", str(tmp_path / "r")]) == 2
    errors = capsys.readouterr().err
    assert errors.startswith("--exudyn-viewer: ")
    assert errors.count("\n") == 1
    assert not (tmp_path / "r").exists()


def test_a_reduced_model_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["run", CONFIG, "--exudyn-viewer", "--modes", "0", "--out", str(tmp_path / "r")]) == 2
    assert "shows runs with method engine" in capsys.readouterr().err


def test_viewer_plays_the_trajectory(solved: tuple[System, Trajectory]) -> None:
    system, trajectory = solved
    solution = viewer.solution_data(system, trajectory.time, trajectory.q, trajectory.v)
    observer = Kinematics(system, trajectory)
    tip = system.links["link"].nodes[-1]
    for row in (0, 100, len(trajectory.time) - 1):
        SetSolutionState(system.mbs, solution, row)
        place = system.mbs.GetNodeOutput(tip, exu.OutputVariableType.Position)
        np.testing.assert_allclose(place[:2], observer.outlines(row)[-1].points[-1], atol=1e-14)


def looks(system: System, number: int) -> list[np.ndarray]:
    """Points (n, 3) m of the shapes that an object is drawn with."""
    shapes = system.mbs.GetObject(number, True)["VgraphicsData"]
    return [np.array(shape["points"]).reshape(-1, 3) for shape in shapes if "points" in shape]


def test_bodies_and_medium_get_a_look(solved: tuple[System, Trajectory]) -> None:
    system, trajectory = solved
    (body,) = system.rigid.values()
    assert not looks(system, body.object)  # lean until it is looked at
    viewer.add_graphics(system, Kinematics(system, trajectory))
    points = np.concatenate(looks(system, body.object))  # in the body's frame, along the link
    # From the rim of the disc, of 48 tiles (0.2 %), to the end of the collar.
    assert np.ptp(points[:, 0]) == pytest.approx(0.01905 / 2 + 0.024765, rel=5e-3)
    assert np.ptp(points[:, 1]) == pytest.approx(0.01905, rel=5e-3)
    for element in system.links["link"].elements:
        assert system.mbs.GetObject(element)["VdrawHeight"] == pytest.approx(0.00635)
    sand = np.concatenate(looks(system, 0))
    assert sand[:, 1].max() == pytest.approx(system.scene.surface, rel=1e-6)


def test_areas_and_bent_bars_are_solids_in_the_frame_of_their_body() -> None:
    motion = InitialMotion(np.array([1.0, 2.0]), np.pi / 2, np.zeros(2), 0.0)
    corners = np.array([[1.0, 2.0], [1.0, 2.2], [0.9, 2.2], [0.9, 2.0], [1.0, 2.0]])
    (solid,) = viewer._solids(Outline("foot", corners, 0.0), motion)
    points = np.array(solid["points"]).reshape(-1, 3)
    np.testing.assert_allclose([points[:, 0].min(), points[:, 0].max()], [0.0, 0.2], atol=1e-7)
    np.testing.assert_allclose([points[:, 1].min(), points[:, 1].max()], [0.0, 0.1], atol=1e-7)
    assert len(viewer._solids(Outline("boom", corners[:3], 0.01), motion)) == 2


SCRIPT = """
import threading, time
from granular_contact import config
from granular_contact.engines.exudyn import viewer
from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.solve import solve
from granular_contact.scene import build as scene
assert viewer.problem() is None
system = build(scene(config.load({config!r}).scenario))
trajectory = solve(system)
def close():
    while not system.container.renderer.IsActive() or system.container.renderer.GetRenderCount() <= 5:
        time.sleep(0.1)
    print(system.container.renderer.GetRenderCount(), "pictures")
    system.mbs.SetRenderEngineStopFlag(True)
threading.Thread(target=close, daemon=True).start()
viewer.show(system, trajectory)
print("closed")
"""


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="no Xvfb on this machine to make a display")
def test_viewer_plays_on_a_display_until_closed() -> None:
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", "1280x1024x24"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert server.stdout is not None
        environment = {**os.environ, "DISPLAY": f":{server.stdout.readline().strip()}"}
        script = [sys.executable, "-c", SCRIPT.format(config=CONFIG)]
        done = subprocess.run(script, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=60)
    finally:
        server.terminate()
        server.wait()
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "closed"
    assert int(done.stdout.split()[0]) > 5
