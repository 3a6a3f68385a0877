"""Second stage: a scenario's names resolved, its geometry laid out and checked.

types                       what comes out: bodies, joints, medium and numbers, as frozen plain data
build, again                Scenario -> Scene; the same for one that differs in its medium or its strike alone
shapes, bodies              shapes -> lines, outlines and masses; masses merged into bodies
extremes                    lowest and farthest points of arcs, wherever they are cut
layout, start, loops        frames of bodies, initial states of joints, kinematic loops
joints, joint_law           joints between bodies, and springs, stops and friction in them
drives, controls            what moves joints; what is set from outside
signals, signal_tables      values over time, and as tables for kernels
bed, media, wheels, wheel_test   where media lie; presets by name; the run of a wheel
media_checks                slopes that media do not keep, gravities that they were not measured at
steps                       how long steps are
workspace, applicability, checks      what can reach the medium, which law takes which shape, what no scene may be
minimal_support, reduced_support      what minimal coordinates and the reduced model can't solve
space                       scenes in space: the same names again, where they differ
"""

from granular_contact.scene.build import build
from granular_contact.scene.types import Scene

__all__ = ["Scene", "build"]
