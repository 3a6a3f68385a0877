"""Schema of a run in space: bodies, joints, initial state and bed in three dimensions; all else as in the plane.

A model in space has `in_space: true`. A config with such a model is a `SpatialScenario`; this package is loaded only
then. The modules `bodies`, `shapes`, `joints`, `bed`, `model` and `scenario` correspond to those of the plane; `turned`
holds directions and orientations.

World: x ahead, y left, z up. Angles, rates and torques are right-handed about their axes. The keys name SI units.
"""

# mypy: implicit-reexport
# ruff: noqa: F401

from granular_contact.config.schema.space.bed import HeightMap, SpatialBed
from granular_contact.config.schema.space.bodies import Inertia, SpatialBody, SpatialFlexible, SpatialLink, SpatialRigid
from granular_contact.config.schema.space.joints import (
    Ball,
    SpatialClosure,
    SpatialFree,
    SpatialHinge,
    SpatialHingeClosure,
    SpatialJoint,
    SpatialSlider,
    SpatialSliderClosure,
    SpatialWeld,
)
from granular_contact.config.schema.space.model import SpatialModel
from granular_contact.config.schema.space.scenario import SpatialInitial, SpatialJointStart, SpatialScenario
