"""Gains of searches over gaits and legs set by hand, checked by longer and finer runs.

    python validation/gaits.py [--quick]

The command `granular-contact optimise` runs each configs/optimise_*.yaml, with its results in results/searches. A
search that is complete there does not run again; an incomplete one continues. The best gait and the original config
then run for longer and with a tenth of the error (`CHECKED`), because a gain is not real if it depends on the instant
at which a run ends, or on its steps. With --quick each search has one population.
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
GAINS = (
    "search",
    "required gain %",
    "gain %",
    "gain %, checked",
    "runs",
    "failed",
    "outside the range of a medium",
    "s of all solves",
)
HEAD = ("search", "", "speed m/s", "cost of transport", "torque mN m", "speed, checked", "cost, checked", "parameters")


@dataclass(frozen=True)
class Found:
    """A finished search.

    told: contents of optimise.json; runs: summaries "by hand" and "found", each as run in the search and as checked;
    seconds: sum of all solve times.
    """

    name: str
    told: dict[str, Any]
    runs: dict[str, tuple[dict[str, Any], dict[str, Any]]]
    seconds: float


def searched(path: Path, out: Path, quick: bool) -> Found:
    """Run or continue the search of a file, check its best gait, and return the results."""
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
    report = json.loads((folder / "optimise.json").read_text(encoding="utf-8"))
    with (folder / "history.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    start = {key: float(rows[0][key]) for key in OF}
    best = Results.open(folder / "best").summary
    checks = (_start(folder), load(folder / "best.yaml"))
    checked = [simulate(config.replace(solver=CHECKED, output={"figures": False})).summary for config in checks]
    seconds = sum(float(row["cost.solve_s"] or 0.0) for row in rows)
    return Found(name, report, {"by hand": (start, checked[0]), "found": (best, checked[1])}, seconds)


def _start(folder: Path) -> Loaded:
    """Original config of the search in a folder."""
    return load(yaml.safe_load((folder / "optimise.yaml").read_text(encoding="utf-8"))["config"])


def rows(search: Found) -> list[list[str]]:
    """Rows of a search in the table of gaits: the gait set by hand and the one found."""
    lines = []
    for which, (as_run, checked) in search.runs.items():
        speed, cost, torque = (as_run[key] for key in OF)
        key = "start" if which == "by hand" else "best"
        numbers = ", ".join(
            f"{name.rpartition('.')[2]} {values[key]:.3g}" for name, values in search.told["parameters"].items()
        )
        lines.append(
            [
                search.name,
                which,
                *(f"{speed:.3f}", f"{cost:.3f}", f"{1e3 * torque:.1f}"),
                *(f"{checked[OF[0]]:.3f}", f"{checked[OF[1]]:.3f}"),
                numbers,
            ]
        )
    return lines


def checked_gain(search: Found) -> float:
    """Relative gain of the found gait over the one set by hand, in the longer and finer runs."""
    faster = search.told["sense"] == "maximise"
    before, after = (search.runs[which][1][OF[0] if faster else OF[1]] for which in ("by hand", "found"))
    return float(after / before - 1.0 if faster else 1.0 - after / before)


def gain(search: Found) -> list[str]:
    """Row of a search in the table of gains."""
    relative = search.told["gain_relative"]
    return [
        search.name,
        f"{search.told['sense']} {search.told['objective']}",
        "-" if relative is None else f"{100 * relative:.1f}",
        f"{100 * checked_gain(search):.1f}",
        f"{search.told['runs']}",
        f"{search.told['failed']}",
        f"{search.told['outside_constraints']}",
        f"{search.seconds:.0f}",
    ]


def study(quick: bool) -> Outcome:
    """Run and check all searches; quick: one population each."""
    out = OUT.with_name(f"{OUT.name}_quick") if quick else OUT
    searches = [searched(path, out, quick) for path in CONFIGS]
    text = (
        "Gains in the runs of the search, and in check runs of 4 s at `solver.accuracy: 1e-3`:\n\n"
        f"{markdown(GAINS, [gain(search) for search in searches])}\n\n"
        "The gait set by hand and the best gait of the search, in the runs of the search (1.5 s at 1e-2) and in the "
        "check runs:\n\n"
        f"{markdown(HEAD, [row for search in searches for row in rows(search)])}"
    )
    claims = [
        Claim(
            f"gaits.{search.name}",
            checked_gain(search) > 0.0,
            f"{100 * checked_gain(search):.1f} % better in the check runs",
        )
        for search in searches
    ]
    return Outcome(text, tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
