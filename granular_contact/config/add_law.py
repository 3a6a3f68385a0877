"""Registration of a user's own law, so that configs can name it."""

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

    It is known to all configs that this process reads afterwards. In Python the class alone is enough, see `laws.law`.

    Parameters
    ----------
    law : type of Law
        The class; its tag is the value of its field `law`.

    Raises
    ------
    ValueError
        Another law has this tag.
    TypeError
        The class lacks its equation, terms, shapes or constants, or kernels can't call its functions. The message
        names what is needed.

    Examples
    --------
    >>> from granular_contact import add_law
    >>> from granular_contact.laws.albert import Albert
    >>> add_law(Albert)  # a law that is registered already stays so
    """
    of_type("law", law, type, "a subclass of Law")
    check_law(law)
    registered = LAWS.get(law.tag())
    if registered is law:
        return
    # A notebook cell that runs twice defines its class twice, under the same name.
    name = law.__module__, law.__qualname__
    is_redefined = registered is not None and (registered.__module__, registered.__qualname__) == name
    if registered is not None and not is_redefined:
        raise ValueError(f"got the tag {law.tag()!r} for {law.__name__}, which another law has")
    LAWS[law.tag()] = law
    with_media: list[type[BaseModel]] = [BedLayer, Bed, Scenario, *Scenario.__subclasses__()]
    for schema_class in with_media:
        schema_class.model_rebuild(force=True)
    allowed.clear_cache()
