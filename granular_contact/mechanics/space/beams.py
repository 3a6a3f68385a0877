"""Flexible links in space along a trajectory: rotations between their rigid elements, energies, deflection, errors.

`scene.space.beams` describes the elements, `mechanics.kernels.space_joints` the moments and forces between them.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.geometry.rotations import vector_products
from granular_contact.mechanics.strains import Strains
from granular_contact.results import series
from granular_contact.results.interpolation import Track
from granular_contact.scene.space.types import SpatialBeam, SpatialJoint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.space.kinematics import SpatialKinematics


def drift(curvatures: Vector, length: float, loose: tuple[bool, bool]) -> float:
    """Phase error: estimated error (m) of positions along a vibrating link by the frequencies of its elements.

    curvatures (n, joints, 2): across the axis (1/m), in the middle of each element; loose: whether root and tip are
    free of moments. The curvature is expanded in waves of wave number k: cos(k s) from a clamped end, sin(k s) from a
    loose one. With elements of length l the relative error of a wave's frequency is about (k l)^2 / 12, as that of its
    deflection under a load. Let c be the total variation of the curvature of a wave over time, and r its range. The
    wave has then passed a phase of pi c / r, and its error of position is

        min(pi l^2 c / 24, r / k^2).

    The bound is twice its amplitude: the wave is at the opposite extreme. The errors of waves, which have different
    frequencies, are added as root of the sum of squares. Damping, by which an error decays, is neglected.
    """
    joints = curvatures.shape[1]
    k = np.pi / length * (np.arange(joints) + 0.5 * sum(loose))
    wave = np.cos(k[:, None] * length * (np.arange(joints) + 0.5) / joints - 0.5 * np.pi * loose[0])
    size = (wave / np.sum(wave**2, axis=1, keepdims=True)) @ curvatures
    variation = np.linalg.norm(np.diff(size, axis=0), axis=2).sum(axis=0)
    span = np.linalg.norm(np.ptp(size, axis=0), axis=1)
    bound = span / np.maximum(k, 0.5 * np.pi / length) ** 2  # k = 0 occurs for a link clamped at both ends
    return float(np.linalg.norm(np.minimum(np.pi / 24.0 * (length / joints) ** 2 * variation, bound)))


class BeamMotion:
    """Motion of a flexible link; (n, ...) arrays over the instants of a trajectory."""

    def __init__(self, motion: SpatialKinematics, beam: SpatialBeam) -> None:
        self.motion, self.beam = motion, beam

    @property
    def center(self) -> tuple[Vector, Vector]:
        """Centre of mass (n, 3) m, and its velocity; elements that are welded to other bodies are included."""
        pieces, total = self.beam.pieces, sum(mass for *_, mass in self.beam.pieces)
        parts = [(mass / total, self.motion.position(body, point)) for body, point, mass in pieces]
        position: Vector = np.sum([share * x for share, (x, _) in parts], axis=0)
        velocity: Vector = np.sum([share * v for share, (_, v) in parts], axis=0)
        return position, velocity

    def frame(self, end: tuple[str | None, Vector, Vector]) -> Vector:
        """Axes (n, 3, 3) of the link's frame on its first or last element."""
        body, _, axes = end
        frame: Vector = self.motion.rotation(body) @ axes
        return frame

    @cached_property
    def deflection(self) -> tuple[Vector, Vector]:
        """Displacement (n, 3) m of the tip from that of the straight link, in the frame of the root, and its rate."""
        (root, origin, _), (tip, tip_origin, axes) = self.beam.root, self.beam.tip
        at_root, root_speed = self.motion.position(root, origin)
        at_tip, tip_speed = self.motion.position(tip, tip_origin + axes[:, 0] * self.beam.length)
        offset, frame = at_tip - at_root, self.frame(self.beam.root)
        relative = tip_speed - root_speed - vector_products(self.motion.spin(root), offset)
        position, rate = (np.einsum("nji,nj->ni", frame, v) for v in (offset, relative))
        return position - [self.beam.length, 0.0, 0.0], rate

    def bend(self) -> Track:
        """Distance (m) of the tip from the axis of the root, and its rate."""
        across, rates = (v[:, 1:] for v in self.deflection)
        size = np.linalg.norm(across, axis=1)
        along = np.sum(across * rates, axis=1)
        return Track(size, np.divide(along, size, out=np.zeros_like(size), where=size > 0.0))

    @cached_property
    def turned(self) -> tuple[Vector, Vector]:
        """Rotation vectors (n, joints, 3) rad from each element to the next, from root to tip, and their rates."""
        scene, pairs = self.motion.scene, []
        for k, name in enumerate(self.beam.joints):
            joint = scene.joint(name)
            theta, rate = self._between(joint)
            sign = 1.0 if joint.parent == self.beam.pieces[k][0] else -1.0
            pairs.append((sign * theta, sign * rate))
        return np.stack([theta for theta, _ in pairs], axis=1), np.stack([rate for _, rate in pairs], axis=1)

    def _between(self, joint: SpatialJoint) -> tuple[Vector, Vector]:
        """Rotation vector (n, 3) rad from a joint's parent to its child, in the frame of the joint, and its rate.

        The rate is the inverse left Jacobian times the angular velocity, see `mechanics.kernels.bending`.
        """
        axes = self.motion.rotation(joint.parent) @ joint.parent_turn
        angle, axis = self.motion.from_home(joint)
        theta, spin = (
            np.einsum("nji,nj->ni", axes, v)
            for v in (angle[:, None] * axis, self.motion.spin(joint.child) - self.motion.spin(joint.parent))
        )
        small = angle < 1e-2
        s = np.where(small, 1.0, angle)
        c = np.where(small, 1.0 / 12.0 + angle**2 / 720.0, (1.0 - 0.5 * s / np.tan(0.5 * s)) / s**2)
        cross = vector_products(theta, spin)
        return theta, spin - 0.5 * cross + c[:, None] * vector_products(theta, cross)

    def element_error(self) -> float:
        """Discretisation error: estimated error (m) of positions along the link, the greatest over the instants.

        With the curvatures kappa_k across the axis at the joints between elements of length l

            e = l^2 / 12 sum |kappa_k+1 - kappa_k| + l^3 / 6 sum kappa_k^2,

        where the curvature continues to zero at an end that is free or hinged. The first term is the error of the
        midpoint rule for a cantilever with a weight at its end, and of bending within single elements. The second term
        is that of chords in place of arcs: four times their shortening, because displaced parts meet other forces.
        `drift` adds the phase error of waves. `validation/curled.py` compares the estimate with the error of ropes that
        fall, curl and are thrown, and of rods that vibrate.
        """
        beam, piece = self.beam, self.beam.length / self.beam.elements
        turns = self.turned[0][:, :, 1:]
        loose = self._is_loose(beam.root), self._is_loose(beam.tip)
        ends = [free * turns[:, [k]] for free, k in zip(loose, (0, -1), strict=True)]
        jumps = np.diff(np.concatenate([turns[:, :1] - ends[0], turns, turns[:, -1:] - ends[1]], axis=1), axis=1)
        rough, chords = np.linalg.norm(jumps, axis=2).sum(axis=1), np.sum(turns**2, axis=(1, 2))
        return float(piece * (rough / 12.0 + chords / 6.0).max()) + drift(turns / piece, beam.length, loose)

    def _is_loose(self, end: tuple[str | None, Vector, Vector]) -> bool:
        """Return whether an end is free of moments, as no body is welded to it."""
        return end[0] is not None and self.motion.scene.body(end[0]).is_element

    def strains(self) -> Strains:
        """Strains and stresses at the root, at the joints between elements and at the tip; ends are extrapolated."""
        beam, n = self.beam, self.beam.elements
        changes = self.turned[0]
        if beam.stretches:
            changes = np.concatenate([changes, self.stretched[0][:, :, None]], axis=2)
        kappa = changes * n / beam.length
        ends = [
            1.5 * kappa[:, k] - 0.5 * kappa[:, k + step] if n > 1 else kappa[:, k] for k, step in ((0, 1), (-1, -1))
        ]
        kappa = np.concatenate([ends[0][:, None], kappa, ends[1][:, None]], axis=1)
        y, z = (0.5 * side for side in beam.section)
        twist, about_y, about_z = np.moveaxis(np.abs(kappa[:, :, :3]), 2, 0)
        bending = y * np.hypot(about_y, about_z) if beam.round else z * about_y + y * about_z
        axial_strain = np.abs(kappa[:, :, 3:]).sum(axis=2)
        (E, G, axial), arm = beam.moduli, y if beam.round else 2.0 * min(y, z)
        stress = np.sqrt((E * bending + axial * axial_strain) ** 2 + 3.0 * (G * arm * twist) ** 2)
        places = np.array([0.0, *((np.arange(n) + 0.5) * beam.length / n), beam.length])
        return Strains(places, bending + axial_strain, stress, beam.yield_stress)

    @cached_property
    def stretched(self) -> tuple[Vector, Vector]:
        """Elongations (n, joints) m between neighbouring elements, and their rates."""
        pairs = []
        for k, name in enumerate(self.beam.joints):
            joint = self.motion.scene.joint(name)
            on_parent, parent_speed = self.motion.position(joint.parent, joint.parent_point)
            on_child, child_speed = self.motion.position(joint.child, joint.child_point)
            sign = 1.0 if joint.parent == self.beam.pieces[k][0] else -1.0
            x = sign * self.motion.rotation(joint.parent) @ joint.parent_turn[:, 0]
            # The offset is parallel to x, so the rotation of x adds nothing to the rate.
            pairs.append((np.sum(x * (on_child - on_parent), axis=1), np.sum(x * (child_speed - parent_speed), axis=1)))
        return np.stack([length for length, _ in pairs], axis=1), np.stack([rate for _, rate in pairs], axis=1)

    def energy_and_loss(self) -> tuple[Vector, Vector]:
        """Strain energy (n,) J, and the power (n,) W that its damping dissipates."""
        theta, rate = self.turned
        laws: Any = [self.motion.scene.joint(name).elastic for name in self.beam.joints]
        stiffness, damping = (np.array([getattr(law, name) for law in laws]) for name in ("stiffness", "damping"))
        stored: Vector = 0.5 * np.sum(stiffness * theta**2, axis=(1, 2))
        dissipated: Vector = np.sum(damping * rate**2, axis=(1, 2))
        if (axial := laws[0].axial) is not None:
            (length, speed), (k, d) = self.stretched, axial
            stored, dissipated = (
                stored + 0.5 * k * np.sum(length**2, axis=1),
                dissipated + d * np.sum(speed**2, axis=1),
            )
        return stored, dissipated

    def columns(self) -> series.Series:
        """Columns of the tip's deflection along y and z of the root, of the twist and of the elongation."""
        name, (deflection, _) = self.beam.name, self.deflection
        columns: series.Series = {}
        for axis in (1, 2):
            text = f"tip of {name} across the axis of its root, along the {'xyz'[axis]} axis of the root"
            columns[f"{name}_deflection_{'xyz'[axis]}_m"] = (text, deflection[:, axis])
        twist = np.sum(self.turned[0][:, :, 0], axis=1)
        columns[f"{name}_twist_deg"] = (
            f"rotation of the tip of {name} against its root, about its axis",
            np.degrees(twist),
        )
        if self.beam.stretches:
            text = f"by how much {name} is longer than it was made"
            columns[f"{name}_stretch_m"] = (text, self.stretched[0].sum(axis=1))
        return columns
