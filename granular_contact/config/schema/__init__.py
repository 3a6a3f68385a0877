"""What a scenario may say: strict frozen classes, SI units in the names of the fields.

`mechanism` holds bodies and joints, `medium` the laws, `method` the choice of solver, `scenario` the run around them.
"""

from granular_contact.config.schema.mechanism import (
    Body,
    CylinderShape,
    DiscShape,
    Flexible,
    Hinge,
    Joint,
    Link,
    Model,
    Rigid,
    Shape,
    Weld,
)
from granular_contact.config.schema.medium import LAWS, LeeMarghitu, Medium, VerticalStatic
from granular_contact.config.schema.method import Method, Reduced
from granular_contact.config.schema.scenario import (
    Elastoplastic,
    Friction,
    Impact,
    Load,
    Output,
    Scenario,
    Smooth,
    Solver,
)

__all__ = [
    "LAWS",
    "Body",
    "CylinderShape",
    "DiscShape",
    "Elastoplastic",
    "Flexible",
    "Friction",
    "Hinge",
    "Impact",
    "Joint",
    "LeeMarghitu",
    "Link",
    "Load",
    "Medium",
    "Method",
    "Model",
    "Output",
    "Reduced",
    "Rigid",
    "Scenario",
    "Shape",
    "Smooth",
    "Solver",
    "VerticalStatic",
    "Weld",
]
