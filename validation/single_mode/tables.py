"""Tables of the study `single_mode_vs_fe.py`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from validation.single_mode.cases import (
    BEAMS,
    BOTH,
    DIAMETER,
    EI,
    MEASURES,
    SPANS,
    Case,
    Point,
    frequencies,
    models,
    rows,
    shortfall,
)
from validation.single_mode.numbers import CHOSEN, NUMBERS, fit, judged, misjudged
from validation.tables import markdown


def percent(points: Point, model: str, measure: str) -> str:
    """Error in per cent, in brackets if the difference of the beams makes it uncertain; a dash if there is none."""
    error = points.error(model, measure)
    if math.isnan(error):
        return "-"
    text = f"{100 * error:.2g}"
    return text if points.known(model, measure) else f"({text})"


def case_table(points: Sequence[Point]) -> str:
    """Table of all cases with all errors."""
    head = ["family", "EI ratio", "rad/s", "deg", "density", "length", "w1 T", "deflection/L"]
    head += [f"{measure[:6]} {model}" for measure in MEASURES for model in ("rigid", "one", "two", "five")]
    rows = []
    for p in points:
        c, peak = p.case, NUMBERS["peak deflection of the beam / L"](p)
        start = [c.family, f"{c.stiffness:g}", c.speed, c.angle, c.density, c.length]
        start += [f"{p.first * p.rigid['T']:.3g}", f"{peak:.1e}"]
        rows.append([*start, *(percent(p, model, q) for q in MEASURES for model in ("rigid", "one", "two", "five"))])
    return markdown(head, rows)


def count_table(points: Sequence[Point]) -> str:
    """Table of the numbers of cases within 1 % and 5 %, by model."""
    head = ["model", *(f"{measure} within {limit} %" for measure in MEASURES for limit in (1, 5))]
    rows = []
    for model in ("rigid", "one", "two", "five"):
        cells = []
        for measure in MEASURES:
            known = judged(points, model, measure)
            for limit in (0.01, 0.05):
                held = sum(p.error(model, measure) <= limit for p in known)
                cells.append(f"{held} of {len(known)}" if known else "-")
        rows.append([model, *cells])
    return markdown(head, rows)


def cause(point: Point, measure: str = "travel") -> str:
    """Cause of an error of one mode above 1 %: too few modes, or geometry, which no number of such modes represents."""
    if not point.known("one", measure):
        return "in doubt"
    one, two, five = (point.error(model, measure) for model in ("one", "two", "five"))
    if one <= 0.01:
        return "within 1 %"
    if two <= 0.01 and five <= 0.01:
        return "second mode"
    if five <= 0.01:
        return "higher modes"
    return "geometry" if five > 0.5 * one else "modes and geometry"


CAUSES = ("within 1 %", "second mode", "higher modes", "modes and geometry", "geometry", "in doubt")


def cause_table(points: Sequence[Point]) -> str:
    """Table of the causes by deflection of the beam."""
    edges = [0.0, 1e-3, 1e-2, 3e-2, 1e-1, 3e-1, math.inf]
    name = "peak deflection of the beam / L"
    rows = []
    for low, high in pairwise(edges):
        inside = [p for p in points if low <= NUMBERS[name](p) < high]
        by_measure = [[cause(p, q) for p in inside] for q in ("travel", "stopping time")]
        cells = [" / ".join(str(causes.count(c)) for causes in by_measure) for c in CAUSES]
        rows.append([f"{low:g} to {high:g}", len(inside), *cells])
    return markdown(["deflection/L", "cases", *CAUSES], rows)


def shape_table() -> str:
    """Table of frequencies on the hinge and steady deflection by number of modes, for the paper's link."""
    exact = frequencies(Case("EI"), 20) / (2.0 * math.pi)
    rows = []
    for modes in (1, 2, 3, 5):
        hertz = frequencies(Case("EI"), modes) / (2.0 * math.pi)
        cells = [f"{f:.1f} ({100 * (f / e - 1):+.2f} %)" for f, e in zip(hertz[:2], exact[:2], strict=False)]
        second = cells[1] if modes > 1 else "-"
        rows.append([modes, cells[0], second, f"{100 * (shortfall(Case('EI'), modes) - 1):+.1f} %"])
    rows.append([20, *(f"{e:.1f}" for e in exact[:2]), "0"])
    head = [
        "clamped-free modes",
        "first frequency on the hinge Hz",
        "second",
        "tip deflection, decelerated by a tip force",
    ]
    return markdown(head, rows)


def axial_table() -> str:
    """Table of the beam with the paper's axial stiffness, compared with one that scales with the bending stiffness."""
    cases = [Case("EI, speed", 10.0**k) for k in (-4, -3, -2)]
    stiff = EI * 16.0 / DIAMETER**2
    asked = {}
    for i, case in enumerate(cases):
        overrides = models(0.0255, SPANS[1], {"fine": BEAMS["coarse"]})["fine"]
        asked[f"c{i}_soft"] = {**case.values, **overrides}
        asked[f"c{i}_stiff"] = {**asked[f"c{i}_soft"], "model.bodies.link.flexible.axial_stiffness_N": stiff}
    summaries = rows(asked)
    cells = []
    for i, case in enumerate(cases):
        scaled, fixed = (Point(case, {"fine": summaries[f"c{i}_{name}"]}) for name in ("soft", "stiff"))
        both = [(scaled.value("fine", q), fixed.value("fine", q)) for q in MEASURES]
        cells.append(
            [f"{case.stiffness:g}", *("-" if a is None or b is None else f"{100 * (b / a - 1):+.2f}" for a, b in both)]
        )
    return markdown(["EI ratio", *(f"{q} %" for q in MEASURES)], cells)


def worse(points: Sequence[Point]) -> str:
    """Sentence on the number of cases in which one mode has a larger error than the rigid link."""
    counts = []
    for measure in BOTH:
        known = [p for p in points if p.known("one", measure) and p.error("one", measure) > 1e-4]
        count = sum(p.error("one", measure) > p.error("rigid", measure) for p in known)
        counts.append(f"{measure}: {count} of {len(known)}")
    return f"One mode has a larger error than the rigid link (errors above 0.01 % only): {', '.join(counts)}."


def collapse_table(points: Sequence[Point]) -> str:
    """Table of R^2 by number and error."""
    pairs = [(model, measure) for model in ("rigid", "one", "two") for measure in BOTH]
    pairs += [("one", "deflection"), ("two", "deflection")]
    rows = [[number, *(f"{fit(points, number, *pair).r2:.2f}" for pair in pairs)] for number in NUMBERS]
    counts = ["cases fitted", *(fit(points, CHOSEN, *pair).count for pair in pairs)]
    return markdown(["N", *(f"{model}: {measure}" for model, measure in pairs)], [*rows, counts])


def limit_table(points: Sequence[Point]) -> str:
    """Table of the power law in the chosen number, its thresholds, and the cases that they misjudge."""
    head = [
        "model",
        "error in",
        "c",
        "p",
        "N at 1 %",
        "above the limit though N is below",
        "within the limit though N is above",
    ]
    head += [
        "smallest N with an error above 1 %",
        "N at 5 %",
        "above the limit though N is below",
        "within the limit though N is above",
        "cases judged",
    ]
    rows = []
    for model in ("rigid", "one", "two"):
        for measure in BOTH:
            f = fit(points, CHOSEN, model, measure)
            cells = [model, measure, f"{f.c:.2g}", f"{f.p:.2f}"]
            for limit in (0.01, 0.05):
                out, within, judged_cases = misjudged(points, CHOSEN, model, measure, limit)
                cells += [f"{f.threshold(limit):.2g}", str(out), str(within)]
                if limit == 0.01:
                    beyond = [p for p in judged(points, model, measure) if p.error(model, measure) > limit]
                    cells.append(f"{min(NUMBERS[CHOSEN](p) for p in beyond):.2g}")
            rows.append([*cells, judged_cases])
    return markdown(head, rows)
