"""Robots and other mechanisms that move in sand, simulated in the multibody engine Exudyn.

A config in YAML, or the same as a dict, is a run:

    load(source, **changes)       read and check a config: `load("runner", solver={"accuracy": 1e-3})`
    simulate(config, control=f)   run it, steered by a function f(time, seen) if there is one -> Results
    Simulation(config)            run it step by step: step, state, restore, reset
    sweep(config, vary)           run many, in processes of their own -> rows
    ensemble(config, count)       run many seeds of a medium's scatter -> means, quantiles, bands
    optimise(config, parameters)  find the values that are best
    build(config)                 check the geometry, without a run -> Scene
    Results                       results["tip_y_m"], plot, figures, animation, to_dataframe, save, Results.open

In an Exudyn script of your own, in the plane or in space:

    GranularBed(mbs, medium, surface)   add_rigid, add_line, add_outline, add_ball, add_cables, add_body; attach
    preset(name, **values)              a medium that is shipped, as `preset("play_sand")`
    Box, Cylinder, Sphere, Capsule, Cone, Plate, Bar, Mesh     shapes in space
    Floor, Layer, Elastoplastic, Smooth                        what else a bed may have

Laws of resistance, each a class whose numbers make a medium; a law of your own is a subclass of `Law`:

    Rft, Rft3d, Drft, LeeMarghitu, Albert, Hill                                  of bars and plates
    Bingham, Poncelet, Allen, LinearDepth, TsimringVolfson, KatsuragiDurian      of balls
    add_law(MyLaw)                                                               for configs that name it by its tag

`help(granular_contact.load)` and so on say the rest; the documentation is in docs/.
"""

from __future__ import annotations

import re
from typing import Any

__version__ = "0.2.0.dev0"  # the only place; CONTRIBUTING.md says what it means

# What is public stands once, in the stub that editors and type checkers read. It is loaded when first asked for:
# reading a config must not load the engine, nor a vacuum run the compiler.
with open(__file__.rpartition(".")[0] + ".pyi", encoding="utf-8") as _stub:
    _HOMES = {name: home for home, name in re.findall(r"^from (\S+) import (\w+) as \2$", _stub.read(), re.M)}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return __all__
