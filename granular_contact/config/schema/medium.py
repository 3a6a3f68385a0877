"""Schema of a granular medium: one class a law, named by the key `law`. A new law is a class and a line in `LAWS`."""

from __future__ import annotations

from typing import Annotated

from granular_contact.config.schema.ball_laws import (
    Allen,
    Bingham,
    KatsuragiDurian,
    LinearDepth,
    Poncelet,
    TsimringVolfson,
)
from granular_contact.config.schema.bar_laws import Albert, Hill, LeeMarghitu
from granular_contact.config.schema.provenance import MediumBase
from granular_contact.config.schema.surface_laws import Drft, Rft, Rft3d
from granular_contact.values.strict import OneOrMore, Tagged

LAWS: dict[str, type[MediumBase]] = {
    "lee_marghitu": LeeMarghitu,
    "albert": Albert,
    "hill": Hill,
    "rft": Rft,
    "drft": Drft,
    "rft3d": Rft3d,
    "bingham": Bingham,
    "poncelet": Poncelet,
    "allen": Allen,
    "linear_depth": LinearDepth,
    "tsimring_volfson": TsimringVolfson,
    "katsuragi_durian": KatsuragiDurian,
}
AnyLaw = (
    LeeMarghitu
    | Albert
    | Hill
    | Rft
    | Drft
    | Rft3d
    | Bingham
    | Poncelet
    | Allen
    | LinearDepth
    | TsimringVolfson
    | KatsuragiDurian
)
# For the type checker this is the union of all laws; at run time `LAWS` decides.
Medium = Annotated[AnyLaw, Tagged("law", LAWS)]
Media = Annotated[tuple[Medium, ...], OneOrMore()]
