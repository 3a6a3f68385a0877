"""Public names, each with the module that defines it: for editors and type checkers, and for `__init__.py`."""

from granular_contact.config.add_law import add_law as add_law
from granular_contact.config.load import load as load
from granular_contact.config.load import preset as preset
from granular_contact.engines.exudyn.bed import GranularBed as GranularBed
from granular_contact.laws.albert import Albert as Albert
from granular_contact.laws.allen import Allen as Allen
from granular_contact.laws.bingham import Bingham as Bingham
from granular_contact.laws.drft import Drft as Drft
from granular_contact.laws.floor import Floor as Floor
from granular_contact.laws.hill import Hill as Hill
from granular_contact.laws.katsuragi_durian import KatsuragiDurian as KatsuragiDurian
from granular_contact.laws.law import Law as Law
from granular_contact.laws.layer import Layer as Layer
from granular_contact.laws.lee_marghitu import LeeMarghitu as LeeMarghitu
from granular_contact.laws.lee_marghitu import VerticalResistance as VerticalResistance
from granular_contact.laws.linear_depth import LinearDepth as LinearDepth
from granular_contact.laws.poncelet import Poncelet as Poncelet
from granular_contact.laws.rft import Rft as Rft
from granular_contact.laws.rft import RftCoefficients as RftCoefficients
from granular_contact.laws.rft3d import Rft3d as Rft3d
from granular_contact.laws.static_friction import Elastoplastic as Elastoplastic
from granular_contact.laws.static_friction import Smooth as Smooth
from granular_contact.laws.tsimring_volfson import TsimringVolfson as TsimringVolfson
from granular_contact.results import Results as Results
from granular_contact.sand.space.mesh_shape import Mesh as Mesh
from granular_contact.sand.space.round_shapes import Capsule as Capsule
from granular_contact.sand.space.round_shapes import Cone as Cone
from granular_contact.sand.space.round_shapes import Cylinder as Cylinder
from granular_contact.sand.space.round_shapes import Sphere as Sphere
from granular_contact.sand.space.shapes import Bar as Bar
from granular_contact.sand.space.shapes import Box as Box
from granular_contact.sand.space.shapes import Plate as Plate
from granular_contact.scene.build import build as build
from granular_contact.simulation import Simulation as Simulation
from granular_contact.steering import simulate as simulate
from granular_contact.studies.ensemble.calls import ensemble as ensemble
from granular_contact.studies.optimise.calls import optimise as optimise
from granular_contact.studies.sweep.calls import sweep as sweep

__version__: str
