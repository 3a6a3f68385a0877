"""Links striking and moving in sand: a plugin for the multibody engine Exudyn.

Two doors. For runs from YAML: `load` a config, `build` its scene and `simulate` it, or the command line. For an Exudyn
model of your own: `GranularBed` with a medium, for example `preset("play_sand")`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from granular_contact.config import load
    from granular_contact.media.lee_marghitu import LeeMarghitu, VerticalResistance
    from granular_contact.media.static_friction import Elastoplastic, Smooth
    from granular_contact.multibody.bed import GranularBed
    from granular_contact.run import run as simulate
    from granular_contact.scene.build import build
    from granular_contact.scene.media import preset

# Loaded when first asked for: reading a config must not load the engine, nor a vacuum run the compiler.
_HOMES = {
    "Elastoplastic": ("granular_contact.media.static_friction", "Elastoplastic"),
    "GranularBed": ("granular_contact.multibody.bed", "GranularBed"),
    "LeeMarghitu": ("granular_contact.media.lee_marghitu", "LeeMarghitu"),
    "Smooth": ("granular_contact.media.static_friction", "Smooth"),
    "VerticalResistance": ("granular_contact.media.lee_marghitu", "VerticalResistance"),
    "build": ("granular_contact.scene.build", "build"),
    "load": ("granular_contact.config", "load"),
    "preset": ("granular_contact.scene.media", "preset"),
    "simulate": ("granular_contact.run", "run"),
}

__all__ = [
    "Elastoplastic",
    "GranularBed",
    "LeeMarghitu",
    "Smooth",
    "VerticalResistance",
    "build",
    "load",
    "preset",
    "simulate",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _HOMES[name]
    return getattr(import_module(module), attribute)
