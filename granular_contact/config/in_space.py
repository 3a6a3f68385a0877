"""Which scenario a tree is of, in the plane or in space; and files that a scenario in space names, by full paths."""

from __future__ import annotations

from pathlib import Path as FilePath

from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.tree import Mapping, Node, Path, Scalar, find, rewritten, set_key


def scenario_class(root: Node) -> type[Scenario]:
    """Class of the scenario of a tree in which the model is resolved: that of space where it says so, or tries to."""
    held, missing = find(root, ("model", "in_space"))
    if missing or (isinstance(held, Scalar) and held.value is False):
        return Scenario
    from granular_contact.config.schema.space import SpatialScenario

    return SpatialScenario


def with_paths(node: Node, key: str, folder: FilePath) -> Node:
    """The tree under a key of a scenario with meshes and maps of heights by their full paths; these start from the
    folder of the file that names them, those of an override from `folder`.
    """

    def change(node: Mapping, _: Path) -> Node | None:
        held = node.nodes.get("file")
        if not (isinstance(held, Scalar) and isinstance(held.value, str) and held.value):
            return None
        base = FilePath(held.position.file).parent if held.position.line is not None else folder
        path = str((base / held.value).resolve())
        return set_key(node, "file", Scalar(held.position, path, path), node.keys["file"])

    return rewritten(node, change, (key,)) if key in ("model", "bed") else node
