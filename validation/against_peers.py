"""Error and run time of this package, MuJoCo and PyElastica, all measured in one run.

    pip install -e '.[bench]' && python validation/against_peers.py

The case is one impact (31 degrees, 6.24 rad/s, 40 ms). Every tool has the same law with the same exact treatment of the
surface. The error is the largest distance of the tip from a converged path, which is computed with MuJoCo and 32
hinges; so the errors of this package include the rotary inertia of the section, which its beam neglects. Run times are
those of the time steps alone, medians after a warm-up. Chains of rigid links follow, see `peer_chains`.
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import load_scenario
from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.solve import solve
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.scene import build as build_scene
from validation import peer_chains
from validation.peers import Path as TipPath
from validation.peers import elastica_pendulum, mujoco_pendulum
from validation.tables import machine, markdown

LEVELS = (60.0, 12.0, 6.0)  # micrometres

# Settings from coarse to fine, selected from many for each tool. OURS: elements, strips per element, steps over the
# 40 ms, tolerance; other tools: hinges or elements, steps. The last but one of OURS has the defaults.
OURS = (
    (1, 4, 40, 1e-3),
    (1, 8, 64, 1e-2),
    (1, 8, 72, 1e-3),
    (2, 4, 64, 1e-3),
    (2, 4, 110, 1e-3),
    (4, 4, 160, 1e-4),
    (4, 4, 200, 1e-5),
    (8, 4, 400, 1e-5),
)
HINGES_PLAIN = ((1, 320), (2, 500), (4, 1600), (6, 3200))
HINGES_LEAPFROG = ((1, 160), (2, 200), (3, 400), (3, 500), (4, 640), (6, 1300))
RODS = (8, 10, 18, 25)


def ours(elements: int, strips: int, steps: int, tolerance: float) -> TipPath:
    """Tip path of this package."""
    scene = build_scene(
        load_scenario(
            HERE.parent / "configs" / "pendulum.yaml",
            [
                f"model.bodies.link.flexible.elements={elements}",
                f"solver.step_s={0.04 / steps}",
                "solver.end_time_s=0.04",
                "solver.rest_time_s=null",
                f"load.strips_per_element={strips}",
                f"solver.tolerance={tolerance}",
            ],
        )
    )
    system = build(scene)
    trajectory = solve(system)
    tip, _ = Kinematics(system, trajectory).position(*scene.tip)
    return TipPath(trajectory.time, tip, trajectory.cost.solve_s)


@dataclass(frozen=True)
class Point:
    """One setting of one tool: error (micrometres) and median time (ms)."""

    tool: str
    setting: str
    error: float
    milliseconds: float


def measure(tool: str, setting: str, run: Callable[[], TipPath], truth: TipPath, repeats: int) -> Point:
    """Measure the error of a setting against the converged path, and its median run time after a warm-up."""
    paths = [run() for _ in range(repeats + 1)][1:]
    path = paths[-1]
    at = np.column_stack([np.interp(path.time, truth.time, truth.tip[:, i]) for i in range(2)])
    error = 1e6 * float(np.max(np.linalg.norm(path.tip - at, axis=1)))
    return Point(tool, setting, error, 1e3 * statistics.median(p.seconds for p in paths))


def points(truth: TipPath, repeats: int) -> list[Point]:
    """Measure all tools at all settings."""
    measured = []
    for setting in OURS:
        n, _, steps, _ = setting
        run = lambda s=setting: ours(*s)  # noqa: E731
        measured.append(measure("granular-contact", f"{n} elements, {steps} steps", run, truth, repeats))
    variants = (
        ("MuJoCo, Python call per step", HINGES_PLAIN, {}),
        ("MuJoCo, Python call per step, leapfrog", HINGES_LEAPFROG, {"leapfrog": True}),
        ("MuJoCo, compiled callback, leapfrog", HINGES_LEAPFROG, {"leapfrog": True, "callback": "native"}),
    )
    for tool, ladder, options in variants:
        for n, steps in ladder:
            run = lambda n=n, s=steps, o=options: mujoco_pendulum.run(n, 0.04 / s, **o)  # noqa: E731
            measured.append(measure(tool, f"{n} hinges, {steps} steps", run, truth, repeats))
    rods = [measure("PyElastica", f"{n} elements", lambda n=n: elastica_pendulum.run(n), truth, 1) for n in RODS]
    return measured + rods


def cheapest(measured: list[Point], level: float) -> dict[str, Point]:
    """Fastest setting of each tool whose error is within a level (micrometres)."""
    best: dict[str, Point] = {}
    for point in measured:
        if point.error <= level and (point.tool not in best or point.milliseconds < best[point.tool].milliseconds):
            best[point.tool] = point
    return best


def draw(measured: list[Point], file: Path) -> None:
    """Draw the work-precision diagram."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from granular_contact.report.figures.style import DPI, PALETTE, style

    with style():
        figure = Figure(figsize=(4.6, 3.2), layout="constrained")
        axes = figure.subplots()
        for tool, marker, color in zip(dict.fromkeys(p.tool for p in measured), "osv^D", PALETTE, strict=False):
            of_tool = sorted((p for p in measured if p.tool == tool), key=lambda p: p.milliseconds)
            times, errors = [p.milliseconds for p in of_tool], [p.error for p in of_tool]
            axes.loglog(times, errors, marker, ls="-", color=color, label=tool)
        for level in LEVELS:
            axes.axhline(level, color="0.6", lw=0.5, ls=":", zorder=0)
        axes.set(xlabel="time of the steps (ms)", ylabel="largest tip-path error (µm)")
        figure.legend(loc="outside upper center", ncols=2)
        file.parent.mkdir(exist_ok=True)
        FigureCanvasAgg(figure).print_figure(file, dpi=DPI)


def main(repeats: int = 9) -> int:
    """Print the tables and draw the figure; return 0 if this package keeps its bounds, else 1."""
    truth = mujoco_pendulum.run(32, 1e-6, integrator="RK4", callback="native")
    measured = points(truth, repeats)
    print(f"{machine('exudyn', 'mujoco', 'pyelastica', 'numba')}; median of {repeats} after a warm-up\n")
    rows = [[p.tool, p.setting, f"{p.error:.1f}", f"{p.milliseconds:.2f}"] for p in measured]
    print(markdown(["tool", "setting", "error um", "ms"], rows))
    print()
    tools = list(dict.fromkeys(p.tool for p in measured))
    rows = []
    for level in LEVELS:
        best = cheapest(measured, level)
        rows.append([f"{level:g} um", *(f"{best[t].milliseconds:.2f}" if t in best else "not reached" for t in tools)])
    print(markdown(["error at most", *(f"{tool}, ms" for tool in tools)], rows))
    draw(measured, HERE / "figures" / "against_peers.png")
    best = {tool: point.milliseconds for tool, point in cheapest(measured, 12.0).items()}
    own = best["granular-contact"]
    mujoco, expert = own / best["MuJoCo, Python call per step"], own / best["MuJoCo, Python call per step, leapfrog"]
    elastica = best["PyElastica"] / own
    print(f"\nAt 12 um this package takes {mujoco:.2f} times MuJoCo's time with one Python call per step (bound: 1.5),")
    print(f"{expert:.1f} times its time where the user adds the leapfrog trick;")
    print(f"PyElastica takes {elastica:.0f} times the time of this package (bound: 30).")
    ahead = chains(max(3, repeats // 3))
    return 0 if mujoco <= 1.5 and elastica >= 30.0 and ahead else 1


def chains(repeats: int) -> bool:
    """Print the tables of the chains; return whether this package takes at most twice MuJoCo's time.

    MuJoCo's time is that with one Python call per step.
    """
    apart = max(peer_chains.agreement(links) for links in peer_chains.SIZES)
    measured = peer_chains.points(repeats)
    print(
        f"\nChains of rigid links; with the finest steps, paths differ by at most {apart:.3f} um from those of "
        f"MuJoCo with RK4; median of {repeats}\n"
    )
    print(peer_chains.tables(measured, peer_chains.SIZES))
    plain = peer_chains.ratios(measured, peer_chains.SIZES)
    expert = peer_chains.ratios(measured, peer_chains.SIZES, peer_chains.LEAPFROG_TOOL)
    print(f"\nMinimal coordinates take {_range(plain)} times MuJoCo's time with one Python call per step (bound: 2),")
    print(f"and {_range(expert)} times its time where the user adds the leapfrog trick.")
    return max(plain.values()) <= 2.0 and apart <= peer_chains.AGREE


def _range(ratios: dict[tuple[float, int], float]) -> str:
    return f"{min(ratios.values()):.2f} to {max(ratios.values()):.2f}"


if __name__ == "__main__":
    sys.exit(main())
