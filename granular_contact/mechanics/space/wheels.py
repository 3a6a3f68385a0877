"""Slip, sinkage, pull, side force and load of wheels in space.

Directions at the surface below the axle: ahead is tangential to the surface and normal to the axle, to where the wheel
rolls as it turns about its axis; left is tangential to the surface and normal to that; load and sinkage are normal to
the surface.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from granular_contact.geometry.rotations import vector_products
from granular_contact.mechanics.mechanism import label
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.wheels import STANDS, sense
from granular_contact.sand.work import wrenches_about
from granular_contact.scene.space.types import Vector


def wheel_histories(motion: SpatialKinematics, forces: Mapping[str, Vector]) -> dict[str, dict[str, Vector]]:
    """Histories of `mechanics.wheels.wheel_histories`, and the side force (N, to the left) and slip angle (degrees).

    forces: of the medium by body, (n, 6): N, and N m about the origin.
    """
    histories, bed = {}, motion.scene.bed
    for body in motion.scene.rigid:
        name, wheel = body.name, body.wheel
        if wheel is None or name not in forces or bed is None:
            continue
        (p, v), axis = motion.position(name, wheel.axle), motion.rotation(name) @ wheel.axis
        height, along, across = bed.tangent(p[:, 0], p[:, 1])
        normal = np.column_stack([-along, -across, np.ones_like(along)])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        ahead = vector_products(axis, normal)
        level = np.linalg.norm(ahead, axis=1, keepdims=True)  # cosine of the camber
        ahead = np.divide(ahead, level, out=np.zeros_like(ahead), where=level > 0.0)
        left = vector_products(normal, ahead)
        force, spin = forces[name][:, :3], np.sum(motion.spin(name) * axis, axis=1)
        moment = wrenches_about(forces[name], p)[:, 3:]
        speed, rim = np.sum(v * ahead, axis=1), wheel.radius * spin
        slip, backward = sense(speed, rim)
        above = (p[:, 2] - height) * normal[:, 2]
        pull, aside = np.sum(force * ahead, axis=1), np.sum(v * left, axis=1)
        moves = np.hypot(speed, aside) > STANDS
        histories[label(name)] = {
            "v": speed,
            "omega": spin,
            "slip": slip,
            "sinkage_m": wheel.rim * level[:, 0] - above,
            "drawbar_pull_N": np.where(backward, -pull, pull),
            "load_N": np.sum(force * normal, axis=1),
            "torque_Nm": -np.sum(moment * axis, axis=1),
            "side_force_N": np.sum(force * left, axis=1),
            "slip_angle_deg": np.where(moves, np.degrees(np.arctan2(aside, np.abs(speed))), 0.0),
        }
    return histories
