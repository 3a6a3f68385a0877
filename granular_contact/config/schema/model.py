"""Schema of a mechanism: bodies, the tree of joints, loop closures, and a chain."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

from pydantic import Field

from granular_contact.config.schema.chain import Chain, expand
from granular_contact.config.schema.joints import Closure, Joint
from granular_contact.config.schema.mechanism import Body
from granular_contact.config.schema.structure import mechanism_faults
from granular_contact.values.strict import Faults, Strict, Text


class Model(Strict):
    """A mechanism in the plane, x horizontal and y up, before it is placed and set in motion."""

    in_space: Literal[False] = False
    """true: a model in space, whose keys are others."""
    name: Text
    description: Text = ""
    bodies: dict[str, Body] = Field(default_factory=dict)
    joints: dict[str, Joint] = Field(default_factory=dict)
    """The tree of joints: each body is the child of one, and the ground is the root."""
    closures: dict[str, Closure] = Field(default_factory=dict)
    """Joints that close loops, between bodies that the tree already connects to the ground."""
    chain: Chain | None = None
    """Many equal links in a row, besides the bodies and joints."""

    @cached_property
    def all_bodies(self) -> dict[str, Body]:
        """Bodies by name, the links of the chain at the end."""
        return self.bodies | (expand(self.chain)[0] if self.chain is not None else {})

    @cached_property
    def all_joints(self) -> dict[str, Joint]:
        """Joints of the tree by name, the hinges of the chain at the end."""
        return self.joints | (expand(self.chain)[1] if self.chain is not None else {})

    def _faults(self) -> Faults:
        return mechanism_faults(self)
