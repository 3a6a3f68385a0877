"""Checks of rigid bodies of an Exudyn system on which a bed shall act; those of beams are in `beams`."""

from __future__ import annotations

from typing import Any

import exudyn as exu
import numpy as np

from granular_contact.errors import SceneError, scene_error, short
from granular_contact.sand.kernels.spatial import SIZE

NODES_IN_SPACE = {"RigidBodyEP": SIZE, "RigidBodyRxyz": 6}  # number of coordinates by the type of the node
OUT_OF_PLANE = 1e-6  # sine of an angle, or m/s and 1/s: round-off that scripts leave


def named_object(mbs: Any, number: Any) -> Any:
    """Data of an object of the system, by the number that the system gave it.

    Raises
    ------
    SceneError
        There is no such object, or `number` is none that the system gave to an object.
    """
    try:
        return mbs.GetObject(number)
    except exu.ExudynError:
        got = f"got {short(repr(number))} ({type(number).__name__}), which is no object of the system"
        raise scene_error("bed", f"{got}; allowed is a number that CreateRigidBody or AddObject returned") from None


def rigid_node(mbs: Any, body: Any) -> tuple[int, int]:
    """Node of a planar rigid body, or of a spatial one with Euler parameters, and its number of coordinates.

    Raises
    ------
    SceneError
        The body is of another kind, or a spatial one does not start in the plane.
    """
    item = named_object(mbs, body)
    if item["objectType"] == "RigidBody2D":
        return int(item["nodeNumber"]), 3
    if item["objectType"] != "RigidBody":
        raise refused(item, "allowed are RigidBody2D and RigidBody")
    node = mbs.GetNode(item["nodeNumber"])
    if node["nodeType"] != "RigidBodyEP":
        raise scene_error("bed", f"the node of {item['name']} is a {node['nodeType']}, allowed is RigidBodyEP")
    _stays_in_plane(item["name"], node)
    return int(item["nodeNumber"]), SIZE


def spatial_node(mbs: Any, body: Any) -> tuple[int, int]:
    """Node of a rigid body in space and its number of coordinates, with Euler parameters or Tait-Bryan angles.

    Raises
    ------
    SceneError
        The body is of another kind.
    """
    item = named_object(mbs, body)
    if item["objectType"] != "RigidBody":
        raise refused(item, "allowed in space is RigidBody")
    kind = mbs.GetNode(item["nodeNumber"])["nodeType"]
    if kind not in NODES_IN_SPACE:
        allowed = " and ".join(NODES_IN_SPACE)
        raise scene_error("bed", f"the node of {item['name']} is a {kind}, allowed are {allowed}")
    return int(item["nodeNumber"]), NODES_IN_SPACE[kind]


def refused(item: Any, allowed: str) -> SceneError:
    """Error for an object of a kind that is not allowed; for a tree it says how to let the medium act on its links."""
    kind = item["objectType"]
    if kind == "KinematicTree":
        allowed += "; weld a rigid body to a MarkerKinematicTreeRigid on its link, see docs/tutorials/exudyn.md"
    return scene_error("bed", f"object {item['name']} is a {kind}, {allowed}")


def _stays_in_plane(name: str, node: Any) -> None:
    """Raise SceneError for a spatial body whose z axis leans out of the world's z axis initially, or starts to.

    The axis may also point downward: the frame of the body is then upside down.
    """
    e = np.add(node["referenceCoordinates"], node["initialCoordinates"])[3:]
    tilt = 2.0 * float(np.hypot(e[1], e[2]) * np.hypot(e[0], e[3]))  # sine of the angle between the z axes
    is_upright = np.hypot(e[1], e[2]) < np.hypot(e[0], e[3])
    rates = np.abs(np.asarray(node["initialVelocities"])[[2, 4, 5] if is_upright else [2, 3, 6]])
    if tilt > OUT_OF_PLANE or rates.max() > OUT_OF_PLANE:
        raise scene_error("bed", f"{name} does not move in the x-y plane: its z axis leans or it has a speed out of it")
