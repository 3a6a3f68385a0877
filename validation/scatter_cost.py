"""Run time of the scatter of grains: runs with and without it, an ensemble of 200 pendulums, a wheel's sweep over slip.

    python validation/scatter_cost.py [--quick]

Runs with and without scatter take turns and are compared by processor time, the least of the repeats. The commands run
as a user runs them, on two workers. The table has their wall-clock time and the processor time of all their processes;
half of the latter is the least possible time on two idle cores.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from granular_contact import build, load
from granular_contact.run import begin
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIGS = ROOT / "configs"
SCATTER = {"relative": 0.15, "length_m": 0.003}
RUNS = {"pendulum": {}, "wheel": {"solver.end_time_s": 1.0}, "dropped": {"solver.end_time_s": 0.2}}
MOST = 1.15  # run time allowed, relative to the run without scatter
WORDS = "medium.scatter={relative: 0.15, length_m: 0.003}"
COMMANDS = {
    "ensemble of 200 pendulums": (["ensemble", "pendulum.yaml", "--count", "200", "--set", WORDS], 10.0),
    "sweep of a wheel over 9 slips": (["sweep", "wheel_slip.yaml"], 20.0),
}
TICK = os.sysconf("SC_CLK_TCK")
LOOK_SECONDS = 0.2


def solve(name: str, scatters: bool) -> float:
    """Processor time (s) of the steps of a solve."""
    changes = RUNS[name] | ({"medium.scatter": SCATTER} if scatters else {})
    solving = begin(build(load(CONFIGS / f"{name}.yaml").scenario.replace(changes))).solving
    began = time.process_time()
    solving.advance()
    return time.process_time() - began


def runs(repeats: int) -> tuple[list[list[str]], list[Claim]]:
    """Time each run without and with scatter, in turn; return rows and claims."""
    rows, claims = [], []
    for name in RUNS:
        times = [(solve(name, False), solve(name, True)) for _ in range(repeats + 1)][1:]
        without, scattered = (min(column) for column in zip(*times, strict=True))
        rows.append([name, f"{1e3 * without:.0f}", f"{1e3 * scattered:.0f}", f"{scattered / without:.2f}"])
        held = scattered <= MOST * without
        detail = f"{scattered / without:.2f} times"
        claims.append(Claim(f"scatter_cost.{name}: scatter adds at most 15 % to the run time", held, detail))
    return rows, claims


class Watch(threading.Thread):
    """Thread that sums up the processor time (s) of all descendants of a process while they live."""

    def __init__(self, root: int) -> None:
        super().__init__(daemon=True)
        self.root, self.seen, self.over = root, dict[int, float](), threading.Event()

    def run(self) -> None:
        """Read the processor times at regular intervals."""
        while not self.over.wait(LOOK_SECONDS):
            self._look()

    def _look(self) -> None:
        parents, spent = {}, {}
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                fields = (folder / "stat").read_text(encoding="ascii").rpartition(")")[2].split()
            except OSError:  # the process has ended
                continue
            parents[int(folder.name)] = int(fields[1])
            spent[int(folder.name)] = (int(fields[11]) + int(fields[12])) / TICK
        below, size = {self.root}, 0
        while size != len(below):
            size = len(below)
            below |= {pid for pid, parent in parents.items() if parent in below}
        self.seen |= {pid: spent[pid] for pid in below if pid in spent}


def timed(command: list[str]) -> tuple[float, float]:
    """Wall-clock time and processor time (s) of a command on two workers."""
    with tempfile.TemporaryDirectory() as folder:
        arguments = [
            command[0],
            str(CONFIGS / command[1]),
            *command[2:],
            "--workers",
            "2",
            "--quiet",
            "--out",
            f"{folder}/o",
        ]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
        began = time.perf_counter()
        process = subprocess.Popen([sys.executable, "-m", "granular_contact", *arguments], env=environment)
        watch = Watch(process.pid)
        watch.start()
        if process.wait() != 0:
            raise RuntimeError(f"{command} failed")
        clock = time.perf_counter() - began
        watch.over.set()
        watch.join()
        return clock, sum(watch.seen.values())


def commands() -> tuple[list[list[str]], list[Claim]]:
    """Time both commands, each in its second run, as the first one may compile; return rows and claims."""
    rows, claims = [], []
    for name, (arguments, limit) in COMMANDS.items():
        timed(arguments if "--count" not in arguments else [*arguments[:3], "4", *arguments[4:]])
        clock, processors = timed(arguments)
        rows.append([name, f"{clock:.1f}", f"{processors:.1f}", f"{processors / 2:.1f}", f"{limit:g}"])
        detail = f"{clock:.1f} s by wall clock, {processors / 2:.1f} s if both cores were otherwise idle"
        claims.append(Claim(f"scatter_cost.{name} takes less than {limit:g} s", clock < limit, detail))
    return rows, claims


def study(quick: bool = False) -> Outcome:
    """Time the runs, and unless quick the commands."""
    rows, claims = runs(5 if quick else 15)
    text = markdown(["run", "without ms", "with scatter ms", "ratio"], rows)
    if not quick:
        of_commands, more = commands()
        load_average = os.getloadavg()[0]
        text += f"\n\nTwo workers; load average {load_average:.1f}, which includes these two.\n\n"
        text += markdown(["command", "wall clock s", "CPU s of all cores", "half of that", "bound s"], of_commands)
        claims += more
    return Outcome(text, tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
