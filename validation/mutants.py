"""Mutation testing: whether the tests notice small changes of decisions, joints, observers and kernels.

    pip install cosmic-ray                      # makes the mutants; only this script needs it
    python validation/mutants.py                # 60 mutants, some ten minutes of an idle core
    python validation/mutants.py --count 12 --area joints --seed 2

Each mutant is one change at one place (an operator, a comparison, a number, a condition), drawn from all places in the
files of an area. The tests of the changed file run on a copy of the project until one test fails. A mutant that no test
notices is printed with its line. Compiled code is reused from mutant to mutant, except for the changed module and the
modules that inline it.
"""

from __future__ import annotations

import argparse
import difflib
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.jit import compiled_sources

ROOT = Path(__file__).parents[1]
PLACE = Path(tempfile.gettempdir()) / "granular-contact-mutants"
COPIED = ("granular_contact", "tests", "models", "configs", "examples", "validation", "pyproject.toml")
LONGEST = 900.0  # s; a mutant that runs longer hangs and counts as detected
# Files to change by area, each with the tests that must notice a change.
_JOINTS = "tests/multibody/test_powers.py", "tests/multibody/test_joints.py", "tests/multibody/test_coordinates.py"
_TREES = (
    "tests/minimal/test_tree_kernels.py",
    "tests/minimal/test_minimal_against_engine.py",
    "tests/minimal/test_mechanisms_against_engine.py",
)
_SPACE_TREES = "tests/minimal/test_space_tree_kernels.py", "tests/minimal/test_space_trees.py"
_LINKS = (
    "tests/space/test_stretch_and_damping.py",
    "tests/space/test_runs_in_space.py",
    "tests/space/test_bending_links.py",
)
_FACETS = (
    "tests/space/test_layers_in_space.py",
    "tests/space/test_wrenches_by_quadrature.py",
    "tests/space/test_forces_in_space.py",
)
_ERRORS = "tests/space/test_facet_error.py", "tests/space/test_links_in_modes.py"
_MODES = (
    "tests/reduced/test_motion.py",
    "tests/reduced/test_modes.py",
    "tests/reduced/test_static.py",
    "tests/reduced/test_against_engine.py",
)
_MUJOCO = (
    "tests/mujoco_door/test_mujoco_models.py",
    "tests/mujoco_door/test_mujoco_motion.py",
    "tests/mujoco_door/test_mujoco_state.py",
)
_ROBOTS = (
    "tests/robot/test_urdf_models.py",
    "tests/robot/test_urdf_faults.py",
    "tests/robot/test_hexapod.py",
    "tests/robot/test_out_of_sand.py",
)
_FITS = (
    "tests/fit/test_uncertainty.py",
    "tests/fit/test_diagnostics.py",
    "tests/fit/test_jacobian.py",
    "tests/fit/test_recovery.py",
)
AREAS: dict[str, dict[str, tuple[str, ...]]] = {
    "joints": {
        "mechanics/kernels/joint_loads.py": (*_JOINTS, "tests/space/test_runs_in_space.py"),
        "mechanics/kernels/joint_laws.py": _JOINTS,
        "engines/exudyn/joint_actions.py": (*_JOINTS, "tests/multibody/test_drives.py"),
        "mechanics/joint_history.py": (*_JOINTS, "tests/test_simulation.py"),
    },
    "trees": {
        "engines/tree/kernels/tree.py": _TREES,
        "engines/tree/kernels/tree_load.py": _TREES,
        "engines/tree/kernels/tree_newton.py": _TREES,
        "engines/tree/kernels/tree_march.py": (*_TREES, "tests/multibody/test_stepping.py", "tests/test_simulation.py"),
        "mechanics/kernels/step_choice.py": (
            "tests/kernels/test_step_choice.py",
            "tests/multibody/test_stepping.py",
            "tests/multibody/test_drives.py",
        ),
        "engines/tree/march.py": (
            *_TREES,
            "tests/test_start_in_sand.py",
            "tests/test_simulation.py",
            "tests/multibody/test_wheels.py::test_a_wheel_begins_and_stays_steady",
        ),
    },
    "observers": {
        "mechanics/observe.py": (
            "tests/multibody/test_powers.py",
            "tests/multibody/test_chains.py",
            "tests/multibody/test_free.py",
            "tests/test_run.py",
            "tests/space/test_bed_in_space.py",
            "tests/space/test_runs_in_space.py",
        ),
        "mechanics/sensors.py": ("tests/test_simulation.py",),
        "results/stopping.py": ("tests/test_stops.py", "tests/multibody/test_stopping.py", "tests/test_edges.py"),
        "results/summary.py": ("tests/test_strides.py",),
    },
    "decisions": {
        "scene/workspace.py": ("tests/scene/test_workspace.py", "tests/scene/test_build.py"),
        "scene/joints.py": ("tests/scene/test_build.py", "tests/scene/test_mechanisms.py", _JOINTS[0]),
        "scene/checks.py": (
            "tests/space/test_scene_in_space.py",
            "tests/scene/test_workspace.py",
            "tests/test_bed_of_a_run.py",
            "tests/space/test_many_facets.py",
        ),
        "engines/exudyn/recorder.py": (
            "tests/multibody/test_free.py",
            "tests/test_edges.py",
            "tests/test_simulation.py",
            "tests/multibody/test_iterations.py",
            "tests/multibody/test_stepping.py",
            "tests/test_ends.py",
        ),
        "results/limits.py": ("tests/test_bed_of_a_run.py", "tests/test_edges.py", "tests/test_start_in_sand.py"),
    },
    "kernels": {
        "sand/kernels/immersion.py": ("tests/kernels/test_immersion.py", "tests/properties/test_forces.py"),
        "sand/kernels/friction.py": ("tests/kernels/test_friction.py",),
        "sand/kernels/kinematics.py": ("tests/kernels/test_kinematics.py", "tests/multibody/test_batches.py"),
        "sand/kernels/batches.py": (
            "tests/bed/test_load.py",
            "tests/multibody/test_batches.py",
            "tests/multibody/test_bed.py",
        ),
        "sand/kernels/planar_sand.py": (
            "tests/bed/test_load.py",
            "tests/multibody/test_batches.py",
            "tests/multibody/test_bed.py",
        ),
    },
    "mechanisms in space": {
        "engines/tree/kernels/space_tree.py": _SPACE_TREES,
        "engines/tree/kernels/space_elimination.py": _SPACE_TREES,
        "mechanics/kernels/space_rotations.py": _SPACE_TREES,
        "engines/tree/kernels/space_ball_joints.py": (*_LINKS, _SPACE_TREES[1]),
        "mechanics/kernels/space_joints.py": (*_LINKS, _SPACE_TREES[1]),
        "mechanics/space/beams.py": _LINKS,
        "mechanics/space/kinematics.py": (*_LINKS, "tests/space/test_scene_in_space.py", "tests/space/test_travel.py"),
    },
    "medium in space": {
        "sand/kernels/facets.py": (*_FACETS, "tests/space/test_terrain.py", "tests/space/test_turning_in_space.py"),
        "sand/kernels/facet_parts.py": _FACETS,
        "sand/kernels/facet_slopes.py": (_FACETS[2],),
        "sand/kernels/space_bodies.py": (
            _FACETS[2],
            "tests/space/test_bodies_in_space.py",
            "tests/multibody/test_beams_of_a_bed.py",
        ),
        "sand/kernels/space_friction.py": (
            _FACETS[2],
            "tests/space/test_bodies_in_space.py",
            "tests/mujoco_door/test_mujoco_motion.py",
            "tests/space/test_turning_in_space.py",
        ),
        "sand/kernels/bars.py": (_FACETS[2], _FACETS[0]),
        "sand/space/facets.py": ("tests/space/test_shapes_in_space.py", *_FACETS),
        "sand/space/revolution.py": ("tests/space/test_shapes_in_space.py", *_FACETS),
        "sand/space/round_shapes.py": ("tests/space/test_shapes_in_space.py", "tests/space/test_scene_in_space.py"),
    },
    "estimates": {
        "mechanics/departure.py": (*_ERRORS, "tests/multibody/test_strip_error.py"),
        "mechanics/strip_departure.py": ("tests/multibody/test_strip_error.py", "tests/reduced/test_against_engine.py"),
        "mechanics/accuracy.py": ("tests/multibody/test_stepping.py", "tests/multibody/test_creep.py", *_ERRORS),
        "mechanics/strains.py": ("tests/multibody/test_strains.py",),
        "mechanics/space/facet_departure.py": _ERRORS,
        "mechanics/space/freedoms.py": _ERRORS,
        "mechanics/space/mode_error.py": _ERRORS,
    },
    "modes": {
        "engines/modal/model.py": _MODES,
        "engines/modal/modes.py": _MODES,
        "engines/modal/kernels/march.py": _MODES,
        "engines/modal/kernels/modal.py": _MODES,
        "engines/modal/kernels/pendulum.py": _MODES,
        "engines/modal/kernels/runge_kutta.py": _MODES,
        "engines/modal/kernels/slip.py": _MODES,
    },
    "results": {
        "results/alike.py": ("tests/test_results.py", "tests/test_compare.py", "tests/test_sweep.py"),
        "results/energy.py": ("tests/test_results.py", "tests/multibody/test_powers.py", "tests/test_run.py"),
        "results/interpolation.py": ("tests/test_results.py", "tests/test_between_steps.py", "tests/test_strides.py"),
        "results/motion.py": ("tests/test_results.py", "tests/test_html.py", "tests/test_animation.py"),
        "results/series.py": ("tests/test_results.py", "tests/test_run.py"),
    },
    "MuJoCo": {
        "engines/mujoco/step.py": _MUJOCO,
        "engines/mujoco/facet_error.py": _MUJOCO,
        "engines/mujoco/geoms.py": _MUJOCO,
        "engines/mujoco/kernels/added_mass.py": _MUJOCO,
        "engines/mujoco/kernels/held_step.py": _MUJOCO,
        "engines/mujoco/kernels/space_added_mass.py": _MUJOCO,
    },
    "robot files": {
        "robot/inertia.py": _ROBOTS,
        "robot/links.py": _ROBOTS,
        "robot/massless.py": _ROBOTS,
        "robot/mechanism.py": _ROBOTS,
        "robot/urdf.py": _ROBOTS,
        "geometry/mesh.py": (*_ROBOTS, "tests/space/test_shapes_in_space.py"),
        "geometry/rotations.py": ("tests/test_rotations.py",),
    },
    "fits": {
        "studies/fit/solve.py": _FITS,
        "studies/fit/uncertainty.py": _FITS,
        "studies/fit/goodness.py": _FITS,
        "studies/fit/problem.py": _FITS,
        "studies/fit/step_bias.py": ("tests/fit/test_step_bias.py",),
        "studies/fit/scatter.py": ("tests/fit/test_scatter_apart.py",),
    },
}
# Operators of cosmic-ray that change what is computed.
OPERATORS = re.compile(
    r"core/(ReplaceBinaryOperator_(Add|Sub|Mul|Div)_(Add|Sub|Mul|Div)$|ReplaceComparisonOperator_(Lt|LtE|Gt|GtE|Eq|NotEq)_"
    r"(Lt|LtE|Gt|GtE|Eq|NotEq)$|ReplaceUnaryOperator_USub_UAdd|ReplaceUnaryOperator_Delete_Not|NumberReplacer|AddNot"
    r"|ReplaceAndWithOr|ReplaceOrWithAnd|ReplaceTrueWithFalse|ReplaceFalseWithTrue|ReplaceContinueWithBreak)"
)


@dataclass(frozen=True)
class Mutant:
    """One change of the code.

    file: path below the package; operator: of cosmic-ray; occurrence: number of the place among those where the
    operator applies.
    """

    area: str
    file: str
    operator: str
    occurrence: int

    def code(self) -> str | None:
        """Source of the changed file."""
        from cosmic_ray.mutating import MutationVisitor
        from cosmic_ray.plugins import get_operator

        source = (ROOT / "granular_contact" / self.file).read_text(encoding="utf-8")
        code: str | None = MutationVisitor.mutate_code(source, get_operator(self.operator)(), self.occurrence)
        return code

    def lines(self) -> str:
        """Changed line before and after."""
        source = (ROOT / "granular_contact" / self.file).read_text(encoding="utf-8")
        changes = difflib.unified_diff(source.splitlines(), (self.code() or "").splitlines(), n=0, lineterm="")
        return "\n".join(line for line in list(changes)[2:])


def places(area: str) -> Iterator[Mutant]:
    """Generate all mutants of the files of an area."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.plugins import get_operator, operator_names

    names = [name for name in operator_names() if OPERATORS.match(name)]
    for file in AREAS[area]:
        tree = get_ast((ROOT / "granular_contact" / file).read_text(encoding="utf-8"))
        for name in names:
            operator = get_operator(name)()
            count = sum(1 for node in ast_nodes(tree) for _ in operator.mutation_positions(node))
            yield from (Mutant(area, file, name, i) for i in range(count))


def drawn(areas: list[str], count: int, seed: int) -> list[Mutant]:
    """Draw `count` mutants, equally many from each area.

    File and kind of operator are drawn first, with weights by their number of places, then one of their mutants.
    """
    mutants: list[Mutant] = []
    for i, area in enumerate(areas):
        share = count // len(areas) + (i < count % len(areas))
        kinds: dict[str, list[Mutant]] = {}
        for mutant in places(area):
            kinds.setdefault(f"{mutant.file} {mutant.operator.partition('_')[0]}", []).append(mutant)
        rng, groups = random.Random(f"{seed} {area}"), [*kinds.values()]
        weights = [len({mutant.occurrence for mutant in group}) for group in groups]
        chosen: dict[Mutant, None] = {}
        while len(chosen) < min(share, sum(map(len, groups))):
            chosen[rng.choice(rng.choices(groups, weights)[0])] = None
        mutants += chosen
    return mutants


def stale(file: str) -> set[str]:
    """Names of modules whose compiled code can contain code of a file: the file's module and all that depend on it.

    Laws are inlined into the kernels at first use, so that code that a law uses can be in all kernels.
    """
    texts = {(path.parent.name, path.stem): path.read_text(encoding="utf-8") for path in compiled_sources()}
    modules = {("kernels", Path(file).stem)}
    while True:
        names = "|".join(sorted(name for _, name in modules))
        use = re.compile(rf"^from .*\b({names})\b|\bkernels\.({names})\b", re.M)
        dependents = modules | {place for place, text in texts.items() if use.search(text)}
        if any(room == "laws" for room, _ in dependents):
            return {name for _, name in texts}
        if dependents == modules:
            return {name for _, name in modules}
        modules = dependents


def tests_notice(tests: Iterable[str], cache: Path) -> bool:
    """Whether one of the tests fails on the copy of the project."""
    # The copy has its own cache, since code compiled elsewhere is that of the unchanged file.
    environment = os.environ | {"PYTHONPATH": str(PLACE), "NUMBA_CACHE_DIR": str(cache), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "pytest", "-p", "no:xdist", "-o", "addopts=", "-x", "-q", *tests]
    try:
        done = subprocess.run(command, cwd=PLACE, env=environment, capture_output=True, timeout=LONGEST, check=False)
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


def is_detected(mutant: Mutant) -> bool:
    """Whether the tests of the file fail on a copy of the project with this change."""
    file, original, cache = PLACE / "granular_contact" / mutant.file, PLACE / "cache", PLACE / "cache_of_mutant"
    before, stamp = file.read_text(encoding="utf-8"), file.stat()
    shutil.rmtree(cache, ignore_errors=True)
    old = stale(mutant.file) if "kernels/" in mutant.file else set()
    # Tests compile the code of the package into functions of their own files, which do not change.
    of_tests = ("test_", "support_")
    shutil.copytree(
        original,
        cache,
        copy_function=os.link,
        ignore=lambda _, names: [
            name for name in names if ".nb" in name and (name.partition(".")[0] in old or name.startswith(of_tests))
        ],
    )
    try:
        file.write_text(mutant.code() or before, encoding="utf-8")
        return tests_notice(AREAS[mutant.area][mutant.file], cache)
    finally:
        file.write_text(before, encoding="utf-8")
        os.utime(file, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))  # else its compiled code counts as outdated


def copied() -> None:
    """Copy the project anew, and keep the compiled code of the last time."""
    for name in COPIED:
        target = PLACE / name
        if target.is_dir():
            shutil.rmtree(target)
        target.parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, target)


def main() -> int:
    """Print the mutants that survive and a table; return 1 if the tests fail on the unchanged code, else 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--area", choices=AREAS, action="append")
    chosen = parser.parse_args()
    areas = chosen.area or [*AREAS]
    copied()
    (PLACE / "cache").mkdir(exist_ok=True)
    for area in areas:
        if tests_notice(dict.fromkeys(test for tests in AREAS[area].values() for test in tests), PLACE / "cache"):
            print(f"the tests of {area} fail on the code as it is, in {PLACE}")
            return 1
    killed: dict[str, list[bool]] = {area: [] for area in areas}
    begin = time.perf_counter()
    for mutant in drawn(areas, chosen.count, chosen.seed):
        detected = is_detected(mutant)
        killed[mutant.area].append(detected)
        print(f"{'detected ' if detected else 'SURVIVED'} {mutant.file}: {mutant.operator}", flush=True)
        if not detected:
            print(mutant.lines(), flush=True)
    print(f"\n| area | mutants | detected |\n| --- | --- | --- |\n{_rows(killed)}")
    print(f"\nseed {chosen.seed}, {time.perf_counter() - begin:.0f} s")
    return 0


def _rows(killed: dict[str, list[bool]]) -> str:
    total = [detected for results in killed.values() for detected in results]
    return "\n".join(
        f"| {name} | {len(results)} | {sum(results)} ({100 * sum(results) / max(len(results), 1):.0f} %) |"
        for name, results in {**killed, "all": total}.items()
    )


if __name__ == "__main__":
    sys.exit(main())
