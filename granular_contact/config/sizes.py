"""Numbers so large that their powers overflow."""

from __future__ import annotations

from collections.abc import Iterator

from granular_contact.config.messages import got
from granular_contact.config.tree import Items, Mapping, Node, Path, Scalar
from granular_contact.errors import Fault

LARGEST = 1e60  # in any unit: the fifth power, of which a second moment times a density is, is still a number


def too_large(node: Node, path: Path = ()) -> Iterator[Fault]:
    """A fault for every number of a tree that is beyond LARGEST."""
    if isinstance(node, Mapping):
        for key, entry in node.nodes.items():
            yield from too_large(entry, (*path, key))
    elif isinstance(node, Items):
        for i, entry in enumerate(node.nodes):
            yield from too_large(entry, (*path, i))
    elif isinstance(node, Scalar) and isinstance(node.value, int | float) and LARGEST < abs(node.value) < float("inf"):
        yield node.position.fault(path, f"got {got(node)}; allowed are numbers up to {LARGEST:g} in size")
