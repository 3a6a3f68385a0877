"""Where one clamped-free mode is enough: rigid, one, two and five modes against the converged finite-element link.

    python validation/single_mode_vs_fe.py [--quick]

The cases vary the modulus, density and length of the paper's link, the impact speed and the impact angle. The modulus
scales axial and bending stiffness together. All models use the elastoplastic law, the same step and the same strips. A
case counts if two beams agree that have 16 and 32 elements, and steps in the ratio of two.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from validation.single_mode.cases import BEAMS, QUICK_BEAMS, Case, Point, design, frequencies, points
from validation.single_mode.figures import draw_collapse, draw_examples, draw_map
from validation.single_mode.numbers import CHOSEN, FASTEST, fit, misjudged
from validation.single_mode.tables import (
    axial_table,
    case_table,
    cause_table,
    collapse_table,
    count_table,
    limit_table,
    shape_table,
    worse,
)
from validation.study import Claim, Outcome, script

FIGURES = HERE / "figures"


def claims(points: Sequence[Point]) -> tuple[Claim, ...]:
    """Claims on the models with few modes, from the points of all cases."""
    every = [p for p in points if p.case.stiffness == p.case.density == p.case.length == 1.0]
    paper = [p for p in every if p.case.speed <= FASTEST]
    statements = []
    for model, name in (("one", "one mode"), ("rigid", "rigid")):
        worst = max(p.error(model, "travel") for p in every)
        statement = f"{name} within 1 % in travel for the paper's link"
        statements.append(_claim(statement, worst <= 0.01, _at_most(worst, every)))
        worst = max(p.error(model, "stopping time") for p in paper)
        statement = f"{name} within 1 % in stopping time for the paper's link up to {FASTEST:g} rad/s"
        statements.append(_claim(statement, worst <= 0.01, _at_most(worst, paper)))
    least = min(p.error("one", "deflection") for p in paper)
    detail = f"an error of at least {100 * least:.1f} % in {len(paper)} impacts"
    statements.append(
        _claim(
            "one mode misses the peak deflection of the paper's link by more than 5 % up to 11 rad/s",
            least > 0.05,
            detail,
        )
    )
    worst = max(p.error("two", "deflection") for p in paper)
    statements.append(
        _claim(
            "two modes within 5 % in peak deflection for the paper's link up to 11 rad/s",
            worst <= 0.05,
            _at_most(worst, paper),
        )
    )
    exact = frequencies(Case("EI"), 20)[0]
    one, two = (frequencies(Case("EI"), n)[0] / exact - 1.0 for n in (1, 2))
    detail = f"{100 * one:+.1f} % with one mode, {100 * two:+.2f} % with two"
    statements.append(_claim("the hinged frequency is more than 10 % too high with one clamped-free mode, within "
    "0.5 % with two",
                        one > 0.1 and two < 0.005, detail))  # fmt: skip
    f = fit(points, CHOSEN, "one", "travel")
    out, within, known = misjudged(points, CHOSEN, "one", "travel", 0.01)
    detail = f"R2 {f.r2:.2f} over {f.count} cases, {out + within} of {known} misjudged at N = {f.threshold(0.01):.2g}"
    statements.append(_claim(f"{CHOSEN} predicts where one mode is within 1 % in travel",
                        f.r2 >= 0.8 and out + within <= 0.1 * known, detail))  # fmt: skip
    agree = sum(p.doubt("travel") <= 2e-3 for p in points)
    detail = f"in {agree} of {len(points)} cases"
    statements.append(
        _claim("the two beams agree within 0.2 % in travel in four of five cases", agree >= 0.8 * len(points), detail)
    )
    return tuple(statements)


def _claim(statement: str, held: bool, detail: str) -> Claim:
    return Claim(f"single_mode_vs_fe.{statement}", bool(held), detail)


def _at_most(worst: float, cases: Sequence[Point]) -> str:
    return f"at most {100 * worst:.2g} % in {len(cases)} impacts"


def study(quick: bool) -> Outcome:
    """Run all cases; draw the figures unless quick."""
    cases = points(design(quick), QUICK_BEAMS if quick else BEAMS)
    parts = [
        "Cases within a limit, of those for which the two beams agree well enough to decide:",
        count_table(cases),
        "The paper's link by number of modes, in vacuum:",
        shape_table(),
        "Causes of the error of one mode, by peak deflection of the beam over length (cases: travel / stopping time):",
        cause_table(cases),
        worse(cases),
        "R2 of log error against log N:",
        collapse_table(cases),
        f"error = c N^p with N = {CHOSEN}:",
        limit_table(cases),
        "All cases, errors in per cent:",
        case_table(cases),
    ]
    if not quick:
        parts += [
            "Changes of the beam's results with the paper's axial stiffness (6.24 rad/s, 31 degrees):",
            axial_table(),
        ]
        FIGURES.mkdir(exist_ok=True)
        draw_map(cases, FIGURES / "single_mode_map.png")
        draw_examples(cases, FIGURES / "single_mode_examples.png")
        draw_collapse(cases, CHOSEN, FIGURES / "single_mode_collapse.png")
    return Outcome("\n\n".join(parts), claims(cases))


if __name__ == "__main__":
    sys.exit(script(study))
