"""Bodies in space on given motions: loads, motions of rigid bodies, and what turns a scene."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from support_refusals import message_of

from granular_contact import Albert, Bar, Box, Cone, Drft, Hill, Layer, LeeMarghitu, Mesh, Poncelet, Rft, Rft3d, Sphere
from granular_contact import VerticalResistance as Vertical
from granular_contact.errors import SceneError
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.shapes import Shape

Array = NDArray[np.float64]
BODY = Body("body", [0, 1, 2, 3, 4, 5, 6])
FLAT = Body("flat", [0, 1, 2])
SAND = Rft3d(1600.0, 0.5, 0.3)
PLAY = LeeMarghitu(2500.0, 6.5, 8.0, Vertical(22.0, 1.1), Vertical(11.0, 1.4))
WAY = [[-0.06, 0.0, 0.01], [0.0, 0.01, 0.0], [0.05, -0.02, -0.02]]
# A medium of every kind, each with a body that it takes.
PAIRS: dict[str, tuple[Any, Shape]] = {
    "rft3d": (SAND, Box((0.1, 0.07, 0.05))),
    "drft": (Drft(density=1600.0, lam=1.1, zeta=0.3, surface_drop=2e-3), Cone(0.08, 0.06)),
    "rft": (Rft(zeta=0.3), Box((0.1, 0.07, 0.05))),
    "lee_marghitu": (PLAY, Bar(WAY, 0.008)),
    "albert": (Albert(1600.0, 8.0), Bar(WAY, 0.008)),
    "hill": (Hill(1600.0, Vertical(10.0, 1.4), Vertical(0.5, 1.7)), Bar(WAY, 0.008)),
    "ball": (Poncelet(3.0, 0.7), Sphere(0.08, 2.0)),
    "layers": ((Layer(SAND, 0.0, 0.03), Layer(Rft(zeta=0.3), 0.03)), Box((0.1, 0.07, 0.05))),
}


def load_on(medium: Any, shape: Shape, size: float | None = None, **options: Any) -> SpatialLoad:
    load = SpatialLoad(medium, options.pop("surface", 0.0), **options)
    load.add_shape(BODY, shape, facet_size=size, mass=1.0)
    return load


def quaternion(turn: Rotation) -> Array:
    """Euler parameters, the real one first."""
    return np.roll(turn.as_quat(), 1)


def state(place: Array, turn: Rotation, velocity: Array, spin: Array) -> tuple[Array, Array]:
    """Coordinates and rates (7,) of a body; spin (3,) rad/s in the world frame."""
    e = quaternion(turn)
    rate = 0.5 * np.array([-spin @ e[1:], *(e[0] * spin + np.cross(spin, e[1:]))])
    return np.concatenate([place, e]), np.concatenate([velocity, rate])


class Motion:
    """A rigid motion with time: place x(t) and turn exp(w t) R0, by smooth functions of t in [0, 1]."""

    def __init__(self, seed: int, depth: float = 0.02, closed: bool = False, way: float = 0.03) -> None:
        random = np.random.default_rng(seed)
        self.start, self.depth, self.closed = Rotation.from_quat(random.normal(size=4)), depth, closed
        self.ways = random.normal(size=(2, 6)) * way * np.array([1.0, 1.0, 0.6, 8.0, 8.0, 8.0])

    def at(self, t: float) -> tuple[Array, Rotation]:
        """Place (m) and turn at t."""
        s = np.array([np.sin(2 * np.pi * t), 1 - np.cos(2 * np.pi * t)]) if self.closed else np.array([t, t * t])
        moved = s @ self.ways
        return np.array([0.0, 0.0, -self.depth]) + moved[:3], Rotation.from_rotvec(moved[3:]) * self.start

    def state(self, t: float, around: Rotation | None = None) -> tuple[Array, Array]:
        """Coordinates and rates, of the whole scene turned if `around` is given; rates by differences."""
        d = 1e-5
        (x, turn), (x_before, turn_before), (x_after, turn_after) = self.at(t), self.at(t - d), self.at(t + d)
        velocity, spin = (x_after - x_before) / (2 * d), (turn_after * turn_before.inv()).as_rotvec() / (2 * d)
        if around is not None:
            x, velocity, spin, turn = around.apply(x), around.apply(velocity), around.apply(spin), around * turn
        return state(x, turn, velocity, spin)


def driven(load: SpatialLoad, motion: Motion, steps: int = 40, around: Rotation | None = None) -> SpatialLoad:
    """Drive a load through a motion of 1 s."""
    load.start(motion.state(0.0, around)[0])
    for i in range(steps + 1):
        load.accept(i / steps, *motion.state(i / steps, around))
        load.update_active(1.0 / steps)
    return load


def planar_state(t: float, spin: float) -> tuple[Array, Array]:
    """x, y, angle of a body that dives and turns, and its rates."""
    q = np.array([0.1 * t, -0.01 - 0.03 * t, 0.4 + spin * t])
    return q, np.array([0.1, -0.03, spin])


def extruded(q: Array, v: Array) -> tuple[Array, Array]:
    """The same in space, with z up: a turn from x to z is one about -y."""
    turn = Rotation.from_rotvec([0.0, -q[2], 0.0])
    return state(np.array([q[0], 0.0, q[1]]), turn, np.array([v[0], 0.0, v[1]]), np.array([0.0, -v[2], 0.0]))


def both(flat: GranularLoad, space: SpatialLoad, spin: float) -> tuple[Array, Array]:
    """Resultant and moment of a planar load and of the same in space, over 30 steps."""
    flat.start(planar_state(0.0, spin)[0])
    space.start(extruded(*planar_state(0.0, spin))[0])
    for i in range(31):
        at = planar_state(i / 30, spin)
        flat.accept(i / 30, *at)
        space.accept(i / 30, *extruded(*at))
        space.update_active(1 / 30)
    # Right-handed about y in space is from z to x, clockwise where x is to the right and z up.
    return flat.history.bodies[:, 0], space.history.bodies[:, 0][:, [0, 2, 4]] * [1.0, 1.0, -1.0]


message = partial(message_of, (SceneError, ValueError))


def prism(outline: Array, width: float) -> Mesh:
    """Closed mesh of a convex outline (n, 2) m in x and z, counter-clockwise seen from -y, and width along y."""
    n, half = len(outline), 0.5 * width
    low, high = (np.column_stack([outline[:, 0], np.full(n, y), outline[:, 1]]) for y in (-half, half))
    i, j = np.arange(n), np.roll(np.arange(n), -1)
    sides = np.concatenate([np.stack([i, j, n + j], 1), np.stack([i, n + j, n + i], 1)])
    k = np.arange(1, n - 1)
    ends = np.concatenate([np.stack([0 * k, k + 1, k], 1), n + np.stack([0 * k, k, k + 1], 1)])
    return Mesh(np.vstack([low, high]), np.vstack([sides[:, ::-1], ends[:, ::-1]]))
