"""Truncation error of links in a few modes: static correction in the air, solving for the correction in a medium.

A motion in modes is not in equilibrium along the modes that are left out (`scene.space.modes`). The moments R_k that
are missing in the joints between elements turn these, if nothing else resists, by R_k / K_k (static correction of the
mode acceleration method; Craig 1981). Because Phi^T R = 0 (`engines.tree.kernels.space_modes`), this deflection is
orthogonal to the modes that are kept. Under a step load the omitted modes swing twice as far, so twice the greatest
deflection at the tip is the estimated error.

A medium resists this deflection, often much more than the link, so that the static deflection may be a thousand times
the error. If it is not small, the error is that of `mechanics.departure` from the first touch on: how far
the motion with all elements departs from the known one. In 45 runs with 1 to 3 modes (paddles, reeds, blades, strips
that fall, oblique strikes) this was 0.27 to 1.4 times the true error, in another one 5.5 times.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from granular_contact.mechanics.departure import at, departed, instants
from granular_contact.mechanics.space.facet_departure import Poses, known_motion, load_with
from granular_contact.mechanics.space.freedoms import groups
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.scene.space.modes import outward
from granular_contact.scene.space.types import SpatialBeam, Vector

INSTANTS = 192  # with 96 two of 36 departures were five times the error and more; 384 hardly change them
SAFE = 1.5  # safety factor, by which the departure is multiplied


def errors(observer: SpatialKinematics, doubtful: float) -> dict[str, float]:
    """Estimated error (m) of the tip's deflection of each link, the greatest over the instants.

    doubtful: of the greatest deflection; a static estimate below it stands.
    """
    static = {name: static_deflections(observer, motion.beam) for name, motion in observer.beams.items()}
    errors = {name: 2.0 * float(each.max()) for name, each in static.items()}
    load = observer.engine.load
    bends = {name: float(np.hypot(*each).max()) for name, each in observer.bends().items()}
    if load is None or not (load.depth > 0.0).any() or all(errors[name] <= doubtful * bends[name] for name in errors):
        return errors
    before = slice(0, int(np.argmax(load.depth > 0.0)))
    return {
        name: max(2.0 * float(static[name][before].max(initial=0.0)), SAFE * departure)
        for name, departure in _departures(observer).items()
    }


def static_deflections(observer: SpatialKinematics, beam: SpatialBeam) -> Vector:
    """Static deflections (n,) m of the tip by the modes left out, without a medium."""
    joints: Any = outward(observer.scene, beam)
    moments = np.stack([observer.engine.mode_residuals[joint.name] for joint in joints], axis=1)
    turns = moments / np.array([joint.elastic.stiffness for joint in joints])
    arm = beam.length * (np.arange(len(joints))[::-1] + 0.5) / len(joints)  # from each joint to the free end
    return np.asarray(np.linalg.norm(np.einsum("nkj,k->nj", turns[:, :, 1:], arm), axis=1))


def _departures(observer: SpatialKinematics) -> dict[str, float]:
    """Greatest departure (m) of the tip's deflection, by link."""
    system, poses = observer.system, Poses()
    own, other = (load_with(system) for _ in range(2))
    motion = known_motion(observer, INSTANTS, _missing)
    changes = [departure[0] for departure in departed(observer, motion, own, [other], poses)]
    known = at(observer.engine, instants(observer, INSTANTS))
    moved = [poses.displaced(q, poses.rates(q, change)) for q, change in zip(known.q, changes, strict=True)]
    beams = [system.kinematics(t).beams for t in (known, replace(known, q=np.array(moved)))]
    tips = [{name: motion.deflection[0][:, 1:] for name, motion in each.items()} for each in beams]
    return {name: float(np.linalg.norm(tips[1][name] - tip, axis=1).max()) for name, tip in tips[0].items()}


def _missing(motion: SpatialKinematics, W: Vector) -> Vector:
    """Forces (n, d) along the degrees of freedom W (n, m, d) by the moments that joints within links miss."""
    group, forces = groups(motion.scene), np.zeros(W.shape[::2])
    for name, moments in motion.engine.mode_residuals.items():
        joint = motion.scene.joint(name)
        if group[joint.parent] != group[joint.child]:
            forces += np.einsum("nji,nj->ni", motion.constraints.coordinates(joint).J @ W, moments)
    return forces
