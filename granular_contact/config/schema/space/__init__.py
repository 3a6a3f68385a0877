"""What a scenario in space may say: as in the plane, with bodies, joints, start and bed of three dimensions.

A model says `in_space: true`; a config of such a model is a `SpatialScenario`, and this package is loaded for it alone.
`bodies`, `shapes`, `joints`, `bed`, `model` and `scenario` are as in the plane; `turned` holds directions and
orientations.

World: x ahead, y left, z up. Angles, rates and torques are right-handed about their axes. SI units, named in the keys.
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
