"""What a scenario may say: strict frozen classes, SI units in the names of the fields.

`mechanism` holds the bodies, `shapes` what they are made of, `joints`, `chain` and `model` what becomes of them,
`initial`, `drives` and `signals` what moves them, `medium` a law, `bed` where the media lie, `method` the choice of
solver, `scenario` the run around them.
"""

from granular_contact.config.schema.bed import Bed, BedLayer, FloorContact
from granular_contact.config.schema.chain import Chain
from granular_contact.config.schema.drives import (
    AnyDrive,
    Drive,
    External,
    Force,
    HingeControl,
    Motion,
    SliderControl,
    Torque,
)
from granular_contact.config.schema.initial import Initial, JointStart
from granular_contact.config.schema.joints import (
    Closure,
    Free,
    Hinge,
    HingeClosure,
    Joint,
    Slider,
    SliderClosure,
    Weld,
)
from granular_contact.config.schema.mechanism import (
    Body,
    Flexible,
    Link,
    Rigid,
)
from granular_contact.config.schema.medium import Media, Medium
from granular_contact.config.schema.method import Method, Minimal, Reduced
from granular_contact.config.schema.model import Model
from granular_contact.config.schema.scenario import (
    Friction,
    Load,
    Output,
    Scenario,
    Solver,
)
from granular_contact.config.schema.shapes import (
    ArcShape,
    CylinderShape,
    DiscShape,
    FootShape,
    PlateShape,
    PolygonShape,
    PolylineShape,
    Shape,
    SphereShape,
)
from granular_contact.config.schema.signals import (
    AnySignal,
    Buehler,
    Constant,
    Csv,
    Ramp,
    Shared,
    Signal,
    Sine,
    Table,
)

__all__ = [
    "AnyDrive",
    "AnySignal",
    "ArcShape",
    "Bed",
    "BedLayer",
    "Body",
    "Buehler",
    "Chain",
    "Closure",
    "Constant",
    "Csv",
    "CylinderShape",
    "DiscShape",
    "Drive",
    "External",
    "Flexible",
    "FloorContact",
    "FootShape",
    "Force",
    "Free",
    "Friction",
    "Hinge",
    "HingeClosure",
    "HingeControl",
    "Initial",
    "Joint",
    "JointStart",
    "Link",
    "Load",
    "Media",
    "Medium",
    "Method",
    "Minimal",
    "Model",
    "Motion",
    "Output",
    "PlateShape",
    "PolygonShape",
    "PolylineShape",
    "Ramp",
    "Reduced",
    "Rigid",
    "Scenario",
    "Shape",
    "Shared",
    "Signal",
    "Sine",
    "Slider",
    "SliderClosure",
    "SliderControl",
    "Solver",
    "SphereShape",
    "Table",
    "Torque",
    "Weld",
]
