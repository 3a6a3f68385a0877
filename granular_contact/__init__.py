"""Links striking and moving in sand: a plugin for the multibody engine Exudyn.

Two doors. For runs from YAML: `load` a config, `build` its scene and `simulate` it, or the command line; a scenario
with other values is `scenario.replace({"medium.eta_d": 5})`. For an Exudyn model of your own: `GranularBed` with a
medium, for example `preset("play_sand")` or a law with numbers of your own; a law of your own is a `Law`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from granular_contact.config.add_law import add_law as add_law
    from granular_contact.config.load import load as load
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
    from granular_contact.multibody.bed import GranularBed as GranularBed
    from granular_contact.run import run as simulate  # noqa: F401
    from granular_contact.scene.build import build as build
    from granular_contact.scene.media import preset as preset
    from granular_contact.studies.sweep.calls import sweep as sweep

# Loaded when first asked for: reading a config must not load the engine, nor a vacuum run the compiler.
_HOMES = {
    "add_law": "config.add_law",
    "build": "scene.build",
    "load": "config.load",
    "preset": "scene.media",
    "simulate": "run",
    "sweep": "studies.sweep.calls",
    "GranularBed": "multibody.bed",
    "Elastoplastic": "laws.static_friction",
    "Smooth": "laws.static_friction",
    "Floor": "laws.floor",
    "Law": "laws.law",
    "Layer": "laws.layer",
    "Albert": "laws.albert",
    "Allen": "laws.allen",
    "Bingham": "laws.bingham",
    "Drft": "laws.drft",
    "Hill": "laws.hill",
    "KatsuragiDurian": "laws.katsuragi_durian",
    "LeeMarghitu": "laws.lee_marghitu",
    "LinearDepth": "laws.linear_depth",
    "Poncelet": "laws.poncelet",
    "Rft": "laws.rft",
    "Rft3d": "laws.rft3d",
    "RftCoefficients": "laws.rft",
    "TsimringVolfson": "laws.tsimring_volfson",
    "VerticalResistance": "laws.lee_marghitu",
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    home = import_module(f"{__name__}.{_HOMES[name]}")
    return getattr(home, "run" if name == "simulate" else name)
