"""Schema of a mechanism: bodies, the tree of joints, loop closures, and a chain.

The check that bodies and joints form a tree with the ground as its root uses names alone. So it also works for a
mechanism with faulty numbers.
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


# Of a chain: the name of its parent, and the names of its links and hinges.
Names = tuple[str, list[str], list[str]]


def mechanism_faults(model: Any) -> Faults:
    """Faults in the structure of a model, in the plane or in space. All its values must be valid one by one."""
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
    """Faults in the structure of a mechanism, with paths below the model.

    Parameters
    ----------
    bodies
        Names of the bodies.
    joints
        Parent and child of each joint of the tree, by the name of the joint.
    closures
        Parent and child of each joint that closes a loop.
    chain
        Parent, links and hinges of the chain; None without one.
    complete
        False if `joints` lacks joints whose parent or child could not be read. A body without a joint is then no fault.
    """
    kinds = {"bodies": bodies, "joints": joints, "closures": closures}
    faults = [fault for kind, given in kinds.items() for fault in _name_faults(kind, given)]
    taken = "is the name of a joint already; give another"
    faults += [(("closures", name), f"{name} {taken}") for name in closures if name in joints]
    all_bodies, all_joints = dict.fromkeys(bodies), dict(joints)
    if chain is not None:
        parent, links, hinges = chain
        faults += _chain_faults(chain, all_bodies, {**joints, **closures})
        root = GROUND if parent in links else parent  # (`_chain_faults` reports a link as parent)
        all_joints |= zip(hinges, zip([root, *links], links, strict=False), strict=True)
        all_bodies |= dict.fromkeys(links)
    joints_by_child: dict[str, list[str]] = defaultdict(list)
    for joint, (parent, child) in all_joints.items():
        if joint in joints:
            faults += _end_faults("joints", joint, parent, child, all_bodies)
        if child in all_bodies:
            joints_by_child[child].append(joint)
    for name, (parent, child) in closures.items():
        faults += _end_faults("closures", name, parent, child, all_bodies)
    for child, (first, *others) in joints_by_child.items():
        message = f"{child} is the child of {first} already; each body has one, and closures close loops"
        faults += [(("joints", name, "child"), message) for name in others if name in joints]
    message = "no joint has {} as its child; each body is the child of one joint"
    faults += [(("bodies", body), message.format(body)) for body in bodies if complete and body not in joints_by_child]
    return faults + _cycle_faults({child: names[0] for child, names in joints_by_child.items()}, joints, all_joints)


def _chain_faults(chain: Names, bodies: Collection[str], joints: Collection[str]) -> list[LocalFault]:
    """Faults of the parent of a chain and of the names of its links and hinges.

    bodies, joints: names of all other bodies and joints.
    """
    parent, links, hinges = chain
    faults: list[LocalFault] = []
    for key, members, others, noun in (("link_name", links, bodies, "body"), ("hinge_name", hinges, joints, "joint")):
        if members and not _NAME.fullmatch(members[0]):
            faults.append((("chain", key), f"got the name {members[0].removesuffix('_1')!r}; {_ALLOWED}"))
        clash = next((name for name in members if name in others), None)
        if clash is not None:
            faults.append((("chain", key), f"{clash} is the name of a {noun} already; give another"))
    if parent not in bodies and parent != GROUND:
        message = f"{parent} is a link of this chain" if parent in links else no_such("body", parent, [GROUND, *bodies])
        faults.append((("chain", "parent"), message))
    return faults


def _name_faults(kind: str, names: Collection[str]) -> list[LocalFault]:
    """Faults of names of bodies, joints or closures: characters that are not allowed, names that are reserved."""
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
    """Faults of the parent and the child of a joint."""
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
    joint_by_child: Mapping[str, str], written: Collection[str], joints: Mapping[str, tuple[str, str]]
) -> list[LocalFault]:
    """One fault for each cycle of joints, at the joint of its first body.

    A joint that connects a body to itself is reported by `_end_faults`.

    Parameters
    ----------
    joint_by_child
        Name of the joint whose child is a body, by the name of the body.
    written
        Names of the joints that the model names itself. The others are hinges of its chain; their fault is at the
        parent of the chain.
    joints
        Parent and child of each joint.
    """
    faults: list[LocalFault] = []
    visited: set[str] = set()
    for start in joint_by_child:
        walk: list[str] = []
        body = start
        while body in joint_by_child and body not in visited:
            visited.add(body)
            walk.append(body)
            body = joints[joint_by_child[body]][0]
        if body in walk and walk.index(body) < len(walk) - 1:
            loop = [*walk[walk.index(body) :], body]
            message = f"{' -> '.join(reversed(loop))} is a closed chain; each body must be connected to the ground"
            path: tuple[str, ...] = ("joints", joint_by_child[body], "parent")
            faults.append((path if joint_by_child[body] in written else ("chain", "parent"), message))
    return faults


class Model(Strict):
    """A mechanism in the plane, x horizontal and y up, without its initial state."""

    in_space: Literal[False] = False
    """false: a model in the plane; true: a model in space, which has other keys."""
    name: Text
    """Name of the mechanism, for messages."""
    description: Text = ""
    """A sentence on the mechanism, for readers."""
    bodies: dict[str, Body] = Field(default_factory=dict)
    """Bodies by name."""
    joints: dict[str, Joint] = Field(default_factory=dict)
    """Joints by name. They form a tree with the ground as its root: each body is the child of exactly one joint."""
    closures: dict[str, Closure] = Field(default_factory=dict)
    """Joints that close kinematic loops, by name. Both their bodies are already connected to the ground by `joints`."""
    chain: Chain | None = None
    """A row of equal links on hinges, in addition to the bodies and joints above; null: none."""

    @cached_property
    def all_bodies(self) -> dict[str, Body]:
        """Bodies by name, then the links of the chain."""
        return self.bodies | (self.chain.expanded()[0] if self.chain is not None else {})

    @cached_property
    def all_joints(self) -> dict[str, Joint]:
        """Joints of the tree by name, then the hinges of the chain."""
        return self.joints | (self.chain.expanded()[1] if self.chain is not None else {})

    def _faults(self) -> Faults:
        return mechanism_faults(self)
