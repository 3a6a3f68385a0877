"""Every study times every kind of model: small configs, what each study does with one, and which refusals are right."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from support_runs import ROOT
from support_sweep import read

from granular_contact import Simulation, cli, load, simulate
from granular_contact.results import Results

PAGE = ROOT / "docs/reference/studies_and_models.md"

SHORT = "solver: {end_time_s: 2.0e-3, step_s: 1.0e-3, rest_time_s: null}\n"
BAR = "{type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 2700}"
BENDING = BAR[:-1] + ", flexible: {youngs_modulus_Pa: 3.0e9, elements: 2}}"
STEEL = "{type: link, length_m: %s, diameter_m: 0.01, density_kg_m3: 7700}"
WHEEL = "{type: rigid, density_kg_m3: 1000, shapes: [{type: wheel, radius_m: 0.05, width_m: 0.05}]}"
HUB = "{type: rigid, mass_kg: 0.1, inertia_kg_m2: 1.0e-5}"
STRUCK = "bed: {height_m: 0.0}\ninitial: {joints: {a: {angle_deg: 20, rate_rad_s: 2}}}\n"
RATE = "initial.joints.a.rate_rad_s"
IN_SPACE = f"""\
surface_height_m: 0
medium: {{from: rft3d_sand, scatter: {{relative: 0.1, length_m: 0.02}}}}
{SHORT}"""


def planar(bodies: str, joints: str, more: str, medium: str = "play_sand") -> str:
    """A config in the plane, of bodies and joints in flow style; more: other keys, on lines."""
    scattered = f"{{from: {medium}, scatter: {{relative: 0.1, length_m: 0.003}}}}"
    model = f"model:\n  name: small\n  bodies: {{{bodies}}}\n  joints: {{{joints}}}\n{more}"
    return f"{model}medium: {scattered}\n{SHORT}load: {{strips_per_rigid_part: 4}}\n"


def hinge(child: str, parent: str = "ground", more: str = "") -> str:
    """A hinge in flow style."""
    return f"{{type: hinge, parent: {parent}, child: {child}{more}}}"


ROBOT = """\
<robot name="small">
<link name="trunk"><inertial><mass value="0.5"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="leg"><inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 -0.05"/><geometry><sphere radius="0.02"/></geometry></collision></link>
<joint name="a" type="continuous"><parent link="trunk"/><child link="leg"/><axis xyz="0 1 0"/></joint>
</robot>
"""  # noqa: E501


@dataclass(frozen=True)
class Model:
    """A kind of model: the config of a run of one, and what of it studies work on.

    varied, values: a number that sweeps and searches vary; measured, coefficient: column that a fit compares, and the
    number of the medium that it finds; driven: joint that an agent moves.
    """

    config: str
    varied: str
    measured: str
    values: tuple[float, float] = (1.0, 2.0)
    coefficient: str = "medium.eta_d"
    driven: str = "a"


MODELS = {
    "pendulum": Model(planar(f"bar: {BAR}", f"a: {hinge('bar')}", STRUCK), RATE, "a_angle_deg"),
    "chain": Model(
        planar(
            f"one: {BAR}, two: {BAR}",
            f"a: {hinge('one')}, b: {hinge('two', 'one', ', parent_point_m: [0.1, 0]')}",
            STRUCK,
        ),
        RATE,
        "a_angle_deg",
    ),
    "loop": Model(
        planar(
            f"crank: {STEEL % 0.1}, coupler: {STEEL % 0.3}, rocker: {STEEL % 0.3}",
            f"a: {hinge('crank', more=', home_deg: -90')}, "
            f"b: {hinge('coupler', 'crank', ', parent_point_m: [0.1, 0], home_deg: 90')}, "
            f"d: {hinge('rocker', more=', parent_point_m: [0.3, -0.2], home_deg: -90')}",
            "  closures: {c: {type: hinge, parent: coupler, child: rocker, parent_point_m: [0.3, 0], "
            "child_point_m: [0.3, 0]}}\nbed: {height_m: 0.0}\ninitial: {joints: {a: {rate_rad_s: 2}}}\n",
        ),
        RATE,
        "a_angle_deg",
    ),
    "flexible link": Model(
        planar(f"hub: {HUB}, bar: {BENDING}", f"a: {hinge('hub')}, b: {{type: weld, parent: hub, child: bar}}", STRUCK),
        RATE,
        "a_angle_deg",
    ),
    "free rod that bends": Model(
        planar(
            f"rod: {BENDING}",
            "a: {type: free, parent: ground, child: rod}",
            "initial: {joints: {a: {vx_m_s: 0.5, vy_m_s: -1}}}\n",
        ),
        "initial.joints.a.vy_m_s",
        "rod_x_m",
        (-2.0, -1.0),
    ),
    "free wheel": Model(
        planar(
            f"hub: {HUB}, wheel: {WHEEL}",
            f"a: {{type: free, parent: ground, child: hub}}, axle: {hinge('wheel', 'hub')}",
            "initial: {joints: {a: {vy_m_s: -1}}}\n",
            "rft_generic",
        ),
        "initial.joints.a.vy_m_s",
        "hub_y_m",
        (-2.0, -1.0),
        "medium.zeta",
        "axle",
    ),
    "wheel at a given slip": Model(
        planar(
            f"carriage: {HUB}, hub: {HUB}, wheel: {WHEEL}",
            "rail: {type: slider, parent: ground, child: carriage}, "
            "post: {type: slider, parent: carriage, child: hub, axis: [0, 1], damping_N_s_per_m: 130}, "
            f"axle: {hinge('wheel', 'hub')}",
            "wheel: {slip: 0.2, speed_m_s: 0.02, load_N: 10}\n",
            "rft_generic",
        ),
        "wheel.slip",
        "post_position_m",
        (0.1, 0.2),
        "medium.zeta",
        "axle",
    ),
    "flexible in space": Model(
        "model:\n  in_space: true\n  name: small\n  bodies:\n"
        "    hub: {type: rigid, mass_kg: 0.1, inertia_kg_m2: {xx: 1.0e-4, yy: 1.0e-4, zz: 1.0e-4}}\n"
        "    bar: {type: link, length_m: 0.1, width_m: 0.02, thickness_m: 0.005, density_kg_m3: 2700, "
        "flexible: {youngs_modulus_Pa: 3.0e9, elements: 2}}\n"
        "  joints:\n    a: {type: hinge, parent: ground, child: hub, axis: [0, 1, 0.3]}\n"
        "    b: {type: weld, parent: hub, child: bar}\n"
        "initial: {joints: {a: {angle_deg: 20, rate_rad_s: 2}}}\n" + IN_SPACE,
        RATE,
        "a_angle_deg",
        coefficient="medium.mu_int",
    ),
    "robot in space": Model(
        "model:\n  in_space: true\n  name: small\n  bodies:\n"
        "    trunk: {type: rigid, density_kg_m3: 500, shapes: [{type: box, size_m: [0.1, 0.08, 0.04]}]}\n"
        "    leg: {type: rigid, density_kg_m3: 500, shapes: [{type: sphere, diameter_m: 0.04}]}\n"
        "  joints:\n    flight: {type: free, parent: ground, child: trunk}\n"
        "    a: {type: hinge, parent: trunk, child: leg, parent_point_m: [0, 0, -0.04], axis: [0, 1, 0]}\n"
        "initial: {joints: {flight: {z_m: 0.02, vz_m_s: -1}}}\n" + IN_SPACE,
        "initial.joints.flight.vz_m_s",
        "trunk_z_m",
        (-2.0, -1.0),
        "medium.mu_int",
    ),
    "URDF": Model(
        "model: {urdf: robot.urdf}\ninitial: {joints: {trunk: {z_m: 0.06, vz_m_s: -1}}}\n" + IN_SPACE,
        "initial.joints.trunk.vz_m_s",
        "trunk_z_m",
        (-2.0, -1.0),
        "medium.mu_int",
    ),
}


class Refused(Exception):
    """What a study says to a model that it does not take."""


class Case:
    """A model in a folder, with what a study needs of it."""

    def __init__(self, name: str, folder: Path, printed: Callable[[], str]) -> None:
        self.model, self.folder, self._said = MODELS[name], folder, printed
        (folder / "robot.urdf").write_text(ROBOT, encoding="utf-8")
        self.config = self.file("model", self.model.config + "output: {figures: false}\n")

    def file(self, name: str, text: str) -> Path:
        """A file of the folder, written."""
        path = self.folder / f"{name}.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    def plain(self) -> dict[str, Any]:
        """The config as data."""
        data: dict[str, Any] = yaml.safe_load(self.config.read_text(encoding="utf-8"))
        return data

    def command(self, *arguments: object) -> None:
        """Run a command; raises Refused with what it says unless it ends well."""
        self._said()
        code = cli.main([*map(str, arguments)])
        printed = self._said()
        if code not in (0, 5):  # 5: two steps of 1 ms are too coarse for a result to be usable, which is told
            raise Refused(printed.strip() or f"exit code {code}")

    def run(self) -> Path:
        """The folder of a run with its figures."""
        folder = self.folder / "run"
        if not folder.exists():
            self.command("run", self.config, "--set", "output.figures=true", "--quiet", "--out", folder)
        return folder


def _run(case: Case) -> None:
    folder = case.run()
    assert list((folder / "figures").glob("*.png"))
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["max_depth_m"] > 0


def _sweep(case: Case) -> None:
    file = case.file("sweep", f"config: model.yaml\nvary: {{{case.model.varied}: {list(case.model.values)}}}\n")
    case.command("sweep", file, "--out", case.folder / "swept")
    assert [row["status"] for row in read(case.folder / "swept")] == ["end_time", "end_time"]


def _ensemble(case: Case) -> None:
    case.command("ensemble", case.config, "--count", 2, "--out", case.folder / "seeds")
    assert [row["status"] for row in read(case.folder / "seeds")] == ["end_time", "end_time"]


def _optimise(case: Case) -> None:
    text = f"config: model.yaml\nparameters: {{{case.model.varied}: {list(case.model.values)}}}\n"
    few = "method: differential_evolution\nevaluations: 6\npopulation: 5\n"  # the fewest that it takes
    fine = "set: {solver.step_s: null, solver.accuracy: 1.0e-3}\n"  # results that are usable: else there is no best
    file = case.file("search", f"{text}objective: {{minimise: max_depth_m}}\n{few}{fine}")
    case.command("optimise", file, "--out", case.folder / "best")


def _fit(case: Case) -> None:
    results = Results.open(case.run())
    time = np.linspace(0.0, results["time_s"][-1], 12)
    values = np.interp(time, results["time_s"], results[case.model.measured])
    data = case.folder / "measured.csv"
    rows = [f"{t!r},{x!r}" for t, x in zip(time.tolist(), values.tolist(), strict=True)]
    data.write_text("\n".join([f"time_s,{case.model.measured}", *rows, ""]), encoding="utf-8")
    options = ("--parameters", case.model.coefficient, "--starts", 1, "--workers", 1, "--no-plots")
    case.command("fit", case.config, data, *options, "--out", case.folder / "fitted")


def _compare(case: Case) -> None:
    config = case.plain()
    del config["medium"]["scatter"]  # which the engine alone has
    file = case.file("without_scatter", yaml.safe_dump(config))
    options = ("--modes", 0, "--elements", 2, "--no-plots", "--out", case.folder / "compared")
    case.command("compare", file, *options)


def _compare_media(case: Case) -> None:
    medium = f"from: {case.plain()['medium']['from']}\n"
    media = ",".join(str(case.file(name, medium)) for name in ("one", "other"))
    case.command("compare-media", case.config, "--media", media, "--no-plots", "--out", case.folder / "media")


def _report(case: Case) -> None:
    case.command("report", case.run())


def _animate(case: Case) -> None:
    options = ("--animate", "--no-plots", "--quiet", "--out", case.folder / "film")
    case.command("run", case.config, *options)
    assert (case.folder / "film" / "animation.gif").is_file()


def _gym(case: Case) -> None:
    from granular_contact.gym import GranularEnv

    drive = f"drives={{{case.model.driven}: {{type: external, torque_Nm: 0, range: [-0.01, 0.01]}}}}"
    options = {"observation": ("depth_m",), "reward": lambda _before, after: after["depth_m"]}
    env = GranularEnv(load(case.config, [drive]).scenario, control_rate_Hz=1000, **options)
    env.reset(seed=0)
    _observation, reward, *_ = env.step(env.action_space.sample())
    assert reward > 0


def _simulation(case: Case) -> None:
    simulation = Simulation(load(case.config))
    kept = simulation.state()
    simulation.step(None, 1e-3)
    simulation.restore(kept)
    assert simulation.run().status.code == "end_time"


def _save_and_open(case: Case) -> None:
    results = simulate(load(case.config))
    reopened = Results.open(results.save(case.folder / "saved", figures=False))
    assert reopened.names == results.names
    reopened.figures()


def _check(case: Case) -> None:
    case.command("check", case.config)


def _schema(case: Case) -> None:
    assert set(case.plain()) <= keys_of_a_run()


@cache
def keys_of_a_run() -> set[str]:
    """The keys in the printed schema of a run."""
    from granular_contact.config import json_schema

    return set(json_schema("run")["properties"])


def _explain(case: Case) -> None:
    case.command("run", case.config, "--explain", "--no-plots", "--out", case.folder / "explained")


STUDIES: Mapping[str, Callable[[Case], None]] = {
    "run": _run,
    "sweep": _sweep,
    "ensemble": _ensemble,
    "optimise": _optimise,
    "fit": _fit,
    "compare": _compare,
    "compare-media": _compare_media,
    "report": _report,
    "animate": _animate,
    "gym": _gym,
    "Simulation": _simulation,
    "save, open": _save_and_open,
    "check": _check,
    "schema": _schema,
    "explain": _explain,
}

RIGID = "model.bodies: no link is flexible, so there is nothing to compare"
BENDS = {"flexible link", "free rod that bends", "flexible in space"}
# The refusals that are right, by the sentence without the place of its file.
REFUSALS: dict[tuple[str, str], str] = {
    **{("compare", model): RIGID for model in MODELS if model not in BENDS},
    ("compare", "free rod that bends"): (
        "method: the model has no rigid body, and it has no hinges, and a is a free joint between the ground and the "
        "root of the flexible rod: the reduced model is for one hinge on the ground, a rigid body on it (any welded "
        "parts), and at most one flexible link, welded to that body by its root, in one medium with a level surface"
    ),
    (
        "gym",
        "free rod that bends",
    ): "drives.a: a is a free joint, which can't be driven; allowed are hinges and sliders",
    ("gym", "wheel at a given slip"): (
        "drives.axle: stands beside wheel, which drives this joint; allowed is one of the two"
    ),
}


NOTES = (
    "`compare` holds reduced models against beams; rigid mechanisms have nothing to be reduced. `gym` moves a model",
    "by a drive `external` of a joint; here that is the hinge that each model has. In these runs media scatter",
    "(`ensemble` needs it), but for those of `compare`, since reduced models in the plane know no scatter.",
)


def page() -> str:
    """The page of the reference that shows the table."""
    sentences = list(dict.fromkeys(REFUSALS.values()))
    lines = [
        "# Studies and models",
        "",
        "Every study with every kind of model, as `tests/test_studies_and_models.py` runs them, on small models in",
        "sand: yes where it works, or the number of the sentence below with which it is refused.",
        "",
        f"| study | {' | '.join(MODELS)} |",
        f"| --- {'| --- ' * len(MODELS)}|",
    ]
    for study in STUDIES:
        cells = [REFUSALS.get((study, model)) for model in MODELS]
        shown = ["yes" if sentence is None else f"({sentences.index(sentence) + 1})" for sentence in cells]
        lines.append(f"| {study} | {' | '.join(shown)} |")
    lines += ["", *(f"{i}. `{sentence}`" for i, sentence in enumerate(sentences, 1)), "", *NOTES, ""]
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
