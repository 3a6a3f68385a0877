"""All laws by their tag."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from granular_contact.laws.albert import Albert
from granular_contact.laws.allen import Allen
from granular_contact.laws.bingham import Bingham
from granular_contact.laws.drft import Drft
from granular_contact.laws.hill import Hill
from granular_contact.laws.katsuragi_durian import KatsuragiDurian
from granular_contact.laws.lee_marghitu import LeeMarghitu
from granular_contact.laws.linear_depth import LinearDepth
from granular_contact.laws.poncelet import Poncelet
from granular_contact.laws.rft import Rft
from granular_contact.laws.rft3d import Rft3d
from granular_contact.laws.tsimring_volfson import TsimringVolfson

LAWS: dict[str, Any] = {
    law.name: law
    for law in (
        LeeMarghitu,
        Albert,
        Hill,
        Rft,
        Drft,
        Rft3d,
        Bingham,
        Poncelet,
        Allen,
        LinearDepth,
        TsimringVolfson,
        KatsuragiDurian,
    )
}

# Those whose source gives a single force at the middle of the immersed part, as `load: {form: resultant}` applies it.
WITH_RESULTANT = (LeeMarghitu.name, Albert.name, Hill.name)


def laws_for(kind: str) -> Collection[str]:
    """Tags of the laws that take a kind of shape."""
    return [tag for tag, law in LAWS.items() if kind in law.takes]
