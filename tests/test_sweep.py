"""Sweeps as a user runs them: the numbers of single runs, in order, whichever cases fail."""

from __future__ import annotations

import functools
import io
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import pytest
from support_figures import sketched
from support_sweep import ANGLE, CONFIGS, ENVIRONMENT, ROOT, SPEED, TIME, arguments, dying, of_speed, read, until, write

from granular_contact import report, scene
from granular_contact.cli import main, many
from granular_contact.config import Scenario, Sweep, load_sweep
from granular_contact.errors import ConfigError
from granular_contact.results import Results
from granular_contact.studies import processes, sweep
from granular_contact.studies.sweep import Row, runner, table
from granular_contact.studies.sweep import local_processes as local
from granular_contact.studies.sweep.worker import _flat, simulate

pytestmark = pytest.mark.slow


def timeless(row: dict[str, str]) -> dict[str, str]:
    return {name: cell for name, cell in row.items() if name != TIME}


# The workers load the engine; the process that waits for them stays small.
SMALL = """import sys
from granular_contact.cli import main
code = main(sys.argv[1:])
assert not {'exudyn', 'numba', 'matplotlib'} & set(sys.modules)
sys.exit(code)
"""


PLAIN = """from granular_contact import load, sweep
print("read")
rigid = load("pendulum_rigid", solver={"end_time_s": 0.002})
print(len(list(sweep(rigid, {"initial.impact_speed_rad_s": [3.0, 4.0]}, workers=2))))
"""


def test_a_sweep_script_without_a_main_guard_gets_a_clear_error(tmp_path):
    (tmp_path / "script.py").write_text(PLAIN)
    line = [sys.executable, str(tmp_path / "script.py")]
    done = subprocess.run(line, env=ENVIRONMENT, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "WorkerPoolError: a worker process ended before its first task" in done.stderr.splitlines()[-1]
    assert 'if __name__ == "__main__":' in done.stderr.splitlines()[-1]
    assert "2" not in done.stdout  # no worker swept on its own


@pytest.fixture(scope="module")
def paper(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """The twelve cases, run on two workers."""
    folder = tmp_path_factory.mktemp("paper") / "out"
    command = ["sweep", CONFIGS / "paper_cases.yaml", "--out", folder, "--workers", "2"]
    line = [sys.executable, "-c", SMALL, *map(str, command)]
    return subprocess.run(line, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, check=False), folder


def test_the_paper_cases_have_a_row_each(paper):
    done, folder = paper
    assert done.returncode == 0, done.stderr
    # Progress, where it takes long, and nothing to warn of.
    assert all(re.match(r"\d+ of 12 cases|the first cases wait", line) for line in done.stderr.splitlines())
    assert sorted(path.name for path in folder.iterdir()) == ["sweep.yaml", "table.csv"]
    rows = read(folder)
    names = [f"{angle}deg_{speed}" for angle, speed in product((22, 31, 45, 61), ("slow", "medium", "fast"))]
    assert [row["case"] for row in rows] == names
    assert list(rows[0])[:6] == ["case", ANGLE, SPEED, "name", "status", "message"]
    assert {"energy.initial_J", "cost.solve_s", "versions.exudyn", "warnings"} < set(rows[0])
    assert {row["status"] for row in rows} == {"rest"}
    shown = done.stdout.splitlines()
    assert [line.split()[0] for line in shown] == ["case", *names, "paper_cases:"]
    assert "12 of 12 cases" in shown[-1]


def test_harder_impacts_stop_sooner_and_deeper(paper):
    """The claim of the source paper, at each of its angles."""
    rows = read(paper[1])
    for angle in ("22", "31", "45", "61.5"):
        of_angle = [row for row in rows if row[ANGLE] == angle]
        assert len(of_angle) == 3
        for slower, faster in pairwise(of_angle):
            assert float(slower[SPEED]) < float(faster[SPEED])
            assert float(slower["stopping_time_s"]) > float(faster["stopping_time_s"])
            assert float(slower["angle_at_stop_deg"]) < float(faster["angle_at_stop_deg"])
            assert float(slower["max_depth_m"]) < float(faster["max_depth_m"])


def test_every_number_is_that_of_a_single_run(paper):
    """To the last bit, in this process, which has not the environment of a worker."""
    cases = load_sweep(CONFIGS / "paper_cases.yaml")
    rows = read(paper[1])
    for i in (0, 4, 11):
        single = dict(_flat(simulate(cases.scenario(cases.cases[i]))))
        assert len(single) > 20
        for name in single.keys() - {TIME}:
            assert rows[i][name] == table.cell(single[name])
        assert float(rows[i][TIME]) > 0.0


@pytest.mark.usefixtures("cases_in_this_process")
def test_the_saved_sweep_gives_the_same_table(paper, tmp_path, capsys):
    assert ended("sweep", paper[1] / "sweep.yaml", "--out", tmp_path / "again", "--quiet") == 0
    assert capsys.readouterr() == ("", "")
    assert list(map(timeless, read(tmp_path / "again"))) == list(map(timeless, read(paper[1])))
    assert (tmp_path / "again" / "sweep.yaml").read_text() == (paper[1] / "sweep.yaml").read_text()


def test_settings_hold_for_all_cases(tmp_path):
    text = (CONFIGS / "paper_cases.yaml").read_text()
    text = text.replace("config: ", f"set: {{model.bodies.link.flexible.elements: 16}}\nconfig: {CONFIGS}/")
    (tmp_path / "twelve.yaml").write_text(text)
    cases = load_sweep(tmp_path / "twelve.yaml")
    elements = [cases.scenario(case).model.bodies["link"].flexible.elements for case in cases.cases]
    assert elements == [16] * 12


# What cases go through in the workers instead of the engine: the speed says what happens.


def slow_first(scenario: Scenario) -> Results:
    time.sleep(0.4 if scenario.initial.impact_speed_rad_s == 0 else 0.0)
    return of_speed(scenario)


def raising(scenario: Scenario) -> Results:
    if scenario.initial.impact_speed_rad_s == 3:
        raise ZeroDivisionError("three\nis too much")
    return of_speed(scenario)


def exiting(scenario: Scenario) -> Results:
    if scenario.initial.impact_speed_rad_s == 3:
        sys.exit("leaving")
    return of_speed(scenario)


def unsendable(scenario: Scenario) -> Results:
    results = of_speed(scenario)
    if scenario.initial.impact_speed_rad_s == 3:
        results.summary["function"] = lambda: 0
    return results


def dying_once(marker: Path, scenario: Scenario) -> Results:
    if scenario.initial.impact_speed_rad_s == 3 and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return of_speed(scenario)


@pytest.fixture(scope="module")
def numbered(tmp_path_factory) -> Sweep:
    """Twenty cases of the speeds 0 to 19."""
    return load_sweep(write(tmp_path_factory.mktemp("numbered"), f"vary:\n  {SPEED}: {{from: 0, to: 19, count: 20}}\n"))


@pytest.fixture(scope="module")
def plain(numbered) -> list[Row]:
    """Their rows by two workers to which nothing happens."""
    return rows_of(numbered, of_speed)


def rows_of(
    cases: Sweep, function: Callable[[Scenario], Results], workers: int = 2, executor=local, **options
) -> list[Row]:
    """Rows in the order of the sweep, of which there must be one for each case."""
    with sweep.WorkerPool(workers, executor) as pool:
        rows = sorted(sweep.run(cases, pool, function=function, **options), key=lambda row: row.index)
    assert [row.name for row in rows] == [case.name for case in cases.cases]
    return rows


def test_rows_have_the_order_of_the_file_not_of_finishing(numbered, tmp_path):
    journal = sweep.Journal(tmp_path)
    with sweep.WorkerPool(2, threads) as pool:
        rows = list(sweep.run(numbered, pool, function=slow_first, journal=journal))
    assert rows[0].index != 0
    assert list(journal) == sorted(rows, key=lambda row: row.index)
    table.write(numbered, journal, tmp_path)
    assert [float(row["speed"]) for row in read(tmp_path)] == list(range(20))


def threads(workers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers)


@pytest.mark.parametrize(("workers", "executor"), [(1, local), (20, threads), (1, threads)])
def test_neither_workers_nor_executor_change_a_row(numbered, plain, workers, executor):
    assert rows_of(numbered, of_speed, workers, executor=executor) == plain


@pytest.mark.parametrize(
    ("function", "lost", "message"),
    [
        (raising, {3}, "ZeroDivisionError: three is too much"),
        (exiting, {3}, "SystemExit: leaving"),
        (dying, {3, 17}, "the process died"),
        (unsendable, {3}, "TypeError: function is not plain data"),
    ],
)
def test_a_case_that_fails_costs_its_own_row_only(numbered, plain, function, lost, message, tmp_path):
    rows = rows_of(numbered, function)
    assert {row.index for row in rows if row.failed} == lost
    good = {row.index: row.summary for row in plain}
    for row in rows:
        if row.index in lost:
            assert set(row.summary) == {"status", "message"}
            assert row.summary["status"] == "error"
            assert message in row.summary["message"]
            assert "\n" not in row.summary["message"]
        else:
            assert row.summary == good[row.index]
    table.write(numbered, rows, tmp_path)
    [cells] = [row for row in read(tmp_path) if row["case"] == "case_04"]
    assert (cells[SPEED], cells["status"], cells["speed"]) == ("3", "error", "")


def test_cases_interrupted_by_a_crash_are_run_again(numbered, plain, tmp_path):
    """A worker killed from outside takes no result with it."""
    function = functools.partial(dying_once, tmp_path / "marker")
    assert rows_of(numbered, function) == plain
    assert (tmp_path / "marker").exists()


@pytest.mark.usefixtures("cases_in_this_process")
def test_real_failures_become_rows_and_are_reported(tmp_path, capsys, monkeypatch):
    path = tmp_path / "many.yaml"
    path.write_text(
        f"config: {CONFIGS / 'pendulum.yaml'}\ncases:\n  good: {{}}\n"
        f"  stuck: {{gravity_m_s2: 1e9, solver.step_s: 0.1}}\n"
    )
    monkeypatch.chdir(tmp_path)
    assert ended("sweep", path, "--out", "out") == 3
    out, err = capsys.readouterr()
    assert err.splitlines()[-1] == "1 of 2 cases failed; saved in out"
    assert "Traceback" not in out
    good, stuck = read(tmp_path / "out")
    assert [row["status"] for row in (good, stuck)] == ["rest", "failed"]
    assert "solver.step_s" in stuck["message"]
    assert (float(stuck["gravity_m_s2"]), float(good["gravity_m_s2"])) == (1e9, 9.81)
    assert f"stuck failed: {stuck['message']}" in out


@pytest.mark.usefixtures("cases_in_this_process")
def test_warnings_of_cases_are_listed_and_useless_cases_set_the_exit_code(tmp_path, capsys):
    fixed = "set: {output.figures: false, solver.end_time_s: 0.06, solver.rest_time_s: null}\n"
    path = write(tmp_path, f"{fixed}vary: {{solver.step_s: [1.0e-2, 2.0e-4, 1.2e-2]}}\n")
    for once_more in (False, True):
        assert ended("sweep", path, "--out", tmp_path / "out") == 5
        err = capsys.readouterr().err.splitlines()
        assert err[-1].startswith("2 of 3 cases are not usable, see their warnings; saved in")
        warnings = [line for line in err if line.startswith("warning: ") and "not usable" in line]
        assert once_more or "(2 of 3 cases, in other cases with other numbers)" in warnings[0]
    assert [row["usable"] for row in read(tmp_path / "out")] == ["false", "true", "false"]


def test_an_absurd_case_is_refused_before_any_runs(tmp_path, capsys, monkeypatch):
    path = tmp_path / "many.yaml"
    path.write_text(f"config: {CONFIGS / 'pendulum.yaml'}\ncases:\n  good: {{}}\n  absurd: {{{SPEED}: 1e50}}\n")
    monkeypatch.chdir(tmp_path)
    assert ended("sweep", path, "--out", "out") == 2
    assert "starts with 1e+50 rad/s: allowed is less than 1e+08" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_cells_of_the_table_are_written_as_text():
    cells = [0.1, 1e-300, None, float("nan"), True, 3, ["a", "b, c"], [], {"law": "x"}, [{"a": 1}], "a; b"]
    expected = ["0.1", "1e-300", "", "", "true", "3", "a; b, c", "", '{"law": "x"}', '[{"a": 1}]', "a; b"]
    assert list(map(table.cell, cells)) == expected


def test_the_saved_sweep_stands_alone(tmp_path):
    """Models and media by name or path are written out, so that the file means the same anywhere."""
    (tmp_path / "arm.yaml").write_text((ROOT / "models" / "compound_pendulum.yaml").read_text().replace("7700", "2700"))
    text = "set: {medium.eta_h: 9}\ncases:\n  a: {model: arm.yaml, solver.step_s: 1e-4}\n  b: {medium: null}\n"
    text += '  c: {medium.name: "sand: \\"fine\\" é", load.friction: {type: smooth}}\n  d: {}\n'
    (tmp_path / "base.yaml").write_text((CONFIGS / "pendulum.yaml").read_text())
    (tmp_path / "many.yaml").write_text("config: base.yaml\n" + text)
    cases = load_sweep(tmp_path / "many.yaml", probe=scene.build)
    (tmp_path / "away").mkdir()
    (tmp_path / "away" / "sweep.yaml").write_text(table.sweep_text(cases), encoding="utf-8")
    for name in ("arm.yaml", "base.yaml", "many.yaml"):
        (tmp_path / name).unlink()
    reloaded = load_sweep(tmp_path / "away" / "sweep.yaml", probe=scene.build)
    assert [reloaded.scenario(case) for case in reloaded.cases] == [cases.scenario(case) for case in cases.cases]
    assert [case.name for case in reloaded.cases] == ["a", "b", "c", "d"]


@pytest.fixture
def cases_in_this_process(monkeypatch):
    """Let the command take its runs in a thread of this process."""
    monkeypatch.setattr(many, "pool", lambda *_: sweep.WorkerPool(1, threads))


@pytest.mark.usefixtures("cases_in_this_process")
def test_plots_give_each_case_its_results(tmp_path, capsys):
    path = write(tmp_path, f"cases:\n  slow: {{{SPEED}: 2}}\n  fast: {{{SPEED}: 9, output.figures: false}}\n")
    with sketched():
        assert ended("sweep", path, "--out", tmp_path / "out", "--plots", "--quiet") == 0
    assert capsys.readouterr() == ("", "")
    assert sorted(entry.name for entry in (tmp_path / "out").iterdir()) == ["cases", "sweep.yaml", "table.csv"]
    cases = tmp_path / "out" / "cases"
    assert sorted(entry.name for entry in cases.iterdir()) == ["fast", "slow"]
    assert list((cases / "slow" / "figures").glob("*.png"))
    assert sorted(entry.name for entry in (cases / "fast").iterdir()) == [
        report.MOTION,
        report.SCENARIO,
        report.SUMMARY,
        report.SERIES,
    ]
    assert ended("sweep", path, "--out", tmp_path / "out", "--quiet", "--restart") == 0
    assert sorted(entry.name for entry in (tmp_path / "out").iterdir()) == ["sweep.yaml", "table.csv"]
    assert ended("sweep", path, "--out", tmp_path / "out", "--plots") == 2
    assert (
        capsys.readouterr().err == f"{tmp_path / 'out'} contains this sweep without --plots; --restart runs it again\n"
    )


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (["many.yaml", "--workers", "0"], "got '0'; allowed is a whole number from 1 to 256"),
        (["many.yaml", "--workers", "two"], "got 'two'"),
        (["no.yaml"], "no.yaml: no such file"),
        (["bad.yaml"], "bad.yaml:3: medium.eta_q: unknown key"),
        (["steep.yaml"], "steep.yaml:4: bed.depth_m: got 0.01 m"),
        ([CONFIGS / "pendulum.yaml"], "the config of one run"),
        (["many.yaml", "--out", "run"], "'summary.json', which no sweep wrote"),
        (["many.yaml", "--out", "many.yaml"], "is a file"),
    ],
    ids=lambda value: " ".join(map(str, value))[-30:] if isinstance(value, list) else "",
)
def test_bad_input_ends_with_2_before_anything_runs(tmp_path, capsys, monkeypatch, command, message):
    write(tmp_path, "cases:\n  a: {}\n")
    write(tmp_path, "cases: {a: {},\n  b: {medium.eta_q: 1}}\n", "bad.yaml")
    write(tmp_path, "cases:\n  a: {}\n  b: {bed.depth_m: 0.01, surface_height_m: 0}\n", "steep.yaml")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "summary.json").touch()
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.chdir(tmp_path)
    assert ended("sweep", *command) == 2
    errors = capsys.readouterr().err
    assert message in errors
    assert "Traceback" not in errors
    assert sorted(tmp_path.rglob("*")) == before


def ended(*command: object) -> int:
    """What the command would end with, in this process."""
    try:
        return main([str(word) for word in command])
    except SystemExit as end:
        return int(end.code or 0)


def test_check_reads_sweeps_too(tmp_path, capsys, monkeypatch):
    good = write(tmp_path, "cases:\n  a: {}\n", "good.yaml")
    write(tmp_path, "cases:\n  a: {}\n  b: {bed.depth_m: 0.01, surface_height_m: 0}\n", "bad.yaml")
    monkeypatch.chdir(tmp_path)
    assert ended("check", "bad.yaml", good.name) == 2
    printed = capsys.readouterr()
    assert printed.out == "good.yaml: ok\n"
    assert printed.err.startswith("bad.yaml:4: bed.depth_m: ")


@pytest.fixture
def under_way(tmp_path) -> Iterator[subprocess.Popen[str]]:
    """A sweep of 300 cases in a session of its own, some of which are finished."""
    text = f"set: {{output.figures: false}}\nvary:\n  {SPEED}: {{from: 1, to: 9, count: 300}}\n"
    path = write(tmp_path, text)
    path.write_text(path.read_text().replace("pendulum_rigid", "pendulum"))
    command = arguments("sweep", path, "--out", tmp_path / "out", "--plots", "--workers", 2)
    process = subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        preexec_fn=functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL),  # tests in the background ignore it
    )  # fmt: skip
    until(lambda: len(list(tmp_path.glob("out.part/cases/case_*"))) >= 12, 60)
    yield process
    if process.poll() is None:
        process.kill()
    process.communicate()


def is_gone(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return True
    return False


def test_ctrl_c_keeps_what_is_finished(under_way, tmp_path):
    os.killpg(under_way.pid, signal.SIGINT)  # as a terminal does: to the workers too
    out, err = under_way.communicate(timeout=20)
    part = tmp_path / "out.part"
    assert under_way.returncode == 130
    rows = read(part)
    assert 0 < len(rows) < 300
    went_on = "and the same command goes on from there"
    assert (out, err) == ("", f"interrupted; {len(rows)} of 300 cases are kept in {part}, {went_on}\n")
    assert {row["status"] for row in rows} == {"rest"}
    names = [row["case"] for row in rows]
    assert names == sorted(names)
    assert set(names) <= {path.name for path in (part / "cases").iterdir()}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["many.yaml", "out.part"]
    until(lambda: is_gone(under_way.pid), 10)


@pytest.mark.skipif(not processes._HAS_SERVER or not processes._HAS_SAFE_PATH, reason="nothing is imported in advance")
def test_workers_begin_with_all_modules_that_are_to_be_imported_in_advance():
    """The server passes over what it can't import, and says nothing."""
    wanted = [*processes._PRELOADED, *(f"granular_contact.{name}" for name in processes._OURS)]
    with local(1) as workers:
        known = workers.submit(eval, "list(__import__('sys').modules)").result()
    assert [name for name in wanted if name not in known] == []


def test_a_worker_pool_that_is_dismissed_leaves_nothing_behind():
    """Neither processes nor the thread that looks after them, whose pipe the interpreter would write to at its exit."""
    before = set(threading.enumerate())
    with sweep.WorkerPool(2, local) as pool:
        work = [pool.executor().submit(time.sleep, 60) for _ in range(8)]
        until(work[0].running, 60)
        since = set(threading.enumerate()) - before
        assert since
    assert not any(thread.is_alive() for thread in since)
    assert all(future.done() for future in work)


def interrupted() -> int:
    """How often Ctrl-C reaches a process that listens for it."""
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    os.kill(os.getpid(), signal.SIGINT)
    signal.signal(signal.SIGINT, before)
    return len(heard)


def is_deaf(process: int) -> bool:
    (mask,) = re.findall(r"SigBlk:\s*(\w+)", Path(f"/proc/{process}/status").read_text())
    return bool(int(mask, 16) >> signal.SIGINT - 1 & 1)


def test_workers_are_deaf_from_their_first_moment():
    """Else a case that Ctrl-C cut short counts as run, and a worker that is just starting complains."""
    assert interrupted() == 1
    with sweep.WorkerPool(1, local) as pool:
        assert pool.executor().submit(interrupted).result(60) == 0
        if Path("/proc").exists():
            assert is_deaf(pool.executor().submit(os.getppid).result(60))


def test_workers_do_not_outlive_a_sweep_that_is_killed(under_way, tmp_path):
    under_way.kill()
    under_way.wait()
    until(lambda: is_gone(under_way.pid), 10)
    assert not (tmp_path / "out").exists()


def test_faults_of_many_cases_are_those_of_few(tmp_path, monkeypatch):
    """Found by workers, or here where a worker dies at it."""
    monkeypatch.setattr(runner, "MOST_CHECKED_HERE", 40)
    path = write(tmp_path, f"vary:\n  {ANGLE}: {{from: 80, to: 100, count: 21}}\n  {SPEED}: [1, 5, 9]\n")
    with pytest.raises(ConfigError) as alone:
        load_sweep(path, probe=scene.build)
    assert len(alone.value.faults) == 10  # of 91 to 100 degrees
    for executor in (threads, Dead):
        with sweep.WorkerPool(2, executor) as pool, pytest.raises(ConfigError) as shared:
            load_sweep(path, probe=scene.build, check=functools.partial(runner.faults, pool=pool))
        assert shared.value.faults == alone.value.faults


class Dead(ThreadPoolExecutor):
    """Loses all that it is given."""

    def submit(self, *_: object) -> Future[Any]:
        lost: Future[Any] = Future()
        lost.set_exception(BrokenExecutor("dead"))
        return lost


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("stream", "quiet", "expected"),
    [
        (io.StringIO(), False, r"6 of 9 cases\n(\d+ of 9 cases, [\d.e+]+ per s, about \d+ s left\n){3}"),
        (io.StringIO(), True, ""),
        (Terminal(), False, r"(?s).*9/9.* cases, [\d.e+]+ per s .*left.*"),
        (Terminal(), True, ""),
    ],
)
def test_progress_is_a_bar_on_a_terminal_and_lines_in_a_log(monkeypatch, stream, quiet, expected):
    monkeypatch.setattr(many, "LINE_SECONDS", 0.0)
    with many.progress(stream, 9, 5, quiet) as advance:
        for _ in range(4):
            advance()
    assert re.fullmatch(expected, stream.getvalue())


@pytest.mark.usefixtures("cases_in_this_process")
def test_sweep_table_shows_varied_keys_and_speed(tmp_path, capsys):
    text = "set: {method: {reduced: {modes: 0}}, output.figures: false}\nvary:\n  medium.eta_d: [4, 5.123456789]\n"
    path = write(tmp_path, f"{text}  initial.impact_speed_rad_s: [2, 3]\n")
    assert ended("sweep", path, "--out", tmp_path / "out") == 0
    shown = capsys.readouterr().out
    head, first, *_ = shown.splitlines()
    assert head.split()[:4] == ["case", "eta_d", "impact_speed_rad_s", "status"]
    assert first.split()[:4] == ["case_1", "4", "2", "rest"]
    assert "5.1235" in shown
    assert re.search(r"4 of 4 cases in [\d.]+ s \([\d.e+-]+ per s\), saved in", shown)
