"""Kind of a YAML file by its keys: config of a run, sweep, optimisation or fit; in the plane or in space."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from granular_contact import examples
from granular_contact.config import tree
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.tree import Node, Scalar, find, replace_mappings, set_key
from granular_contact.config.yaml_source import read_file

_SEARCH = {"objective", "parameters"}


def is_run(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` is the config of one run by its keys; False for one that can't be read.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a shipped one.

    Returns
    -------
    bool
        Whether the key `model` stands at the top of the file.
    """
    return "model" in _keys(path)


def is_sweep(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` is a sweep by its keys; False for one that can't be read.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a shipped one.

    Returns
    -------
    bool
        Whether `config`, `cases`, `vary` or `sample` stands at the top of the file, but neither `objective` nor
        `parameters`.
    """
    keys = _keys(path)
    return bool({"config", "cases", "vary", "sample"} & keys) and not _SEARCH & keys


def is_optimise(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` is an optimisation by its keys; False for one that can't be read.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a shipped one.

    Returns
    -------
    bool
        Whether `objective` or `parameters` stands at the top of the file, but not `runs`.
    """
    keys = _keys(path)
    return bool(_SEARCH & keys) and "runs" not in keys


def is_fit(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` is a fit file by its keys; False for one that can't be read.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a shipped one.

    Returns
    -------
    bool
        Whether the key `runs` stands at the top of the file.
    """
    return "runs" in _keys(path)


def _keys(path: str | PathLike[str]) -> set[str]:
    """Keys at the top of a YAML file; empty if it can't be read or is no mapping."""
    root = read_file(examples.named(Path(path)), [])
    return set(root.nodes) if isinstance(root, tree.Mapping) else set()


def scenario_class(root: Node) -> type[Scenario]:
    """Class of the scenario of a tree in which the model is resolved.

    That of space if the model has a key `in_space` that is not false: a faulty value is then reported there.
    """
    in_space, missing = find(root, ("model", "in_space"))
    if missing or (isinstance(in_space, Scalar) and in_space.value is False):
        return Scenario
    from granular_contact.config.schema.space import SpatialScenario

    return SpatialScenario


def with_paths(node: Node, key: str, folder: Path) -> Node:
    """The tree under a key of a config in which the files of meshes and height maps have absolute paths.

    Relative paths start from the folder of the file that contains them, those of an override from `folder`.
    """

    def change(node: tree.Mapping, _: tree.Path) -> Node | None:
        file = node.nodes.get("file")
        if not (isinstance(file, Scalar) and isinstance(file.value, str) and file.value):
            return None
        base = Path(file.position.file).parent if file.position.line is not None else folder
        path = str((base / file.value).resolve())
        return set_key(node, "file", Scalar(file.position, path, path), node.keys["file"])

    return replace_mappings(node, change, (key,)) if key in ("model", "bed") else node
