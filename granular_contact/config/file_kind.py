"""The kind of a YAML file by its keys: a sweep, a fit, or else a config."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from granular_contact.config import tree
from granular_contact.config.yaml_source import read_file


def is_sweep(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` is a sweep by its keys; False for one that can't be read."""
    return bool({"config", "cases", "vary", "sample"} & _keys(path))


def is_fit(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` is a fit file by its keys; False for one that can't be read."""
    return "runs" in _keys(path)


def _keys(path: str | PathLike[str]) -> set[str]:
    root = read_file(Path(path), [])
    return set(root.nodes) if isinstance(root, tree.Mapping) else set()
