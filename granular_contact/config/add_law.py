"""A law from outside the package, in YAML."""

from __future__ import annotations

from pydantic import BaseModel

from granular_contact.config import allowed
from granular_contact.config.schema import Bed, BedLayer, Scenario
from granular_contact.errors import of_type
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.functions import check_law
from granular_contact.laws.law import Law


def add_law(law: type[Law]) -> None:
    """Register a law of your own, so that configs can name it: `medium: {law: TAG, ...}`.

    It counts for configs that this process reads from now on. In Python the class alone is enough, see `laws.law`.

    Parameters
    ----------
    law : type of Law
        The class; its tag is the value of its field `law`.

    Raises
    ------
    ValueError
        Another law has this tag.
    TypeError
        The class lacks its equation, terms, shapes or constants, or kernels can't call its functions; with those that
        are wanted.

    Examples
    --------
    >>> from granular_contact import add_law
    >>> from granular_contact.laws.albert import Albert
    >>> add_law(Albert)  # a law that is registered already stays so
    """
    of_type("law", law, type, "a subclass of Law")
    check_law(law)
    held = LAWS.get(law.tag())
    if held is law:
        return
    again = held is not None and (held.__module__, held.__qualname__) == (law.__module__, law.__qualname__)
    if held is not None and not again:  # (a cell of a notebook that is run again defines its class anew)
        raise ValueError(f"got the tag {law.tag()!r} for {law.__name__}, which another law has")
    LAWS[law.tag()] = law
    changed: list[type[BaseModel]] = [BedLayer, Bed, Scenario, *Scenario.__subclasses__()]
    for part in changed:
        part.model_rebuild(force=True)
    allowed.forget()
