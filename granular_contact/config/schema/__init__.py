"""What a scenario may say: strict frozen classes, SI units in the names of the fields.

`mechanism` holds the bodies, `shapes` what they are made of, `joints`, `chain` and `model` what becomes of them,
`initial`, `drives` and `signals` what moves them, `medium` the laws, `bed` where the media lie, `method` the choice of
solver, `scenario` the run around them.
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
from granular_contact.config.schema.medium import LAWS, AnyLaw, Media, Medium
from granular_contact.config.schema.method import Method, Minimal, Reduced
from granular_contact.config.schema.model import Model
from granular_contact.config.schema.provenance import Range
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
from granular_contact.config.schema.surface_laws import Drft, Rft, Rft3d, RftCoefficients

__all__ = [
    "LAWS",
    "Albert",
    "Allen",
    "AnyDrive",
    "AnyLaw",
    "AnySignal",
    "ArcShape",
    "Bed",
    "BedLayer",
    "Bingham",
    "Body",
    "Buehler",
    "Chain",
    "Closure",
    "Constant",
    "Csv",
    "CylinderShape",
    "DiscShape",
    "Drft",
    "Drive",
    "Elastoplastic",
    "Flexible",
    "FloorContact",
    "FootShape",
    "Force",
    "Free",
    "Friction",
    "Hill",
    "Hinge",
    "HingeClosure",
    "HingeControl",
    "Initial",
    "Joint",
    "JointStart",
    "KatsuragiDurian",
    "LeeMarghitu",
    "LinearDepth",
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
    "Poncelet",
    "Ramp",
    "Range",
    "Reduced",
    "Rft",
    "Rft3d",
    "RftCoefficients",
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
    "TsimringVolfson",
    "VerticalStatic",
    "Weld",
]
