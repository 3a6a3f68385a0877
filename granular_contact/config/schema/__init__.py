"""What a scenario may say: strict frozen classes, SI units in the names of the fields.

`mechanism` holds the bodies, `joints`, `chain` and `model` what becomes of them, `initial`, `drives` and `signals` what
moves them, `medium` the laws, `method` the choice of solver, `scenario` the run around them.
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
    CylinderShape,
    DiscShape,
    Flexible,
    Link,
    Rigid,
    Shape,
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
    "Table",
    "Torque",
    "VerticalStatic",
    "Weld",
]
