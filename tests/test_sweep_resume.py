"""Killed sweeps resume: no row is lost or run twice, and folders of other sweeps stay untouched."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import signal
import struct
import subprocess
import sys
import threading
from collections import Counter
from concurrent.futures import BrokenExecutor, ThreadPoolExecutor
from pathlib import Path

import psutil
import pytest
from support_sweep import (
    ENVIRONMENT,
    ROOT,
    SPEED,
    arguments,
    of_speed,
    read,
    timeless_bytes,
    until,
    write,
)

from granular_contact.cli import main
from granular_contact.cli import many as shared
from granular_contact.cli import sweep as cli
from granular_contact.config import load_sweep
from granular_contact.report import held
from granular_contact.studies import sweep
from granular_contact.studies.sweep import WorkerPool
from granular_contact.studies.sweep import journal as journals
from granular_contact.studies.sweep import local_processes as local
from granular_contact.studies.sweep.journal import Journal, Row

QUICK = "set: {method: {reduced: {modes: 0}}}\n"


class Threads(ThreadPoolExecutor):
    """Ends when it is told to, as processes do."""

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        super().shutdown(wait=True, cancel_futures=cancel_futures)


def many(folder: Path) -> Path:
    """Sixty impacts: long enough to be killed between."""
    return write(folder, f"vary:\n  {SPEED}: {{from: 1, to: 9, count: 60}}\n")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of the sweep in one go, in a thread of this process."""
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(shared, "pool", lambda *_: sweep.WorkerPool(1, Threads))
        assert main(["sweep", str(many(folder)), "--out", str(folder / "out"), "--quiet"]) == 0
    return folder / "out"


def start(folder: Path) -> subprocess.Popen[str]:
    command = arguments("sweep", folder / "many.yaml", "--out", folder / "out", "--workers", 2)
    return subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def lines(folder: Path) -> list[bytes]:
    """Whole lines of the journal of an unfinished sweep."""
    files = (folder / "out.part" / "journal").glob("*.jsonl")
    return [line for file in files for line in file.read_bytes().splitlines(keepends=True) if line.endswith(b"\n")]


def kill_workers(process: subprocess.Popen[str]) -> None:
    """Kill the workers of a sweep: below the command stands their server, and they below that."""
    workers = [worker for server in psutil.Process(process.pid).children() for worker in server.children()]
    assert len(workers) >= 2
    for worker in workers:
        worker.kill()


@pytest.mark.slow
def test_a_sweep_killed_whose_workers_are_killed_too_gives_the_same_table(whole, tmp_path):
    many(tmp_path)
    process = start(tmp_path)
    until(lambda: len(lines(tmp_path)) >= 15, 60)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert not (tmp_path / "out").exists()
    kept = lines(tmp_path)
    assert len(kept) < 60
    process = start(tmp_path)
    until(lambda: len(lines(tmp_path)) >= len(kept) + 10, 60)
    # Each line is one run: those of before are there as they were, and no case was run again.
    finished = lines(tmp_path)
    assert set(kept) < set(finished)
    assert set(Counter(json.loads(line)["index"] for line in finished).values()) == {1}
    kill_workers(process)
    out, err = process.communicate(timeout=100)
    assert (process.returncode, err) == (0, "")
    assert f"{len(kept)} of 60 cases are there" in out
    assert timeless_bytes(tmp_path / "out") == timeless_bytes(whole)
    assert (tmp_path / "out" / "sweep.yaml").read_bytes() == (whole / "sweep.yaml").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["many.yaml", "out"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["sweep.yaml", "table.csv"]
    # What was kept is in the table to the digit, times too, which no second run would repeat.
    times = {row["case"]: row["cost.solve_s"] for row in read(tmp_path / "out")}
    for line in kept:
        row = json.loads(line)
        assert times[row["name"]] == repr(row["summary"]["cost.solve_s"])


def test_a_line_that_is_torn_anywhere_is_no_row(tmp_path):
    rows = [
        Row(i, f"c{i}", {SPEED: 0.1 * i}, {"status": "rest", "message": 'said "}\n"', "x": i / 3}) for i in range(3)
    ]
    writer = Journal(tmp_path).writer()
    for row in rows:
        writer.append(row.line())
    writer.close()
    [file] = tmp_path.iterdir()
    text = file.read_bytes()
    assert list(Journal(tmp_path)) == rows
    for end in range(len(text)):
        file.write_bytes(text[:end])
        assert list(Journal(tmp_path)) == rows[: text[:end].count(b"\n")]


def test_a_row_written_twice_counts_once(tmp_path):
    first, second = (Row(0, "a", {}, {"status": "rest", "message": "", "try": i}) for i in (1, 2))
    writer = Journal(tmp_path).writer()
    for row in (first, second):
        writer.append(row.line())
    writer.close()
    assert list(Journal(tmp_path)) == [first]


# ---- what is in the way ----


@pytest.fixture(autouse=True)
def _here(monkeypatch):
    """Let the command, where it is no process of its own, run its cases in a thread of this one."""
    monkeypatch.setattr(shared, "pool", lambda *_: sweep.WorkerPool(1, Threads))


def small(folder: Path, cases: str = "  a: {}\n  b: {gravity_m_s2: 9}\n", name: str = "many.yaml") -> Path:
    return write(folder, f"{QUICK}cases:\n{cases}", name)


def state(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.parametrize(
    ("cases", "message"),
    [
        ("  a: {}\n  b: {gravity_m_s2: 9.5}\n", "cases.b.gravity_m_s2 is 9 there, but 9.5 is requested"),
        ("  a: {}\n  c: {gravity_m_s2: 9}\n", "cases.c is not in that folder"),
        ("  a: {}\n", "cases.b is in that folder alone"),
    ],
)
def test_a_finished_folder_of_another_sweep_is_refused(tmp_path, capsys, cases, message):
    out = str(tmp_path / "out")
    assert main(["sweep", str(small(tmp_path)), "--out", out, "--quiet"]) == 0
    small(tmp_path, cases)
    before = state(tmp_path)
    for more in ([], ["--restart"]):
        assert main(["sweep", str(tmp_path / "many.yaml"), "--out", out, *more]) == 2
        seen = capsys.readouterr()
        assert seen.err == f"{out} contains another sweep ({message}); give another --out, or remove the folder\n"
        assert state(tmp_path) == before


def test_a_config_that_changed_is_another_sweep(tmp_path, capsys):
    out = str(tmp_path / "out")
    assert main(["sweep", str(small(tmp_path)), "--out", out, "--quiet"]) == 0
    text = (tmp_path / "many.yaml").read_text()
    (tmp_path / "many.yaml").write_text(text.replace("set: {", "set: {medium.eta_h: 9, "))
    assert main(["sweep", str(tmp_path / "many.yaml"), "--out", out]) == 2
    assert "config.medium.eta_h is 8.0 there, but 9.0 is requested" in capsys.readouterr().err


def test_a_finished_sweep_is_not_run_again_unless_asked(tmp_path, capsys):
    path, out = str(small(tmp_path)), str(tmp_path / "out")
    assert main(["sweep", path, "--out", out, "--quiet"]) == 0
    before = state(tmp_path)
    assert main(["sweep", path, "--out", out]) == 0
    assert capsys.readouterr().out == f"{out} holds all cases of this sweep already; --restart runs them again\n"
    assert state(tmp_path) == before
    assert main(["sweep", path, "--out", out, "--restart", "--quiet"]) == 0
    assert read(Path(out))[0]["cost.solve_s"] != ""
    assert state(tmp_path) != before  # other times
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["many.yaml", "out"]


def interrupted(folder: Path, monkeypatch, *more: str) -> None:
    """Run the sweep in `folder` until its first row."""

    def stop(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(cli, "_check_outputs", stop)
        patched.setattr(sweep.executor, "cores", lambda: 1)
        assert main(["sweep", str(folder / "many.yaml"), "--out", str(folder / "out"), "--quiet", *more]) == 130


SAMPLE = f"{QUICK}sample:\n  method: latin_hypercube\n  count: 8\n  ranges: {{{SPEED}: [1, 9]}}\n"


def test_an_unfinished_folder_of_another_sweep_is_refused(tmp_path, capsys, monkeypatch):
    path, out = write(tmp_path, SAMPLE), str(tmp_path / "out")
    interrupted(tmp_path, monkeypatch)
    errors = capsys.readouterr().err
    went_on = f"of 8 cases are kept in {out}.part, and the same command goes on from there\n"
    assert errors.startswith("interrupted; ")
    assert errors.endswith(went_on)
    path.write_text(path.read_text().replace("count: 8", "count: 9"))
    before = state(tmp_path)
    assert main(["sweep", str(path), "--out", out]) == 2
    difference = "(sample.count is 8 there, but 9 is requested)"
    message = f"{out}.part contains another sweep {difference}; --restart discards it and starts again\n"
    assert capsys.readouterr().err == message
    assert state(tmp_path) == before
    assert main(["sweep", str(path), "--out", out, "--restart", "--quiet"]) == 0
    assert len(read(tmp_path / "out")) == 9
    assert not (tmp_path / "out.part").exists()


def test_other_versions_and_options_do_not_go_on(tmp_path, capsys, monkeypatch):
    path, out = write(tmp_path, SAMPLE), str(tmp_path / "out")
    interrupted(tmp_path, monkeypatch)
    capsys.readouterr()
    assert main(["sweep", str(path), "--out", out, "--plots"]) == 2
    assert "was begun without --plots; continue without --plots" in capsys.readouterr().err
    begun = tmp_path / "out.part" / "journal" / "begun.json"
    text = begun.read_text()
    begun.write_text(text.replace('"exudyn": "1', '"exudyn": "0'))
    assert main(["sweep", str(path), "--out", out]) == 2
    assert "was begun with exudyn 0" in capsys.readouterr().err
    begun.write_text(text)
    with held(tmp_path / "out.part" / "journal"):
        assert main(["sweep", str(path), "--out", out]) == 2
        assert "another process is working on this sweep" in capsys.readouterr().err
    assert main(["sweep", str(path), "--out", out, "--quiet"]) == 0


def test_a_foreign_part_folder_is_left_alone(tmp_path, capsys):
    path = small(tmp_path)
    (tmp_path / "out.part").mkdir()
    (tmp_path / "out.part" / "thesis.tex").touch()
    assert main(["sweep", str(path), "--out", str(tmp_path / "out"), "--restart"]) == 2
    assert "'thesis.tex', which no sweep wrote" in capsys.readouterr().err
    assert [entry.name for entry in (tmp_path / "out.part").iterdir()] == ["thesis.tex"]


def test_a_full_disk_keeps_what_is_there(tmp_path, capsys, monkeypatch):
    """A worker writes half of its row, then there is no room left."""
    path, out = write(tmp_path, SAMPLE), tmp_path / "out"
    real, written = os.write, [0]

    def full(file: int, data: bytes) -> int:
        written[0] += 1
        if written[0] > 4:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(file, data if written[0] <= 3 else data[: len(data) // 2])

    with monkeypatch.context() as patched:
        patched.setattr(journals.os, "write", full)
        assert main(["sweep", str(path), "--out", str(out)]) == 2
    seen = capsys.readouterr()
    kept = "3 of 8 cases are kept in"
    message = (
        f"the sweep can't go on: No space left on device; {kept} {out}.part, and the same command goes on from there\n"
    )
    assert (seen.out, seen.err) == ("", message)
    assert len(Journal(tmp_path / "out.part" / "journal")) == 3
    assert main(["sweep", str(path), "--out", str(out)]) == 0
    assert "3 of 8 cases are there" in capsys.readouterr().out
    assert len(read(out)) == 8


def test_a_disk_that_is_full_before_the_first_row(tmp_path, capsys, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    path = write(tmp_path, SAMPLE)
    with monkeypatch.context() as patched:
        patched.setattr(journals.os, "write", full)
        assert main(["sweep", str(path), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert [entry.name for entry in tmp_path.iterdir()] == ["many.yaml"]


def test_results_of_a_case_that_can_not_be_saved_end_the_sweep(tmp_path):
    """They are no failure of the case, which would count as done the next time."""
    cases = load_sweep(write(tmp_path, f"vary:\n  {SPEED}: [1, 2, 3]\n"))
    (tmp_path / "file").touch()
    with pytest.raises(FileExistsError), sweep.WorkerPool(1, Threads) as pool:
        list(sweep.run(cases, pool, cases_folder=tmp_path / "file", function=of_speed))


def test_finished_rows_of_a_sweep_are_not_run(tmp_path):
    cases = load_sweep(write(tmp_path, f"vary:\n  {SPEED}: {{from: 0, to: 19, count: 20}}\n"))
    with sweep.WorkerPool(2, local) as pool:
        rows = list(sweep.run(cases, pool, done={0, 3, 19}, function=of_speed))
    assert {row.index for row in rows} == set(range(20)) - {0, 3, 19}


def test_the_checkout_is_the_package_under_test():
    assert Path(sweep.__file__).is_relative_to(ROOT)


# ---- a worker that is lost in mid-sentence ----


def dies_in_mid_sentence() -> None:
    """Be killed with half a result in the pipe."""
    frame = sys._getframe()
    while frame is not None and "pipe" not in frame.f_locals:
        frame = frame.f_back
    os.write(frame.f_locals["pipe"].fileno(), struct.pack("!i", 100_000) + b"half")
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_worker_killed_while_it_writes_does_not_keep_the_pool_waiting() -> None:
    with WorkerPool(2) as pool:
        lost = pool.executor().submit(dies_in_mid_sentence)
        assert isinstance(lost.exception(timeout=30), BrokenExecutor)
        assert pool.executor().submit(os.getpid).result(30) > 0  # the pool goes on
        pool.shutdown()
        assert pool.executor().submit(os.getpid).result(30) > 0
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("ThreadPoolExecutor")]
