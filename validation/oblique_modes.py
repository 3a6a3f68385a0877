"""How much of an oblique impact one bending mode a plane holds: the full motion in space, taken apart into modes.

    python validation/oblique_modes.py [--quick]

The source's link on its hub strikes play sand, on an axis that is inclined: at 0 deg it strikes as in the plane, at 60
deg it comes more from the side than from above, and bends about both of its axes. Rotation vectors between the 32
elements of the full model are curvatures kappa(s, t) about y and z and twist; they are put together from the curvatures
W_n'' of the modes of a cantilever,

    kappa(s, t) = sum_n a_n(t) W_n''(s),    a_n = int kappa W_n'' ds / int W_n''^2 ds,

which are orthogonal, so that the energy of bending is the sum of those of the modes. What the first mode of each plane
leaves is what no reduced model of one mode a plane can have: a bound. The models themselves, `oblique_model`, are
run and compared with the full model of as many elements.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "tests" / "space")]

from support_bending import into_space, pendulum

from granular_contact import load, simulate
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.run import run
from granular_contact.scene import build
from validation.oblique_model import ROOTS, Reduced, curvature
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
BENDING, ELEMENTS, DURATION = 15.1642, 32, 0.025  # N m2; s, as long as the source's link takes to stop
FEW, STEP = 8, 1e-4  # elements and step (s) of reduced models and what they are compared with
INCLINATIONS, FACTORS = (0.0, 30.0, 60.0), (1.0, 0.1, 0.01, 0.001)


def config(inclination: float, factor: float, elements: int) -> dict[str, Any]:
    """The strike, on an axis inclined by so many deg, with the stiffness multiplied."""
    given = into_space(pendulum(BENDING * factor, elements), 0.0)
    angle = np.radians(inclination)
    given["model"]["joints"]["pivot"]["axis"] = [0.0, float(np.cos(angle)), float(np.sin(angle))]
    given["solver"] = {"end_time_s": DURATION, "accuracy": 1e-3}
    return given


def struck(inclination: float, factor: float) -> tuple[Vector, Vector]:
    """Rotation vectors (n, joints, 3) rad along the link, from the impact on; deflection (n, 2) m of the tip."""
    kept: list[Any] = []

    def inspect(system: Any, trajectory: Any) -> None:
        beam = SpatialKinematics(system, trajectory).beams["link"]
        kept[:] = [beam.turned()[0], beam.deflection[0][:, 1:]]

    scenario = load(config(inclination, factor, ELEMENTS)).scenario
    run(build(scenario), scenario, inspect=inspect)
    return kept[0], kept[1]


def left(theta: Vector, modes: int) -> tuple[float, float]:
    """What so many modes of each plane leave: of the energy of bending over the run, of the tip's greatest deflection.

    theta (n, joints, 2): turns about y and z from each element to the next.
    """
    place = (np.arange(theta.shape[1]) + 0.5) / theta.shape[1]
    shapes = np.array([curvature(root, place) for root in ROOTS[:modes]])
    rest = theta - np.einsum("njk,mj,mi->nik", theta, np.linalg.pinv(shapes).T, shapes)
    whole, off = (np.linalg.norm(np.einsum("njk,j->nk", one, 1.0 - place), axis=1).max() for one in (theta, rest))
    return float(np.sum(rest**2) / np.sum(theta**2)), float(off / whole)


def modelled(inclination: float, factor: float, modes: int) -> float:
    """Error of the deflection of a model of so many modes a plane, of the greatest one; both of few elements."""
    given = load(config(inclination, factor, FEW))
    full, scene = simulate(given), build(given)
    t, bent = Reduced(scene, modes).run(DURATION, STEP)
    times = np.linspace(0.0, min(DURATION, full["time_s"][-1]), 400)
    whole, found = (
        np.array([np.interp(times, when, column) for column in columns])
        for when, columns in ((full["time_s"], [full[f"link_deflection_{x}_m"] for x in "yz"]), (t, bent[:, 1:].T))
    )
    return float(np.linalg.norm(found - whole, axis=0).max() / np.linalg.norm(whole, axis=0).max())


def _models(quick: bool) -> tuple[str, list[Claim]]:
    """Table and claims of the models."""
    cases = [(30.0, 0.1)] if quick else [(0.0, 0.1), (60.0, 0.1), *((30.0, factor) for factor in FACTORS)]
    rows, errors = [], []
    for inclination, factor in cases:
        errors.append([modelled(inclination, factor, modes) for modes in (1, 2)])
        rows.append([f"{inclination:g}", f"{factor:g}", *(f"{100 * one:.1f}" for one in errors[-1])])
    one, two = np.transpose(errors)
    claims = [
        Claim(
            "oblique_modes.a model of one mode a plane is off in the deflection",
            min(one) > 0.05,
            f"by {100 * min(one):.0f} to {100 * max(one):.0f} % (asked: above 5)",
        ),
        Claim(
            "oblique_modes.a model of two modes a plane holds it",
            max(two) < 0.05,
            f"{100 * min(two):.1f} to {100 * max(two):.1f} % off (asked: below 5)",
        ),
    ]
    header = ["inclined by, deg", "stiffness, times", "model of one mode a plane, %", "of two, %"]
    words = "Error of the deflection of reduced models, with a mode of torsion, of the greatest one."
    return f"{words}\n\n{markdown(header, rows)}", claims


def study(quick: bool) -> Outcome:
    """All inclinations and stiffnesses."""
    rows, one, two, twist = [], [], [], []
    for inclination in INCLINATIONS[::2] if quick else INCLINATIONS:
        for factor in FACTORS[::2] if quick else FACTORS:
            theta, bent = struck(inclination, factor)
            energy, tip = left(theta[:, :, 1:], 1)
            one.append(tip)
            two.append(left(theta[:, :, 1:], 2)[1])
            twist.append(float(np.sum(theta[:, :, 0] ** 2) / np.sum(theta**2)))
            most = (f"{1e3 * np.abs(bent[:, k]).max():.2f}" for k in (0, 1))
            parts = (f"{100 * part:.1f}" for part in (energy, tip, two[-1]))
            rows.append([f"{inclination:g}", f"{factor:g}", *most, *parts])
    header = ["inclined by, deg", "stiffness, times", "most along y, mm", "along z, mm"]
    header += ["one mode leaves of the energy, %", "of the deflection, %", "two modes, %"]
    ranges = [f"{100 * min(some):.1f} to {100 * max(some):.1f} %" for some in (one, two)]
    claims = (
        Claim(
            "oblique_modes.one mode a plane misses the deflection", min(one) > 0.05, f"by {ranges[0]} (asked: above 5)"
        ),
        Claim("oblique_modes.two modes a plane hold it", max(two) < 0.05, f"to {ranges[1]} (asked: below 5)"),
        Claim(
            "oblique_modes.there is no torsion", max(twist) < 1e-3, f"{max(twist):.1e} of turns squared (asked: 1e-3)"
        ),
    )
    models, of_models = _models(quick)
    return Outcome(f"{markdown(header, rows)}\n\n{models}", (*claims, *of_models))


if __name__ == "__main__":
    sys.exit(script(study))
