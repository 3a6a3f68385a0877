"""Reduced model of a pendulum in space: a link clamped to a hub on a hinge, in modes of two planes and of torsion.

The axis of the link floats with the hub. Rotation vectors between its elements, see `scene.space.beams`, are

    theta_k(t) = sum_i S_ki a_i(t),    S_ki ~ W_i''(s_k) about y or z, cos(pi s_k / 2 L) of torsion about x,

with the curvatures W'' of a cantilever's modes: the full model, restricted to so many shapes of it (Galerkin's method).
Finite turns and the shortening of a bent axis stay in it, unlike in `engines.modal`. With the rates J(q) v of all
bodies, q the angle of the hinge and the a_i,

    J^T M J v' = J^T (F - M J' v - w x I w) - K a - D a',    K, D = sum_k S^T (K_k, D_k) S,

F gravity and the sand's force on each element, as in production. By the implicit rule of midpoints; sand is accepted at
the end of each step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry import rotations
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space.of_scene import add_part, load_of
from granular_contact.scene.space.types import SpatialScene

Vector = NDArray[np.float64]
ROOTS = (1.87510407, 4.69409113, 7.85475744, 10.99554073)
NEAR, MOST = 1e-9, 25  # of rates, at which iterations end; iterations
AHEAD = 1e-7  # s, by which J' v is found


def curvature(root: float, share: Vector) -> Vector:
    """W'' of a cantilever's mode, but for its scale, at places from 0 at the root to 1 at the tip."""
    s, ratio = root * share, (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
    return np.asarray(np.cosh(s) + np.cos(s) - ratio * (np.sinh(s) + np.sin(s)))


class Reduced:
    """A model of so many modes in each plane and in torsion; q (n,): angle (rad) from the start, amplitudes."""

    def __init__(self, scene: SpatialScene, modes: int, torsion: int = 1) -> None:
        self.scene, (beam,) = scene, scene.beams
        self.bodies = [scene.body(name) for name, *_ in beam.pieces if name is not None]
        self.joints, self.beam = [scene.joint(name) for name in beam.joints], beam
        (self.hinge,) = (joint for joint in scene.joints if joint.kind == "hinge")
        place = (np.arange(len(self.joints)) + 0.5) / len(self.joints)
        shapes = [(axis, curvature(root, place)) for axis in (1, 2) for root in ROOTS[:modes]]
        shapes += [(0, np.cos((i + 0.5) * np.pi * place)) for i in range(torsion)]
        self.S = np.zeros((len(self.joints), 3, 1 + len(shapes)))
        for i, (axis, shape) in enumerate(shapes):
            self.S[:, axis, 1 + i] = shape
        laws: list[Any] = [joint.elastic for joint in self.joints]
        self.K, self.D = (
            np.einsum("kai,ka,kaj->ij", self.S, np.array(values), self.S)
            for values in ([law.stiffness for law in laws], [law.damping for law in laws])
        )
        hub = self.bodies[0].motion
        self.axis = hub.rotation @ self.hinge.child_turn[:, 2]
        self.pivot = hub.world(self.hinge.child_point)
        self.mass = np.array([body.mass for body in self.bodies])
        self.inertia = np.array([body.inertia for body in self.bodies])
        self.load = load_of(scene) if scene.media else None
        for i, body in enumerate(self.bodies if self.load is not None else ()):
            for part in body.parts:
                if part.in_sand:
                    add_part(self.load, Body(body.name, 7 * i + np.arange(7)), part, scene, body.mass)

    def placed(self, q: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Places (b, 3) m and axes (b, 3, 3) of all bodies, and how they go with rates: (b, 3, n) of each."""
        b, n, hub = len(self.bodies), len(q), self.bodies[0].motion
        x, R, Jx, Jw = np.zeros((b, 3)), np.zeros((b, 3, 3)), np.zeros((b, 3, n)), np.zeros((b, 3, n))
        turn = rotations.about(self.axis, float(q[0]))
        x[0], R[0] = self.pivot + turn @ (hub.position - self.pivot), turn @ hub.rotation
        Jw[0, :, 0], Jx[0, :, 0] = self.axis, np.cross(self.axis, x[0] - self.pivot)
        for k, joint in enumerate(self.joints):
            theta, A = self.S[k] @ q, R[k] @ joint.parent_turn
            R[k + 1] = A @ rotations.of_vector(theta) @ joint.child_turn.T
            Jw[k + 1] = Jw[k] + A @ _left(theta) @ self.S[k]
            arm, other = R[k] @ joint.parent_point, R[k + 1] @ joint.child_point
            x[k + 1] = x[k] + arm - other
            Jx[k + 1] = Jx[k] - rotations.cross(arm) @ Jw[k] + rotations.cross(other) @ Jw[k + 1]
        return x, R, Jx, Jw

    def forces(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """Mass matrix (n, n), and all generalised forces (n,), those of inertia among them."""
        x, R, Jx, Jw = self.placed(q)
        *_, Jx_later, Jw_later = self.placed(q + AHEAD * v)
        inertia = np.einsum("bij,bjk,blk->bil", R, self.inertia, R)
        speed, spin = Jx @ v, Jw @ v
        gain, turn = (Jx_later @ v - speed) / AHEAD, (Jw_later @ v - spin) / AHEAD
        F = -self.mass[:, None] * (gain + np.array([0.0, 0.0, self.scene.gravity]))
        T = -np.einsum("bij,bj->bi", inertia, turn) - np.cross(spin, np.einsum("bij,bj->bi", inertia, spin))
        if self.load is not None and self.load.active:
            state, rates, e = self.state(x, R, speed, spin)
            sand = np.zeros(len(state))
            self.load.add_forces(state, rates, sand)
            pushed = sand.reshape(-1, 7)
            F += pushed[:, :3]
            # The power Q . e' of forces on Euler parameters is T . w with e' = G^T w / 4.
            unit = np.stack([rotations.quaternion_rates(e, np.tile(one, (len(e), 1))) for one in np.eye(3)], axis=1)
            T += np.einsum("bij,bj->bi", unit, pushed[:, 3:])
        M = np.einsum("b,bxi,bxj->ij", self.mass, Jx, Jx) + np.einsum("bxi,bxy,byj->ij", Jw, inertia, Jw)
        whole = np.einsum("bxi,bx->i", Jx, F) + np.einsum("bxi,bx->i", Jw, T)
        return M, whole - self.K @ q - self.D @ v

    def state(self, x: Vector, R: Vector, speed: Vector, spin: Vector) -> tuple[Vector, Vector, Vector]:
        """Coordinates of bodies and their rates as the load takes them, and Euler parameters (b, 4)."""
        e = np.array([rotations.quaternion_of(one) for one in R])
        rates = np.hstack([speed, rotations.quaternion_rates(e, spin)])
        return np.hstack([x, e]).ravel(), rates.ravel(), e

    def deflection(self, q: Vector) -> Vector:
        """Place (3,) m of the tip in the frame of the root, less that where the link is straight."""
        x, R, *_ = self.placed(q)
        (_, origin, axes), (_, other, last) = self.beam.root, self.beam.tip
        apart = x[-1] + R[-1] @ (other + last[:, 0] * self.beam.length) - x[0] - R[0] @ origin
        bent: Vector = (R[0] @ axes).T @ apart - [self.beam.length, 0.0, 0.0]
        return bent

    def run(self, end: float, step: float) -> tuple[Vector, Vector]:
        """Times (n,) s and deflections (n, 3) m of the tip."""
        q, v = np.zeros((2, self.K.shape[0]))
        v[0] = self.hinge.rate
        times, bent = [0.0], [self.deflection(q)]
        if self.load is not None:
            self.load.start(self._now(q, v)[0])
            self.load.accept(0.0, *self._now(q, v))
        for k in range(round(end / step)):
            if self.load is not None:
                self.load.update_active(step)
            middle = self._solved(q, v, step)
            q, v = q + step * middle, 2.0 * middle - v
            if self.load is not None:
                self.load.accept((k + 1) * step, *self._now(q, v))
            times.append((k + 1) * step)
            bent.append(self.deflection(q))
        return np.array(times), np.array(bent)

    def _now(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        x, R, Jx, Jw = self.placed(q)
        return self.state(x, R, Jx @ v, Jw @ v)[:2]

    def _solved(self, q: Vector, v: Vector, step: float) -> Vector:
        """Rates at the middle of a step, by Newton's method, whose matrix is made by differences."""

        def lacks(u: Vector) -> Vector:
            M, f = self.forces(q + 0.5 * step * u, u)
            return np.asarray(M @ (u - v) * (2.0 / step) - f)

        u, size = v.copy(), float(np.abs(v).max()) + 1e-3
        for i in range(MOST):
            r = lacks(u)
            if i % 8 == 0:
                h = 1e-6 * size
                slope = np.column_stack([(lacks(u + h * one) - r) / h for one in np.eye(len(u))])
            change = np.linalg.solve(slope, r)
            u -= change
            if np.abs(change).max() < NEAR * size:
                break
        return u


def _left(t: Vector) -> Vector:
    """Left Jacobian (3, 3) of the exponential map: the angular velocity of exp(t) is this times t'."""
    s, hat = float(np.linalg.norm(t)), rotations.cross(t)
    a, b = (0.5, 1.0 / 6.0) if s < 1e-4 else ((1.0 - np.cos(s)) / s**2, (s - np.sin(s)) / s**3)
    return np.asarray(np.eye(3) + a * hat + b * hat @ hat)
