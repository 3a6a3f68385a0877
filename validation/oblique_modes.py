"""Share of an oblique impact that one bending mode a plane represents: modal decomposition of the full motion in space.

    python validation/oblique_modes.py [--quick]

The source's link on its hub strikes play sand while it rotates about an inclined axis. At 0 deg it strikes as in the
plane; at 60 deg it comes more from the side than from above, and bends about both of its axes. The rotation vectors
between the 32 elements of the full model give the curvatures kappa(s, t) about y and z, and the twist. The curvatures
are expanded in the curvatures W_n'' of the modes of a cantilever,

    kappa(s, t) = sum_n a_n(t) W_n''(s),    a_n = int kappa W_n'' ds / int W_n''^2 ds.

These are orthogonal, so that the bending energy is the sum of the energies of the modes. The part that the first mode
of each plane leaves out is a lower bound of the error of every reduced model with one mode a plane. The reduced models,
`method: {reduced: {modes: 1}}`, are also run and compared with the full model.
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
BENDING, ELEMENTS, DURATION = 15.1642, 32, 0.025  # N m2; number; s, time that the source's link takes to stop
MODES = 1, 2, 3  # modes a plane of the reduced models
ROOTS = 1.87510407, 4.69409113, 7.85475744, 10.99554073  # of the frequency equation of a cantilever
INCLINATIONS, FACTORS = (0.0, 30.0, 60.0), (1.0, 0.1, 0.01, 0.001)


def curvature(root: float, share: Vector) -> Vector:
    """Curvature W'' of a cantilever's mode, up to a factor, at positions from 0 (root) to 1 (tip)."""
    s, ratio = root * share, (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
    return np.asarray(np.cosh(s) + np.cos(s) - ratio * (np.sinh(s) + np.sin(s)))


def config(inclination: float, factor: float, elements: int) -> dict[str, Any]:
    """Config of the impact: inclination of the axis in deg, factor of the stiffness, number of elements."""
    given = into_space(pendulum(BENDING * factor, elements), 0.0)
    angle = np.radians(inclination)
    given["model"]["joints"]["pivot"]["axis"] = [0.0, float(np.cos(angle)), float(np.sin(angle))]
    given["solver"] = {"end_time_s": DURATION, "accuracy": 1e-3}
    return given


def struck(inclination: float, factor: float) -> tuple[Vector, Vector]:
    """Rotation vectors (n, joints, 3) rad between elements and deflections (n, 2) m of the tip, from the impact on."""
    motion: list[Any] = []

    def inspect(system: Any, trajectory: Any) -> None:
        beam = SpatialKinematics(system, trajectory).beams["link"]
        motion[:] = [beam.turned[0], beam.deflection[0][:, 1:]]

    scenario = load(config(inclination, factor, ELEMENTS)).scenario
    run(build(scenario), scenario, inspect=inspect)
    return motion[0], motion[1]


def left(theta: Vector, modes: int) -> tuple[float, float]:
    """Shares of the bending energy over the run and of the tip's greatest deflection that the first modes leave out.

    theta (n, joints, 2): rotations (rad) about y and z from each element to the next. modes: number in each plane.
    """
    place = (np.arange(theta.shape[1]) + 0.5) / theta.shape[1]
    shapes = np.array([curvature(root, place) for root in ROOTS[:modes]])
    rest = theta - np.einsum("njk,mj,mi->nik", theta, np.linalg.pinv(shapes).T, shapes)
    whole, error = (
        np.linalg.norm(np.einsum("njk,j->nk", angles, 1.0 - place), axis=1).max() for angles in (theta, rest)
    )
    return float(np.sum(rest**2) / np.sum(theta**2)), float(error / whole)


def modelled(inclination: float, factor: float, modes: Sequence[int]) -> list[tuple[float, float]]:
    """Errors of reduced models with these numbers of modes per plane: true and estimated in the run's warning.

    Both are errors of the tip's deflection relative to the greatest deflection; the estimate is 0 without a warning.
    """
    given = config(inclination, factor, ELEMENTS)
    full, errors = simulate(load(given)), []
    times = np.linspace(0.0, min(DURATION, full["time_s"][-1]), 400)
    whole = _deflection(full, times)
    most = float(np.linalg.norm(whole, axis=0).max())
    for count in modes:
        reduced = simulate(load(given | {"method": {"reduced": {"modes": count}}}))
        estimates = [text.split("be ")[1].split(" m")[0] for text in reduced.warnings if "too few modes" in text]
        error = float(np.linalg.norm(_deflection(reduced, times) - whole, axis=0).max()) / most
        errors.append((error, float(estimates[0]) / most if estimates else 0.0))
    return errors


def _deflection(run: Results, times: Vector) -> Vector:
    return np.array([np.interp(times, run["time_s"], run[f"link_deflection_{x}_m"]) for x in "yz"])


def _models(quick: bool) -> tuple[str, list[Claim]]:
    """Table and claims of the reduced models."""
    cases = [(30.0, 0.1)] if quick else [(x, y) for x in INCLINATIONS for y in FACTORS]
    rows, pairs = [], []
    for inclination, factor in cases:
        pairs.append(of_case := modelled(inclination, factor, MODES))
        row = [
            f"{100 * error:.1f}" + (f" ({100 * estimates:.1f})" if estimates else "") for error, estimates in of_case
        ]
        rows.append([f"{inclination:g}", f"{factor:g}", *row])
    errors, estimates = np.array(pairs).transpose(2, 1, 0)
    claims = []
    for name, of_count, holds in zip(
        ("one mode", "two modes", "three modes"), errors, (False, True, True), strict=True
    ):
        statement = f"oblique_modes.a model of {name} per plane " + (
            "represents the deflection" if holds else "misses the deflection"
        )
        required = f"required: {'below' if holds else 'above'} 5"
        good = of_count.max() < 0.05 if holds else of_count.min() > 0.05
        claims.append(
            Claim(statement, bool(good), f"by {100 * of_count.min():.1f} to {100 * of_count.max():.1f} % ({required})")
        )
    silent, ratio = errors[estimates == 0.0].max(), (estimates / errors)[estimates > 0.0]
    detail = (
        f"{100 * silent:.1f} % at most without a warning; {ratio.min():.2f} to {ratio.max():.2f} times the "
        "error is estimated"
    )
    good = silent < 0.05 and ratio.min() > 1.0 / 3.0 and ratio.max() < 3.0
    detail += " (required: 5 %; a third to three times)"
    claims.append(Claim("oblique_modes.the error of left-out modes is estimated", bool(good), detail))
    header = ["inclination, deg", "stiffness factor", *(f"modes per plane: {count}" for count in MODES)]
    caption = (
        "Error of the deflection of reduced models, in % of the largest deflection; in brackets the estimate "
        "that the run reports."
    )
    return f"{caption}\n\n{markdown(header, rows)}", claims


def study(quick: bool) -> Outcome:
    """Run all inclinations and stiffnesses."""
    rows, first, first_two, twist = [], [], [], []
    for inclination in INCLINATIONS[::2] if quick else INCLINATIONS:
        for factor in FACTORS[::2] if quick else FACTORS:
            theta, bent = struck(inclination, factor)
            energy, tip = left(theta[:, :, 1:], 1)
            first.append(tip)
            first_two.append(left(theta[:, :, 1:], 2)[1])
            twist.append(float(np.sum(theta[:, :, 0] ** 2) / np.sum(theta**2)))
            most = (f"{1e3 * np.abs(bent[:, k]).max():.2f}" for k in (0, 1))
            parts = (f"{100 * part:.1f}" for part in (energy, tip, first_two[-1]))
            rows.append([f"{inclination:g}", f"{factor:g}", *most, *parts])
    header = ["inclination, deg", "stiffness factor", "largest along y, mm", "along z, mm"]
    header += ["left by one mode: energy, %", "deflection, %", "left by two modes: deflection, %"]
    ranges = [f"{100 * min(shares):.1f} to {100 * max(shares):.1f} %" for shares in (first, first_two)]
    claims = (
        Claim(
            "oblique_modes.one mode per plane misses the deflection",
            min(first) > 0.05,
            f"by {ranges[0]} (required: above 5)",
        ),
        Claim(
            "oblique_modes.two modes per plane represent the deflection",
            max(first_two) < 0.05,
            f"to {ranges[1]} (required: below 5)",
        ),
        Claim(
            "oblique_modes.there is no torsion",
            max(twist) < 1e-3,
            f"{max(twist):.1e} of the squared rotations (required: 1e-3)",
        ),
    )
    models, of_models = _models(quick)
    return Outcome(f"{markdown(header, rows)}\n\n{models}", (*claims, *of_models))


if __name__ == "__main__":
    sys.exit(script(study))
