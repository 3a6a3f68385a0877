"""How much of an oblique impact one bending mode a plane holds: the full motion in space, taken apart into modes.

    python validation/oblique_modes.py [--quick]

The source's link on its hub strikes play sand, on an axis that is inclined: at 0 deg it strikes as in the plane, at 60
deg it comes more from the side than from above, and bends about both of its axes. Rotation vectors between the 32
elements of the full model are curvatures kappa(s, t) about y and z and twist; they are put together from the curvatures
W_n'' of the modes of a cantilever,

    kappa(s, t) = sum_n a_n(t) W_n''(s),    a_n = int kappa W_n'' ds / int W_n''^2 ds,

which are orthogonal, so that the energy of bending is the sum of those of the modes. What the first mode of each plane
leaves is what no reduced model of one mode a plane can have: a bound. The models themselves, `method: {reduced:
{modes: 1}}`, are run and compared with the full model.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "tests" / "space")]

from support_bending import into_space, pendulum

from granular_contact import Results, load, simulate
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.run import run
from granular_contact.scene import build
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
BENDING, ELEMENTS, DURATION = 15.1642, 32, 0.025  # N m2; s, as long as the source's link takes to stop
MODES = 1, 2, 3  # of reduced models, a plane
ROOTS = 1.87510407, 4.69409113, 7.85475744, 10.99554073  # of a cantilever's modes
INCLINATIONS, FACTORS = (0.0, 30.0, 60.0), (1.0, 0.1, 0.01, 0.001)


def curvature(root: float, share: Vector) -> Vector:
    """W'' of a cantilever's mode, but for its scale, at places from 0 at the root to 1 at the tip."""
    s, ratio = root * share, (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
    return np.asarray(np.cosh(s) + np.cos(s) - ratio * (np.sinh(s) + np.sin(s)))


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


def modelled(inclination: float, factor: float, modes: Sequence[int]) -> list[tuple[float, float]]:
    """Of models of so many modes a plane: error of the deflection, of the greatest one, and the error that is told."""
    given = config(inclination, factor, ELEMENTS)
    full, found = simulate(load(given)), []
    times = np.linspace(0.0, min(DURATION, full["time_s"][-1]), 400)
    whole = _deflection(full, times)
    most = float(np.linalg.norm(whole, axis=0).max())
    for count in modes:
        one = simulate(load(given | {"method": {"reduced": {"modes": count}}}))
        told = [words.split("be ")[1].split(" m")[0] for words in one.warnings if "too few modes" in words]
        error = float(np.linalg.norm(_deflection(one, times) - whole, axis=0).max()) / most
        found.append((error, float(told[0]) / most if told else 0.0))
    return found


def _deflection(run: Results, times: Vector) -> Vector:
    return np.array([np.interp(times, run["time_s"], run[f"link_deflection_{x}_m"]) for x in "yz"])


def _models(quick: bool) -> tuple[str, list[Claim]]:
    """Table and claims of the models."""
    cases = [(30.0, 0.1)] if quick else [(x, y) for x in INCLINATIONS for y in FACTORS]
    rows, all_of = [], []
    for inclination, factor in cases:
        all_of.append(found := modelled(inclination, factor, MODES))
        row = [f"{100 * error:.1f}" + (f" ({100 * told:.1f})" if told else "") for error, told in found]
        rows.append([f"{inclination:g}", f"{factor:g}", *row])
    errors, told = np.array(all_of).transpose(2, 1, 0)
    claims = []
    for name, few, holds in zip(("one mode", "two modes", "three modes"), errors, (False, True, True), strict=True):
        words = f"oblique_modes.a model of {name} a plane " + ("holds it" if holds else "is off in the deflection")
        asked = f"asked: {'below' if holds else 'above'} 5"
        good = few.max() < 0.05 if holds else few.min() > 0.05
        claims.append(Claim(words, bool(good), f"by {100 * few.min():.1f} to {100 * few.max():.1f} % ({asked})"))
    silent, said = errors[told == 0.0].max(), (told / errors)[told > 0.0]
    words = f"{100 * silent:.1f} % at most without a word; {said.min():.2f} to {said.max():.2f} of the error is told"
    good = silent < 0.05 and said.min() > 1.0 / 3.0 and said.max() < 3.0
    words += " (asked: 5 %, a third to three times)"
    claims.append(Claim("oblique_modes.what modes leave out is told", bool(good), words))
    header = ["inclined by, deg", "stiffness, times", *(f"modes a plane: {count}" for count in MODES)]
    words = (
        "Error of the deflection of reduced models, of the greatest one, in %; in brackets what the run tells of it."
    )
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
