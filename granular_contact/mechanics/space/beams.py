"""Links that bend along a trajectory: rotation vectors between their elements, energies, the frames of their ends.

See `scene.space.beams` for the elements, and `mechanics.kernels.space_joints` for what acts between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.mechanics.strains import Strains
from granular_contact.results import series
from granular_contact.results.interpolation import Track
from granular_contact.scene.space.types import SpatialBeam, SpatialJoint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.space.kinematics import SpatialKinematics


def drift(curvatures: Vector, length: float, loose: tuple[bool, bool]) -> float:
    """Estimated error (m) of places along a link by the frequencies of its elements, which grows as it vibrates.

    curvatures (n, joints, 2): across its axis (1/m), in the middle of each element; loose: whether no moment bends its
    root and its tip. As a sum of waves of numbers k, cos(k s) from an end that is held and sin(k s) from a loose one:
    of elements of length l the frequency of a wave is off by about (k l)^2 / 12, of itself, as its deflection is under
    a load. A wave whose curvature has come and gone by c in all, from one extreme to the other by r, has gone through a
    phase of pi c / r, so it is off by

        min(pi l^2 c / 24, r / k^2),

    where the latter is both its amplitudes: it is at the other extreme. Of waves, each with its own frequency, the root
    of the sum of squares. Damping, which lets an error fade, is left out.
    """
    joints = curvatures.shape[1]
    k = np.pi / length * (np.arange(joints) + 0.5 * sum(loose))
    wave = np.cos(k[:, None] * length * (np.arange(joints) + 0.5) / joints - 0.5 * np.pi * loose[0])
    size = (wave / np.sum(wave**2, axis=1, keepdims=True)) @ curvatures
    gone = np.linalg.norm(np.diff(size, axis=0), axis=2).sum(axis=0)
    between = np.linalg.norm(np.ptp(size, axis=0), axis=1)
    most = between / np.maximum(k, 0.5 * np.pi / length) ** 2  # a link held at both ends has a wave without a length
    return float(np.linalg.norm(np.minimum(np.pi / 24.0 * (length / joints) ** 2 * gone, most)))


class BeamMotion:
    """The motion of a link that bends; (n, ...) over the instants of a trajectory.

    center: its centre of mass (m) and the velocity of it, with the elements that are welded to other bodies.
    """

    def __init__(self, motion: SpatialKinematics, beam: SpatialBeam) -> None:
        self.motion, self.beam = motion, beam

    @property
    def center(self) -> tuple[Vector, Vector]:
        """Centre of mass (n, 3) m, and its velocity."""
        pieces, total = self.beam.pieces, sum(mass for *_, mass in self.beam.pieces)
        found = [(mass / total, self.motion.position(body, point)) for body, point, mass in pieces]
        place: Vector = np.sum([share * at for share, (at, _) in found], axis=0)
        velocity: Vector = np.sum([share * speed for share, (_, speed) in found], axis=0)
        return place, velocity

    def frame(self, end: tuple[str | None, Vector, Vector]) -> Vector:
        """Axes (n, 3, 3) of the link's frame on the element at its root or tip."""
        body, _, axes = end
        found: Vector = self.motion.rotation(body) @ axes
        return found

    @property
    def deflection(self) -> tuple[Vector, Vector]:
        """Place (n, 3) m of the tip in the frame of the root, less that where the link is straight; its rate."""
        (root, origin, _), (tip, other, axes) = self.beam.root, self.beam.tip
        at, speed = self.motion.position(root, origin)
        end, end_speed = self.motion.position(tip, other + axes[:, 0] * self.beam.length)
        apart, frame = end - at, self.frame(self.beam.root)
        relative = end_speed - speed - np.cross(self.motion.spin(root), apart)
        bent, rate = (np.einsum("nji,nj->ni", frame, v) for v in (apart, relative))
        return bent - [self.beam.length, 0.0, 0.0], rate

    def bend(self) -> Track:
        """Distance (m) of the tip from the axis of the root, with its rate."""
        across, rates = (v[:, 1:] for v in self.deflection)
        size = np.linalg.norm(across, axis=1)
        along = np.sum(across * rates, axis=1)
        return Track(size, np.divide(along, size, out=np.zeros_like(size), where=size > 0.0))

    def turned(self) -> tuple[Vector, Vector]:
        """Rotation vectors (n, joints, 3) rad from each element to the next, from root to tip, and their rates."""
        scene, found = self.motion.scene, []
        for k, name in enumerate(self.beam.joints):
            joint = scene.joint(name)
            theta, rate = self._between(joint)
            sign = 1.0 if joint.parent == self.beam.pieces[k][0] else -1.0
            found.append((sign * theta, sign * rate))
        return np.stack([one for one, _ in found], axis=1), np.stack([rate for _, rate in found], axis=1)

    def _between(self, joint: SpatialJoint) -> tuple[Vector, Vector]:
        """Rotation vector (n, 3) rad from a joint's parent to its child, in the frame of the joint; its rate."""
        axes = self.motion.rotation(joint.parent) @ joint.parent_turn
        angle, axis = self.motion.from_home(joint)
        theta, spin = (
            np.einsum("nji,nj->ni", axes, v)
            for v in (angle[:, None] * axis, self.motion.spin(joint.child) - self.motion.spin(joint.parent))
        )
        small = angle < 1e-2
        s = np.where(small, 1.0, angle)
        c = np.where(small, 1.0 / 12.0 + angle**2 / 720.0, (1.0 - 0.5 * s / np.tan(0.5 * s)) / s**2)
        once = np.cross(theta, spin)
        return theta, spin - 0.5 * once + c[:, None] * np.cross(theta, once)

    def element_error(self) -> float:
        """Estimated error (m) of places along the link by the length of elements, the greatest over the instants.

        With the curvatures kappa_k across the axis at the joints between elements of length l

            e = l^2 / 12 sum |kappa_k+1 - kappa_k| + l^3 / 6 sum kappa_k^2,

        where the curvature goes on to zero at an end that is free or hinged. The first is the error of a cantilever
        with a weight at its end, by the rule of midpoints, and what single elements can't resolve; the second is of
        chords in place of arcs, four times what they are shorter by, since what is at another place meets other forces.
        What waves are behind or ahead by adds to it, see `drift`. `validation/curled.py` compares it with the error of
        ropes that fall, curl and are thrown, and of rods that vibrate.
        """
        beam, piece = self.beam, self.beam.length / self.beam.elements
        turns = self.turned()[0][:, :, 1:]
        loose = self._is_loose(beam.root), self._is_loose(beam.tip)
        ends = [free * turns[:, [k]] for free, k in zip(loose, (0, -1), strict=True)]
        jumps = np.diff(np.concatenate([turns[:, :1] - ends[0], turns, turns[:, -1:] - ends[1]], axis=1), axis=1)
        rough, chords = np.linalg.norm(jumps, axis=2).sum(axis=1), np.sum(turns**2, axis=(1, 2))
        return float(piece * (rough / 12.0 + chords / 6.0).max()) + drift(turns / piece, beam.length, loose)

    def _is_loose(self, end: tuple[str | None, Vector, Vector]) -> bool:
        """Whether nothing is welded to an end, so that no moment bends it."""
        return end[0] is not None and self.motion.scene.body(end[0]).is_element

    def strains(self) -> Strains:
        """Strains and stresses at the root, the joints between elements and the tip."""
        beam, n = self.beam, self.beam.elements
        changes = self.turned()[0]
        if beam.stretches:
            changes = np.concatenate([changes, self.stretched()[0][:, :, None]], axis=2)
        kappa = changes * n / beam.length
        ends = [
            1.5 * kappa[:, k] - 0.5 * kappa[:, k + step] if n > 1 else kappa[:, k] for k, step in ((0, 1), (-1, -1))
        ]
        kappa = np.concatenate([ends[0][:, None], kappa, ends[1][:, None]], axis=1)
        y, z = (0.5 * side for side in beam.section)
        twist, about_y, about_z = np.moveaxis(np.abs(kappa[:, :, :3]), 2, 0)
        bent = y * np.hypot(about_y, about_z) if beam.round else z * about_y + y * about_z
        along = np.abs(kappa[:, :, 3:]).sum(axis=2)
        (E, G, axial), arm = beam.moduli, y if beam.round else 2.0 * min(y, z)
        stress = np.sqrt((E * bent + axial * along) ** 2 + 3.0 * (G * arm * twist) ** 2)
        places = np.array([0.0, *((np.arange(n) + 0.5) * beam.length / n), beam.length])
        return Strains(places, bent + along, stress, beam.yield_stress)

    def stretched(self) -> tuple[Vector, Vector]:
        """How much farther apart (n, joints) m elements are than of the link as it was made; the rates."""
        found = []
        for k, name in enumerate(self.beam.joints):
            joint = self.motion.scene.joint(name)
            at, speed = self.motion.position(joint.parent, joint.parent_point)
            to, other = self.motion.position(joint.child, joint.child_point)
            sign = 1.0 if joint.parent == self.beam.pieces[k][0] else -1.0
            x = sign * self.motion.rotation(joint.parent) @ joint.parent_turn[:, 0]
            # What is apart is along x, so that turning with the parent does not change the speed along it.
            found.append((np.sum(x * (to - at), axis=1), np.sum(x * (other - speed), axis=1)))
        return np.stack([one for one, _ in found], axis=1), np.stack([rate for _, rate in found], axis=1)

    def energy_and_loss(self) -> tuple[Vector, Vector]:
        """Strain energy (n,) J, and the power (n,) W that its damping takes."""
        theta, rate = self.turned()
        laws: Any = [self.motion.scene.joint(name).elastic for name in self.beam.joints]
        stiffness, damping = (np.array([getattr(law, name) for law in laws]) for name in ("stiffness", "damping"))
        stored: Vector = 0.5 * np.sum(stiffness * theta**2, axis=(1, 2))
        lost: Vector = np.sum(damping * rate**2, axis=(1, 2))
        if (axial := laws[0].axial) is not None:
            (apart, speed), (k, d) = self.stretched(), axial
            stored, lost = stored + 0.5 * k * np.sum(apart**2, axis=1), lost + d * np.sum(speed**2, axis=1)
        return stored, lost

    def columns(self) -> series.Series:
        """Deflection of the tip in both planes of the root's frame, and the twist from root to tip."""
        name, (bent, _) = self.beam.name, self.deflection
        found: series.Series = {}
        for axis in (1, 2):
            words = f"tip of {name} across the axis of its root, along the {'xyz'[axis]} axis of the root"
            found[f"{name}_deflection_{'xyz'[axis]}_m"] = (words, bent[:, axis])
        twist = np.sum(self.turned()[0][:, :, 0], axis=1)
        found[f"{name}_twist_deg"] = (
            f"rotation of the tip of {name} against its root, about its axis",
            np.degrees(twist),
        )
        if self.beam.stretches:
            words = f"by how much {name} is longer than it was made"
            found[f"{name}_stretch_m"] = (words, self.stretched()[0].sum(axis=1))
        return found
