"""Links striking and moving in sand: a plugin for the multibody engine Exudyn.

Two doors. For runs from YAML: `load` a config, `build` its scene and `simulate` it, or the command line; a scenario
with other values is `scenario.replace({"medium.eta_d": 5})`. For an Exudyn model of your own: `GranularBed` with a
medium, for example `preset("play_sand")` or a law with numbers of your own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from granular_contact.config import load
    from granular_contact.media.albert import Albert
    from granular_contact.media.allen import Allen
    from granular_contact.media.bingham import Bingham
    from granular_contact.media.drft import Drft
    from granular_contact.media.floor import Floor
    from granular_contact.media.hill import Hill
    from granular_contact.media.katsuragi_durian import KatsuragiDurian
    from granular_contact.media.layer import Layer
    from granular_contact.media.lee_marghitu import LeeMarghitu, VerticalResistance
    from granular_contact.media.linear_depth import LinearDepth
    from granular_contact.media.poncelet import Poncelet
    from granular_contact.media.rft import Coefficients as RftCoefficients
    from granular_contact.media.rft import Rft
    from granular_contact.media.rft3d import Rft3d
    from granular_contact.media.static_friction import Elastoplastic, Smooth
    from granular_contact.media.tsimring_volfson import TsimringVolfson
    from granular_contact.multibody.bed import GranularBed
    from granular_contact.run import run as simulate
    from granular_contact.scene.build import build
    from granular_contact.scene.media import preset
    from granular_contact.studies.sweep.calls import sweep

# Loaded when first asked for: reading a config must not load the engine, nor a vacuum run the compiler.
_HOMES = {
    "Albert": ("granular_contact.media.albert", "Albert"),
    "Allen": ("granular_contact.media.allen", "Allen"),
    "Bingham": ("granular_contact.media.bingham", "Bingham"),
    "Drft": ("granular_contact.media.drft", "Drft"),
    "Elastoplastic": ("granular_contact.media.static_friction", "Elastoplastic"),
    "Floor": ("granular_contact.media.floor", "Floor"),
    "GranularBed": ("granular_contact.multibody.bed", "GranularBed"),
    "Hill": ("granular_contact.media.hill", "Hill"),
    "KatsuragiDurian": ("granular_contact.media.katsuragi_durian", "KatsuragiDurian"),
    "Layer": ("granular_contact.media.layer", "Layer"),
    "LeeMarghitu": ("granular_contact.media.lee_marghitu", "LeeMarghitu"),
    "LinearDepth": ("granular_contact.media.linear_depth", "LinearDepth"),
    "Poncelet": ("granular_contact.media.poncelet", "Poncelet"),
    "Rft": ("granular_contact.media.rft", "Rft"),
    "Rft3d": ("granular_contact.media.rft3d", "Rft3d"),
    "RftCoefficients": ("granular_contact.media.rft", "Coefficients"),
    "Smooth": ("granular_contact.media.static_friction", "Smooth"),
    "TsimringVolfson": ("granular_contact.media.tsimring_volfson", "TsimringVolfson"),
    "VerticalResistance": ("granular_contact.media.lee_marghitu", "VerticalResistance"),
    "build": ("granular_contact.scene.build", "build"),
    "load": ("granular_contact.config", "load"),
    "preset": ("granular_contact.scene.media", "preset"),
    "simulate": ("granular_contact.run", "run"),
    "sweep": ("granular_contact.studies.sweep.calls", "sweep"),
}

__all__ = [
    "Albert",
    "Allen",
    "Bingham",
    "Drft",
    "Elastoplastic",
    "Floor",
    "GranularBed",
    "Hill",
    "KatsuragiDurian",
    "Layer",
    "LeeMarghitu",
    "LinearDepth",
    "Poncelet",
    "Rft",
    "Rft3d",
    "RftCoefficients",
    "Smooth",
    "TsimringVolfson",
    "VerticalResistance",
    "build",
    "load",
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
