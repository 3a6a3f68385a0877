"""What a YAML file means to be, by its keys: a search, a sweep, a fit, or else a config."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from granular_contact.config import tree
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
    root = read_file(Path(path), [])
    return set(root.nodes) if isinstance(root, tree.Mapping) else set()
