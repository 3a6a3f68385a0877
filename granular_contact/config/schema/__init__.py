"""Schema of all files: strict frozen classes with SI units in the names of the fields.

scenario                     a run as a whole; its load, solver and output
model, mechanism, shapes     a mechanism: its bodies, links and chains, and the shapes of rigid bodies
joints                       joints of a mechanism, and their springs, stops and friction
initial, drives, signals     initial state, drives and their signals over time
bed                          media, surface, layers, floor and container
wheel                        single-wheel tests
method                       methods of solution
robot                        models from robot files
space                        mechanisms in space
sweep, optimise, fit         files of many runs

The text under a field is its description in the reference and in the JSON Schema for editors.
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
