"""All laws by their tag in YAML. A new law is a file in this folder and a line in `LAWS`.

Schema, messages, reference and the checks of `tests/laws` follow from that line.
"""

from __future__ import annotations

from granular_contact.laws.albert import Albert
from granular_contact.laws.allen import Allen
from granular_contact.laws.bingham import Bingham
from granular_contact.laws.drft import Drft
from granular_contact.laws.hill import Hill
from granular_contact.laws.katsuragi_durian import KatsuragiDurian
from granular_contact.laws.law import Law
from granular_contact.laws.lee_marghitu import LeeMarghitu
from granular_contact.laws.linear_depth import LinearDepth
from granular_contact.laws.poncelet import Poncelet
from granular_contact.laws.pressure_sinkage import PressureSinkage
from granular_contact.laws.reece import Reece
from granular_contact.laws.rft import Rft
from granular_contact.laws.rft3d import Rft3d
from granular_contact.laws.table import StressTable
from granular_contact.laws.tsimring_volfson import TsimringVolfson

LAWS: dict[str, type[Law]] = {
    law.tag(): law
    for law in (
        LeeMarghitu,
        Albert,
        Hill,
        Rft,
        Drft,
        Rft3d,
        PressureSinkage,
        Reece,
        StressTable,
        Bingham,
        Poncelet,
        Allen,
        LinearDepth,
        TsimringVolfson,
        KatsuragiDurian,
    )
}


def laws_for(kind: str) -> list[str]:
    """Tags of the laws that act on a kind of shape.

    Parameters
    ----------
    kind : str
        One of `laws.kinds.Kind`.

    Returns
    -------
    list of str
        Values of the key `law` in YAML, in the order of `LAWS`.
    """
    return [tag for tag, law in LAWS.items() if kind in law.takes]
