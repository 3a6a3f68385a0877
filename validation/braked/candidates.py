"""Candidate effects that 3D-RFT on a level surface lacks; docs/studies/braked_wheel.md has their equations.

A candidate is a set of effects with a strength from 0 (the level surface) to 1. Its parameters are those of the sand
(density and friction angle) and at most one number from a plate; choices without a source are marked [ours].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from validation.braked.wheel import SAND, Rim, balance, rim, stress
from validation.measurements.cmu import Rolling, table

Vector = NDArray[np.float64]

TRAVEL = (
    0.5  # m, least travel from touch to the mean of the measurement (raw files of the data), which gathers the heap
)
EXPONENT = 1.4  # power of pressure over depth: middle of the range 1.25 to 1.55 [ours]
COHESION = 1000.0  # Pa, set by hand by the authors of the data for their runs of wheels
PLATE = 0.06  # m, diameter of the plate that gives the one number
AHEAD, BASE = stress(np.array([[1.0, 0.0], [0.0, -1.0]]), np.array([[1.0, 0.0], [1.0, 0.0]]))  # dragged along x


@dataclass(frozen=True)
class Effects:
    """Effects of a candidate.

    floor: depth of the rut at the wheel's lowest point over the sinkage; by_slip: multiply the floor by |slip|; heap:
    "", "plane" (all sand swept over TRAVEL) or "sides" (limited by the flow to the sides); tilted: the surface falls
    from the heap to the floor, otherwise the heap raises the whole surface; wedge: "", "rft", "plane", "crescents" or
    "godwin"; cohesion: Pa; growth: of pressure, "", "depth" or "size"; sides: earth pressure on both sides, "", "rest"
    or "passive"; slip_sinkage: Lyasko's factor instead of a balance of forces; strength: 0 to 1.
    """

    floor: float = 0.0
    by_slip: bool = False
    heap: str = ""
    tilted: bool = True
    wedge: str = ""
    cohesion: float = 0.0
    growth: str = ""
    sides: str = ""
    slip_sinkage: bool = False
    strength: float = 1.0


CANDIDATES = {
    "A1 rut to the wheel's bottom": Effects(floor=1.0),
    "A2 rut half filled": Effects(floor=0.5),
    "A3 rut by slip": Effects(floor=1.0, by_slip=True),
    "A4 heap before, level": Effects(heap="sides", tilted=False),
    "B1 swept heap, plane": Effects(heap="plane"),
    "B2 swept heap, flow to the sides": Effects(heap="sides"),
    "B3 swept heap and rut by slip": Effects(heap="sides", floor=1.0, by_slip=True),
    "C1 wedge, 3D-RFT on its front": Effects(wedge="rft"),
    "C2 wedge, passive pressure, plane": Effects(wedge="plane"),
    "C3 wedge, passive pressure, crescents": Effects(wedge="crescents"),
    "C4 C3 and the heap B2": Effects(wedge="crescents", heap="sides"),
    "C5 C3 and cohesion 1 kPa (not allowed)": Effects(wedge="crescents", cohesion=COHESION),
    "C6 wedge, passive pressure, crescents of Godwin and Spoor": Effects(wedge="godwin"),
    "D1 slip sinkage": Effects(slip_sinkage=True),
    "E1 growth with depth": Effects(growth="depth"),
    "E2 growth with depth and size": Effects(growth="size"),
    "F1 friction of the sides, pressure at rest": Effects(sides="rest"),
    "F2 friction of the sides, passive pressure": Effects(sides="passive"),
    "G1 E1 and A3": Effects(growth="depth", floor=1.0, by_slip=True),
    "G2 E1 and B2": Effects(growth="depth", heap="sides"),
    "G3 E1 and C1": Effects(growth="depth", wedge="rft"),
    "G4 E1 and C3": Effects(growth="depth", wedge="crescents"),
    "G5 E1 and C4": Effects(growth="depth", wedge="crescents", heap="sides"),
    "G6 E2 and C1": Effects(growth="size", wedge="rft"),
    "G7 E2 and C3": Effects(growth="size", wedge="crescents"),
    "G8 E1 and D1": Effects(growth="depth", slip_sinkage=True),
    "G9 E2 and D1": Effects(growth="size", slip_sinkage=True),
    "G10 E1, A3 and F2": Effects(growth="depth", floor=1.0, by_slip=True, sides="passive"),
    "G11 E1, C1, B2 and F2": Effects(growth="depth", wedge="rft", heap="sides", sides="passive"),
}


def passive(width: float, depth: float, kind: str, cohesion: float = 0.0) -> float:
    """Passive force (N) on an upright face of a width and depth (m), pushed ahead, with friction of sand on sand.

    N_gamma and N_c are those of a plane wedge (McKyes) with the failure plane of least force. Failure at both sides is
    included by `kind`: "crescents" multiplies the force of weight by 1 + 2 r / (3 b) and that of cohesion by 1 + r / b
    before the minimum (McKyes and Ali); "godwin" multiplies the least force by 1 + (d / b) (m - (m - 1) / 3), m = r / d
    (Godwin and Spoor).
    """
    if depth <= 0.0:
        return 0.0
    phi = float(np.arctan(SAND.mu))
    beta = np.radians(np.linspace(5.0, 85.0, 161))
    cot, cut = 1.0 / np.tan(beta), 1.0 / np.tan(beta + phi)
    below = -np.sin(phi) + np.cos(phi) * cut  # cos(rho + delta) + sin(rho + delta) cot(beta + phi), rho = 90 degrees
    reach = depth * cot if kind == "crescents" else 0.0 * cot
    of_weight = 0.5 * SAND.weight * depth**2 * cot * (1.0 + 2.0 * reach / (3.0 * width))
    of_cohesion = cohesion * depth * (1.0 + cot * cut) * (1.0 + reach / width)
    able = below > 1e-3
    forces = (of_weight + of_cohesion)[able] / below[able]
    least = int(np.argmin(forces))
    m = cot[able][least]
    share = 1.0 + depth / width * (m - (m - 1.0) / 3.0) if kind == "godwin" else 1.0
    return float(width * forces[least] * share)


@cache
def length_of(growth: str) -> float:
    """Length z0 or D0 (m) of a growth, fitted by least squares to the logarithm of the pressures under PLATE."""
    rows = table("plates_large_box")
    rows = rows[rows["diameter_mm"] == 1e3 * PLATE]
    z = 1e-3 * rows["depth_mm"]
    level = stress(np.array([[0.0, -1.0]]), np.array([[0.0, -1.0]]))[0, 1] * z
    mean = float(np.mean(np.log(1e3 * rows["pressure_kPa"] / level)))
    power = EXPONENT - 1.0
    if growth == "depth":  # ln p - ln level = power (ln z - ln z0)
        return float(np.exp(np.mean(np.log(z)) - mean / power))
    return float(np.exp(np.log(PLATE) + power * np.mean(np.log(z / PLATE)) - mean))


def size_of(area: float) -> float:
    """Diameter (m) of the round plate with an area (m2)."""
    return float(np.sqrt(4.0 * area / np.pi))


def grown(effects: Effects, depth: Vector, size: float) -> Vector:
    """Effective depth g (n,) m: the depth (n,) m, or a function of it with growth; size: D of the contact, m."""
    z = np.maximum(depth, 0.0)
    if not effects.growth:
        return z
    power, length = (EXPONENT - 1.0) * effects.strength, length_of(effects.growth)
    if effects.growth == "depth":
        return z * (z / length) ** power
    return z * (size / length) ** effects.strength * (z / size) ** power


def side_pressure(effects: Effects) -> float:
    """Friction stress on the sides over the depth (Pa/m)."""
    sine = SAND.mu / np.hypot(1.0, SAND.mu)
    ratio = 1.0 - sine if effects.sides == "rest" else (1.0 + sine) / (1.0 - sine)
    return float(effects.strength * SAND.mu * ratio * SAND.weight)


@dataclass(frozen=True)
class Model:
    """A candidate for one wheel at one slip."""

    effects: Effects
    rim: Rim
    slip: float

    @property
    def swept(self) -> float:
        """Share chi of its travel that the lowest point slides forward: 1 for a locked wheel, 0 for rolling."""
        return max(0.0, 1.0 - self.rim.ratio) * self.effects.strength

    def heap(self, sinkage: float) -> float:
        """Height (m) of the heap in front of the wheel."""
        phi, chi = SAND.mu, self.swept
        if self.effects.heap == "plane":
            return float(np.sqrt(2.0 * phi * chi * max(0.0, sinkage) * TRAVEL))
        return chi * phi * self.rim.width / 4.0 if self.effects.heap == "sides" else 0.0

    def grown(self, depth: Vector, sinkage: float) -> Vector:
        """Effective depth g (n,) m of points of the rim; the size of the contact is that of the rim's front."""
        return grown(self.effects, depth, size_of(self.rim.width * max(1e-4, self.rim.front(sinkage))))

    def on_rim(self, sinkage: float) -> Vector:
        """Force (Fx, Fz) N on the rim below the candidate's surface."""
        effects = self.effects
        high = self.heap(sinkage)
        floor = effects.strength * effects.floor * sinkage * (abs(self.slip) if effects.by_slip else 1.0)
        front = self.rim.front(sinkage + high)

        def effective(x: Vector, z: Vector) -> Vector:
            low = -floor if effects.tilted else high
            surface = low + (high - low) * np.minimum(1.0, x / max(front, 1e-9))
            return self.grown(surface - z, sinkage)

        force = self.rim.force(sinkage, effective)
        if effects.sides:
            force = force + side_pressure(effects) * self.rim.sides(sinkage)
        return force

    def on_wedge(self, sinkage: float) -> Vector:
        """Force (Fx, Fz) N on a wedge that fills the space in front of the rim to its lowest point, and on its base."""
        effects, width, high = self.effects, self.rim.width, self.heap(sinkage)
        length, depth = self.rim.front(sinkage), sinkage + high
        if effects.wedge == "rft":
            z = np.linspace(0.0, depth, 41)
            g = np.trapezoid(self.grown(z, sinkage), z)
            face = width * g * AHEAD
        else:
            phi = np.arctan(SAND.mu)
            force = passive(width, depth, effects.wedge, effects.cohesion)
            face = force * np.array([-np.cos(phi), np.sin(phi)])
        g = float(self.grown(np.array([depth]), sinkage)[0])
        base = width * length * g * BASE
        return face + base - np.array([0.0, SAND.weight * width * self.area(sinkage, length)])

    def area(self, sinkage: float, length: float) -> float:
        """Area (m2) of the wedge's section, between the rim, its front contact and its lowest point."""
        radius = self.rim.radius
        angle = float(np.arccos(max(-1.0, 1.0 - sinkage / radius)))
        under = radius * length - 0.5 * (radius**2 * angle + length * (radius - sinkage))  # below the rim, from bottom
        return max(0.0, under)

    def force(self, sinkage: float) -> Vector:
        """Force (Fx, Fz) N on the wheel; a share chi of the contact is that of the wedge [ours]."""
        if not self.effects.wedge:
            return self.on_rim(sinkage)
        chi = self.swept
        return (1.0 - chi) * self.on_rim(sinkage) + (chi * self.on_wedge(sinkage) if chi > 0.0 else 0.0)


def solve(effects: Effects, measured: Rolling, bound: tuple[float, float]) -> tuple[float, float]:
    """Sinkage (m) and Fx (N) of a wheel (radius, width) at a measured slip and load."""
    model = Model(effects, rim(*bound, measured.rim / measured.forward), measured.slip)
    if not effects.slip_sinkage:
        return balance(model.force, measured.load)
    rolling = Model(effects, rim(*bound, 1.0), 0.0)
    at_rest, _ = balance(rolling.force, measured.load)
    by_balance, _ = balance(model.force, measured.load)
    i = min(1.0, abs(measured.slip))
    lyasko = at_rest * (1.0 + i) / (1.0 - 0.5 * i)
    sinkage = by_balance + effects.strength * (lyasko - by_balance)
    force = model.force(sinkage)
    return sinkage, float(force[0] * measured.load / force[1])
