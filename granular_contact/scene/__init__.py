"""Second stage: resolve the names of a scenario, lay out its geometry and check it.

types, parts                the result: bodies, joints, medium and numbers, as frozen plain data
build, variants             Scenario -> Scene; scenes that differ only in the medium or in the impact
shapes, bodies              shapes -> lines, outlines and masses; masses merged into bodies
layout, start               poses of bodies, initial states of joints
loops, homes                kinematic loops; the reference configuration in which they close
joints, joint_law           joints between bodies, and springs, stops and friction in them
drives                      drives of joints, and controls that are set during a run
signals, signal_tables      signals over time, and their tables for kernels
bed, wheels, wheel_test     surface, layers and floor of the bed; runs of one wheel
steps                       step sizes
stiff                       links that bend too little to show
workspace, checks           parts that can reach the medium; faults and notes of scenes
methods                     scenes that minimal coordinates and the modal model support
space                       scenes in space, with modules of the same names where they differ from the plane
"""

from granular_contact.scene.build import build
from granular_contact.scene.types import Scene

__all__ = ["Scene", "build"]
