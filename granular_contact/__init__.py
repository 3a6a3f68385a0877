"""Links striking and moving in sand: a plugin for the multibody engine Exudyn.

Two doors. For runs from YAML: `load` a config and `simulate` it, or the command line; `load("runner",
solver={"accuracy": 1e-3})` and `replace(medium={"eta_d": 5})` change values; `Results` have their columns by name and
are plotted, saved and opened; a `Simulation` goes on step by step. For an Exudyn model of your own: `GranularBed` with
a medium, for example `preset("play_sand")` or a law with numbers of your own; a law of your own is a `Law`; in space
with shapes such as `Box` or `Mesh`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from granular_contact.bed.space.shapes import Bar, Box, Capsule, Cone, Cylinder, Mesh, Plate, Sphere
    from granular_contact.config.add_law import add_law
    from granular_contact.config.load import load
    from granular_contact.laws.albert import Albert
    from granular_contact.laws.allen import Allen
    from granular_contact.laws.bingham import Bingham
    from granular_contact.laws.drft import Drft
    from granular_contact.laws.floor import Floor
    from granular_contact.laws.hill import Hill
    from granular_contact.laws.katsuragi_durian import KatsuragiDurian
    from granular_contact.laws.law import Law
    from granular_contact.laws.layer import Layer
    from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
    from granular_contact.laws.linear_depth import LinearDepth
    from granular_contact.laws.poncelet import Poncelet
    from granular_contact.laws.rft import Rft, RftCoefficients
    from granular_contact.laws.rft3d import Rft3d
    from granular_contact.laws.static_friction import Elastoplastic, Smooth
    from granular_contact.laws.tsimring_volfson import TsimringVolfson
    from granular_contact.multibody.bed import GranularBed
    from granular_contact.results import Results
    from granular_contact.scene.build import build
    from granular_contact.scene.media import preset
    from granular_contact.simulation import Simulation, simulate
    from granular_contact.studies.optimise.calls import optimise
    from granular_contact.studies.sweep.calls import sweep

# Loaded when first asked for: reading a config must not load the engine, nor a vacuum run the compiler.
_HOMES = {
    "Albert": ("granular_contact.laws.albert", "Albert"),
    "Allen": ("granular_contact.laws.allen", "Allen"),
    "Bar": ("granular_contact.bed.space.shapes", "Bar"),
    "Bingham": ("granular_contact.laws.bingham", "Bingham"),
    "Box": ("granular_contact.bed.space.shapes", "Box"),
    "Capsule": ("granular_contact.bed.space.shapes", "Capsule"),
    "Cone": ("granular_contact.bed.space.shapes", "Cone"),
    "Cylinder": ("granular_contact.bed.space.shapes", "Cylinder"),
    "Drft": ("granular_contact.laws.drft", "Drft"),
    "Elastoplastic": ("granular_contact.laws.static_friction", "Elastoplastic"),
    "Floor": ("granular_contact.laws.floor", "Floor"),
    "GranularBed": ("granular_contact.multibody.bed", "GranularBed"),
    "Hill": ("granular_contact.laws.hill", "Hill"),
    "KatsuragiDurian": ("granular_contact.laws.katsuragi_durian", "KatsuragiDurian"),
    "Law": ("granular_contact.laws.law", "Law"),
    "Layer": ("granular_contact.laws.layer", "Layer"),
    "LeeMarghitu": ("granular_contact.laws.lee_marghitu", "LeeMarghitu"),
    "LinearDepth": ("granular_contact.laws.linear_depth", "LinearDepth"),
    "Mesh": ("granular_contact.bed.space.shapes", "Mesh"),
    "Plate": ("granular_contact.bed.space.shapes", "Plate"),
    "Poncelet": ("granular_contact.laws.poncelet", "Poncelet"),
    "Results": ("granular_contact.results", "Results"),
    "Rft": ("granular_contact.laws.rft", "Rft"),
    "Rft3d": ("granular_contact.laws.rft3d", "Rft3d"),
    "RftCoefficients": ("granular_contact.laws.rft", "RftCoefficients"),
    "Simulation": ("granular_contact.simulation", "Simulation"),
    "Smooth": ("granular_contact.laws.static_friction", "Smooth"),
    "Sphere": ("granular_contact.bed.space.shapes", "Sphere"),
    "TsimringVolfson": ("granular_contact.laws.tsimring_volfson", "TsimringVolfson"),
    "VerticalResistance": ("granular_contact.laws.lee_marghitu", "VerticalResistance"),
    "add_law": ("granular_contact.config.add_law", "add_law"),
    "build": ("granular_contact.scene.build", "build"),
    "load": ("granular_contact.config.load", "load"),
    "optimise": ("granular_contact.studies.optimise.calls", "optimise"),
    "preset": ("granular_contact.scene.media", "preset"),
    "simulate": ("granular_contact.simulation", "simulate"),
    "sweep": ("granular_contact.studies.sweep.calls", "sweep"),
}

__all__ = [
    "Albert",
    "Allen",
    "Bar",
    "Bingham",
    "Box",
    "Capsule",
    "Cone",
    "Cylinder",
    "Drft",
    "Elastoplastic",
    "Floor",
    "GranularBed",
    "Hill",
    "KatsuragiDurian",
    "Law",
    "Layer",
    "LeeMarghitu",
    "LinearDepth",
    "Mesh",
    "Plate",
    "Poncelet",
    "Results",
    "Rft",
    "Rft3d",
    "RftCoefficients",
    "Simulation",
    "Smooth",
    "Sphere",
    "TsimringVolfson",
    "VerticalResistance",
    "add_law",
    "build",
    "load",
    "optimise",
    "preset",
    "simulate",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _HOMES[name]
    return getattr(import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
