"""Whether bodies and joints form a tree that hangs on the ground.

Works on names alone, so that it can be asked about a mechanism whose numbers are faulty too.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Mapping
from difflib import get_close_matches

from granular_contact.config.schema.base import LocalFault

GROUND = "ground"
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")


def structure_faults(
    bodies: Collection[str], joints: Mapping[str, tuple[str, str]], *, complete: bool = True
) -> list[LocalFault]:
    """Faults of a mechanism, with paths below the model.

    Parameters
    ----------
    bodies
        Names of the bodies.
    joints
        Parent and child of each joint.
    complete
        False if `joints` lacks some whose ends could not be read; a body without a joint is then no fault.
    """
    faults = _name_faults("bodies", bodies) + _name_faults("joints", joints)
    joints_of: dict[str, list[str]] = defaultdict(list)
    for joint, (parent, child) in joints.items():
        faults += _end_faults(joint, parent, child, bodies)
        if child in bodies:
            joints_of[child].append(joint)
    for child, names in joints_of.items():
        faults += [
            (("joints", name, "child"), f"{child} is the child of {names[0]} already; one joint holds a body")
            for name in names[1:]
        ]
    if complete:
        faults += [
            (("bodies", body), f"no joint has {body} as its child; each body is the child of one joint")
            for body in bodies
            if body not in joints_of
        ]
    return faults + _cycle_faults({child: names[0] for child, names in joints_of.items()}, joints)


def _name_faults(kind: str, names: Collection[str]) -> list[LocalFault]:
    allowed = "a letter or _, then letters, digits, _ and -, are allowed"
    faults: list[LocalFault] = [
        ((kind, name), f"got the name {name!r}; {allowed}") for name in names if not _NAME.fullmatch(name)
    ]
    if GROUND in names and kind == "bodies":
        faults.append(((kind, GROUND), "the name ground is that of the fixed frame; give the body another"))
    return faults


def _end_faults(joint: str, parent: str, child: str, bodies: Collection[str]) -> list[LocalFault]:
    faults: list[LocalFault] = []
    if parent not in bodies and parent != GROUND:
        faults.append((("joints", joint, "parent"), _unknown_body(parent, [GROUND, *bodies])))
    if child == GROUND:
        faults.append((("joints", joint, "child"), "the ground can't be a child; it moves with nothing"))
    elif child not in bodies:
        faults.append((("joints", joint, "child"), _unknown_body(child, list(bodies))))
    elif child == parent:
        faults.append((("joints", joint, "child"), f"joins {child} to itself; parent and child must differ"))
    return faults


def _unknown_body(name: str, known: list[str]) -> str:
    near = get_close_matches(name, known, 1)
    hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(known)}"
    return f"there is no body {name!r}; {hint}"


def _cycle_faults(joint_of: Mapping[str, str], joints: Mapping[str, tuple[str, str]]) -> list[LocalFault]:
    """One fault for each closed chain, at the joint of its first body; self-joints have their fault already."""
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
            message = f"{' -> '.join(reversed(loop))} is a closed chain; each body must lead back to the ground"
            faults.append((("joints", joint_of[body], "parent"), message))
    return faults
