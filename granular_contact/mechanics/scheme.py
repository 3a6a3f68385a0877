"""The spectral radius of generalised-alpha at high frequency, by what moves in a scene."""

from __future__ import annotations

from granular_contact.scene.types import Scene

SPECTRAL_RADIUS = 0.9
# Steps that change leave an oscillation in the accelerations of bodies that hang on each other by joints. It fades by
# the spectral radius a step; at 0.9 the control takes it for jumps of the force, and what Newton's method leaves in
# joints. Jumps of a prescribed acceleration leave one at fixed steps too: at 0.9 the work that the drive of a wheel put
# in was reported twice as large as it is.
OF_CHANGING_STEPS = 0.5
# Where sand stops links that hang on each other, each stop leaves such an oscillation too. In links that bend it is in
# vibrations far too fast for the step: at 0.9 it lasts for fifty steps, in each of which bristles yield and hold anew.
# That takes half of all iterations, and the error of the motion is 1.3 to 2.3 times as large as at 0.6 (that of a chain
# which has only just struck is a tenth less). Rigid links take 6 % fewer iterations at 0.8, with the same errors to a
# fifteenth; at 0.6 theirs are larger where all of a chain lies in the sand.
OF_STOPPING, OF_STOPPING_RIGID = 0.6, 0.8


def spectral_radius(scene: Scene) -> float:
    """Of a scene whose config names none, without links that are too stiff for it."""
    changing = scene.solver.accuracy is not None and moving_joints(scene) > 1
    if changing or prescribed(scene):
        return OF_CHANGING_STEPS
    if not stops(scene):
        return SPECTRAL_RADIUS
    return OF_STOPPING if scene.links else OF_STOPPING_RIGID


def moving_joints(scene: Scene) -> int:
    """How many joints let their bodies move against each other."""
    return sum(joint.kind != "weld" for joint in scene.joints)


def prescribed(scene: Scene) -> bool:
    """Whether signals say how something moves."""
    return any(drive.kind == "motion" for drive in scene.drives)


def stops(scene: Scene) -> bool:
    """Whether links in the plane that hang on each other, and are not driven, meet sand, at fixed steps."""
    passive = not scene.drives and scene.solver.accuracy is None and not scene.in_space
    return passive and bool(scene.media) and moving_joints(scene) > 1
