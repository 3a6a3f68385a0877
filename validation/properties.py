"""What must hold of every scene, on random ones: symmetry, convergence, energy, and that a silent answer is right.

    python validation/properties.py [--quick] [--count 1000] [--seed 0] [--jobs 2] [--store FOLDER] [--keep FOLDER]

A scene is a seed (validation/random_scenes): a mechanism of every kind, with drives, in a medium of every law, on a
bed, solved in every way. It goes through the loader of the command line, and is run as it is; mirrored in x; a
kilometre away; with its parts in another order; with half the step; with a quarter to a sixteenth of it; with a quarter
of the step (a smaller part where that is too long), eight times the strips and four times the elements (in space: half
the step, and facets of a third); and with chosen steps where they were fixed, or the other way round. Finer runs, and
images in space, have the strips or facets that the run itself chose, or shares of them. A run is **silent** when it
ends well without a warning about its own accuracy. Differences are greatest distances of any body (with its turn times
its reach) over the way of whatever moves most; infinite where an image does not end. --store keeps what came of every
scene in a file, and runs those alone that have none yet: for a study that is stopped and goes on, or several at once.
--keep writes every scene that offends as a config. `properties_in_space.py` does the same in space.
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
SHARE = 0.2  # of the time of a scene, in the quick form
SILENT = 1e-2  # of the way: what a run without a warning may be off by
BALANCE = 1e-3
# Of the way: images; or the accuracy for which steps are chosen; or, where round-off grows as the motion diverges, what
# steps do.
ALIKE = 1e-4
STRIPS, ELEMENTS = 8, 4
FACETS = 1.0 / 3.0  # of their size


@dataclass(frozen=True)
class Found:
    """What came of a scene; differences are of the way, NaN where there is none.

    steps, space: from the finer runs; images: by name; numbers: of summaries at fixed and chosen steps, and the worst.
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
        """Whether it claims to be right."""
        return self.end in GOOD and not self.warnings

    @property
    def alike(self) -> float:
        """How far an image of it may be off."""
        return max(ALIKE, self.accuracy, _finite(self.steps), _finite(self.half))

    @property
    def cause(self) -> str:
        """What most of the error is of."""
        return "steps" if not self.space > 2.0 * self.steps else "strips and elements"


@dataclass(frozen=True)
class World:
    """Scenes of the plane or of space. divided: that image with so many times shorter steps, and finer in space.

    shorter: how many times, of that image at first; most_steps: of the reference for steps; wall: s, for any run.
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
            "a kilometre away": images.shifted,
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
            "a kilometre away": images_in_space.shifted,
            "parts in another order": images.reordered,
        },
        lambda tree, factor: images_in_space.finer(images.finer(tree, factor), FACETS),
        shorter=2.0,  # facets of a third are nine times as many
        most_steps=4_000,
        wall=120.0,
    ),
}


def look(seed: int, quick: bool = False, world: str = "plane") -> Found:
    """Draw a scene, and run it in all its forms; in a process of a pool. quick: only its beginning."""
    began = time.process_time()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            drawn = WORLDS[world].draw(seed, folder)
        except GranularContactError as error:
            return Found(seed, "-", "-", "-", "refused", str(error).splitlines()[0])
        found = _judged(drawn, folder, SHARE if quick else 1.0, WORLDS[world])
    return Found(**{**vars(found), "seconds": time.process_time() - began})


def look_or_read(seed: int, quick: bool = False, store: Path | None = None, world: str = "plane") -> Found:
    """As `look`, once for each store: later what was found is read."""
    if store is None:
        return look(seed, quick, world)
    path = store / f"{world}_{seed}{'_quick' * quick}.json"
    if path.exists():
        read = json.loads(path.read_text(encoding="utf-8"))
        return Found(**{key: tuple(value) if isinstance(value, list) else value for key, value in read.items()})
    found = look(seed, quick, world)
    whole = path.with_suffix(f".{os.getpid()}")  # a file is there as a whole, or not at all
    whole.write_text(json.dumps(vars(found)), encoding="utf-8")
    whole.replace(path)
    return found


def _judged(drawn: Drawn, folder: Path, share: float, world: World) -> Found:
    solver = drawn.tree["solver"]
    tree = drawn.tree | {"solver": solver | {"max_wall_s": world.wall, "end_time_s": share * solver["end_time_s"]}}
    try:
        scene = build(load_scenario(write(tree, folder)))
        results, kept = solve_and_keep(tree, folder)
    except GranularContactError as error:
        return Found(drawn.seed, drawn.kind, drawn.solver, _law(tree), "refused", str(error).splitlines()[0])
    found: dict[str, Any] = {
        "seed": drawn.seed, "kind": drawn.kind, "solver": drawn.solver, "law": _law(tree),
        "end": results.status.code, "message": results.status.message, "warnings": _doubts(results),
        "finite": bool(np.isfinite(results.table).all()),
        "imbalance": results.summary["energy"]["imbalance_relative"],
        "accuracy": scene.solver.accuracy or 0.0,
    }  # fmt: skip
    if results.status.code not in GOOD:
        return Found(**found)
    own = track(results, tree, scene.least_path)
    again = _Again(own, folder, scene.least_path)
    same = kept if scene.in_space else tree  # strips in the plane are chosen alike, from those of the config on
    found["images"] = {
        name: again.off(image, same, name == "mirror image", ends=math.inf) for name, image in world.images.items()
    }
    found["half"] = again.off(lambda one: images.finer(one, 2.0), kept, silent=True)
    steps = tree["solver"]["end_time_s"] / tree["solver"].get("step_s", images.STEP)
    most = min(16.0, max(4.0, 2.0 ** math.floor(math.log2(world.most_steps / steps))))
    found["steps"] = again.off(lambda one: images.finer(one, most), kept)
    for factor in (world.shorter, most):  # a reference with steps that are too long itself tells nothing of strips
        finer = partial(world.divided, factor=factor)
        # (Of a body that has 200 000 facets there are none of a third of their size.)
        found["space"] = again.off(finer, kept, silent=factor < most, refused=math.nan)
        if math.isfinite(found["space"]):
            break
    if (other := again.run(images.chosen, tree)) is not None and other.status.code in GOOD:
        found["numbers"] = summaries_apart(
            results, other, own, max(scene.length, 1e-3), scene.mass * abs(scene.gravity)
        )
        found["other_warned"] = bool(_doubts(other))
    return Found(**found)


def _law(tree: Any) -> str:
    media = tree["medium"]
    return "+".join(
        one if isinstance(one, str) else one.get("law", one.get("from"))
        for one in (media if isinstance(media, list) else [media])
    )


def _doubts(results: Any) -> tuple[str, ...]:
    return tuple(w for w in results.warnings if not any(word in w for word in OF_RANGES))


@dataclass(frozen=True)
class _Again:
    """Runs of a scene in other forms, against its own track."""

    own: Track
    folder: Path
    least_path: float

    def run(self, image: images.Image, tree: Any) -> Any:
        """Results of a form; None where there is none."""
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
        """How far the scene is from this form of it.

        silent: only where the form carries no warning; ends, refused: what it is where the form does not end well, or
        is refused.
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


def every(
    seeds: Sequence[int],
    jobs: int,
    quick: bool = False,
    told: Callable[[Found], None] = lambda _: None,
    store: Path | None = None,
    world: str = "plane",
) -> list[Found]:
    """All scenes, on so many processes of one thread each; store: folder of what is known of them."""
    found = []
    if store is not None:
        store.mkdir(parents=True, exist_ok=True)
    with local_processes(jobs) as pool:
        for one in pool.map(look_or_read, *zip(*((seed, quick, store, world) for seed in seeds), strict=True)):
            told(one)
            found.append(one)
    return found


# ---- what it shows ----


def _share(value: float) -> str:
    return "-" if not math.isfinite(value) else f"{value:.2%}"


def _greatest(values: Sequence[float]) -> float:
    return max((value for value in values if math.isfinite(value)), default=math.nan)


def silent_table(found: Sequence[Found], by: Callable[[Found], str], of: str) -> str:
    """Silent errors of one cause (`steps` or `space`) by some property of the scenes."""
    rows = []
    for name in [*sorted({by(one) for one in found}), "all"]:
        mine = [one for one in found if name in (by(one), "all")]
        silent = [one for one in mine if one.silent]
        off = [getattr(one, of) for one in silent]
        judged = [value for value in off if math.isfinite(value)]
        middle = _share(float(np.median(judged))) if judged else "-"
        counts = [sum(value > limit for value in judged) for limit in (5e-3, SILENT)]
        rows.append([name, len(mine), len(silent), len(judged), middle, *counts, _share(_greatest(judged))])
    head = ["", "scenes", "silent", "judged", "median", "above 0.5 %", "above 1 %", "greatest"]
    return markdown(head, rows)


def property_table(found: Sequence[Found]) -> str:
    """Images, half the step, fixed against chosen steps, and energy."""
    rows = []
    for name in _images(found):
        off = [one.images[name] for one in found if math.isfinite(one.images.get(name, math.nan))]
        rows.append([name, len(off), *_spread(off)])
    for name, off in (
        ("half the step", [one.half for one in found if one.silent]),
        ("summaries at fixed and chosen steps", [one.numbers[0] for one in found if _both_silent(one)]),
        ("energy imbalance, silent", [one.imbalance for one in found if one.silent]),
        ("energy imbalance, warned", [one.imbalance for one in found if one.end in GOOD and one.warnings]),
    ):
        known = [value for value in off if math.isfinite(value)]
        rows.append([name, len(known), *_spread(known)])
    return markdown(["property", "scenes", "median", "90 %", "greatest"], rows)


def _images(found: Sequence[Found]) -> list[str]:
    return list(dict.fromkeys(name for one in found for name in one.images))


def _spread(values: Sequence[float]) -> list[str]:
    return [f"{value:.1e}" for value in np.quantile(values, (0.5, 0.9, 1.0))] if values else ["-"] * 3


def _both_silent(one: Found) -> bool:
    return one.silent and not one.other_warned


def offenders(found: Sequence[Found]) -> dict[str, list[Found]]:
    """Scenes that break a property, by claim."""
    broken = {
        "every number is finite": [one for one in found if not one.finite],
        "every run ends, or says what to change": [
            one for one in found if one.end not in (*GOOD, "refused") and not _explained(one)
        ],
        "no run fails": [one for one in found if one.end == "failed"],
    }
    for name in _images(found):
        broken[name] = [one for one in found if one.silent and one.images.get(name, 0.0) > one.alike]
    return broken | {
        "half the step is within 1 % without a warning": [one for one in found if one.silent and one.half > SILENT],
        "summaries at fixed and chosen steps are within 2 %, or four times the accuracy": [
            one for one in found if _both_silent(one) and one.numbers[0] > max(2.0 * SILENT, 4.0 * one.accuracy)
        ],
        "an energy imbalance above 1e-3 is never silent": [
            one for one in found if one.silent and one.imbalance > BALANCE
        ],
        "no silent error of steps above 1 %": [one for one in found if one.silent and one.steps > SILENT],
        "no silent error of strips and elements above 1 %": [
            one for one in found if one.silent and one.space > SILENT and one.cause != "steps"
        ],
    }


def _explained(one: Found) -> bool:
    return one.end == "failed" and any(word in one.message for word in ("take a", "needs", "allowed"))


def worst(found: Sequence[Found], most: int = 12) -> str:
    """The scenes with the largest silent errors."""
    off = [one for one in found if one.silent and max(_finite(one.steps), _finite(one.space)) > 5e-3]
    off.sort(key=lambda one: -max(_finite(one.steps), _finite(one.space)))
    rows = [[one.seed, one.kind, one.solver, one.law, one.cause, _share(one.steps), _share(one.space)] for one in off]
    return markdown(["seed", "kind", "solver", "law", "cause", "steps", "strips and steps"], rows[:most])


def _finite(value: float) -> float:
    return value if math.isfinite(value) else 0.0


def outcome(found: Sequence[Found], of: str = "properties") -> Outcome:
    """Tables and claims of a study."""
    ends = Counter(one.end if one.end not in GOOD else "silent" if one.silent else "warned" for one in found)
    said = ", ".join(f"{count} {end}" for end, count in ends.most_common())
    parts = [f"{len(found)} scenes: {said}."]
    parts += ["Symmetry, convergence, energy.", property_table(found)]
    parts += [
        "Silent errors of the steps, by the kind of mechanism.",
        silent_table(found, lambda one: one.kind, "steps"),
    ]
    parts += [
        "The same against a quarter of the step, 8 times the strips and 4 times the elements; in space half the step, "
        "and facets of a third."
    ]
    parts += [silent_table(found, lambda one: one.kind, "space")]
    parts += ["The same by solver.", silent_table(found, lambda one: one.solver, "space")]
    parts += ["The largest silent errors.", worst(found)]
    broken = offenders(found)
    made = [Claim(f"{of}.{name}", not bad, _told(name, bad, found)) for name, bad in broken.items()]
    return Outcome("\n\n".join(parts), tuple(made))


def _told(name: str, bad: Sequence[Found], found: Sequence[Found]) -> str:
    seeds = f" (seeds {', '.join(str(one.seed) for one in bad[:8])}{', ...' * (len(bad) > 8)})" if bad else ""
    keys = Counter(one.numbers[1] for one in bad) if name.startswith("summaries") else Counter()
    most = f"; most {', '.join(f'{key} {count}' for key, count in keys.most_common(4))}" if keys else ""
    return f"{len(bad)} of {len(found)} scenes break it{seeds}{most}"


def keep(found: Sequence[Found], target: Path, world: str = "plane") -> None:
    """Write the scenes that offend, each with what it broke, into folders named by their seeds."""
    said: dict[int, list[str]] = {}
    for name, bad in offenders(found).items():
        for one in bad:
            said.setdefault(one.seed, []).append(name)
    for seed, names in said.items():
        folder = target / str(seed)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        write(WORLDS[world].draw(seed, folder).tree, folder)
        one = next(one for one in found if one.seed == seed)
        (folder / "found.txt").write_text("\n".join([*names, str(one)]) + "\n", encoding="utf-8")


def study(quick: bool = False) -> Outcome:
    """All scenes, or the first few."""
    return outcome(every(range(SEED, SEED + (QUICK if quick else COUNT)), cores(), quick))


def main(arguments: Sequence[str] | None = None, world: str = "plane", of: str = "properties") -> int:
    """As a script; 0 when every claim held."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help=f"the beginnings of {QUICK} scenes")
    parser.add_argument("--count", type=int, help=f"scenes, {COUNT} unless given")
    parser.add_argument("--seed", type=int, default=SEED, help="of the first scene")
    parser.add_argument("--jobs", type=int, default=cores(), help="processes")
    parser.add_argument("--store", type=Path, help="folder that keeps what came of every scene, for a run that goes on")
    parser.add_argument("--keep", type=Path, help="folder for the scenes that offend, as configs")
    chosen = parser.parse_args(arguments)
    count = chosen.count or (QUICK if chosen.quick else COUNT)
    began = time.perf_counter()
    found = every(range(chosen.seed, chosen.seed + count), chosen.jobs, chosen.quick, _progress, chosen.store, world)
    made = outcome(found, of)
    spent = f"{time.perf_counter() - began:.0f} s, {sum(one.seconds for one in found):.0f} s of processor time"
    print(f"{machine('exudyn', 'numba')}; {spent}\n\n{made.text}\n")
    for claim in made.claims:
        print(claim)
    if chosen.keep is not None:
        keep(found, chosen.keep, world)
    return 0 if all(claim.held for claim in made.claims) else 1


def _progress(one: Found) -> None:
    line = [f"{one.seed:5d} {one.kind:18s} {one.solver:22s} {one.law[:24]:24s} {one.end:9s} {len(one.warnings)} w"]
    line += [f"E {one.imbalance:.1e} steps {one.steps:.1e} half {one.half:.1e} space {one.space:.1e}"]
    line += [" ".join(f"{value:.0e}" for value in one.images.values()), f"{one.numbers[0]:.1e} {one.seconds:.1f} s"]
    print("  ".join(line), one.message if one.end not in GOOD else "", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
