"""Objects of Exudyn that a bed refuses, each by its kind; those that it takes are in docs/tutorials/exudyn.md."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import pytest
from exudyn.utilities import InertiaCuboid
from support_refusals import faults_of

from granular_contact import Box, GranularBed, preset
from granular_contact.errors import SceneError

PAGE = Path(__file__).parents[2] / "docs/tutorials/exudyn.md"
RIGID = InertiaCuboid(2700, [0.1, 0.1, 0.1])


def tree(mbs: Any) -> Any:
    zero = {"initialCoordinates": [0], "initialCoordinates_t": [0]}
    node = mbs.AddNode(items.NodeGenericODE2(numberOfODE2Coordinates=1, referenceCoordinates=[0], **zero))
    return mbs.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.RevoluteY],
            linkParents=[-1],
            jointTransformations=exu.Matrix3DList([np.eye(3)]),
            jointOffsets=exu.Vector3DList([[0, 0, 0]]),
            linkMasses=[0.1],
            linkCOMs=exu.Vector3DList([[0.1, 0, 0]]),
            linkInertiasCOM=exu.Matrix3DList([np.eye(3)]),
        )
    )


def beam(mbs: Any) -> Any:
    nodes = [mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[x, 0, 0])) for x in (0.0, 0.1)]
    stiff = {"axialStiffness": 1.0, "shearStiffness": 1.0, "bendingStiffness": 1.0}
    mass = {"massPerLength": 1.0, "crossSectionInertia": 1.0}
    return mbs.AddObject(items.ObjectBeamGeometricallyExact2D(nodeNumbers=nodes, length=0.1, **mass, **stiff))


def mass_point(mbs: Any) -> Any:
    node = mbs.AddNode(items.NodePoint(referenceCoordinates=[0, 0, 0]))
    return mbs.AddObject(items.ObjectMassPoint(nodeNumber=node, mass=1.0))


def rotation_vector(mbs: Any) -> Any:
    return mbs.CreateRigidBody(inertia=RIGID, nodeType=exu.NodeType.RotationRotationVector)


def in_plane(mbs: Any) -> Callable[[Any], None]:
    bed = GranularBed(mbs, preset("play_sand"), 0.0)
    return lambda body: bed.add_rigid(body, [0, 0], [0.1, 0], 0.01)


def cables(mbs: Any) -> Callable[[Any], None]:
    bed = GranularBed(mbs, preset("play_sand"), 0.0)
    return lambda body: bed.add_cables([body], 0.01)


def in_space(mbs: Any) -> Callable[[Any], None]:
    bed = GranularBed(mbs, preset("rft3d_sand"), 0.0, up=(0, 0, 1))
    return lambda body: bed.add_body(body, Box((0.1, 0.1, 0.1)))


@pytest.mark.parametrize("add", [in_plane, cables, in_space])
@pytest.mark.parametrize(
    ("made", "kind"),
    [
        (tree, "KinematicTree"),
        (beam, "BeamGeometricallyExact2D"),
        (mass_point, "MassPoint"),
        (rotation_vector, "RotVec"),
    ],
)
def test_unsupported_objects_are_refused_with_their_kind(made: Callable[[Any], Any], kind: str, add: Any) -> None:
    mbs = exu.SystemContainer().AddSystem()
    if (made, add) == (beam, cables):
        add(mbs)(made(mbs))
        return
    (fault,) = faults_of(SceneError, add(mbs), made(mbs))
    assert "allowed" in fault.message
    assert (kind == "KinematicTree") == ("MarkerKinematicTreeRigid" in fault.message)
    assert kind in fault.message or (kind, add) == ("RotVec", cables)  # there the body is none, too


@pytest.mark.parametrize("add", [in_plane, cables, in_space])
def test_a_number_of_no_object_is_refused(add: Any) -> None:
    """Exudyn's own errors name its functions, and not what was given to the bed."""
    mbs = exu.SystemContainer().AddSystem()
    made = mbs.CreateRigidBody(inertia=RIGID, returnDict=True)
    for number in (7, -1, None, "foot", made["nodeNumber"], made):
        with pytest.raises(SceneError, match=r"^bed\.add_\w+: got .*, which is no object of the system; allowed is"):
            add(mbs)(number)


def test_an_element_is_no_list_of_elements() -> None:
    mbs = exu.SystemContainer().AddSystem()
    with pytest.raises(SceneError, match=r"^bed.add_cables: got \d; allowed is a list of elements"):
        GranularBed(mbs, preset("play_sand"), 0.0).add_cables(beam(mbs), 0.01)


def test_an_unattached_bed_reports_nothing() -> None:
    """Its forces were zeros, which looks like a body above the sand."""
    mbs = exu.SystemContainer().AddSystem()
    body = mbs.CreateRigidBody(inertia=RIGID, referencePosition=[0, 0, 0.04])
    bed = GranularBed(mbs, preset("rft3d_sand"), 0.0, up=(0, 0, 1))
    bed.add_body(body, Box((0.1, 0.1, 0.1)))
    mbs.Assemble()
    for read in (lambda: bed.force, lambda: bed.work, lambda: bed.bodies, lambda: bed.history):
        with pytest.raises(SceneError, match=r"it does not act, .*: call attach\(\) before mbs.Assemble\(\)"):
            read()


def test_the_tutorial_names_the_unsupported_objects() -> None:
    page = PAGE.read_text(encoding="utf-8")
    for kind in ("ObjectKinematicTree", "ObjectBeamGeometricallyExact2D", "mass points", "rotation vectors"):
        assert kind in page
