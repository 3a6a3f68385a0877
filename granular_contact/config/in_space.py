"""Which scenario a tree is of, in the plane or in space; and files that a scenario in space names, by full paths."""

from __future__ import annotations

from pathlib import Path

from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.tree import Items, Mapping, Node, Scalar, child, set_key

IN_SPACE = "in_space"


def is_in_space(root: Node) -> bool:
    """Whether the model of a tree says that it is in space, or tries to."""
    model = child(root, "model") if isinstance(root, Mapping) else None
    return isinstance(model, Mapping) and IN_SPACE in model.nodes


def scenario_class(root: Node) -> type[Scenario]:
    """Class of the scenario of a tree in which the model is resolved; that of space is loaded where it is needed."""
    if not is_in_space(root):
        return Scenario
    from granular_contact.config.schema.space import SpatialScenario

    return SpatialScenario


def with_paths(root: Node, folder: Path) -> Node:
    """The tree with meshes and maps of heights by their full paths; these start from the folder of the file that names
    them, those of an override from `folder`.
    """
    if not is_in_space(root):
        return root
    for key in ("model", "bed"):
        held = child(root, key)
        if isinstance(held, Mapping) and isinstance(root, Mapping):
            root = set_key(root, key, _placed(held, folder), root.keys[key])
    return root


def _placed(node: Node, folder: Path) -> Node:
    if isinstance(node, Items):
        return Items(node.position, tuple(_placed(one, folder) for one in node.nodes))
    if not isinstance(node, Mapping):
        return node
    for key, held in node.nodes.items():
        if key != "file":
            node = set_key(node, key, _placed(held, folder), node.keys[key])
        elif isinstance(held, Scalar) and isinstance(held.value, str) and held.value:
            at = held.position
            base = Path(at.file).parent if at.line is not None else folder
            path = str((base / held.value).resolve())
            node = set_key(node, key, Scalar(at, path, path), node.keys[key])
    return node
