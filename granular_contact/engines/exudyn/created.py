"""`mbs.CreateGranularBed(...)`: `GranularBed` as one of the methods `Create...` of Exudyn's systems.

Exudyn binds its own `Create...` functions by the decorator `extends` of `exudyn.misc.extensionRegistry`, which also
refuses a name that is taken. Exudyn does not document `misc`. If `misc` is missing or does not bind, `bind` raises
ImportError.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import metadata
from typing import Any

import exudyn as exu
from numpy.typing import ArrayLike

from granular_contact.config.load import preset
from granular_contact.engines.exudyn.bed import GranularBed
from granular_contact.laws.floor import Floor
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.laws.static_friction import Elastoplastic, Smooth

NAME = "CreateGranularBed"


def create_granular_bed(
    mbs: Any,
    medium: str | Law | Layer | Sequence[Law | Layer],
    surface: ArrayLike = 0.0,
    *,
    slope: ArrayLike = 0.0,
    up: ArrayLike | None = None,
    gravity: float = 9.81,
    static: Elastoplastic | Smooth | None = None,
    form: str = "distributed",
    end_cap: bool = False,
    floor: Floor | None = None,
) -> GranularBed:
    """Create a granular bed; then add bodies to it, and attach it before `mbs.Assemble()`.

    Parameters
    ----------
    mbs : exudyn.MainSystem
        The system.
    medium : str, Law, Layer, or sequence of these
        The name of a shipped medium, such as "play_sand", or a medium as in `GranularBed`.
    surface, slope, up, gravity, static, form, end_cap, floor
        As in `GranularBed`; lengths in m, gravity in m/s2.

    Returns
    -------
    GranularBed
        The bed. `add_rigid`, `add_line`, `add_outline`, `add_ball` and `add_cables` add bodies in the plane; with `up`,
        `add_body` and `add_cables` add bodies in space. `attach` puts the load into the system.

    Raises
    ------
    ConfigError
        No shipped medium has that name.
    ValueError
        As in `GranularBed`.
    """
    media = preset(medium) if isinstance(medium, str) else medium
    options: dict[str, Any] = {"gravity": gravity, "static": static, "form": form, "end_cap": end_cap, "floor": floor}
    return GranularBed(mbs, media, surface, slope=slope, up=up, **options)


def bind(system: Any = exu.MainSystem) -> None:
    """Make `create_granular_bed` a method of Exudyn's systems; a second call does nothing.

    Raises
    ------
    ImportError
        This version of Exudyn cannot bind it.
    """
    if getattr(system, NAME, create_granular_bed) is not create_granular_bed:
        raise ImportError(_refusal("the name is taken"))
    try:
        from exudyn.misc.extensionRegistry import extends, install

        extends(system, NAME)(create_granular_bed)
        install()
    except (ImportError, AttributeError, TypeError) as error:
        raise ImportError(_refusal(str(error))) from error
    if getattr(system, NAME, None) is not create_granular_bed:
        raise ImportError(_refusal("exudyn.misc.extensionRegistry binds nothing"))


def _refusal(why: str) -> str:
    return (
        f"Exudyn {metadata.version('exudyn')} takes no mbs.{NAME} ({why}): "
        "from granular_contact import GranularBed, and GranularBed(mbs, ...) is the same"
    )
