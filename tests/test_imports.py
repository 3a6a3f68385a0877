"""Which libraries are loaded when, and which rooms of the package may import which."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import pytest
from support_runs import ROOT

PACKAGE = ROOT / "granular_contact"
MODULES = sorted(PACKAGE.rglob("*.py"))
# Rooms from the ground up: each imports itself and those before it.
FLOORS = (
    ("errors", "examples", "values", "jit"),
    ("studies.processes",),
    ("geometry", "config.tree"),
    ("config.csv_table", "config.yaml_source"),
    ("sand.kernels",),
    ("mechanics.kernels", "laws"),
    ("robot",),
    ("config",),
    ("sand.space.triangles", "sand.space.heights"),  # shapes and surfaces are made once, for scenes too
    ("sand.space.facets",),
    ("sand.space.revolution",),
    ("sand.space.shapes",),
    ("sand.space.round_shapes",),
    ("sand.space.beam_shape",),
    ("sand.space.mesh_shape",),
    ("scene", "starter"),
    ("results",),
    ("sand",),
    ("mechanics",),
    ("engines.exudyn", "engines.tree", "engines.modal", "engines.mujoco"),
    ("run",),
    ("controllers", "report"),
    ("control_values",),
    ("simulation_state",),
    ("simulation",),
    ("steering", "gym"),
    ("studies.sweep",),
    ("studies",),
    ("cli",),
)
# What rooms do without, though it lies below them; and what lies above them and is loaded when a method is called.
NEVER = {
    "sand.kernels": {"laws"},
    "mechanics.kernels": {"laws"},
    "laws": {"geometry", "config", "mechanics.kernels"},
    "robot": {"laws", "jit"},
    "config": {"jit", "sand.kernels"},
    "scene": {"jit", "sand.kernels"},
    "results": {"jit", "sand.kernels", "mechanics.kernels", "config"},
    "sand": {"config", "robot"},
    "mechanics": {"config", "robot"},
    "engines.mujoco": {"mechanics", "scene", "results", "config"},
    "report": {"run", "engines", "mechanics", "sand", "scene", "laws", "jit"},
    "studies": {"engines", "mechanics", "jit"},
}
LATE = {"results.methods": {"report", "config"}, "scene.space": {"sand.space.load"}}
ROOMS = [room for floor in FLOORS for room in floor]


def dotted(path: Path) -> str:
    """Name of a module within the package; of a package its own, not that of `__init__`."""
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix("__init__").strip(".")


NAMES = {dotted(path) for path in MODULES} - {""}


def part(name: str, names: set[str]) -> str:
    """The longest of some names that a module's name begins with; its first word if there is none."""
    parents = [n for n in names if f"{name}.".startswith(f"{n}.")]
    return max(parents, key=len, default=name.split(".")[0])


@cache
def nodes(path: Path) -> list[ast.AST]:
    return list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))


@cache
def imports(path: Path, *, when_run: bool = False) -> set[str]:
    """Dotted names of all that a file imports, inside functions too; when_run: without what only types need."""
    checks = [
        statement
        for statement in nodes(path)
        if isinstance(statement, ast.If) and ast.unparse(statement.test) == "TYPE_CHECKING"
    ]
    left_out = {node for statement in checks for node in ast.walk(statement)} if when_run else set()
    names: set[str] = set()
    for node in nodes(path):
        if node in left_out:
            continue
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names |= {f"{node.module}.{alias.name}" for alias in node.names} | {str(node.module)}
    return names


def own_modules(path: Path) -> set[str]:
    """The package's modules that a file imports."""
    ours = {name for name in imports(path) if name.startswith("granular_contact.")}
    modules = {name.removeprefix("granular_contact.") for name in ours} & NAMES
    return {name for name in modules if not any(other.startswith(f"{name}.") for other in modules)}


def ids(path: Path) -> str:
    return str(path.relative_to(PACKAGE))


def wrong(of: Callable[[Path], set[str]], modules: Sequence[Path] = MODULES) -> dict[str, set[str]]:
    """What is wrong with each module, of those with which something is."""
    return {ids(path): names for path in modules if (names := of(path))}


def below(name: str) -> set[str]:
    """Rooms that a module may import: its own, those on lower floors, and what it may load late."""
    room = part(name, set(ROOMS))
    floor = next((i for i, rooms in enumerate(FLOORS) if room in rooms), len(FLOORS))
    lower = {module for rooms in FLOORS[:floor] for module in rooms} | {room}
    never = NEVER.get(room, set())
    late = set().union(*(more for module, more in LATE.items() if f"{name}.".startswith(f"{module}.")))
    return {
        module for module in lower if module == room or not any(f"{module}.".startswith(f"{no}.") for no in never)
    } | late


def test_imports_go_one_way() -> None:
    def forbidden(path: Path) -> set[str]:
        name = dotted(path)
        if part(name, set(ROOMS)) not in ROOMS:  # at the top, and free
            return set()
        allowed = below(name)
        return {other for other in own_modules(path) if not {part(other, set(ROOMS)), part(other, allowed)} & allowed}

    assert len(MODULES) > 300
    assert wrong(forbidden) == {}


def test_heavy_libraries_stay_where_they_belong() -> None:
    homes: dict[str, tuple[str, ...]] = {
        "exudyn": ("engines.exudyn",),
        "mujoco": ("engines.mujoco",),
        "numba": ("jit", "sand.kernels", "mechanics.kernels", "engines"),
        "pydantic": ("config", "laws", "values"),
        "matplotlib": ("report.figures",),
        "gymnasium": ("gym",),
        "pandas": (),
        "trimesh": ("geometry", "robot"),
        "pyvista": ("report.figures",),
        "lxml": ("robot",),
    }

    def astray(path: Path) -> set[str]:
        libraries = {name.split(".")[0] for name in imports(path, when_run=True)} & set(homes)
        name = dotted(path)
        return {
            library for library in libraries if not any(f"{name}.".startswith(f"{home}.") for home in homes[library])
        }

    assert wrong(astray) == {}


def test_sand_and_mechanics_know_no_engine() -> None:
    def engines(path: Path) -> set[str]:
        text = path.read_text(encoding="utf-8").lower()
        return {name for name in ("import exudyn", "mujoco", "systemdata") if name in text}

    rooms = [path for path in MODULES if dotted(path).startswith(("sand", "mechanics", "laws", "jit"))]
    assert len(rooms) > 80
    assert wrong(engines, rooms) == {}


def test_only_the_command_line_prints_and_exits() -> None:
    # (os._exit is left out: a worker process has to end without its parent.)
    shouts = {"print", "exit", "quit", "sys.exit", "sys.stdout.write", "sys.stderr.write"}

    def output_calls(path: Path) -> set[str]:
        calls = {ast.unparse(node.func) for node in nodes(path) if isinstance(node, ast.Call)} & shouts
        raised = {ast.unparse(node.exc) for node in nodes(path) if isinstance(node, ast.Raise) and node.exc is not None}
        return calls | {error for error in raised if "SystemExit" in error}

    assert wrong(output_calls, [path for path in MODULES if not dotted(path).startswith(("__main__", "cli"))]) == {}


RUN = """
from granular_contact import config
from granular_contact.scene import build
from granular_contact.run import run
scenario = config.load("configs/{config}.yaml", {overrides}).scenario
results = run(build(scenario), scenario)
assert len(results.table) > 10
"""
SHORT = "solver.end_time_s=0.01"
# What a fresh interpreter does in turn. What is not loaded after a part was loaded by none before it.
WITH_THE_ENGINE = {
    "workers are started": "from granular_contact.studies import processes",
    "laws": "from granular_contact.laws import catalogue, floor, probe",
    "a config is checked": 'from granular_contact import config\nconfig.load("configs/pendulum.yaml")',
    "a scene is built": """
from granular_contact import config, scene
scene.build(config.load("configs/pendulum.yaml").scenario)
""",
    "a run without a medium": RUN.format(config="pendulum", overrides=["medium=null", SHORT]),
    "a run out of reach of the bed": RUN.format(config="pendulum", overrides=["surface_height_m=-0.5", SHORT]),
    "a run without figures": RUN.format(config="pendulum", overrides=["output.figures=false", SHORT])
    + """
import tempfile
from pathlib import Path
from granular_contact import report
with tempfile.TemporaryDirectory() as folder:
    report.write(results, Path(folder, "run"), figures=False)
""",
}
WITHOUT_THE_ENGINE = {
    "a bed on given poses": """
import numpy as np
from granular_contact import preset
from granular_contact.sand.contact_lines import Body, polyline
from granular_contact.sand.load import GranularLoad
load = GranularLoad(preset("rft_generic"), surface=0.0)
load.add(polyline(Body("plate", [0, 1, 2]), [[-0.05, 0.0], [0.05, 0.0]], width=0.1))
pose, velocity = np.array([0.0, -0.02, 0.0]), np.array([0.0, -0.1, 0.0])
load.start(pose)
load.accept(0.0, pose, velocity)
assert load.force(pose, velocity, np.zeros(3))[1] > 0.0
""",
    "a reduced run": RUN.format(config="pendulum", overrides=["method=reduced", SHORT]),
    "a run in minimal coordinates": RUN.format(config="pendulum_rigid", overrides=["method=minimal", SHORT]),
}
WITHOUT_RUNS = {
    "the command prints its help": """
from granular_contact.cli import main
assert main([]) == 0
""",
    "configs and their schema": """
from granular_contact import config
config.load("configs/pendulum.yaml")
config.json_schema()
config.load_sweep("configs/paper_cases.yaml")
""",
    "the command prints the schema": """
assert main(["schema"]) == 0
""",
    "the command checks a config": """
assert main(["check", "configs/pendulum.yaml"]) == 0
""",
}


def loaded(parts: dict[str, str]) -> dict[str, set[str]]:
    """Modules that a fresh interpreter holds after each of some parts of a program, packages among them."""
    tell = "\nimport sys\nprint('loaded', ' '.join(sorted(sys.modules)))\n"
    code = "".join(part + tell for part in parts.values())
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True, timeout=600
    )
    lines = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("loaded ")]
    return {name: set(line) for name, line in zip(parts, lines, strict=True)}


@pytest.fixture(scope="module")
def after() -> dict[str, set[str]]:
    return loaded(WITH_THE_ENGINE)


@pytest.mark.slow
def test_run_without_figures_loads_no_matplotlib(after: dict[str, set[str]]) -> None:
    modules = after["a run without figures"]
    assert "matplotlib" not in modules
    assert {"numba", "exudyn"} <= modules  # the tests would see them


@pytest.mark.slow
def test_a_planar_run_loads_nothing_of_space(after: dict[str, set[str]]) -> None:
    names = after["a run without figures"]
    assert "granular_contact.sand.kernels.lines" in names  # the test would see it
    assert of_space(names) == set()


def of_space(names: set[str]) -> set[str]:
    """Those of some modules that only scenes in space need."""
    kernels = {f"granular_contact.sand.kernels.{name}" for name in ("facets", "bars", "slices")}
    ours = {name for name in names if name.startswith("granular_contact.")}
    return (ours & kernels) | {name for name in ours if ".space" in name or "space_" in name}


@pytest.mark.slow
def test_scene_without_medium_and_bed_out_of_reach_load_no_numba(after: dict[str, set[str]]) -> None:
    assert "exudyn" in after["a run without a medium"]
    assert "numba" not in after["a run without a medium"]
    assert "numba" not in after["a run out of reach of the bed"]


def test_the_server_of_workers_starts_before_anything_is_loaded(after: dict[str, set[str]]) -> None:
    assert not after["workers are started"] & {"numpy", "pydantic", "yaml", "granular_contact.config"}


def test_laws_load_no_compiler(after: dict[str, set[str]]) -> None:
    assert "numba" not in after["laws"]


def test_checking_a_config_loads_no_engine(after: dict[str, set[str]]) -> None:
    assert not after["a config is checked"] & {"numba", "exudyn", "matplotlib", "scipy"}


def test_building_a_scene_loads_no_engine(after: dict[str, set[str]]) -> None:
    assert not after["a scene is built"] & {"numba", "exudyn", "matplotlib"}


@pytest.mark.slow
def test_given_poses_reduced_and_minimal_coordinates_load_no_engine() -> None:
    after = loaded(WITHOUT_THE_ENGINE)
    assert "numba" in after["a bed on given poses"]  # the test would see it
    assert not after["a reduced run"] & {"exudyn", "matplotlib", "scipy.integrate"}
    assert not after["a run in minimal coordinates"] & {"exudyn", "matplotlib"}
    assert of_space(after["a run in minimal coordinates"]) == set()


@pytest.mark.slow
def test_commands_without_runs_load_nothing_heavy() -> None:
    after, heavy = loaded(WITHOUT_RUNS), {"exudyn", "numba", "matplotlib"}
    assert not after["the command prints its help"] & {"pydantic", "yaml", "numpy", *heavy}
    assert "pydantic" in after["configs and their schema"]  # the test would see it
    assert not after["configs and their schema"] & {*heavy, "numpy", "rich", "multiprocessing"}
    assert not after["the command prints the schema"] & {*heavy, "numpy"}
    assert "numpy" in after["the command checks a config"]
    assert not after["the command checks a config"] & heavy


def test_the_index_of_a_room_names_all_its_modules() -> None:
    missing = {}
    for room in (path for path in MODULES if path.name == "__init__.py"):
        name = room.parent.relative_to(PACKAGE).as_posix()
        if name in (".", "cli", "laws"):  # named by what they export, a module a command, a module a law
            continue
        index = ast.get_docstring(ast.parse(room.read_text(encoding="utf-8"))) or ""
        missing[name] = {path.stem for path in room.parent.glob("[!_]*.py")} - set(re.findall(r"\w+", index))
    assert missing == {name: set() for name in missing}
