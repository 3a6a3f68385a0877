"""What is loaded when, and who may import whom."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest
from support_runs import ROOT

PACKAGE = ROOT / "granular_contact"
MODULES = sorted(PACKAGE.rglob("*.py"))
# For each part of the package, what of the package it may import; the longest name that fits counts, on both sides.
# Parts not named here are at the top and free.
MAY = {
    "errors": set(),
    "examples": set(),
    "geometry": set(),
    "kernels": {"kernels"},
    "values": {"values"},
    "laws": {"laws", "kernels", "values"},
    "config": {"config", "config.csv_table", "values", "laws", "errors", "examples", "geometry"},
    "scene": {"scene", "config", "laws", "errors", "geometry"},
    "results": {"results", "scene", "laws", "geometry"},
    # Folders and figures by method calls of results: loaded when one is called.
    "results.methods": {"results", "report", "report.figures", "report.pages", "config", "scene", "errors"},
    "bed": {"bed", "kernels", "laws", "scene", "results", "geometry", "errors"},
    "bed.space": {"bed.space", "bed", "kernels", "laws", "errors"},
    # Three ways through; the reduced one knows nothing of the others.
    # The coordinates of the engine's door and its observer, without the engine.
    "minimal": {"minimal", "bed", "multibody", "scene", "laws", "kernels", "results"},
    "multibody": {"multibody", "bed", "bed.space", "results", "scene", "laws", "kernels", "geometry", "errors"},
    "reduced": {"reduced", "results", "config", "scene", "laws", "kernels", "errors"},
    # (kernels tell when they are compiled)
    "run": {"config", "kernels", "scene", "laws", "multibody", "minimal", "reduced", "results", "errors"},
    "simulation": {"run", "config", "scene", "results", "multibody", "errors"},  # (multibody: types only)
    "gym": {"gym", "simulation", "config", "examples", "report.figures", "results", "errors"},
    "report": {"results", "report.figures"},
    "report.figures": {"report.figures", "report", "results"},
    "report.pages": {"report.pages", "report.figures", "report", "results", "config.csv_table", "errors"},
    "studies": {"config", "scene", "run", "report", "report.figures", "results", "errors"},
    "studies.sweep": {"studies.sweep", "config", "scene", "run", "report", "report.figures", "results", "errors"},
    "studies.optimise": {
        "studies.optimise",
        "studies.sweep",
        "config",
        "scene",
        "run",
        "report",
        "report.figures",
        "results",
        "errors",
    },
    "studies.fit": {
        "studies.fit",
        "studies.sweep",
        "config",
        "config.csv_table",
        "scene",
        "run",
        "report",
        "report.figures",
        "results",
        "errors",
    },
}
IMPORTED: set[str] = set().union(*MAY.values())


def dotted(path: Path) -> str:
    """Name of a module within the package; of a package its own, not that of `__init__`."""
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix("__init__").strip(".")


NAMES = {dotted(path) for path in MODULES} - {""}


def part(name: str, names: set[str]) -> str:
    """The longest of some names that a module's name begins with; its first word if there is none."""
    found = [n for n in names if f"{name}.".startswith(f"{n}.")]
    return max(found, key=len, default=name.split(".")[0])


class WhenRun(ast.NodeTransformer):
    """Leaves out what is imported for checkers of types only."""

    def visit_If(self, node: ast.If) -> ast.AST | None:
        return None if ast.unparse(node.test) == "TYPE_CHECKING" else self.generic_visit(node)


def imports(path: Path, *, when_run: bool = False) -> set[str]:
    """Dotted names of all that a file imports, inside functions too; when_run: without what only types need."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    if when_run:
        tree = WhenRun().visit(tree)
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names |= {f"{node.module}.{alias.name}" for alias in node.names} | {str(node.module)}
    return names


def own(path: Path) -> set[str]:
    """The package's modules that a file imports."""
    found = {name.removeprefix("granular_contact.") for name in imports(path)}
    return found & NAMES


def ids(path: Path) -> str:
    return str(path.relative_to(PACKAGE))


@pytest.mark.parametrize("path", MODULES, ids=ids)
def test_imports_go_one_way(path: Path) -> None:
    allowed = MAY.get(part(dotted(path), set(MAY)))
    if allowed is not None:
        assert {part(name, IMPORTED) for name in own(path)} <= allowed


@pytest.mark.parametrize("path", MODULES, ids=ids)
def test_heavy_libraries_stay_where_they_belong(path: Path) -> None:
    libraries = {name.split(".")[0] for name in imports(path, when_run=True)}
    homes = {
        "exudyn": ("multibody",),
        "numba": ("kernels",),
        "pydantic": ("config", "laws", "values"),
        "matplotlib": ("report.figures",),
        "gymnasium": ("gym",),
        "pandas": (),
        "trimesh": ("bed.space",),
    }
    for library in libraries & set(homes):
        assert part(dotted(path), IMPORTED) in homes[library]


@pytest.mark.parametrize("path", [p for p in MODULES if dotted(p).startswith(("bed", "kernels", "laws"))], ids=ids)
def test_the_bed_knows_no_engine(path: Path) -> None:
    text = path.read_text(encoding="utf-8").lower()
    assert not [name for name in ("exudyn", "mujoco", "mbs") if name in text]


@pytest.mark.parametrize("path", MODULES, ids=ids)
def test_only_the_command_line_prints_and_exits(path: Path) -> None:
    if dotted(path).startswith(("__main__", "cli")):
        return
    # (os._exit is left out: a worker process has to end without its parent.)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            assert name not in ("print", "exit", "quit", "sys.exit", "sys.stdout.write", "sys.stderr.write")
        if isinstance(node, ast.Raise) and node.exc is not None:
            assert "SystemExit" not in ast.unparse(node.exc)


def modules_after(code: str) -> set[str]:
    """Names of all modules that a fresh interpreter holds after running code."""
    code += "\nimport sys\nprint(' '.join(sorted(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True, timeout=600
    )
    return set(done.stdout.splitlines()[-1].split())


def loaded(code: str) -> set[str]:
    """Top-level packages that a fresh interpreter holds after running code."""
    return {name.split(".")[0] for name in modules_after(code)}


RUN = """
from granular_contact import config
from granular_contact.scene import build
from granular_contact.run import run
scenario = config.load("configs/{config}.yaml", {overrides}).scenario
results = run(build(scenario), scenario)
assert len(results.table) > 10
"""


def test_run_without_figures_loads_no_matplotlib(tmp_path: Path) -> None:
    code = RUN.format(config="pendulum", overrides=["output.figures=false"])
    code += f"""
from pathlib import Path
from granular_contact import report
report.write(results, Path({str(tmp_path / "run")!r}), figures=False)
"""
    modules = loaded(code)
    assert "matplotlib" not in modules
    assert {"numba", "exudyn"} <= modules  # the test would see it


def test_scene_without_medium_loads_no_numba() -> None:
    modules = loaded(RUN.format(config="pendulum", overrides=["medium=null", "solver.end_time_s=0.01"]))
    assert "numba" not in modules
    assert "matplotlib" not in modules
    assert "exudyn" in modules


def test_a_planar_run_loads_nothing_of_space() -> None:
    names = modules_after(RUN.format(config="pendulum", overrides=["solver.end_time_s=0.01"]))
    assert "granular_contact.kernels.lines" in names  # the test would see it
    space = {"facets", "bars", "slices"} | {path.stem for path in MODULES if path.stem.startswith("space_")}
    assert not names & {f"granular_contact.kernels.{name}" for name in space}
    assert not [name for name in names if name.startswith("granular_contact.bed.space")]


def test_bed_out_of_reach_loads_no_numba() -> None:
    modules = loaded(RUN.format(config="pendulum", overrides=["surface_height_m=-0.5", "solver.end_time_s=0.01"]))
    assert "numba" not in modules


def test_a_bed_on_given_poses_loads_no_engine() -> None:
    code = """
import numpy as np
from granular_contact import preset
from granular_contact.bed.contact_lines import Body, polyline
from granular_contact.bed.load import GranularLoad
load = GranularLoad(preset("rft_generic"), surface=0.0)
load.add(polyline(Body("plate", [0, 1, 2]), [[-0.05, 0.0], [0.05, 0.0]], width=0.1))
pose, velocity = np.array([0.0, -0.02, 0.0]), np.array([0.0, -0.1, 0.0])
load.start(pose)
load.accept(0.0, pose, velocity)
assert load.force(pose, velocity, np.zeros(3))[1] > 0.0
"""
    modules = loaded(code)
    assert "numba" in modules  # the test would see it
    assert not modules & {"exudyn", "matplotlib"}


def test_a_run_in_minimal_coordinates_loads_no_engine() -> None:
    modules = loaded(RUN.format(config="pendulum_rigid", overrides=["method=minimal", "solver.end_time_s=0.01"]))
    assert "numba" in modules
    assert "exudyn" not in modules


def test_laws_load_no_compiler() -> None:
    assert "numba" not in loaded("from granular_contact.laws import catalogue, floor, probe")


def test_checking_a_config_loads_no_engine() -> None:
    modules = loaded('from granular_contact import config\nconfig.load("configs/pendulum.yaml")')
    assert not modules & {"numba", "exudyn", "matplotlib", "scipy"}


def test_building_a_scene_loads_no_engine() -> None:
    code = 'from granular_contact import config, scene\nscene.build(config.load("configs/pendulum.yaml").scenario)'
    assert not loaded(code) & {"numba", "exudyn", "matplotlib"}
