"""Faults of a config that pydantic does not report: numbers that are too large, and the structure of faulty models.

pydantic checks the structure of a model, for example bodies without a joint, only if all its values are valid.
"""

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
    """Errors in the structure of a model whose `errors` kept pydantic from checking it; in the form of pydantic."""
    is_checked = all(error["loc"][0] != "model" or error["type"] == FAULTS for error in errors if error["loc"])
    model = tree.plain(tree.find(root, ["model"])[0])
    if is_checked or not isinstance(model, dict):
        return []
    bodies, joints, closures = (model.get(key, {}) for key in ("bodies", "joints", "closures"))
    if not all(isinstance(part, dict) for part in (bodies, joints, closures)):
        return []
    (tree_ends, all_joints_read), (loop_ends, _) = _ends(joints), _ends(closures)
    chain, chain_read = _chain_names(model.get("chain"))
    complete = all_joints_read and chain_read
    faults = structure_faults(bodies, tree_ends, closures=loop_ends, chain=chain, complete=complete)
    return [{"type": FAULTS, "loc": ("model",), "ctx": refusal(faults).context}] if faults else []


def _ends(joints: dict[str, Any]) -> tuple[dict[str, tuple[str, str]], bool]:
    """Parent and child of the joints that have both, and whether all joints have both."""
    ends = {
        name: (joint["parent"], joint["child"])
        for name, joint in joints.items()
        if isinstance(joint, dict) and isinstance(joint.get("parent"), str) and isinstance(joint.get("child"), str)
    }
    return ends, len(ends) == len(joints)


def _chain_names(chain: Any) -> tuple[tuple[str, list[str], list[str]] | None, bool]:
    """Parent, links and hinges of a chain (None without one), and whether these could be read."""
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


LARGEST = 1e60  # in any unit; its fifth power is finite, the highest power in use (density times second moment)


def too_large(node: tree.Node, path: tree.Path = ()) -> Iterator[Fault]:
    """A fault for every number of a tree whose magnitude exceeds LARGEST."""
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
