"""Random media, surfaces, bodies and motions for hypothesis, and short ways to ask the kernels about them.

A `State` is one run of stations in one medium at one instant. All laws of the schema are drawn with admissible
coefficients; runs are round bars, plates, outlines with straight or round sides and balls, whole or between two depths,
with and without end caps, in both forms, and the floor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from random import Random
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydantic import TypeAdapter
from support_parts import called

from granular_contact.config import schema
from granular_contact.laws.floor import Floor
from granular_contact.laws.law import Law
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.kernels import law, lines
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.probe import probe
from validation.fuzzing.media import FAMILIES, numbers

Array = NDArray[np.float64]
Record = NDArray[np.void]
G = 9.81
LEVEL = np.array([[0.0, 0.0]])
DEEPER = np.array([0.0, 1e-3])
CHECKED: TypeAdapter[Any] = TypeAdapter(schema.Medium)
TAKES = {"bar": ("round",), "plate": ("round", "flat", "outline"), "ball": ("ball",)}
KINDS = tuple((family, kind) for family, kinds in TAKES.items() for kind in kinds)


@dataclass(frozen=True)
class State:
    """P (n, 2) m, V (n, 2) m/s, anchors (n, 2) m; run and record as in `law`; static None for a floor."""

    medium: Law | None
    static: Elastoplastic | Smooth | None
    P: Array
    V: Array
    anchors: Array
    run: Record
    profile: Array
    record: Record
    kind: str

    def with_(self, **changes: Any) -> State:
        return replace(self, **changes)

    def forces(self) -> tuple[Array, Array]:
        """Forces at the stations (n, 2) and totals (terms, 3)."""
        F, totals = np.zeros_like(self.P), np.zeros((law.TERMS, 3))
        probe(self.P, self.V, self.anchors, self.run, self.profile, self.record, F, totals)
        return F, totals

    def scale(self) -> float:
        """Greatest force at a station (N), here or a millimetre deeper: round-off of depths is seen next to it."""
        return max(1e-12, *(float(np.abs(state.forces()[0]).max()) for state in (self, self.with_(P=self.P - DEEPER))))

    def accepted(self) -> State:
        """The state after its step was accepted: the anchors follow."""
        anchors = self.anchors.copy()
        called(lines.drag_anchors)(self.P, anchors, self.run[0], self.profile, medium_record(self.record)[0])
        return replace(self, anchors=anchors)

    def rested(self) -> State:
        """The same with every bristle at rest."""
        return replace(self, anchors=self.P.copy())


def medium(rng: Random, family: str) -> Law:
    """A law of a family, checked by the schema as one that was read."""
    name = rng.choice(FAMILIES[family])
    return CHECKED.validate_python({"law": name} | numbers(rng, name))


def _static(rng: Random, yields: tuple[float, float]) -> Elastoplastic | Smooth:
    if rng.random() < 0.3:
        return Smooth(10.0 ** rng.uniform(-3, 0))
    return Elastoplastic(math.exp(rng.uniform(*map(math.log, yields))), rng.choice((0.0, 1e-3, 0.01)))


def _profile(rng: Random) -> Array:
    if rng.random() < 0.5:
        return LEVEL
    x = np.sort([rng.uniform(-0.3, 0.3) for _ in range(rng.randint(2, 4))])
    corners = np.column_stack([x + 1e-3 * np.arange(len(x)), [rng.uniform(-0.05, 0.05) for _ in x]])
    aside = np.array([1.0, 0.0])  # as beds have it: level beyond the corners
    return np.vstack([corners[0] - aside, corners, corners[-1] + aside])


def _line(rng: Random, kind: str) -> Array:
    """Stations (n, 2) m about the origin: straight or bent bars and plates, closed outlines."""
    if kind == "ball":
        return np.zeros((2, 2))
    n = rng.randint(2, 6)
    if kind == "outline":
        corners = rng.randint(3, 6)
        angles = rng.uniform(0, 2 * math.pi) + 2 * math.pi * np.arange(corners + 1) / corners
        return rng.uniform(0.01, 0.1) * np.column_stack([np.cos(angles), np.sin(angles)])
    heading = rng.uniform(-math.pi, math.pi)
    bends = 0.0 if rng.random() < 0.5 else rng.uniform(-0.6, 0.6)
    pieces = rng.uniform(0.005, 0.08) * np.array(
        [[math.cos(heading + i * bends), math.sin(heading + i * bends)] for i in range(n - 1)]
    )
    line = np.vstack([np.zeros(2), np.cumsum(pieces, axis=0)])
    return line - line.mean(axis=0)


def run_record(rng: Random, kind: str, plain: bool = False) -> Record:
    run = np.zeros(1, law.LINE)
    run["width"] = rng.uniform(0.003, 0.05)
    if kind == "ball":
        run["drop"], run["mass"] = 0.5 * run["width"], rng.uniform(0.01, 1.0)
        return run
    if kind == "outline":
        run["side"] = rng.choice((-1, 1))
    if plain:
        return run
    run["cap"] = kind != "outline" and rng.random() < 0.3
    if rng.random() < 0.3:
        top = rng.choice((0.0, rng.uniform(0.0, 0.05)))
        run["layered"], run["top"], run["bottom"] = True, top, top + rng.choice((0.02, 0.1, math.inf))
    else:
        run["resultant"] = kind in ("round", "flat") and rng.random() < 0.2
    return run


def state(
    rng: Random, family: str, kind: str, yields: tuple[float, float] = (1e-5, 1e-2), plain: bool = False
) -> State:
    """A run that mostly lies around the surface or below it, turning and bending as it goes."""
    static, line = _static(rng, yields), _line(rng, kind)
    around = medium(rng, family)
    P = line + np.array([rng.uniform(-0.2, 0.2), rng.uniform(-0.15, 0.03)])
    speed, turn = 10.0 ** rng.uniform(-3, 1), rng.choice((0.0, rng.uniform(-30, 30)))
    heading = rng.uniform(-math.pi, math.pi)
    V = speed * np.array([math.cos(heading), math.sin(heading)]) + turn * np.column_stack([-line[:, 1], line[:, 0]])
    u_y = static.yield_displacement if isinstance(static, Elastoplastic) else 1e-3
    stretch = np.array([[rng.uniform(-1, 1), rng.uniform(-1, 1)] for _ in P])
    if kind == "ball":  # both of its stations are its centre
        stretch[1] = stretch[0]
    anchors = P - rng.choice((0.5, 1.5)) * u_y * stretch
    run = run_record(rng, kind, plain)
    if kind == "outline" and rng.random() < 0.5:  # chords of a circle, as the sides of a disc
        run["turn"] = 2 * math.pi / (len(P) - 1)
    return State(around, static, P, V, anchors, run, _profile(rng), around.record(static, G), kind)


def on_floor(rng: Random) -> State:
    """A bar or a ball around a floor."""
    kind = rng.choice(("round", "ball"))
    given = state(rng, "ball" if kind == "ball" else "bar", kind, plain=True)
    floor = Floor(rng.uniform(-0.1, 0.0), 10.0 ** rng.uniform(2, 8), rng.choice((0.0, rng.uniform(0, 1))))
    return given.with_(medium=None, static=None, record=floor.record(kind), profile=floor.profile)


# Numbers that hypothesis chooses, the odd ones among them (level, at rest, just touching), and makes simple where
# something fails; or such as come, away from all that.
ODD = st.randoms(use_true_random=False)
COMMON = st.integers(0, 2**32).map(Random)


def states(rngs: st.SearchStrategy[Random] = ODD, **more: Any) -> st.SearchStrategy[State]:
    """All laws on all kinds of runs."""
    return st.builds(lambda pair, rng: state(rng, *pair, **more), st.sampled_from(KINDS), rngs)


def floors(rngs: st.SearchStrategy[Random] = ODD) -> st.SearchStrategy[State]:
    return st.builds(on_floor, rngs)


def static_bound(given: State, lowest: float) -> float:
    """Most that the static force on the body can be (N) while it stays above `lowest` (m), all strips added.

    It grows with depth; the body is put to its deepest under a level surface as high as the highest point of the true
    one, and slides in 32 directions. Between two of them it can be larger by 1 / cos of half the angle; 1.1 covers that
    and the third powers in rft3d.
    """
    top = float(given.profile[:, 1].max())
    down = np.array([0.0, lowest - float(given.P[:, 1].min())])
    whole = given.run.copy()
    whole["layered"], whole["cap"], whole["resultant"] = False, False, False
    most = 0.0
    still = given.with_(P=given.P + down, V=np.zeros_like(given.V), run=whole, profile=np.array([[0.0, top]]))
    for i in range(len(given.P) - 1):
        strip = still.with_(P=still.P[i : i + 2], V=still.V[i : i + 2], anchors=still.anchors[i : i + 2])
        most += max(_slid(strip, angle) for angle in np.linspace(0, 2 * math.pi, 32, endpoint=False))
    return 1.1 * most


def _slid(strip: State, angle: float) -> float:
    assert isinstance(strip.static, Elastoplastic)
    stretch = 4.0 * strip.static.yield_displacement * np.array([math.cos(angle), math.sin(angle)])
    return float(np.linalg.norm(strip.with_(anchors=strip.P - stretch).forces()[0].sum(axis=0)))
