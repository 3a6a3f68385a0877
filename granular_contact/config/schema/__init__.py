"""What a scenario may say: strict frozen classes, SI units in the names of the fields.

`mechanism` holds the bodies and chains, `shapes` what they are made of, `joints` and `model` what becomes of them,
`initial`, `drives` and `signals` what moves them, `bed` the media and where they lie, `wheel` the run of one wheel,
`method` the choice of solver, `scenario` the run around them. `robot` is a model from a robot file, `space` holds
mechanisms in space; `sweep`, `optimise` and `fit` are other files.
"""

# mypy: implicit-reexport
# ruff: noqa: F401

from granular_contact.config.schema.bed import Bed, BedLayer, Medium
from granular_contact.config.schema.drives import AnyDrive, External, Force, HingeControl, Motion, Torque
from granular_contact.config.schema.initial import Initial, JointStart
from granular_contact.config.schema.joints import Closure, Free, Hinge, HingeClosure, Joint, Slider, SliderClosure, Weld
from granular_contact.config.schema.mechanism import Body, Flexible, Link, Rigid
from granular_contact.config.schema.method import AnyMethod, Engine, Minimal, Reduced
from granular_contact.config.schema.model import Model
from granular_contact.config.schema.scenario import Load, Output, Scenario, Solver
from granular_contact.config.schema.signals import AnySignal, Buehler, Constant, Csv, Ramp, Shared, Sine, Table
