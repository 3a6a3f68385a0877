"""Every law with sample coefficients, short ways to call its kernels, and the published formulas once more in NumPy."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray
from support_parts import called

from granular_contact.laws.albert import Albert
from granular_contact.laws.allen import Allen
from granular_contact.laws.bingham import Bingham
from granular_contact.laws.drft import Drft
from granular_contact.laws.hill import Hill
from granular_contact.laws.katsuragi_durian import KatsuragiDurian
from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.laws.linear_depth import LinearDepth
from granular_contact.laws.poncelet import Poncelet
from granular_contact.laws.pressure_sinkage import PressureSinkage
from granular_contact.laws.reece import Reece
from granular_contact.laws.rft import Rft, RftCoefficients
from granular_contact.laws.rft3d import Rft3d
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.laws.tsimring_volfson import TsimringVolfson
from granular_contact.sand.kernels import kinematics, law, spatial, strip
from granular_contact.sand.kernels.forces import medium_record

Array = NDArray[np.float64]

G = 9.81
MASS, DIAMETER = 0.0667, 0.0254  # of the balls here
# On a bristle that is not stretched s = v / (1e-12 m/s): exactly the sign of anything faster, and its closed forms.
TRUE_SIGN = Elastoplastic(1e-12, 1.0)

GENERIC = RftCoefficients(0.206, 0.169, 0.212, 0.358, 0.055, -0.124, 0.253, 0.007, 0.088)
LOOSE = RftCoefficients(0.051, 0.047, 0.053, 0.083, 0.020, -0.026, 0.057, 0.000, 0.025)
CLOSE = RftCoefficients(0.094, 0.092, 0.092, 0.151, 0.035, -0.039, 0.086, 0.018, 0.046)
SAND = Rft3d(1617.0, 1.07, 0.1806)
# So rough that the friction of the surface never limits: S / xi_n is then alpha, but for what would drive.
ROUGH = Rft3d(1617.0, 1.07, 1e9)

BEKKER = PressureSinkage(9e5, 1.3, 29.0, k_c=2e3, cohesion=300.0, shear_deformation_modulus=0.02)
REECE = Reece(1330.0, 20.0, 1.2, 29.0, k_c_prime=3.0, cohesion=300.0)
SURFACE_LAWS = (Rft(GENERIC, 0.3), Rft(LOOSE), Rft(CLOSE), Drft(LOOSE, 1500.0, 1.1), SAND, ROUGH, BEKKER, REECE)
BAR_LAWS = (
    LeeMarghitu(2500.0, 6.5, 8.0, VerticalResistance(22.0, 1.1), VerticalResistance(3.0, 1.7)),
    Albert(2500.0, 8.0),
    Hill(2500.0, VerticalResistance(10.0, 1.4), VerticalResistance(0.5, 1.7)),
    Hill(2500.0, VerticalResistance(10.0, 1.4), VerticalResistance(0.5, 1.7), length_scale=0.02),
)
LEE_MARGHITU, ALBERT, HILL, HILL_SCALED = BAR_LAWS
SCALAR_LAWS = (
    Bingham(3.0, 2.0),
    Poncelet(3.0, 0.7),
    Allen(0.7, 2.0, 3.0),
    LinearDepth(90.0),
    TsimringVolfson(0.7, 400.0, 1.6),
    KatsuragiDurian(90.0, drag_length_per_diameter=3.4),
    KatsuragiDurian(90.0, drag_length=0.09),
)
ALL_LAWS = SURFACE_LAWS + BAR_LAWS + SCALAR_LAWS


def label(medium: object) -> str:
    return str(medium.name)


NO_STRETCH = np.zeros((2, 2))


@dataclass(frozen=True)
class Strip:
    """Ends P (2, 2) m, their velocities V (2, 2) m/s, stretch e (2, 2) m of their bristles; surface at y = 0."""

    P: Array
    V: Array
    width: float = 0.01
    side: int = 0
    e: Array = field(default_factory=NO_STRETCH.copy)
    turn: float = 0.0


def run_record(width: float, side: int = 0, mass: float = 0.0, turn: float = 0.0) -> NDArray[np.void]:
    run = np.zeros(1, law.LINE)
    run["width"], run["side"], run["mass"], run["turn"] = width, side, mass, turn
    for name in ("ahead0", "ahead1", "back0", "back1"):
        run[name] = np.inf  # the medium is sheared as far as it can be
    return run


@njit(cache=True)
def _strip(a, b, z0, z1, c, V, e, run, m, f):
    v0, v1, e0, e1 = (V[0, 0], V[0, 1]), (V[1, 0], V[1, 1]), (e[0, 0], e[0, 1]), (e[1, 0], e[1, 1])
    law.strip_force(strip.Strip(a, b, z0, z1, (c[0], c[1]), v0, v1, e0, e1), run[0], m[0], f)


@njit(cache=True)
def _ball(z, v, e, run, m, f):
    law.ball_force(z, (v[0], v[1]), (e[0], e[1]), run[0], m[0], f)


@njit(cache=True)
def _drag(p, a, m):
    return law.drag_anchor((p[0], p[1]), (a[0], a[1]), m[0])


def stations(q: Array, v: Array, geometry: NDArray[np.void], P: Array, V: Array) -> None:
    """Fill positions and velocities of the stations of a body of any kind."""
    of_spatial = geometry["kind"][0] == kinematics.SPATIAL
    called(spatial.spatial_stations if of_spatial else kinematics.stations)(q, v, geometry, P, V)


def below(z0: float, z1: float) -> tuple[float, float]:
    """Part of a strip with these end depths that lies in the medium; (0, 0) where none does."""
    if max(z0, z1) <= 0.0:
        return 0.0, 0.0
    crossing = z0 / (z0 - z1) if z0 * z1 < 0.0 else 0.0
    return (crossing if z0 < 0.0 else 0.0), (crossing if z1 < 0.0 else 1.0)


def strip_force(s: Strip, record: NDArray[np.void]) -> Array:
    """End forces f[term, end, xy] of a strip."""
    z0, z1 = -s.P[:, 1]
    f = np.zeros((law.TERMS, 2, 2))
    run = run_record(s.width, s.side, turn=s.turn)
    _strip(*below(z0, z1), z0, z1, s.P[1] - s.P[0], s.V, s.e, run, medium_record(record), f)
    return f


def ball_force(z: float, v: Array, e: Array, record: NDArray[np.void]) -> Array:
    """Forces f[term, xy] on a ball."""
    f = np.zeros((law.TERMS, 2))
    _ball(z, v, e, run_record(DIAMETER, mass=MASS), medium_record(record), f)
    return f


def dragged(p: Array, anchor: Array, record: NDArray[np.void]) -> Array:
    return np.array(_drag(p, anchor, medium_record(record)))


def element(beta: float, gamma: float, depth: float = 1.0, speed: float = 1.0, side: int = 0) -> Strip:
    """Square metre of a plate at beta (deg), its middle at a depth, that moves at gamma (deg) below the horizontal."""
    b, g = np.radians([beta, gamma])
    t, v = np.array([np.cos(b), np.sin(b)]), speed * np.array([np.cos(g), -np.sin(g)])
    P = np.array([-0.5 * t, 0.5 * t]) - [0.0, depth]
    return Strip(P, np.array([v, v]), 1.0, side)


def published_rft(c: RftCoefficients, beta: float, gamma: float) -> tuple[float, float]:
    """alpha_x, alpha_z (N/cm3) as printed; angles in degrees."""
    b, g = np.radians([beta, gamma])
    alpha_z = c.A00 + c.A10 * np.cos(2 * b) + c.B11 * np.sin(2 * b + g) + c.B01 * np.sin(g)
    alpha_z += c.B_11 * np.sin(-2 * b + g)
    alpha_x = c.C11 * np.cos(2 * b + g) + c.C01 * np.cos(g) + c.C_11 * np.cos(-2 * b + g) + c.D10 * np.sin(2 * b)
    return alpha_x, alpha_z


SOFT = Elastoplastic(0.02, 0.01)
