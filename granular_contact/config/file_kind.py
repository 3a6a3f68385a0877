"""What a YAML file means to be, by its keys: a search, a sweep, a fit or a config, and whether it is in space."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from granular_contact import examples
from granular_contact.config import tree
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.tree import Node, Scalar, find, rewritten, set_key
from granular_contact.config.yaml_source import read_file

_SEARCH = {"objective", "parameters"}


def is_run(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` means to be the config of one run; False for one that can't be read."""
    return "model" in _keys(path)


def is_sweep(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` means to be a sweep; False for one that can't be read."""
    keys = _keys(path)
    return bool({"config", "cases", "vary", "sample"} & keys) and not _SEARCH & keys


def is_optimise(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` means to be a search for the best numbers; False for one that can't be read."""
    keys = _keys(path)
    return bool(_SEARCH & keys) and "runs" not in keys


def is_fit(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` is a fit file by its keys; False for one that can't be read."""
    return "runs" in _keys(path)


def _keys(path: str | PathLike[str]) -> set[str]:
    root = read_file(examples.named(Path(path)), [])
    return set(root.nodes) if isinstance(root, tree.Mapping) else set()


def scenario_class(root: Node) -> type[Scenario]:
    """Class of the scenario of a tree in which the model is resolved: that of space where it says so, or tries to."""
    held, missing = find(root, ("model", "in_space"))
    if missing or (isinstance(held, Scalar) and held.value is False):
        return Scenario
    from granular_contact.config.schema.space import SpatialScenario

    return SpatialScenario


def with_paths(node: Node, key: str, folder: Path) -> Node:
    """The tree under a key of a scenario with meshes and maps of heights by their full paths; these start from the
    folder of the file that names them, those of an override from `folder`.
    """

    def change(node: tree.Mapping, _: tree.Path) -> Node | None:
        held = node.nodes.get("file")
        if not (isinstance(held, Scalar) and isinstance(held.value, str) and held.value):
            return None
        base = Path(held.position.file).parent if held.position.line is not None else folder
        path = str((base / held.value).resolve())
        return set_key(node, "file", Scalar(held.position, path, path), node.keys["file"])

    return rewritten(node, change, (key,)) if key in ("model", "bed") else node
