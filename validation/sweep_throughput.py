"""How many impacts a second a sweep runs, what two cores gain over one, and whether its memory grows.

    python validation/sweep_throughput.py [--quick]

The whole command, as a user runs it: 10 000 impacts of the source's single-mode pendulum, 1 000 of the finite-element
one, by Latin hypercube over four inputs. One worker and two in turn, best of the repeats each, so that a machine that
others use for a while counts less.

Efficiency is the time on one worker over twice that on two. `whole` has starting, reading, checking and writing in it,
`running` is from the first row to the last. `by CPU` does not depend on who else uses the cores: what the workers
compute over that and what the parent needs besides (its CPU seconds beyond those of a sweep of two cases), which on two
cores is taken from the workers.
"""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from validation.tables import machine, markdown

CONFIG = ROOT / "configs" / "pendulum.yaml"
METHODS = {"single mode, reduced": "{reduced: {modes: 1}}", "finite elements": "engine"}
COUNTS = {"single mode, reduced": 10_000, "finite elements": 1_000}
RANGES = """
    medium.eta_d: [4, 9]
    medium.eta_h: [4, 16]
    initial.impact_speed_rad_s: [2, 9]
    initial.impact_angle_deg: [22, 60]
"""
LOOK_SECONDS = 0.05
TICK = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True)
class Timing:
    """One sweep: seconds in all and from the first row to the last, CPU s and memory (MB) of the parent.

    memory: at a fifth of the rows, and the most after that.
    """

    whole: float
    running: float
    parent: float
    memory: tuple[float, float]


def sweep_file(method: str, count: int, folder: Path) -> Path:
    path = folder / "many.yaml"
    sample = f"sample:\n  method: latin_hypercube\n  count: {count}\n  ranges:{RANGES}"
    path.write_text(f"config: {CONFIG}\nset: {{method: {METHODS[method]}}}\n{sample}", encoding="utf-8")
    return path


def run(method: str, count: int, workers: int) -> tuple[Timing, int]:
    """Time the command from outside; with the number of cases that have not failed."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = sweep_file(method, count, folder)
        words = ["sweep", str(path), "--out", str(folder / "out"), "--workers", str(workers), "--quiet"]
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        begin = time.perf_counter()
        with subprocess.Popen([sys.executable, "-m", "granular_contact", *words], env=environment) as process:
            timing = watch(process, folder / "out.part" / "journal", begin)
        with (folder / "out" / "table.csv").open(encoding="utf-8", newline="") as file:
            good = sum(row["status"] in ("rest", "end_time") for row in csv.DictReader(file))
    return timing, good


def watch(process: subprocess.Popen[bytes], journal: Path, begin: float) -> Timing:
    """Look at the parent, and at the bytes in its journal, until it is gone."""
    seen: list[tuple[float, int, float]] = []  # seconds, bytes of rows, MB
    cpu = 0.0
    while process.poll() is None:
        time.sleep(LOOK_SECONDS)
        try:
            cpu = cpu_seconds(process.pid)
            size = sum(path.stat().st_size for path in journal.glob("*.jsonl"))
            seen.append((time.perf_counter() - begin, size, memory(process.pid)))
        except OSError:  # gone in between
            continue
    whole = time.perf_counter() - begin
    rows = [one for one in seen if one[1] > 0] or seen[-1:]  # of very few cases none may be seen
    most = max(one[1] for one in rows)
    first = rows[0][0]
    last = next(one[0] for one in rows if one[1] == most)
    early = next(one[2] for one in rows if one[1] >= most / 5)
    return Timing(whole, last - first, cpu, (early, max(one[2] for one in rows)))


def cpu_seconds(process: int) -> float:
    """CPU seconds of one process, without its children."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def memory(process: int) -> float:
    """Resident memory of one process, MB."""
    text = Path(f"/proc/{process}/status").read_text()
    line = next((line for line in text.splitlines() if line.startswith("VmRSS")), "VmRSS: 0 kB")
    return int(line.split()[1]) / 1024.0


def measure(method: str, count: int, repeats: int) -> tuple[list[str], float]:
    """A row of the table, and the efficiency of the whole command."""
    small, _ = run(method, 2, 1)  # compiles, where nothing is compiled yet
    small, _ = run(method, 2, 1)
    timings: dict[int, list[Timing]] = {1: [], 2: []}
    good = count
    for _ in range(repeats):
        for workers, found in timings.items():
            timing, fine = run(method, count, workers)
            found.append(timing)
            good = min(good, fine)
    one, two = (min(timings[workers], key=lambda t: t.whole) for workers in (1, 2))
    running = min(t.running for t in timings[1]) / (2 * min(t.running for t in timings[2]))
    parent = max(0.0, min(t.parent for t in timings[2]) - small.parent)
    computed = min(t.running for t in timings[1])
    whole = one.whole / (2 * two.whole)
    cells = [
        method,
        f"{good} of {count}",
        f"{one.whole:.1f}",
        f"{two.whole:.1f}",
        f"{count / one.whole:.0f}",
        f"{count / two.whole:.0f}",
        f"{100 * whole:.1f}",
        f"{100 * running:.1f}",
        f"{100 * computed / (computed + parent):.1f}",
        f"{1e3 * parent / count:.3f}",
        f"{two.memory[0]:.0f}, {two.memory[1]:.0f}",
    ]
    return cells, whole


HEAD = (
    "impacts",
    "run",
    "s, 1 worker",
    "s, 2 workers",
    "per s, 1",
    "per s, 2",
    "efficiency %, whole",
    "running",
    "by CPU",
    "parent ms per case",
    "parent MB at a fifth, most",
)


def main() -> int:
    """Print the table; 0 when two workers keep 95 % of what they could do, else 1."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="a tenth of the impacts, once")
    parser.add_argument("--repeats", type=int, default=3)
    chosen = parser.parse_args()
    share, repeats = (10, 1) if chosen.quick else (1, chosen.repeats)
    found = [measure(method, count // share, repeats) for method, count in COUNTS.items()]
    print(f"{machine('exudyn', 'numba', 'scipy')}; best of {repeats} after a warm-up\n")
    print(markdown(HEAD, [cells for cells, _ in found]))
    return 0 if all(whole >= 0.95 for _, whole in found) else 1


if __name__ == "__main__":
    sys.exit(main())
