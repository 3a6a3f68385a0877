"""What a scenario may say: strict frozen classes, SI units in the names of the fields.

`mechanism` holds bodies and joints, `medium` the laws, `method` the choice of solver, `scenario` the run around them.
"""

from granular_contact.config.schema.ball_laws import (
    Allen,
    Bingham,
    KatsuragiDurian,
    LinearDepth,
    Poncelet,
    TsimringVolfson,
)
from granular_contact.config.schema.bar_laws import Albert, Hill, LeeMarghitu, VerticalStatic
from granular_contact.config.schema.bed import Bed, BedLayer, FloorContact
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
from granular_contact.config.schema.medium import LAWS, AnyLaw, Media, Medium
from granular_contact.config.schema.method import Method, Reduced
from granular_contact.config.schema.provenance import Range
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
from granular_contact.config.schema.surface_laws import Drft, Rft, Rft3d, RftCoefficients

__all__ = [
    "LAWS",
    "Albert",
    "Allen",
    "AnyLaw",
    "Bed",
    "BedLayer",
    "Bingham",
    "Body",
    "CylinderShape",
    "DiscShape",
    "Drft",
    "Elastoplastic",
    "Flexible",
    "FloorContact",
    "Friction",
    "Hill",
    "Hinge",
    "Impact",
    "Joint",
    "KatsuragiDurian",
    "LeeMarghitu",
    "LinearDepth",
    "Link",
    "Load",
    "Media",
    "Medium",
    "Method",
    "Model",
    "Output",
    "Poncelet",
    "Range",
    "Reduced",
    "Rft",
    "Rft3d",
    "RftCoefficients",
    "Rigid",
    "Scenario",
    "Shape",
    "Smooth",
    "Solver",
    "TsimringVolfson",
    "VerticalStatic",
    "Weld",
]
