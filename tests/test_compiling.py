"""Compiling is announced, and is neither time of the solve nor wall time of a run; in processes of their own."""

from __future__ import annotations

import gc
import json
import os
import shutil
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from support_runs import ROOT, simulate

from granular_contact import build, load

# A clock that an hour passes on whenever a kernel is needed for the first time in a process, be it compiled or loaded
# from the cache: what comes after the clock has started takes an hour of it. Each solver has a process of its own, all
# of which are copies of one that has loaded the package and needed no kernel yet.
SLOWLY = """
import json, os, sys, time, traceback
from numba.core.dispatcher import Dispatcher

real, compile_now, hours = time.perf_counter, Dispatcher.compile, [0]

def slowly(self, *arguments, **options):
    hours[0] += 1
    return compile_now(self, *arguments, **options)

Dispatcher.compile = slowly
time.perf_counter = lambda: real() + 3600.0 * hours[0]
sys.path.insert(0, TESTS)
from support_runs import ROOT, simulate

import exudyn
import granular_contact.engines.exudyn.solve, granular_contact.engines.tree.solve, granular_contact.engines.modal.solve

for name, overrides in SOLVERS.items():
    assert hours[0] == 0
    if os.fork() == 0:
        try:
            results = simulate(*overrides, "solver.max_wall_s=60", "solver.end_time_s=0.005")
            print(json.dumps([name, results.status.code, results.summary["cost"]["solve_s"], hours[0]]), flush=True)
        except BaseException:
            traceback.print_exc()
        os._exit(0)
    os.wait()
"""
SOLVERS = {
    "engine, chosen steps, settled": (
        "pendulum_rigid",
        "solver.accuracy=1e-3",
        "initial={settle: true, joints: {pivot: {angle_deg: 31}}}",
        "solver.rest_time_s=null",
    ),
    "minimal": ("double_pendulum", "method={minimal: {}}"),
    "reduced, bristles": ("pendulum", "method.reduced={modes: 1, static: elastoplastic}"),
}


def in_a_process(code: str, cache: Path | None = None) -> subprocess.CompletedProcess[str]:
    environment = dict(os.environ, PYTHONPATH=str(ROOT))
    if cache is not None:
        environment["NUMBA_CACHE_DIR"] = str(cache)
    return subprocess.run(
        [sys.executable, "-c", code], env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes can't be copied here")
def test_compiling_is_no_wall_time() -> None:
    code = SLOWLY.replace("TESTS", repr(str(ROOT / "tests"))).replace("SOLVERS", repr(SOLVERS))
    done = in_a_process(code)
    times = {name: rest for name, *rest in map(json.loads, done.stdout.splitlines())}
    assert times.keys() == SOLVERS.keys(), done.stderr
    for solver, (status, seconds, kernels) in times.items():
        assert kernels > 0, solver
        assert status == "end_time", solver
        assert seconds < 60.0, solver


def test_compiling_is_reported_once_when_it_begins() -> None:
    from numba import njit

    from granular_contact.jit import compiled  # noqa: F401  # listens
    from granular_contact.jit.compiling import announced, seconds

    sentences: list[str] = []
    before, begin = seconds(), time.perf_counter()
    kernel = njit(lambda x: x + 1.0)
    with announced(sentences.append, "a sum"):
        assert sentences == []
        kernel(1.0)
        assert sentences == ["compiling a sum, once in an installation: 2 to 40 s"]
        kernel(1)
        assert len(sentences) == 1
    spent = seconds() - before
    assert 0.0 < spent < time.perf_counter() - begin  # nothing is counted twice
    sentences.clear()
    with announced(sentences.append, "a sum"):
        kernel(2.0)
    njit(lambda x: x - 1.0)(1.0)
    with announced(None, "a sum"):
        njit(lambda x: x - 2.0)(1.0)
    assert sentences == []


def test_garbage_collection_pauses_during_compilation() -> None:
    from numba import njit
    from numba.core import event
    from numba.core.errors import TypingError

    from granular_contact.jit import compiled  # noqa: F401  # listens

    class Looks(event.Listener):
        def on_start(self, event: object) -> None:  # noqa: ARG002
            seen.append(gc.isenabled())

        def on_end(self, event: object) -> None:
            pass

    seen: list[bool] = []
    with event.install_listener("numba:compile", Looks()):
        njit(lambda x: x + 4.0)(1.0)
        with pytest.raises(TypingError):
            njit(lambda x: x + "")(1.0)
        assert gc.isenabled()
        gc.disable()
        try:
            njit(lambda x: x + 5.0)(1.0)
            assert not gc.isenabled()
        finally:
            gc.enable()
    assert seen
    assert not any(seen)


def test_compiling_after_the_solve_is_reported_outside_wall_time(monkeypatch: pytest.MonkeyPatch) -> None:
    from numba import njit

    from granular_contact import run as runs
    from granular_contact.jit.compiling import seconds

    def results(*given: object) -> object:
        njit(lambda x: x + 3.0)(1.0)
        return made(*given)

    made, announced, before = runs.results, list[str](), seconds()
    monkeypatch.setattr(runs, "results", results)
    scene = build(load(str(ROOT / "configs" / "pendulum_rigid.yaml"), ["solver.end_time_s=0.002"]))
    runs.run(scene, compiling=lambda sentence: announced.append(sentence))
    assert len(announced) == 1
    assert seconds() > before


def cache_without(kernel: str, folder: Path) -> Path:
    """A copy of the cache of the tests in which one kernel is not compiled yet."""
    for file in Path(os.environ["NUMBA_CACHE_DIR"]).rglob("*.nb[ic]"):
        copy = folder / file.relative_to(os.environ["NUMBA_CACHE_DIR"])
        copy.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # a test beside this one wrote it anew
            if f".{kernel}-" not in file.name:
                shutil.copy(file, copy)
    return folder


@pytest.mark.slow
def test_the_command_says_on_stderr_what_it_compiles_the_first_time_only(tmp_path: Path) -> None:
    """A library call says nothing."""
    simulate("pendulum_rigid", "solver.end_time_s=0.005")  # the others are compiled
    cache = cache_without("update_active", tmp_path / "cache")
    run = ["run", str(ROOT / "configs" / "pendulum_rigid.yaml"), "--set", "solver.end_time_s=0.005", "--no-plots"]
    code = f"from granular_contact.cli import main; main({[*run, '--out', str(tmp_path / 'out')]!r})"
    first, second = (in_a_process(code, cache) for _ in range(2))
    message = "compiling the law lee_marghitu for round bars, once in an installation: 2 to 40 s\n"
    assert (first.stderr, second.stderr) == (message, "")
    assert [" s of compiling, once" in done.stdout for done in (first, second)] == [True, False]


@pytest.mark.slow
def test_the_run_that_compiles_has_the_numbers_of_those_that_read_its_code(tmp_path):
    """Of a link that bends: its steps differed in the last digit, as copies of one function were rounded otherwise."""
    bends = {"length_m": 0.05, "diameter_m": 0.008, "density_kg_m3": 1500}
    bends |= {"flexible": {"youngs_modulus_Pa": 5e7, "elements": 3}}
    scene = {
        "model": {"in_space": True, "name": "chain", "chain": {"count": 6, "link": bends}},
        "medium": "rft3d_sand",
        "surface_height_m": -0.05,
        "initial": {"joints": {"hinge_1": {"rate_rad_s": 2}}},
        "solver": {"end_time_s": 0.03, "accuracy": 1e-2},
    }
    scene["model"]["chain"]["hinge"] = {"axes": [[0, 1, 0], [0, 0, 1]]}
    script = f"from granular_contact import simulate\nprint(simulate({scene!r})['hinge_2_rate_rad_s'].tobytes().hex())"
    kept = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    first, second = (
        subprocess.run([sys.executable, "-c", script], env=kept, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    assert first
    assert first == second
