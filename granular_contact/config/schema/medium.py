"""A granular medium in a scenario: one of the laws, named by the key `law`."""

from __future__ import annotations

from typing import Annotated

from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.law import Law
from granular_contact.values.strict import OneOrMore, Tagged

Medium = Annotated[Law, Tagged("law", LAWS)]
Media = Annotated[tuple[Medium, ...], OneOrMore()]
