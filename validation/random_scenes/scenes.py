"""Random scene by its seed: mechanism, medium, bed, load and solver as a dict of plain YAML types, and its files."""

from __future__ import annotations

import copy
import csv
import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random
from typing import Any

import yaml

from granular_contact.config import load_scenario
from granular_contact.errors import GranularContactError
from granular_contact.results.observation import results
from granular_contact.run import begin, run
from granular_contact.sand.space.facets import size_for_accuracy
from granular_contact.scene import build
from granular_contact.scene.types import Minimal, Reduced
from validation.fuzzing.media import law
from validation.random_scenes.bodies import media
from validation.random_scenes.images import STEP, is_reduced
from validation.random_scenes.mechanisms import KINDS

Tree = dict[str, Any]
RUN = "run.yaml"
TIMES, SEEDS = 8, 1_000_003


@dataclass(frozen=True)
class Drawn:
    """A random scene.

    kind: of the mechanism; solver: kind of steps and method of solution; tree: config, with the further keys `files`
    and, for images, `aside`, which no config has.
    """

    seed: int
    kind: str
    solver: str
    tree: Tree


def draw(seed: int, folder: Path) -> Drawn:
    """Draw the scene of a seed, with an explicit surface; draw again if the parts do not fit together.

    Files are written to `folder` to find the height at which the mechanism touches the surface.

    Raises
    ------
    GranularContactError
        No draw fitted together.
    """
    return fitting(seed, folder, _drawn)


def fitting(seed: int, folder: Path, make: Callable[[int, Random, Path], Drawn]) -> Drawn:
    """Draw with `make` from a seed until the parts fit together; errors as those of `draw`."""
    for attempt in range(TIMES - 1):
        with suppress(GranularContactError):
            return make(seed, Random(seed + SEEDS * attempt), folder)
    return make(seed, Random(seed + SEEDS * TIMES), folder)


def _drawn(seed: int, rng: Random, folder: Path) -> Drawn:
    kind = rng.choices(list(KINDS), [weight for _, weight, _ in KINDS.values()])[0]
    make, _, families = KINDS[kind]
    family = rng.choice(families)
    scene: Tree = {}
    model, starts = make(rng, family, scene)
    buried = scene.pop("buried", 0.0)
    tree: Tree = {"model": {"name": "drawn"} | model, "medium": media(rng, family), "initial": {"joints": starts}}
    tree |= scene | {"load": _load(rng, family, scene), "output": {"bodies": "all"}}
    end = rng.uniform(0.08, 0.22)
    tree["solver"] = {"end_time_s": round(end, 3), "rest_time_s": rng.choice((None, 0.02, 0.02))}
    solver = _solver(rng, tree)
    _refine_media(tree)
    _lay(rng, tree, family, buried, folder)
    method = build(load_scenario(write(tree, folder))).method
    by = "" if isinstance(method, Reduced) else ", minimal" if isinstance(method, Minimal) else ", engine"
    return Drawn(seed, kind, f"{solver}{by}", tree)


def _solver(rng: Random, tree: Tree) -> str:
    """Draw the kind of steps; fixed steps mostly have the usual size."""
    if is_reduced(tree):
        return "reduced"
    if rng.random() < 0.3:
        tree["solver"]["accuracy"] = rng.choice((1e-2, 1e-3, 1e-3))
        return "chosen steps"
    # The step is given explicitly, since a driven mechanism has adaptive steps by default.
    tree["solver"]["step_s"] = 10.0 ** rng.uniform(-4.0, -3.0) if rng.random() < 0.3 else STEP
    return "fixed steps"


def _load(rng: Random, family: str, scene: Tree) -> Tree:
    """Draw settings of the load, mostly the default."""
    load: Tree = {}
    if rng.random() < 0.15 and not is_reduced(scene):
        load["friction"] = {"type": "smooth", "reference_speed_m_s": 10.0 ** rng.uniform(-3, -1.5)}
    elif rng.random() < 0.3:
        load["friction"] = {"type": "elastoplastic", "yield_displacement_m": 10.0 ** rng.uniform(-5.5, -3.5)}
    if family == "bar" and rng.random() < 0.2:
        load["end_cap"] = True
    return load


def _refine_media(tree: Tree) -> None:
    """Add the required number to the one preset that lacks it."""
    if isinstance(tree["medium"], dict) and "from" in tree["medium"]:
        tree["medium"]["stiffness_N_m"] = 60.0


def _lay(rng: Random, tree: Tree, family: str, buried: float, folder: Path) -> None:
    """Add a bed to the scene, at the height of touch or lower, with a slope, a profile, layers or a floor."""
    plain = is_reduced(tree)
    bed: Tree = {}
    form = rng.random()
    if form < 0.2 and not plain:
        bed["slope_deg"] = rng.uniform(-25.0, 25.0)
    lower = rng.choice((0.0, 0.0, rng.uniform(0.0, 0.02))) - buried
    touch = touching(tree | {"bed": bed} if bed else tree, folder)
    if 0.2 <= form < 0.35 and not plain:
        x = [rng.uniform(-0.3, -0.05), rng.uniform(-0.04, 0.04), rng.uniform(0.05, 0.3)]
        bed["profile_m"] = [[at, touch - lower - rng.uniform(0.0, 0.02)] for at in x]
    else:
        bed["height_m"] = touch - lower
    if rng.random() < 0.15 and not plain:
        bed["depth_m"] = rng.uniform(0.05, 0.12) + buried
        if rng.random() < 0.7 and not plain:
            stiffness = 10.0 ** rng.uniform(4, 6)
            bed["floor"] = {"stiffness_N_m2": stiffness, "damping_s_m": rng.choice((0.0, 0.3))}
    if rng.random() < 0.15 and not plain and family != "ball":
        bed["layers"] = [{"top_m": rng.uniform(0.005, 0.04), "medium": law(rng, family)}]
    tree["bed"] = bed


def touching(tree: Tree, folder: Path) -> float:
    """Height (m) at x = 0 of the surface that the mechanism touches at its start; with a height map: of its zero."""
    scene = build(load_scenario(write(tree | {"output": {"figures": False}}, folder)))
    bed: Any = scene.bed
    height = float(bed.origin if scene.in_space else bed.height(0.0))
    return height if math.isfinite(height) else 0.0


def write(tree: Tree, folder: Path) -> Path:
    """Write a scene and its files into a folder; return the path of the config."""
    tree = copy.deepcopy(tree)
    tree.pop("aside", None)
    for name, columns in tree.pop("files", {}).items():
        if isinstance(columns, str):
            (folder / name).write_text(columns, encoding="utf-8")
            continue
        with (folder / name).open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(columns)
            rows.writerows(zip(*columns.values(), strict=True))
    text = yaml.safe_dump(tree, sort_keys=False)
    (folder / RUN).write_text(text, encoding="utf-8")
    return folder / RUN


def solve(tree: Tree, folder: Path) -> Any:
    """Run a scene through the loader of the command line; `aside` may contain the sizes of its facets."""
    scene: Any = build(load_scenario(write(tree, folder)))
    shares = tree.get("aside", {}).get("facets")
    if shares is None:
        return run(scene)
    usual = _size_asked(scene)
    begun = begin(replace(scene, facet_shares={body: share / usual for body, share in shares.items()}))
    begun.solving.advance()
    return results(begun.observe(begun.solving.trajectory()), {}, 0)


def solve_and_keep(tree: Tree, folder: Path) -> tuple[Any, Tree]:
    """Run a scene; return the results, and the scene with the strips or facets that the run chose."""
    scenes: list[Any] = []
    done = run(build(load_scenario(write(tree, folder))), inspect=lambda system, _: scenes.append(system.scene))
    if not scenes:  # a reduced model
        return done, tree
    if not scenes[0].in_space:
        strips = {f"strips_{key}": number for key, number in done.summary.get("strips", {}).items()}
        return done, tree | {"load": tree["load"] | strips}
    usual, chosen = _size_asked(scenes[0]), scenes[0].facet_shares
    shares = {body.name: usual * chosen.get(body.name, 1.0) for body in scenes[0].rigid}
    return done, tree | {"aside": tree.get("aside", {}) | {"facets": shares}}


def _size_asked(scene: Any) -> float:
    """Facet size for the accuracy of a scene, over the facet size without an accuracy."""
    return size_for_accuracy(1.0, scene.solver.named).edge / size_for_accuracy(1.0, None).edge
