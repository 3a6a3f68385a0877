"""What searches gain over gaits and legs set by hand, and whether the gain is real.

    python validation/gaits.py [--quick]

Each configs/optimise_*.yaml is run by the command `granular-contact optimise`, with its results in results/searches. A
search that is complete there is not run again, an incomplete one is continued. The best gait and the original config
are then run for longer and with a tenth of the error (`CHECKED`), because a gain that depends on the instant at which a
run ends, or on its steps, is not real. --quick makes searches of one population each.
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

import yaml

from granular_contact import Results, load, simulate
from granular_contact.config import Loaded
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIGS = sorted((ROOT / "configs").glob("optimise_*.yaml"))
CHECKED = {"accuracy": 1e-3, "end_time_s": 4.0}
QUICK_RUNS = 13
OUT = ROOT / "results" / "searches"
OF = "forward_speed_second_half_m_s", "cost_of_transport", "largest_drive_torque_Nm"
GAINS = ("search", "asked", "gain %", "gain %, checked", "runs", "failed", "outside", "s of all solves")
HEAD = ("search", "", "speed m/s", "cost of transport", "torque mN m", "speed, checked", "cost, checked", "parameters")


@dataclass(frozen=True)
class Found:
    """A finished search: what optimise.json says, and its two runs, each as it was and checked."""

    name: str
    told: dict[str, Any]
    runs: dict[str, tuple[dict[str, Any], dict[str, Any]]]
    seconds: float


def searched(path: Path, out: Path, quick: bool) -> Found:
    """Run the search of a file, or take what there is."""
    name = path.stem.removeprefix("optimise_")
    folder = out / name
    if quick:
        text = path.read_text(encoding="utf-8").replace("config: ", f"config: {path.parent}/")
        path = out / f"{name}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = [line for line in text.splitlines() if not line.startswith("evaluations")]
        path.write_text("\n".join([*lines, f"evaluations: {QUICK_RUNS}", ""]), encoding="utf-8")
    command = [sys.executable, "-m", "granular_contact", "optimise", str(path), "--out", str(folder), "--quiet"]
    subprocess.run(command, check=True)
    told = json.loads((folder / "optimise.json").read_text(encoding="utf-8"))
    with (folder / "history.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    start = {key: float(rows[0][key]) for key in OF}
    best = Results.open(folder / "best").summary
    checks = (_start(folder), load(folder / "best.yaml"))
    checked = [simulate(one.replace(solver=CHECKED, output={"figures": False})).summary for one in checks]
    seconds = sum(float(row["cost.solve_s"] or 0.0) for row in rows)
    return Found(name, told, {"by hand": (start, checked[0]), "found": (best, checked[1])}, seconds)


def _start(folder: Path) -> Loaded:
    """The config as it was, of the search in a folder."""
    return load(yaml.safe_load((folder / "optimise.yaml").read_text(encoding="utf-8"))["config"])


def rows(found: Found) -> list[list[str]]:
    """Two lines of the table, and one with the gain."""
    lines = []
    for which, (as_run, checked) in found.runs.items():
        speed, cost, torque = (as_run[key] for key in OF)
        key = "start" if which == "by hand" else "best"
        numbers = ", ".join(
            f"{name.rpartition('.')[2]} {one[key]:.3g}" for name, one in found.told["parameters"].items()
        )
        lines.append(
            [
                found.name,
                which,
                *(f"{speed:.3f}", f"{cost:.3f}", f"{1e3 * torque:.1f}"),
                *(f"{checked[OF[0]]:.3f}", f"{checked[OF[1]]:.3f}"),
                numbers,
            ]
        )
    return lines


def checked_gain(found: Found) -> float:
    """Relative gain of the gait found over that set by hand, in the longer and finer runs."""
    faster = found.told["sense"] == "maximise"
    before, after = (found.runs[which][1][OF[0] if faster else OF[1]] for which in ("by hand", "found"))
    return float(after / before - 1.0 if faster else 1.0 - after / before)


def gain(found: Found) -> list[str]:
    """Cells of the table of gains."""
    told = found.told["gain_relative"]
    return [
        found.name,
        f"{found.told['sense']} {found.told['objective']}",
        "-" if told is None else f"{100 * told:.1f}",
        f"{100 * checked_gain(found):.1f}",
        f"{found.told['runs']}",
        f"{found.told['failed']}",
        f"{found.told['outside_constraints']}",
        f"{found.seconds:.0f}",
    ]


def study(quick: bool) -> Outcome:
    """Gains of the searches, also in longer and finer runs; quick: one population each."""
    out = OUT.with_name(f"{OUT.name}_quick") if quick else OUT
    searches = [searched(path, out, quick) for path in CONFIGS]
    text = (
        "Gains of the search, and in runs of 4 s at `solver.accuracy: 1e-3`:\n\n"
        f"{markdown(GAINS, [gain(search) for search in searches])}\n\n"
        "The gait set by hand and the one found, as run in the search (1.5 s at 1e-2), and checked:\n\n"
        f"{markdown(HEAD, [row for search in searches for row in rows(search)])}"
    )
    claims = [
        Claim(f"gaits.{search.name}", checked_gain(search) > 0.0, f"{100 * checked_gain(search):.1f} % better, checked")
        for search in searches
    ]
    return Outcome(text, tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
