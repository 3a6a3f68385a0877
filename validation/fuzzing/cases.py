"""Files of a fuzzing case, determined by its seed."""

from __future__ import annotations

import shutil
from pathlib import Path
from random import Random
from typing import Any

import yaml

from validation.fuzzing.mutations import damaged, rescaled
from validation.fuzzing.scenarios import scenario

ROOT = Path(__file__).parents[2]
CONFIGS = sorted((ROOT / "configs").glob("*.yaml"))
MODELS = sorted((ROOT / "models").glob("*.yaml"))
PRESETS = sorted((ROOT / "granular_contact" / "laws" / "presets").glob("*.yaml"))
_KINDS = ("drawn", "rescaled", "damaged", "config", "model", "preset")
_WEIGHTS = (40, 15, 15, 12, 10, 8)
RUN = "run.yaml"


def kind_of(seed: int) -> str:
    """Kind of the case that a seed determines."""
    return Random(seed).choices(_KINDS, _WEIGHTS)[0]


def write(seed: int, folder: Path) -> Path:
    """Write the files of a case into an empty folder; return the path of its config.

    Kinds of cases: drawn, a random scenario; rescaled, a random scenario with numbers of a wrong magnitude; damaged, a
    mutated random scenario; config, model and preset: a run that uses a mutated copy of a shipped file.
    """
    rng = Random(seed)
    kind = rng.choices(_KINDS, _WEIGHTS)[0]
    text = {"config": _config, "model": _model, "preset": _preset}.get(kind, _drawn)(rng, kind, folder)
    # A lone surrogate can't be encoded in UTF-8, so no file has one.
    (folder / RUN).write_text(text, encoding="utf-8", errors="replace")
    return folder / RUN


def keep(folder: Path, target: Path) -> None:
    """Copy the files of a case to a target folder."""
    shutil.copytree(folder, target, dirs_exist_ok=True)


def _drawn(rng: Random, kind: str, _: Path) -> str:
    tree = scenario(rng)
    if kind == "rescaled":
        tree = rescaled(rng, tree, rng.randint(1, 3))
    text = _dumped(tree)
    return damaged(rng, text) if kind == "damaged" else text


def _config(rng: Random, _: str, folder: Path) -> str:
    chosen = rng.choice(CONFIGS)
    for path in CONFIGS:  # a sweep refers to them
        shutil.copy(path, folder)
    return damaged(rng, chosen.read_text(encoding="utf-8"))


def _model(rng: Random, _: str, folder: Path) -> str:
    text = damaged(rng, rng.choice(MODELS).read_text(encoding="utf-8"))
    (folder / "mutant.yaml").write_text(text, encoding="utf-8", errors="replace")
    start: Any = {"impact_angle_deg": rng.uniform(-90, 90), "impact_speed_rad_s": rng.gauss(0, 5)}
    start = start if rng.random() < 0.7 else {"settle": True}
    return _dumped({"model": "mutant.yaml", "medium": rng.choice(("play_sand", "rft_generic", None)), "initial": start})


def _preset(rng: Random, _: str, folder: Path) -> str:
    text = damaged(rng, rng.choice(PRESETS).read_text(encoding="utf-8"))
    (folder / "mutant.yaml").write_text(text, encoding="utf-8", errors="replace")
    start = {"impact_angle_deg": rng.uniform(0, 90), "impact_speed_rad_s": rng.gauss(0, 5)}
    return _dumped({"model": "compound_pendulum", "medium": "mutant.yaml", "initial": start})


def _dumped(tree: Any) -> str:
    return str(yaml.safe_dump(tree, sort_keys=False))
