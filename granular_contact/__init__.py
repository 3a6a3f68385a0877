"""Robots and other mechanisms that move in sand, simulated in the multibody engine Exudyn.

A config in YAML, or the same content as a dict, describes a run:

    load(source, **changes)       read and check a config: `load("runner", solver={"accuracy": 1e-3})`
    simulate(config, control=f)   run it, steered by a function f(time, observations) if there is one -> Results
    Simulation(config)            run it step by step: step, state, restore, reset
    sweep(config, vary)           run many cases, in worker processes -> rows
    ensemble(config, count)       run many seeds of a medium's scatter -> means, quantiles, bands
    optimise(config, parameters)  find the best values of parameters
    build(config)                 check the geometry without a run -> Scene
    Results                       results["tip_y_m"], plot, figures, animation, to_dataframe, save, Results.open

In an Exudyn script of your own, in the plane or in space:

    GranularBed(mbs, medium, surface)   add_rigid, add_line, add_outline, add_ball, add_cables, add_body; attach
    preset(name, **values)              a shipped medium, as `preset("play_sand")`
    Box, Cylinder, Sphere, Capsule, Cone, Plate, Bar, Mesh     shapes in space
    Floor, Layer, Elastoplastic, Smooth                        floor, layers and static friction of a bed

Laws of resistance: each is a class, and an object of it with numbers is a medium. A law of your own is a subclass of
`Law`:

    Rft, Rft3d, Drft, LeeMarghitu, Albert, Hill                                  of bars and plates
    Bingham, Poncelet, Allen, LinearDepth, TsimringVolfson, KatsuragiDurian      of balls
    add_law(MyLaw)                                                               for configs that name it by its tag

See `help(granular_contact.load)` and so on for each of them; the documentation is in docs/.
"""

from __future__ import annotations

import re
from typing import Any

__version__ = "0.2.0.dev0"  # the only place of the version; CONTRIBUTING.md explains its numbers

# The stub file, which editors and type checkers read, lists the public names. Each is imported at its first use, so
# that reading a config does not load the engine, and a run in vacuum does not load the compiler.
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
