"""What is wrong with a tree before pydantic reads it, or where it does not get that far: loose bodies, huge numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from granular_contact.config import tree
from granular_contact.config.messages import got
from granular_contact.config.schema.mechanism import names
from granular_contact.config.schema.model import GROUND, structure_faults
from granular_contact.errors import Fault
from granular_contact.values.strict import FAULTS, refusal


def structure_errors(root: tree.Node, errors: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """What is wrong with the tree of bodies, for a model in which pydantic did not get as far as to ask."""
    asked = all(error["loc"][0] != "model" or error["type"] == FAULTS for error in errors if error["loc"])
    model = tree.plain(tree.find(root, ["model"])[0])
    if asked or not isinstance(model, dict):
        return []
    bodies, joints, closures = (model.get(key, {}) for key in ("bodies", "joints", "closures"))
    if not all(isinstance(part, dict) for part in (bodies, joints, closures)):
        return []
    (tree_ends, read), (loop_ends, _) = _ends(joints), _ends(closures)
    chain, understood = _chain_names(model.get("chain"))
    complete = read and understood
    faults = structure_faults(bodies, tree_ends, closures=loop_ends, chain=chain, complete=complete)
    return [{"type": FAULTS, "loc": ("model",), "ctx": refusal(faults).context}] if faults else []


def _ends(joints: dict[str, Any]) -> tuple[dict[str, tuple[str, str]], bool]:
    """Parent and child of the joints that have both, and whether all have."""
    ends = {
        name: (joint["parent"], joint["child"])
        for name, joint in joints.items()
        if isinstance(joint, dict) and isinstance(joint.get("parent"), str) and isinstance(joint.get("child"), str)
    }
    return ends, len(ends) == len(joints)


def _chain_names(chain: Any) -> tuple[tuple[str, list[str], list[str]] | None, bool]:
    """What a chain adds, None without one, and whether that could be read."""
    if chain is None:
        return None, True
    if not isinstance(chain, dict):
        return None, False
    parent = chain.get("parent", GROUND)
    links = names(chain.get("link_name", "link"), chain.get("count"))
    hinges = names(chain.get("hinge_name", "hinge"), chain.get("count"))
    if not links or not hinges or not isinstance(parent, str):
        return None, False
    return (parent, links, hinges), True


LARGEST = 1e60  # in any unit: the fifth power, of which a second moment times a density is, is still a number


def too_large(node: tree.Node, path: tree.Path = ()) -> Iterator[Fault]:
    """A fault for every number of a tree that is beyond LARGEST."""
    if isinstance(node, tree.Mapping):
        for key, entry in node.nodes.items():
            yield from too_large(entry, (*path, key))
    elif isinstance(node, tree.Items):
        for i, entry in enumerate(node.nodes):
            yield from too_large(entry, (*path, i))
    elif (
        isinstance(node, tree.Scalar)
        and isinstance(node.value, int | float)
        and LARGEST < abs(node.value) < float("inf")
    ):
        yield node.position.fault(path, f"got {got(node)}; allowed are numbers up to {LARGEST:g} in size")
