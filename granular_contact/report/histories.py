"""Panels of curves over time, for figures and pages; each curve is a sum of columns.

The names of the columns tell which joints, drives, bodies, terms of the medium's force and energies a run has. Equal
curves are drawn as one curve; curves that are only round-off are not drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from granular_contact.report.units import Array, Unit, greatest, split, unit_for
from granular_contact.results.energy import accumulate

ROUND_OFF = 1e-9  # of the largest number with the same unit in the table; smaller curves are round-off
SAME = 1e-6  # relative tolerance of equal curves
# Least scale of round-off of angles and lengths, for runs in which all of them are small.
_LEAST = {"deg": 1.0, "m": 1e-3}
BASES = {"deg": "deg", "m": "m", "m_s": "m/s", "rad_s": "rad/s", "N": "N", "Nm": "N·m", "W": "W", "J": "J"}
FIXED = ("deg", "rad/s", "m/s")  # units without prefixes

_SI = Unit(1.0, "")

Values = Callable[[str], Array]


@dataclass(frozen=True)
class Curve:
    """A sum of columns, each with a factor.

    start: whether values are relative to the first one; integral: whether to integrate over time, as a power to a work.
    along: column of the abscissa, if it differs between the curves of a panel.
    """

    label: str
    terms: tuple[tuple[str, float], ...]
    start: bool = False
    integral: bool = False
    along: str = ""

    def values(self, column: Values) -> Array:
        """Values (rows,) in SI units or degrees; column: function from the name of a column to its values."""
        total = np.sum([factor * column(name) for name, factor in self.terms], axis=0)
        if self.integral:
            total = accumulate(column("time_s"), total)
        return np.asarray(total - total[0] if self.start else total)


@dataclass(frozen=True)
class Panel:
    """Curves of one quantity in a common unit, over time or over a column `along` (m)."""

    title: str
    base: str
    curves: tuple[Curve, ...]
    unit: Unit = _SI
    along: str = ""

    @property
    def heading(self) -> str:
        """Title with the unit."""
        return f"{self.title} ({self.unit.name})" if self.title and self.unit.name else self.title or self.unit.name


@dataclass(frozen=True)
class Group:
    """Panels of one figure: its name, a heading and a caption."""

    name: str
    heading: str
    caption: str
    panels: tuple[Panel, ...]


def groups(names: Sequence[str], terms: Sequence[str], column: Values) -> list[Group]:
    """Groups of panels of a table with the given columns and terms of the medium's force; empty ones are left out."""
    run = _RunNames(names, terms)
    scales = _scales(names, column)
    all_groups = [_wheels(run), _travel(run), _joints(run), _forces(run), _depths(run), _energy(run)]
    visible = [replace(group, panels=tuple(_visible(group.panels, column, scales))) for group in all_groups]
    return [group for group in visible if group.panels]


def groups_of(names: Sequence[str], terms: Sequence[str], column: Values) -> list[Group]:
    """Groups of a table without panels that repeat others; see `groups` and `distinct`."""
    return distinct(groups(names, terms, column), column)


def distinct(all_groups: Sequence[Group], column: Values, *, compared: bool = False) -> list[Group]:
    """Remove panels whose curves other panels show: the force on a single body is the sum, a carriage follows its rail.

    Lengths or energies of opposite sign count as equal: a post rises as far as its wheel sinks less. compared: whether
    the curves are of several runs; then panels on which all runs are constant and equal are removed as well.
    """
    shown: list[tuple[str, Array]] = []
    removed = set()
    for group in sorted(all_groups, key=_priority):
        for i, panel in enumerate(group.panels):
            curves = [] if panel.along else [curve.values(column) for curve in panel.curves]
            if curves and (
                all(_is_shown(panel.base, values, shown) for values in curves) or (compared and _are_constant(curves))
            ):
                removed.add((group.name, i))
            shown += [(panel.base, values) for values in curves]
    kept = [
        replace(group, panels=tuple(panel for i, panel in enumerate(group.panels) if (group.name, i) not in removed))
        for group in all_groups
    ]
    return [group for group in kept if group.panels]


_PRIORITY = ("wheel", "travel", "path", "depth", "forces", "joints", "energy")  # of two equal panels the first stays


def _priority(group: Group) -> int:
    return _PRIORITY.index(group.name) if group.name in _PRIORITY else len(_PRIORITY)


def _is_shown(base: str, values: Array, shown: Sequence[tuple[str, Array]]) -> bool:
    signs = (1.0, -1.0) if base in ("m", "J") else (1.0,)
    return any(base == other_base and _alike(values, sign * other) for other_base, other in shown for sign in signs)


def _are_constant(curves: Sequence[Array]) -> bool:
    return float(np.nanmax(curves) - np.nanmin(curves)) <= SAME * greatest(curves)


def _scales(names: Iterable[str], column: Values) -> dict[str, float]:
    """Largest number of each unit in the table; for moments at least the largest force times the largest length."""
    scales: dict[str, float] = {}
    for name in names:
        base = BASES.get(split(name)[1])
        if base is not None:
            scales[base] = max(scales.get(base, 0.0), greatest(column(name)))
    scales["N·m"] = max(scales.get("N·m", 0.0), scales.get("N", 0.0) * scales.get("m", 0.0))
    return scales


def _visible(panels: Iterable[Panel], column: Values, scales: dict[str, float]) -> Iterable[Panel]:
    """Panels in suitable units, without curves that are only round-off, and with equal curves joined to one."""
    for panel in panels:
        least = ROUND_OFF * max(scales.get(panel.base, 0.0), _LEAST.get(panel.base, 0.0))
        kept: list[tuple[Curve, Array]] = []
        for curve in panel.curves:
            values = curve.values(column)
            if not greatest(values) > least:
                continue
            twin = next((i for i, (_, other) in enumerate(kept) if _alike(values, other)), None)
            if twin is None:
                kept.append((curve, values))
            else:
                joined = replace(kept[twin][0], label=f"{kept[twin][0].label}, {curve.label}")
                kept[twin] = joined, kept[twin][1]
        if not kept:
            continue
        yield in_unit(replace(panel, curves=tuple(curve for curve, _ in kept)), column)


def panel(title: str, name: str, curves: Sequence[Curve], column: Values) -> Panel:
    """Make a panel of curves that all have the unit of the column `name`."""
    return in_unit(Panel(title, BASES.get(split(name)[1], ""), tuple(curves)), column)


def in_unit(panel: Panel, column: Values) -> Panel:
    """Return a panel with the unit that suits its curves."""
    if not panel.base or panel.base in FIXED:
        return replace(panel, unit=Unit(1.0, panel.base))
    largest = max(greatest(curve.values(column)) for curve in panel.curves)
    return replace(panel, unit=unit_for(largest, panel.base))


def _alike(first: Array, second: Array) -> bool:
    return greatest(first - second) <= SAME * max(greatest(first), greatest(second))


class _RunNames:
    """Names of joints, drives, bodies and links of a run, taken from the names of its columns."""

    def __init__(self, names: Sequence[str], terms: Sequence[str]) -> None:
        self.columns, self.terms = set(names), tuple(terms)

        def stems(end: str, *others: str) -> list[str]:
            candidates = [name.removesuffix(end) for name in names if name.endswith(end)]
            return [stem for stem in candidates if all(stem + other in self.columns for other in others)]

        self.hinges = stems("_angle_deg", "_rate_rad_s")
        self.sliders = stems("_position_m", "_speed_m_s")
        self.drive_torques = stems("_torque_Nm", "_power_W")
        self.drive_forces = stems("_force_N", "_power_W")
        self.bodies = stems("_x_m", "_vx_m_s")
        self.loaded = stems("_granular_x_N")
        self.immersible = [body for body in stems("_depth_m") if body in self.bodies]
        self.bending = stems("_deflection_y_m", "_deflection_z_m")  # in space
        self.strained = stems("_strain", "_root_strain")
        self.wheels = stems("_slip", "_sinkage_m")
        self.in_space = any(f"{body}_vz_m_s" in self.columns for body in self.bodies)
        self.up = "z" if self.in_space else "y"

    def panel(self, title: str, base: str, curves: Iterable[tuple[str, str]], along: str = "") -> Panel:
        """Make a panel of single columns, given by label and name; missing columns are skipped."""
        kept = tuple(Curve(label, ((name, 1.0),)) for label, name in curves if name in self.columns)
        return Panel(title, base, kept, along=along)


def _wheels(run: _RunNames) -> Group:
    """Slip, sinkage and forces of wheels, along and across the surface below their axle."""
    quantities = (
        *(("slip", "", "slip"), ("sinkage", "m", "sinkage_m"), ("drawbar pull", "N", "drawbar_pull_N")),
        *(("load", "N", "load_N"), ("torque", "N·m", "torque_Nm"), ("side force", "N", "side_force_N")),
        *(("slip angle", "deg", "slip_angle_deg"),),
    )
    panels = [
        run.panel(title, base, [(wheel, f"{wheel}_{end}") for wheel in run.wheels]) for title, base, end in quantities
    ]
    caption = "Slip, sinkage, pull, load and torque, along and across the surface below the axle."
    return Group("wheel", "Wheel" if len(run.wheels) == 1 else "Wheels", caption, tuple(panels))


def _travel(run: _RunNames) -> Group:
    """Motion of the first body (of a robot the trunk), or the path of the tip if bodies have no columns."""
    up = "height" if run.in_space or run.bodies else "height of the tip"
    if not run.bodies:
        panels = [
            run.panel("tip, horizontal", "m", [("tip x", "tip_x_m")]),
            run.panel(up, "m", [("tip y", "tip_y_m"), ("tip z", "tip_z_m")]),
        ]
        return Group("path", "Path of the tip", "Path of the tip.", () if run.hinges else tuple(panels))
    body = run.bodies[0]
    tilts = [(name, f"{body}_{name}_deg") for name in ("roll", "pitch", "yaw")]
    tilts.append(("pitch (clockwise)", f"{body}_orientation_deg"))  # in the plane
    ahead, upward = f"{body}_vx_m_s", f"{body}_v{run.up}_m_s"
    sideways = [("sideways", f"{body}_vy_m_s")] if run.in_space else []
    panels = [
        run.panel(f"{body}, ahead", "m", [("x", f"{body}_x_m")]),
        *([run.panel(f"{body}, to the left", "m", [("y", f"{body}_y_m")])] if run.in_space else []),
        run.panel(f"{body}, height", "m", [(run.up, f"{body}_{run.up}_m")]),
        run.panel(f"{body}, {'angles' if run.in_space else 'pitch'}", "deg", tilts),
        run.panel(f"{body}, speed", "m/s", [("ahead", ahead), *sideways, ("upward", upward)]),
    ]
    caption = f"Path and speed of the centre of mass of {body}, and its attitude."
    return Group("travel", f"Motion of {body}", caption, tuple(panels))


def _joints(run: _RunNames) -> Group:
    """Angle and rate of hinges, position and speed of sliders; torque, power and work of drives."""
    rates = [(name, f"{name}_rate_rad_s") for name in run.hinges]
    if "mean_rate_rad_s" in run.columns:
        rates.append(("mean (angular momentum / inertia)", "mean_rate_rad_s"))
    driven = [*run.drive_torques, *run.drive_forces]
    works = tuple(Curve(name, ((f"{name}_power_W", 1.0),), integral=True) for name in driven)
    panels = [
        run.panel("angle of joints", "deg", [(name, f"{name}_angle_deg") for name in run.hinges]),
        run.panel("rate of joints", "rad/s", rates),
        run.panel("position of sliders", "m", [(name, f"{name}_position_m") for name in run.sliders]),
        run.panel("speed of sliders", "m/s", [(name, f"{name}_speed_m_s") for name in run.sliders]),
        run.panel("torque of drives", "N·m", [(name, f"{name}_torque_Nm") for name in run.drive_torques]),
        run.panel("force of drives", "N", [(name, f"{name}_force_N") for name in run.drive_forces]),
        run.panel("power of drives", "W", [(name, f"{name}_power_W") for name in driven]),
        Panel("work of drives", "J", works),
        run.panel("deflection of the last flexible link", "m", [("tip", "deflection_m")]),
        *(
            run.panel(f"deflection of {link}", "m", [(f"along {axis}", f"{link}_deflection_{axis}_m") for axis in "yz"])
            for link in run.bending
        ),
        run.panel("twist of links", "deg", [(link, f"{link}_twist_deg") for link in run.bending]),
        run.panel("greatest strain of links", "", [(link, f"{link}_strain") for link in run.strained]),
    ]
    caption = "Angle, rate, torque, power and work of joints." if driven else "Angle and rate of joints."
    return Group("joints", "Joints", caption, tuple(panels))


def _forces(run: _RunNames) -> Group:
    """Forces of the medium: each term, their sum, and the forces on each body."""
    axes = [("horizontal force", "x"), ("vertical force", "y")]
    if run.in_space:
        axes = [("force ahead", "x"), ("force to the left", "y"), ("vertical force", "z")]
    panels = [Panel(title, "N", _terms(run, f"force_{axis}_N")) for title, axis in axes]
    moments = [("pivot", "moment_Nm"), ("centre of mass", "moment_about_center_of_mass_Nm")]
    panels += [Panel(f"moment about the {about}", "N·m", _terms(run, end)) for about, end in moments]
    for side, axis in (("ahead", "x"), ("upward", run.up)):
        curves = [(name, f"{name}_granular_{axis}_N") for name in run.loaded]
        panels.append(run.panel(f"force on each body, {side}", "N", curves))
    caption = "Forces of the medium: each term, their sum, and the forces on each body."
    return Group("forces", "Forces of the medium", caption, tuple(panels))


def _terms(run: _RunNames, end: str) -> tuple[Curve, ...]:
    """Curves of the terms of a force, with their sum first if there are several."""
    columns = [(term, f"{term}_{end}") for term in run.terms if f"{term}_{end}" in run.columns]
    single = tuple(Curve(term.replace("_", " "), ((name, 1.0),)) for term, name in columns)
    return (Curve("sum", tuple((name, 1.0) for _, name in columns)), *single) if len(single) > 1 else single


def _depths(run: _RunNames) -> Group:
    """Depth of bodies other than wheels, which have a sinkage, and vertical force against depth."""
    bodies = [name for name in run.immersible if name not in run.wheels]
    depths = [(name, f"{name}_depth_m") for name in bodies]
    panels = [run.panel("depth", "m", depths or [("deepest point", "depth_m")])] if bodies or not run.wheels else []
    for name in bodies[:MOST_BODIES]:
        title, forces = f"vertical force on {name} against its depth", [(name, f"{name}_granular_{run.up}_N")]
        panels.append(run.panel(title, "N", forces, along=f"{name}_depth_m"))
    upward = tuple((f"{term}_force_{run.up}_N", 1.0) for term in run.terms if f"{term}_force_{run.up}_N" in run.columns)
    if not run.immersible and upward and "depth_m" in run.columns:
        panels.append(Panel("vertical force against depth", "N", (Curve("sum", upward),), along="depth_m"))
    caption = "Depth of the deepest point of each body, and the vertical force of the medium against it."
    return Group("depth", "Depth, and force against depth", caption, tuple(panels))


MOST_BODIES = 8  # greatest number of bodies whose force is drawn against depth


ENERGIES = (  # label, column, factor; gravity is counted from the start
    ("kinetic", "kinetic_J", 1.0),
    ("gravity, from start", "gravity_J", 1.0),
    ("elastic", "elastic_J", 1.0),
    ("dissipated in medium", "granular_work_J", -1.0),
    ("dissipated by damping", "damping_work_J", -1.0),
    ("springs and stops of joints", "spring_J", 1.0),
    ("dissipated by dampers", "joint_damping_work_J", -1.0),
    ("dissipated by dry friction", "friction_work_J", -1.0),
    ("taken by the floor", "floor_work_J", -1.0),
    ("less work of drives", "drive_work_J", -1.0),
)


def _energy(run: _RunNames) -> Group:
    """Energies and works, and the imbalance of energy."""
    present = (entry for entry in ENERGIES if entry[1] in run.columns)
    curves = tuple(Curve(label, ((name, factor),), start=name == "gravity_J") for label, name, factor in present)
    panels = [
        Panel("energy", "J", curves),
        run.panel("energy imbalance", "J", [("imbalance", "energy_imbalance_J")]),
    ]
    caption = "Stored and dissipated energy; apart from the imbalance the sum is constant."
    return Group("energy", "Energy", caption, tuple(panels))
