"""Which scenario a tree is of, in the plane or in space; and files that a scenario in space names, by full paths."""

from __future__ import annotations

from functools import partial
from pathlib import Path as FilePath

from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.tree import Mapping, Node, Path, Scalar, child, rewritten, set_key, under

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


def with_paths(root: Node, folder: FilePath) -> Node:
    """The tree with meshes and maps of heights by their full paths; these start from the folder of the file that names
    them, those of an override from `folder`.
    """

    def change(node: Mapping, _: Path) -> Node | None:
        held = node.nodes.get("file")
        if not (isinstance(held, Scalar) and isinstance(held.value, str) and held.value):
            return None
        base = FilePath(held.position.file).parent if held.position.line is not None else folder
        path = str((base / held.value).resolve())
        return set_key(node, "file", Scalar(held.position, path, path), node.keys["file"])

    for key in ("model", "bed") if is_in_space(root) else ():
        root = under(root, key, partial(rewritten, change=change, path=(key,)))
    return root
