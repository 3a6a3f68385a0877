"""What a scenario may say: strict frozen classes, SI units in the names of the fields.

`mechanism` holds the bodies, `shapes` what they are made of, `joints`, `chain` and `model` what becomes of them, `drives` and `signals` what moves them,
`medium` the laws, `method` the choice of solver, `scenario` the run around them.
"""

from granular_contact.config.schema.chain import Chain
from granular_contact.config.schema.drives import (
    AnyDrive,
    Drive,
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
from granular_contact.config.schema.medium import LAWS, LeeMarghitu, Medium, VerticalStatic
from granular_contact.config.schema.method import Method, Reduced
from granular_contact.config.schema.model import Model
from granular_contact.config.schema.scenario import (
    Elastoplastic,
    Friction,
    Load,
    Output,
    Scenario,
    Smooth,
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
    "LAWS",
    "AnyDrive",
    "AnySignal",
    "ArcShape",
    "Body",
    "Buehler",
    "Chain",
    "Closure",
    "Constant",
    "Csv",
    "CylinderShape",
    "DiscShape",
    "Drive",
    "Elastoplastic",
    "Flexible",
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
    "LeeMarghitu",
    "Link",
    "Load",
    "Medium",
    "Method",
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
    "Smooth",
    "Solver",
    "SphereShape",
    "Table",
    "Torque",
    "VerticalStatic",
    "Weld",
]
