"""Properties that every scene must have, tested on random scenes: symmetry, convergence, energy, right silent answers.

    python validation/properties.py [--quick] [--count 1000] [--seed 0] [--jobs 2] [--store FOLDER] [--keep FOLDER]

A seed determines a scene (validation/random_scenes). The scenes have all kinds of mechanisms and drives, media of all
laws, beds, and all methods of solution. The loader of the command line reads each scene. It runs unchanged and in these
forms:

- mirrored in x; translated by 1 km; with its parts in another order (its *images*);
- with half the step, and with a quarter to a sixteenth of the step (less if that run has a warning);
- with a quarter of the step (less if that is too long), eight times the strips and four times the elements; in space
  with half the step and facets of a third of the size;
- with adaptive steps if they were fixed, and the other way round.

Finer runs, and images in space, have the strips or facets that the first run chose, or multiples of them. A run is
**silent** if it ends well without a warning about its own accuracy. A difference is the greatest distance of any body
(rotations times the radius of the body) over the path length of the part that moves most; it is infinite if an image
does not end well. --store keeps the result of every scene in a file, and runs only scenes without a file; so a study
can be interrupted and continued, or run several times at once. --keep writes every scene that breaks a property as a
config. `properties_in_space.py` does the same in space.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.config import load_scenario
from granular_contact.errors import GranularContactError
from granular_contact.scene import build
from granular_contact.studies.processes import cores, local_processes
from validation.random_scenes import images, images_in_space, in_space
from validation.random_scenes.scenes import Drawn, draw, solve, solve_and_keep, write
from validation.random_scenes.tracks import Track, apart, summaries_apart, track
from validation.stability import GOOD, OF_RANGES
from validation.study import Claim, Outcome
from validation.tables import machine, markdown

COUNT, QUICK, SEED = 1000, 8, 0
SHARE = 0.2  # simulated share of the end time of a scene in the quick form
SILENT = 1e-2  # relative error allowed in a run without a warning
BALANCE = 1e-3
# Relative difference allowed between images. If these are larger: twice the accuracy of adaptive steps, as each of the
# two runs may be off by it; the error of the steps, as round-off grows like that error where the motion diverges.
ALIKE = 1e-4
STRIPS, ELEMENTS = 8, 4
FACETS = 1.0 / 3.0  # factor on the size of facets in finer runs


@dataclass(frozen=True)
class Found:
    """Results of a scene; differences are relative to the path length, NaN if there is none.

    steps, half: difference from runs with shorter steps; space: from the run with finer strips, elements or facets;
    images: from each image, by name; numbers: greatest difference of the summaries at fixed and adaptive steps, and its
    key; other_warned: whether the run with the other kind of steps warned; seconds: processor time of all runs.
    """

    seed: int
    kind: str
    solver: str
    law: str
    end: str
    message: str = ""
    warnings: tuple[str, ...] = ()
    finite: bool = True
    accuracy: float = 0.0
    imbalance: float = math.nan
    steps: float = math.nan
    half: float = math.nan
    space: float = math.nan
    images: dict[str, float] = field(default_factory=dict)
    numbers: tuple[float, str] = (math.nan, "")
    other_warned: bool = False
    seconds: float = 0.0

    @property
    def silent(self) -> bool:
        """Whether the run ended well without a warning about its accuracy."""
        return self.end in GOOD and not self.warnings

    @property
    def alike(self) -> float:
        """Difference allowed between the scene and an image."""
        return max(ALIKE, 2.0 * self.accuracy, _finite(self.steps), _finite(self.half))

    @property
    def cause(self) -> str:
        """Main source of the error."""
        return "steps" if not self.space > 2.0 * self.steps else "strips and elements"


@dataclass(frozen=True)
class World:
    """Functions and limits for scenes in the plane or in space.

    divided: makes a config with finer strips, elements or facets, and with steps shorter by a factor; shorter: the
    first factor to try; most_steps: limit on the steps of the reference for steps; wall: limit on the wall-clock time
    of any run, s.
    """

    draw: Callable[[int, Path], Drawn]
    images: dict[str, images.Image]
    divided: Callable[[images.Tree, float], images.Tree]
    shorter: float
    most_steps: int
    wall: float


WORLDS = {
    "plane": World(
        draw,
        {
            "mirror image": images.mirrored,
            "translated by 1 km": images.shifted,
            "parts in another order": images.reordered,
        },
        lambda tree, factor: images.divided(images.finer(tree, factor), STRIPS, ELEMENTS),
        shorter=4.0,
        most_steps=8_000,
        wall=15.0,
    ),
    "space": World(
        in_space.draw,
        {
            "mirror image": images_in_space.mirrored,
            "turned about the vertical": images_in_space.turned,
            "translated by 1 km": images_in_space.shifted,
            "parts in another order": images.reordered,
        },
        lambda tree, factor: images_in_space.finer(images.finer(tree, factor), FACETS),
        shorter=2.0,  # not 4, as there are nine times as many facets
        most_steps=4_000,
        wall=120.0,
    ),
}


def look(seed: int, quick: bool = False, world: str = "plane") -> Found:
    """Draw a scene and run it in all its forms, in a process of a pool; quick: only the beginning of the scene."""
    began = time.process_time()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            drawn = WORLDS[world].draw(seed, folder)
        except GranularContactError as error:
            return Found(seed, "-", "-", "-", "refused", str(error).splitlines()[0])
        result = _judged(drawn, folder, SHARE if quick else 1.0, WORLDS[world])
    return Found(**{**vars(result), "seconds": time.process_time() - began})


def look_or_read(seed: int, quick: bool = False, store: Path | None = None, world: str = "plane") -> Found:
    """Same as `look`, but read the result from the store if it is there, and write it there if not."""
    if store is None:
        return look(seed, quick, world)
    path = store / f"{world}_{seed}{'_quick' * quick}.json"
    if path.exists():
        read = json.loads(path.read_text(encoding="utf-8"))
        return Found(**{key: tuple(value) if isinstance(value, list) else value for key, value in read.items()})
    result = look(seed, quick, world)
    part = path.with_suffix(f".{os.getpid()}")  # renamed below, so that no process reads a part of a file
    part.write_text(json.dumps(vars(result)), encoding="utf-8")
    part.replace(path)
    return result


def _judged(drawn: Drawn, folder: Path, share: float, world: World) -> Found:
    solver = drawn.tree["solver"]
    tree = drawn.tree | {"solver": solver | {"max_wall_s": world.wall, "end_time_s": share * solver["end_time_s"]}}
    try:
        scene = build(load_scenario(write(tree, folder)))
        results, refined = solve_and_keep(tree, folder)
    except GranularContactError as error:
        return Found(drawn.seed, drawn.kind, drawn.solver, _law(tree), "refused", str(error).splitlines()[0])
    values: dict[str, Any] = {
        "seed": drawn.seed, "kind": drawn.kind, "solver": drawn.solver, "law": _law(tree),
        "end": results.status.code, "message": results.status.message, "warnings": _doubts(results),
        "finite": bool(np.isfinite(results.table).all()),
        "imbalance": results.summary["energy"]["imbalance_relative"],
        "accuracy": scene.solver.accuracy or 0.0,
    }  # fmt: skip
    if results.status.code not in GOOD:
        return Found(**values)
    own = track(results, tree, scene.least_path)
    forms = _Forms(own, folder, scene.least_path)
    base = refined if scene.in_space else tree  # in the plane an image chooses the same strips as the run
    values["images"] = {
        name: forms.off(image, base, name == "mirror image", ends=math.inf) for name, image in world.images.items()
    }
    values["half"] = forms.off(lambda one: images.finer(one, 2.0), refined, silent=True)
    steps = tree["solver"]["end_time_s"] / tree["solver"].get("step_s", images.STEP)
    most = min(16.0, max(4.0, 2.0 ** math.floor(math.log2(world.most_steps / steps))))
    factors = [most, 4.0 * most]
    values["steps"] = forms.off_reference(images.finer, refined, factors)
    # Refused without a fault: a body that has 200 000 facets can't have facets of a third of the size.
    values["space"] = forms.off_reference(world.divided, refined, [world.shorter, *factors], refused=math.nan)
    if (other := forms.run(images.chosen, tree)) is not None and other.status.code in GOOD:
        values["numbers"] = summaries_apart(
            results, other, own, max(scene.length, 1e-3), scene.mass * abs(scene.gravity)
        )
        values["other_warned"] = bool(_doubts(other))
    return Found(**values)


def _law(tree: Any) -> str:
    media = tree["medium"]
    return "+".join(
        medium if isinstance(medium, str) else medium.get("law", medium.get("from"))
        for medium in (media if isinstance(media, list) else [media])
    )


def _doubts(results: Any) -> tuple[str, ...]:
    return tuple(w for w in results.warnings if not any(word in w for word in OF_RANGES))


@dataclass(frozen=True)
class _Forms:
    """Runs of other forms of a scene, compared with the track of the scene itself."""

    own: Track
    folder: Path
    least_path: float

    def run(self, image: images.Image, tree: Any) -> Any:
        """Run a form of the scene; None if the scene has no such form."""
        try:
            return solve(image(tree), self.folder)
        except images.NoImage:
            return None

    def off(
        self,
        image: images.Image,
        tree: Any,
        mirror: bool = False,
        silent: bool = False,
        ends: float = math.nan,
        refused: float = math.inf,
    ) -> float:
        """Run a form of the scene and return its difference from the scene; NaN if there is no such form.

        silent: return NaN if the run of the form has a warning; ends, refused: value to return if the run does not end
        well, or if the form is refused.
        """
        try:
            results = self.run(image, tree)
        except GranularContactError:
            return refused
        if results is None or (silent and _doubts(results)):
            return math.nan
        if results.status.code not in GOOD:
            return ends
        return apart(self.own, track(results, image(tree), self.least_path), mirror)

    def off_reference(
        self,
        finer: Callable[[images.Tree, float], images.Tree],
        tree: Any,
        factors: Sequence[float],
        refused: float = math.inf,
    ) -> float:
        """Difference from the first finer run without a warning, else from the finest; NaN if that does not end well.

        finer: makes a config with steps shorter by a factor; factors: in the order in which they are tried. A run with
        a warning may be farther off than the scene itself. refused: as in `off`.
        """
        for factor in factors:
            difference = self.off(partial(finer, factor=factor), tree, silent=factor < factors[-1], refused=refused)
            if math.isfinite(difference):
                break
        return difference


def every(
    seeds: Sequence[int],
    jobs: int,
    quick: bool = False,
    told: Callable[[Found], None] = lambda _: None,
    store: Path | None = None,
    world: str = "plane",
) -> list[Found]:
    """Results of all scenes, run on `jobs` processes of one thread each.

    told: called with each result as soon as it is known; store: folder with known results.
    """
    results = []
    if store is not None:
        store.mkdir(parents=True, exist_ok=True)
    with local_processes(jobs) as pool:
        for result in pool.map(look_or_read, *zip(*((seed, quick, store, world) for seed in seeds), strict=True)):
            told(result)
            results.append(result)
    return results


# ---- tables and claims ----


def _share(value: float) -> str:
    return "-" if not math.isfinite(value) else f"{value:.2%}"


def _greatest(values: Sequence[float]) -> float:
    return max((value for value in values if math.isfinite(value)), default=math.nan)


def silent_table(scenes: Sequence[Found], by: Callable[[Found], str], of: str) -> str:
    """Table of the silent errors of one cause (`of`: "steps" or "space"), grouped by a property of the scenes."""
    rows = []
    for name in [*sorted({by(scene) for scene in scenes}), "all"]:
        group = [scene for scene in scenes if name in (by(scene), "all")]
        silent = [scene for scene in group if scene.silent]
        off = [getattr(scene, of) for scene in silent]
        judged = [value for value in off if math.isfinite(value)]
        middle = _share(float(np.median(judged))) if judged else "-"
        counts = [sum(value > limit for value in judged) for limit in (5e-3, SILENT)]
        rows.append([name, len(group), len(silent), len(judged), middle, *counts, _share(_greatest(judged))])
    head = ["", "scenes", "silent", "judged", "median", "above 0.5 %", "above 1 %", "greatest"]
    return markdown(head, rows)


def property_table(scenes: Sequence[Found]) -> str:
    """Table of the differences of images, half the step, and fixed from adaptive steps, and of the energy balance."""
    rows = []
    for name in _images(scenes):
        off = [scene.images[name] for scene in scenes if math.isfinite(scene.images.get(name, math.nan))]
        rows.append([name, len(off), *_spread(off)])
    for name, off in (
        ("half the step", [scene.half for scene in scenes if scene.silent]),
        ("summaries at fixed and chosen steps", [scene.numbers[0] for scene in scenes if _both_silent(scene)]),
        ("energy imbalance, silent", [scene.imbalance for scene in scenes if scene.silent]),
        ("energy imbalance, warned", [scene.imbalance for scene in scenes if scene.end in GOOD and scene.warnings]),
    ):
        known = [value for value in off if math.isfinite(value)]
        rows.append([name, len(known), *_spread(known)])
    return markdown(["property", "scenes", "median", "90 %", "greatest"], rows)


def _images(scenes: Sequence[Found]) -> list[str]:
    return list(dict.fromkeys(name for scene in scenes for name in scene.images))


def _spread(values: Sequence[float]) -> list[str]:
    return [f"{value:.1e}" for value in np.quantile(values, (0.5, 0.9, 1.0))] if values else ["-"] * 3


def _both_silent(scene: Found) -> bool:
    return scene.silent and not scene.other_warned


def violations(scenes: Sequence[Found]) -> dict[str, list[Found]]:
    """Scenes that break a property, by name of the claim."""
    broken = {
        "every number is finite": [scene for scene in scenes if not scene.finite],
        "every run reaches its end or says what to change": [
            scene for scene in scenes if scene.end not in (*GOOD, "refused") and not _explained(scene)
        ],
        "no run fails": [scene for scene in scenes if scene.end == "failed"],
    }
    for name in _images(scenes):
        broken[name] = [scene for scene in scenes if scene.silent and scene.images.get(name, 0.0) > scene.alike]
    return broken | {
        "halving the step changes a result without a warning by at most 1 %": [
            scene for scene in scenes if scene.silent and scene.half > SILENT
        ],
        "summaries with fixed and chosen steps differ by at most 2 % or four times the accuracy": [
            scene
            for scene in scenes
            if _both_silent(scene) and scene.numbers[0] > max(2.0 * SILENT, 4.0 * scene.accuracy)
        ],
        "an energy imbalance above 1e-3 always has a warning": [
            scene for scene in scenes if scene.silent and scene.imbalance > BALANCE
        ],
        "no error of steps above 1 % is without a warning": [
            scene for scene in scenes if scene.silent and scene.steps > SILENT
        ],
        "no error of strips and elements above 1 % is without a warning": [
            scene for scene in scenes if scene.silent and scene.space > SILENT and scene.cause != "steps"
        ],
    }


def _explained(scene: Found) -> bool:
    return scene.end == "failed" and any(word in scene.message for word in ("take a", "needs", "allowed"))


def worst(scenes: Sequence[Found], most: int = 12) -> str:
    """Table of the scenes with the largest silent errors."""
    off = [scene for scene in scenes if scene.silent and max(_finite(scene.steps), _finite(scene.space)) > 5e-3]
    off.sort(key=lambda scene: -max(_finite(scene.steps), _finite(scene.space)))
    rows = [[s.seed, s.kind, s.solver, s.law, s.cause, _share(s.steps), _share(s.space)] for s in off]
    return markdown(["seed", "kind", "solver", "law", "cause", "steps", "strips and steps"], rows[:most])


def _finite(value: float) -> float:
    return value if math.isfinite(value) else 0.0


def outcome(scenes: Sequence[Found], of: str = "properties") -> Outcome:
    """Tables and claims of a study."""
    ends = Counter(scene.end if scene.end not in GOOD else "silent" if scene.silent else "warned" for scene in scenes)
    listed = ", ".join(f"{count} {end}" for end, count in ends.most_common())
    parts = [f"{len(scenes)} scenes: {listed}."]
    parts += ["Symmetry, convergence and energy.", property_table(scenes)]
    parts += [
        "Errors of the steps in scenes without a warning, by kind of mechanism.",
        silent_table(scenes, lambda scene: scene.kind, "steps"),
    ]
    parts += [
        "The same, against a reference with a quarter of the step, 8 times the strips and 4 times the elements (in "
        "space half the step and facets of a third of the size)."
    ]
    parts += [silent_table(scenes, lambda scene: scene.kind, "space")]
    parts += ["The same by solver.", silent_table(scenes, lambda scene: scene.solver, "space")]
    parts += ["The largest errors without a warning.", worst(scenes)]
    broken = violations(scenes)
    claims = [Claim(f"{of}.{name}", not bad, _detail(name, bad, scenes)) for name, bad in broken.items()]
    return Outcome("\n\n".join(parts), tuple(claims))


def _detail(name: str, bad: Sequence[Found], scenes: Sequence[Found]) -> str:
    seeds = f" (seeds {', '.join(str(scene.seed) for scene in bad[:8])}{', ...' * (len(bad) > 8)})" if bad else ""
    keys = Counter(scene.numbers[1] for scene in bad) if name.startswith("summaries") else Counter()
    most = f"; most often {', '.join(f'{key} {count}' for key, count in keys.most_common(4))}" if keys else ""
    return f"{len(bad)} of {len(scenes)} scenes violate it{seeds}{most}"


def keep(scenes: Sequence[Found], target: Path, world: str = "plane") -> None:
    """Write each scene that breaks a property into a folder named by its seed, with the names of the properties."""
    broken: dict[int, list[str]] = {}
    for name, bad in violations(scenes).items():
        for scene in bad:
            broken.setdefault(scene.seed, []).append(name)
    for seed, names in broken.items():
        folder = target / str(seed)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        write(WORLDS[world].draw(seed, folder).tree, folder)
        drawn = next(scene for scene in scenes if scene.seed == seed)
        (folder / "found.txt").write_text("\n".join([*names, str(drawn)]) + "\n", encoding="utf-8")


def study(quick: bool = False) -> Outcome:
    """Run all scenes; quick: the beginnings of the first ones."""
    return outcome(every(range(SEED, SEED + (QUICK if quick else COUNT)), cores(), quick))


def main(arguments: Sequence[str] | None = None, world: str = "plane", of: str = "properties") -> int:
    """Run the study as a script; return 0 if all claims hold, else 1."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help=f"run only the first part of {QUICK} scenes")
    parser.add_argument("--count", type=int, help=f"number of scenes; default {COUNT}")
    parser.add_argument("--seed", type=int, default=SEED, help="seed of the first scene")
    parser.add_argument("--jobs", type=int, default=cores(), help="number of processes")
    parser.add_argument(
        "--store", type=Path, help="folder for the results of each scene; a stopped run continues from it"
    )
    parser.add_argument("--keep", type=Path, help="folder for the configs of scenes that violate a property")
    chosen = parser.parse_args(arguments)
    count = chosen.count or (QUICK if chosen.quick else COUNT)
    began = time.perf_counter()
    scenes = every(range(chosen.seed, chosen.seed + count), chosen.jobs, chosen.quick, _progress, chosen.store, world)
    result = outcome(scenes, of)
    spent = f"{time.perf_counter() - began:.0f} s, {sum(scene.seconds for scene in scenes):.0f} s of processor time"
    print(f"{machine('exudyn', 'numba')}; {spent}\n\n{result.text}\n")
    for claim in result.claims:
        print(claim)
    if chosen.keep is not None:
        keep(scenes, chosen.keep, world)
    return 0 if all(claim.held for claim in result.claims) else 1


def _progress(scene: Found) -> None:
    line = [
        f"{scene.seed:5d} {scene.kind:18s} {scene.solver:22s} {scene.law[:24]:24s} {scene.end:9s} "
        f"{len(scene.warnings)} w"
    ]
    line += [f"E {scene.imbalance:.1e} steps {scene.steps:.1e} half {scene.half:.1e} space {scene.space:.1e}"]
    line += [
        " ".join(f"{value:.0e}" for value in scene.images.values()),
        f"{scene.numbers[0]:.1e} {scene.seconds:.1f} s",
    ]
    print("  ".join(line), scene.message if scene.end not in GOOD else "", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
