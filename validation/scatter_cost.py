"""What the scatter of grains costs: a run with and without it; an ensemble of 200 pendulums; a wheel's sweep over slip.

    python validation/scatter_cost.py [--quick]

Runs are compared by their processor time, with and without in turn, the least of the repeats. The commands are run as a
user runs them, on two workers, and timed by the clock, with all the processor time that their processes take beside
it: half of that is the least that two cores could do it in, whoever else uses them.
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
MOST = 1.15  # times the run without scatter
WORDS = "medium.scatter={relative: 0.15, length_m: 0.003}"
COMMANDS = {
    "ensemble of 200 pendulums": (["ensemble", "pendulum.yaml", "--count", "200", "--set", WORDS], 10.0),
    "sweep of a wheel over 9 slips": (["sweep", "wheel_slip.yaml"], 20.0),
}
TICK = os.sysconf("SC_CLK_TCK")
LOOK_SECONDS = 0.2


def solve(name: str, scatters: bool) -> float:
    """Processor time (s) of a solve, from its first step on."""
    changes = RUNS[name] | ({"medium.scatter": SCATTER} if scatters else {})
    solving = begin(build(load(CONFIGS / f"{name}.yaml").scenario.replace(changes))).solving
    began = time.process_time()
    solving.advance()
    return time.process_time() - began


def runs(repeats: int) -> tuple[list[list[str]], list[Claim]]:
    """Each run without and with scatter, in turn."""
    rows, claims = [], []
    for name in RUNS:
        times = [(solve(name, False), solve(name, True)) for _ in range(repeats + 1)][1:]
        without, scattered = (min(column) for column in zip(*times, strict=True))
        rows.append([name, f"{1e3 * without:.0f}", f"{1e3 * scattered:.0f}", f"{scattered / without:.2f}"])
        held = scattered <= MOST * without
        words = f"{scattered / without:.2f} times"
        claims.append(Claim(f"scatter_cost.{name}: scatter costs at most 0.15 of a run", held, words))
    return rows, claims


class Watch(threading.Thread):
    """Sums up the processor time (s) of all processes below one, for as long as they live."""

    def __init__(self, root: int) -> None:
        super().__init__(daemon=True)
        self.root, self.seen, self.over = root, dict[int, float](), threading.Event()

    def run(self) -> None:
        """Look again and again."""
        while not self.over.wait(LOOK_SECONDS):
            self._look()

    def _look(self) -> None:
        parents, spent = {}, {}
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                fields = (folder / "stat").read_text(encoding="ascii").rpartition(")")[2].split()
            except OSError:  # it has ended
                continue
            parents[int(folder.name)] = int(fields[1])
            spent[int(folder.name)] = (int(fields[11]) + int(fields[12])) / TICK
        below, size = {self.root}, 0
        while size != len(below):
            size = len(below)
            below |= {pid for pid, parent in parents.items() if parent in below}
        self.seen |= {pid: spent[pid] for pid in below if pid in spent}


def timed(words: list[str]) -> tuple[float, float]:
    """Seconds by the clock, and of processors, of a command on two workers."""
    with tempfile.TemporaryDirectory() as folder:
        arguments = [words[0], str(CONFIGS / words[1]), *words[2:], "--workers", "2", "--quiet", "--out", f"{folder}/o"]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
        began = time.perf_counter()
        process = subprocess.Popen([sys.executable, "-m", "granular_contact", *arguments], env=environment)
        watch = Watch(process.pid)
        watch.start()
        if process.wait() != 0:
            raise RuntimeError(f"{words} failed")
        clock = time.perf_counter() - began
        watch.over.set()
        watch.join()
        return clock, sum(watch.seen.values())


def commands() -> tuple[list[list[str]], list[Claim]]:
    """Both commands, the second time each, as the first may compile."""
    rows, claims = [], []
    for name, (words, most) in COMMANDS.items():
        timed(words if "--count" not in words else [*words[:3], "4", *words[4:]])
        clock, processors = timed(words)
        rows.append([name, f"{clock:.1f}", f"{processors:.1f}", f"{processors / 2:.1f}", f"{most:g}"])
        said = f"{clock:.1f} s by the clock, {processors / 2:.1f} s if two cores had nothing else to do"
        claims.append(Claim(f"scatter_cost.{name} takes less than {most:g} s", clock < most, said))
    return rows, claims


def study(quick: bool = False) -> Outcome:
    """What runs cost, and unless quick the commands."""
    rows, claims = runs(5 if quick else 15)
    text = markdown(["run", "without ms", "with scatter ms", "ratio"], rows)
    if not quick:
        told, more = commands()
        load_average = os.getloadavg()[0]
        text += f"\n\nTwo workers; load average {load_average:.1f}, of which two are these.\n\n"
        text += markdown(["command", "clock s", "processors s", "half of it", "asked"], told)
        claims += more
    return Outcome(text, tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
