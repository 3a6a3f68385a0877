"""Schema of a mechanism: bodies, the tree of joints, loop closures, and a chain.

Whether bodies and joints form a tree with the ground as its root needs names only, so that mechanisms with faulty
numbers can be checked, too.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Mapping
from functools import cached_property
from typing import Any, Literal

from pydantic import Field

from granular_contact.config.schema.joints import Closure, Joint
from granular_contact.config.schema.mechanism import Body, Chain, names
from granular_contact.values.strict import Faults, LocalFault, Strict, Text, no_such

GROUND = "ground"
_ALLOWED = "letters, digits, _ and - are allowed, - not as the first"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*")


# Of a chain: what it hangs on, and the names of its links and hinges.
Names = tuple[str, list[str], list[str]]


def mechanism_faults(model: Any) -> Faults:
    """Faults of a model, in the plane or in space, all of whose numbers could be read."""
    chain = model.chain
    if not model.bodies and chain is None:
        yield ("bodies",), "is missing or empty; allowed is a mapping of one name or more, or a chain"
    yield from structure_faults(
        model.bodies,
        {name: (joint.parent, joint.child) for name, joint in model.joints.items()},
        closures={name: (joint.parent, joint.child) for name, joint in model.closures.items()},
        chain=chain and (chain.parent, names(chain.link_name, chain.count), names(chain.hinge_name, chain.count)),
    )


def structure_faults(
    bodies: Collection[str],
    joints: Mapping[str, tuple[str, str]],
    *,
    closures: Mapping[str, tuple[str, str]],
    chain: Names | None,
    complete: bool = True,
) -> list[LocalFault]:
    """Faults of a mechanism, with paths below the model.

    Parameters
    ----------
    bodies
        Names of the bodies.
    joints
        Parent and child of each joint.
    closures
        Parent and child of each joint that closes a loop.
    chain
        The links and hinges that a chain adds.
    complete
        False if `joints` lacks some whose ends could not be read; a body without a joint is then no fault.
    """
    kinds = {"bodies": bodies, "joints": joints, "closures": closures}
    faults = [fault for kind, given in kinds.items() for fault in _name_faults(kind, given)]
    again = "is the name of a joint already; give another"
    faults += [(("closures", name), f"{name} {again}") for name in closures if name in joints]
    all_bodies, all_joints = dict.fromkeys(bodies), dict(joints)
    if chain is not None:
        parent, links, hinges = chain
        faults += _chain_faults(chain, all_bodies, {**joints, **closures})
        root = GROUND if parent in links else parent  # which has its fault
        all_joints |= zip(hinges, zip([root, *links], links, strict=False), strict=True)
        all_bodies |= dict.fromkeys(links)
    joints_of: dict[str, list[str]] = defaultdict(list)
    for joint, (parent, child) in all_joints.items():
        if joint in joints:
            faults += _end_faults("joints", joint, parent, child, all_bodies)
        if child in all_bodies:
            joints_of[child].append(joint)
    for name, (parent, child) in closures.items():
        faults += _end_faults("closures", name, parent, child, all_bodies)
    for child, above in joints_of.items():
        words = f"{child} is the child of {above[0]} already; each body has one, and closures close loops"
        faults += [(("joints", name, "child"), words) for name in above[1:] if name in joints]
    words = "no joint has {} as its child; each body is the child of one joint"
    faults += [(("bodies", body), words.format(body)) for body in bodies if complete and body not in joints_of]
    return faults + _cycle_faults({child: names[0] for child, names in joints_of.items()}, joints, all_joints)


def _chain_faults(chain: Names, bodies: Collection[str], joints: Collection[str]) -> list[LocalFault]:
    """Faults of the parent of a chain and of the names of its parts; `bodies` and `joints` are the others."""
    parent, links, hinges = chain
    faults: list[LocalFault] = []
    for key, own, others, what in (("link_name", links, bodies, "body"), ("hinge_name", hinges, joints, "joint")):
        if own and not _NAME.fullmatch(own[0]):
            faults.append((("chain", key), f"got the name {own[0].removesuffix('_1')!r}; {_ALLOWED}"))
        clash = next((name for name in own if name in others), None)
        if clash is not None:
            faults.append((("chain", key), f"{clash} is the name of a {what} already; give another"))
    if parent not in bodies and parent != GROUND:
        what = f"{parent} is a link of this chain" if parent in links else no_such("body", parent, [GROUND, *bodies])
        faults.append((("chain", "parent"), what))
    return faults


def _name_faults(kind: str, names: Collection[str]) -> list[LocalFault]:
    faults: list[LocalFault] = [
        ((kind, name), f"got the name {name!r}; {_ALLOWED}") for name in names if not _NAME.fullmatch(name)
    ]
    if GROUND in names and kind == "bodies":
        faults.append(((kind, GROUND), "the name ground is that of the fixed frame; give the body another"))
    if kind == "bodies" and {"tip", "tip_body"} <= set(names):
        faults.append(((kind, "tip_body"), "its columns are those of the body tip; give one of the two another name"))
    if kind == "joints" and "mean" in names:
        faults.append(((kind, "mean"), "its columns are those of the mean rate; give the joint another name"))
    return faults


def _end_faults(kind: str, joint: str, parent: str, child: str, bodies: Collection[str]) -> list[LocalFault]:
    faults: list[LocalFault] = []
    if parent not in bodies and parent != GROUND:
        faults.append(((kind, joint, "parent"), no_such("body", parent, [GROUND, *bodies])))
    if child == GROUND:
        faults.append(((kind, joint, "child"), "the ground can't be a child"))
    elif child not in bodies:
        faults.append(((kind, joint, "child"), no_such("body", child, list(bodies))))
    elif child == parent:
        faults.append(((kind, joint, "child"), f"joins {child} to itself; parent and child must differ"))
    return faults


def _cycle_faults(
    joint_of: Mapping[str, str], own: Collection[str], joints: Mapping[str, tuple[str, str]]
) -> list[LocalFault]:
    """One fault for each cycle of joints, at the joint of its first body; joints of a body with itself are reported
    elsewhere.

    own: the joints that are written out; the others are those of a chain, which hangs on its parent.
    """
    faults: list[LocalFault] = []
    seen: set[str] = set()
    for start in joint_of:
        chain: list[str] = []
        body = start
        while body in joint_of and body not in seen:
            seen.add(body)
            chain.append(body)
            body = joints[joint_of[body]][0]
        if body in chain and chain.index(body) < len(chain) - 1:
            loop = [*chain[chain.index(body) :], body]
            message = f"{' -> '.join(reversed(loop))} is a closed chain; each body must be connected to the ground"
            path: tuple[str, ...] = ("joints", joint_of[body], "parent")
            faults.append((path if joint_of[body] in own else ("chain", "parent"), message))
    return faults


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
        return self.bodies | (self.chain.expanded()[0] if self.chain is not None else {})

    @cached_property
    def all_joints(self) -> dict[str, Joint]:
        """Joints of the tree by name, the hinges of the chain at the end."""
        return self.joints | (self.chain.expanded()[1] if self.chain is not None else {})

    def _faults(self) -> Faults:
        return mechanism_faults(self)
