"""A law from outside the package, in YAML."""

from __future__ import annotations

from granular_contact.config import allowed
from granular_contact.config.schema import Bed, BedLayer, Scenario
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.law import Law


def add_law(law: type[Law]) -> None:
    """Let `medium: {law: TAG, ...}` name a law of your own, in configs that this process reads from now on.

    In Python the law needs no more than its class, see `laws.law`.

    Raises
    ------
    ValueError
        Another law has its tag.
    TypeError
        The class says nothing of its equation, terms, shapes or constants.
    """
    lacking = [name for name in ("equation", "terms", "takes", "constants") if not hasattr(law, name)]
    if lacking:
        raise TypeError(f"{law.__name__} has no {', '.join(lacking)}; every law says them of itself")
    if LAWS.setdefault(law.tag(), law) is not law:
        raise ValueError(f"got the tag {law.tag()!r} for {law.__name__}, which another law has")
    for part in (BedLayer, Bed, Scenario):
        part.model_rebuild(force=True)
    allowed.root.cache_clear()
