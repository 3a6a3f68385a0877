"""Second stage: a scenario's names resolved, its geometry laid out and checked.

types, parts                what comes out: bodies, joints, medium and numbers, as frozen plain data
build, again                Scenario -> Scene; the same for one that differs in its medium or its strike alone
shapes, bodies              shapes -> lines, outlines and masses; masses merged into bodies
layout, start               frames of bodies, initial states of joints
loops, homes                kinematic loops; the reference configuration in which they close
joints, joint_law           joints between bodies, and springs, stops and friction in them
drives                      what moves joints, or is set from outside
signals, signal_tables      values over time, and as tables for kernels
bed, media, wheels, wheel_test   where media lie; presets by name; the run of a wheel
steps                       how long steps are
stiff                       links that bend too little to show
workspace, checks           what can reach the medium; what no scene may be
methods                     what minimal coordinates and the modal model can't solve
space                       scenes in space: the same names again, where they differ
"""

from granular_contact.scene.build import build
from granular_contact.scene.types import Scene

__all__ = ["Scene", "build"]
