"""Sweeps on a real Dask scheduler and two worker processes, over TCP on this machine."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from support_sweep import CONFIGS, ENVIRONMENT, SPEED, dying_at_three, of_speed, timeless_bytes, write

from granular_contact import __version__
from granular_contact.cli import main, many
from granular_contact.config import load_optimise, load_sweep
from granular_contact.studies import sweep
from granular_contact.studies.optimise.search import search
from granular_contact.studies.sweep import cluster
from granular_contact.studies.sweep.cluster import cluster_pool

pytestmark = pytest.mark.slow

pytest.importorskip("distributed")
SCATTER = "medium.scatter={relative: 0.3, length_m: 0.003, seed: 11}"
QUICK = f"""set: {{method: {{reduced: {{modes: 0}}}}, output.figures: false}}
vary:
  {SPEED}: {{from: 1, to: 9, count: 12}}
"""


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def daemon(folder: Path, *command: str) -> subprocess.Popen[bytes]:
    """A process of Dask's; one crash is enough to blame a task."""
    environment = {**ENVIRONMENT, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return subprocess.Popen([sys.executable, "-m", *command], cwd=folder, env=environment, **quiet)


def end(process: subprocess.Popen[bytes]) -> None:
    for member in [*psutil.Process(process.pid).children(recursive=True), process]:
        member.kill()
    process.wait()


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    port = free_port()
    command = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
    process = daemon(tmp_path_factory.mktemp("scheduler"), *command)
    yield f"tcp://127.0.0.1:{port}", process
    if process.poll() is None:
        end(process)


@pytest.fixture(scope="module")
def cluster_of_two(scheduler, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a scheduler to which two workers come, and come again when they have died."""
    address, _ = scheduler
    folder = tmp_path_factory.mktemp("workers")
    command = ["--nworkers", "2", "--nthreads", "1", "--no-dashboard", "--local-directory", str(folder)]
    process = daemon(folder, "distributed.cli.dask_worker", address, *command)
    yield address
    end(process)


@pytest.fixture
def workers(cluster_of_two) -> str:
    """Address of the scheduler, once both workers are there: the test before may have killed them."""
    from distributed import Client

    with Client(cluster_of_two, timeout=20, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
    return cluster_of_two


@pytest.fixture
def numbered(tmp_path) -> sweep.WorkerPool:
    return load_sweep(write(tmp_path, f"vary:\n  {SPEED}: {{from: 0, to: 19, count: 20}}\n"))


def test_a_scheduler_without_workers_is_reported(scheduler, tmp_path, capsys):
    path = write(tmp_path, QUICK)
    assert main(["sweep", str(path), "--out", str(tmp_path / "out"), "--scheduler", scheduler[0]]) == 2
    message = f"--scheduler {scheduler[0]}: it has no workers; start some with dask worker {scheduler[0]}\n"
    assert capsys.readouterr() == ("", message)
    assert list(tmp_path.iterdir()) == [path]


@pytest.fixture
def in_a_thread(monkeypatch) -> Callable[[], None]:
    """Lets commands without a cluster take their runs in a thread of this process from now on."""
    asked = many.pool

    def pool(chosen, shared):
        return sweep.WorkerPool(1, ThreadPoolExecutor) if chosen.scheduler is None else asked(chosen, shared)

    return lambda: monkeypatch.setattr(many, "pool", pool)


def ran(*command: object) -> None:
    """A command, with its own process beside the workers'."""
    assert main([*map(str, command), "--quiet"]) == 0


def test_an_ensemble_is_the_same_here_and_on_a_cluster(workers, in_a_thread, tmp_path) -> None:
    command = ("ensemble", CONFIGS / "pendulum_rigid.yaml", "--set", SCATTER, "--set", "output.figures=false")
    in_a_thread()
    written = {}
    for name, where in (("here", ()), ("there", ("--scheduler", workers))):
        ran(*command, "--count", 7, "--out", tmp_path / name, *where)
        tables = ("statistics.csv", "convergence.csv", "bands.csv")
        written[name] = [(tmp_path / name / table).read_bytes() for table in tables]
    assert written["here"] == written["there"]
    assert written["here"][0].count(b"\n") > 5


def test_a_cluster_gives_the_table_of_a_thread(workers, in_a_thread, tmp_path, monkeypatch):
    """That of two processes: test_sweep_resume.py."""
    path = write(tmp_path, QUICK)
    in_a_thread()
    ran("sweep", path, "--out", tmp_path / "one")
    monkeypatch.chdir(tmp_path)  # the workers stand elsewhere
    ran("sweep", path.name, "--out", "cluster", "--scheduler", workers, "--plots")
    assert timeless_bytes(tmp_path / "one").count(b"\n") == 13
    assert timeless_bytes(tmp_path / "cluster") == timeless_bytes(tmp_path / "one")
    cases = sorted(entry.name for entry in (tmp_path / "cluster" / "cases").iterdir())
    assert cases == [f"case_{i:02}" for i in range(1, 13)]


def test_a_search_on_a_cluster_is_that_of_this_machine(workers, tmp_path):
    text = f"config: {CONFIGS / 'pendulum_rigid.yaml'}\nparameters: {{{SPEED}: [1, 9]}}\n"
    text += "objective: {maximise: speed}\nmethod: differential_evolution\nevaluations: 20\n"
    (tmp_path / "search.yaml").write_text(text, encoding="utf-8")
    study = load_optimise(tmp_path / "search.yaml")
    with cluster_pool(workers) as pool:
        on_cluster = search(study, pool, function=of_speed, journal=sweep.Journal(tmp_path))
    with sweep.WorkerPool(1, ThreadPoolExecutor) as pool:
        assert search(study, pool, function=of_speed).rows == on_cluster.rows
    assert on_cluster.value > 8
    assert [row.index for row in sweep.Journal(tmp_path)] == list(range(20))


def test_a_case_that_crashes_its_worker_is_a_failed_row(workers, numbered, tmp_path):
    journal = sweep.Journal(tmp_path)
    with cluster_pool(workers) as pool:
        rows = sorted(sweep.run(numbered, pool, function=dying_at_three, journal=journal), key=lambda row: row.index)
    assert [row.index for row in rows] == list(range(20))
    assert [row.index for row in rows if row.failed] == [3]
    assert "the process died" in rows[3].summary["message"]
    # Those of a process of this machine that dies: test_sweep.py.
    with sweep.WorkerPool(1, ThreadPoolExecutor) as pool:
        whole = sorted(sweep.run(numbered, pool, function=of_speed), key=lambda row: row.index)
    assert [row for row in rows if not row.failed] == [row for row in whole if row.index != 3]
    assert list(journal) == rows


@pytest.mark.parametrize(
    ("package", "version", "message"),
    [
        ("exudyn", "0.1", "has exudyn 1"),
        ("granular-contact", "0.0", f"has granular-contact {__version__}, but this process has 0.0"),
        ("python", "2.7", "has python 3"),
        ("nothing-like-this", "1", "has no nothing-like-this, but this process has 1"),
    ],
)
def test_workers_that_are_not_like_this_process_are_refused(workers, monkeypatch, package, version, message):
    monkeypatch.setattr(cluster, "versions", lambda: {package: version})
    with pytest.raises(sweep.WorkerPoolError) as caught:
        cluster_pool(workers)
    assert str(caught.value).startswith(f"--scheduler {workers}: the worker tcp://127.0.0.1:")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_that_workers_do_not_see_is_reported(workers, tmp_path):
    with pytest.raises(sweep.WorkerPoolError, match=r"does not see .*nowhere"):
        cluster_pool(workers, tmp_path / "nowhere")


def test_a_scheduler_that_is_lost_ends_the_sweep_and_keeps_its_rows(scheduler, workers, numbered, tmp_path):
    """The last test of this cluster."""
    journal = sweep.Journal(tmp_path)
    with cluster_pool(workers) as pool:
        rows = sweep.run(numbered, pool, function=of_speed, journal=journal)
        assert len(list(islice(rows, 5))) == 5
        end(scheduler[1])
        with pytest.raises(sweep.WorkerPoolError, match="the connection is lost"):
            list(rows)
    assert 5 <= len(journal) < 20


@pytest.mark.parametrize("listening", [False, True])
def test_a_scheduler_that_does_not_answer_is_named(listening, tmp_path, monkeypatch, capsys):
    """Nobody there, and somebody who says nothing."""
    monkeypatch.setattr(cluster, "ANSWER_SECONDS", 0.5)
    path = write(tmp_path, QUICK)
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        if listening:
            listener.listen()
        address = f"tcp://127.0.0.1:{listener.getsockname()[1]}"
        begin = time.monotonic()
        assert main(["sweep", str(path), "--out", str(tmp_path / "out"), "--scheduler", address]) == 2
        assert time.monotonic() - begin < 5.0
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(f"--scheduler {address}: no Dask scheduler answers (")
    assert list(tmp_path.iterdir()) == [path]


def test_results_lost_with_a_worker_count_as_lost_tasks():
    """Its task had ended; distributed's own executor would leave whoever waits for it waiting."""
    from distributed import KilledWorker

    class Client:
        def submit(self, *_, **__):
            return self

        def add_done_callback(self, call):
            call(self)

        def result(self):
            raise KilledWorker("work", SimpleNamespace(address="tcp://127.0.0.1:2"), 0)

    outcome = cluster._ClusterExecutor(Client(), "tcp://127.0.0.1:1").submit(of_speed)
    assert isinstance(outcome.exception(timeout=1.0), BrokenExecutor)


def test_nothing_of_distributed_writes_to_the_terminal():
    import logging

    client = logging.getLogger("distributed.client")
    client.setLevel(logging.WARNING)  # as distributed does when it is imported
    cluster._silence()
    assert not client.isEnabledFor(logging.ERROR)
    assert not logging.getLogger("distributed.of_later").isEnabledFor(logging.ERROR)


def test_the_answer_is_awaited_for_less_than_ten_seconds():
    assert cluster.ANSWER_SECONDS < 9.0


def test_a_malformed_scheduler_address_is_refused(tmp_path, capsys):
    path = write(tmp_path, QUICK)
    assert main(["sweep", str(path), "--out", str(tmp_path / "out"), "--scheduler", "nonsense"]) == 2
    assert "--scheduler nonsense: missing port number" in capsys.readouterr().err


def test_distributed_is_an_extra(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "distributed", None)
    path = write(tmp_path, QUICK)
    assert main(["sweep", str(path), "--out", str(tmp_path / "out"), "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert capsys.readouterr().err == f"{cluster.MISSING}\n"
