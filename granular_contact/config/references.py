"""References to models and media: replace names and paths by trees, merged with the keys beside `from`.

The provenance of a medium is corrected if a config changes some of its numbers: a preset with a changed number is no
longer published, and a fitted medium no longer fitted.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from granular_contact.config import tree
from granular_contact.config.messages import got, kind_of
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import Fault, short
from granular_contact.laws.catalogue import LAWS
from granular_contact.robot.files import is_file
from granular_contact.values.strict import did_you_mean

FROM, LAW, SCATTER = "from", "law", "measured_scatter"
_NAME = re.compile(r"[A-Za-z0-9_-]+")
_PACKAGE = Path(__file__).parents[1]


@dataclass(frozen=True)
class Library:
    """Folders in which files of one kind are found by name.

    key: key of a scenario that names such a file; noun: word for the kind in messages; folders: gives the folders, in
    order, for the folder of the file that contains the name.
    """

    key: str
    noun: str
    folders: Callable[[Path], list[Path]]


def _model_folders(folder: Path) -> list[Path]:
    # The last folder is for an editable install, in which the models are beside the package.
    return [folder / ".." / "models", folder / "models", folder, _PACKAGE / "models", _PACKAGE.parent / "models"]


MODELS = Library("model", "model", _model_folders)
MEDIA = Library("medium", "medium preset", lambda _: [_PACKAGE / "laws" / "presets"])


def medium_names() -> list[str]:
    """Names of all medium presets."""
    return sorted(path.stem for folder in MEDIA.folders(Path()) for path in folder.glob("*.yaml"))


class Resolver:
    """Replaces references to models and media by their trees. Faults are appended to `faults`.

    notices: sentences about parts of robot files that were skipped.
    """

    def __init__(self, config: Path, faults: list[Fault]) -> None:
        self._config, self._faults = config, faults
        self.notices: list[Fault] = []

    def resolve(self, node: tree.Node, library: Library) -> tree.Node:
        """Tree of a model or medium that is given as a name, a path, or a mapping with or without `from`.

        null is returned as it is.
        """
        if isinstance(node, tree.Scalar) and node.value is None:
            return node
        if isinstance(node, tree.Mapping) or (isinstance(node, tree.Scalar) and isinstance(node.value, str)):
            expanded = self._expand(node, library, self._config, ())
            if library is MODELS and isinstance(expanded, tree.Mapping) and "urdf" in expanded.nodes:
                from granular_contact.config.urdf import mechanism  # loaded for robot files alone

                return mechanism(expanded, self._faults, self.notices)
            return expanded
        if isinstance(node, tree.Broken):
            return node
        return self._refuse(node.position, (library.key,), f"got {got(node)}; allowed is {_forms(library)}")

    def _refuse(self, position: tree.Position, path: tuple[str, ...], message: str) -> tree.Broken:
        """Append a fault, and return the node that stands for the faulty one."""
        self._faults.append(position.fault(path, message))
        return tree.Broken(position)

    def _expand(self, node: tree.Node, library: Library, file: Path, chain: tuple[Path, ...]) -> tree.Node:
        """`node`, merged over the model or medium that it refers to.

        file: the file that contains the node; chain: the files whose references led to it, from the first one.
        """
        if isinstance(node, tree.Scalar):
            return self._load(node, library, (library.key,), file, chain)
        if not isinstance(node, tree.Mapping):
            return node
        if isinstance(node.nodes.get(SCATTER), tree.Scalar) and library is MEDIA:
            node = self._with_scatter(node, file, chain)
        if FROM not in node.nodes:
            return node
        base = self._load(node.nodes[FROM], library, (library.key, FROM), file, chain)
        if isinstance(base, tree.Broken):
            return base
        if library is not MEDIA:
            return tree.merge(base, tree.drop_key(node, FROM))
        base_law, law = tree.child(base, LAW), tree.child(node, LAW)
        if base_law is not None and law is not None and tree.plain(base_law) != tree.plain(law):
            reason = f"got {got(law)}, but {tree.plain(node.nodes[FROM])} is of the law {tree.plain(base_law)}"
            message = f"{reason}, and law can't change under from: leave one of the two out"
            return self._refuse(node.keys[LAW], (library.key, LAW), message)
        return with_true_provenance(base, tree.merge(base, tree.drop_key(node, FROM)))

    def _with_scatter(self, node: tree.Mapping, file: Path, chain: tuple[Path, ...]) -> tree.Mapping:
        """A medium whose `measured_scatter` names another medium, with the measurements of that medium in its place.

        The other medium is the same sand in another law.
        """
        name = node.nodes[SCATTER]
        other = self._load(name, MEDIA, (MEDIA.key, SCATTER), file, chain)
        none = tree.Items(name.position, ())
        measured = other if isinstance(other, tree.Broken) else tree.child(other, SCATTER) or none
        return tree.set_key(node, SCATTER, measured, node.keys[SCATTER])

    def _load(
        self, node: tree.Node, library: Library, path: tuple[str, ...], file: Path, chain: tuple[Path, ...]
    ) -> tree.Node:
        """Tree of the model or medium that `node` names; path: key of the node; file, chain: as for `_expand`."""
        if isinstance(node, tree.Broken):
            return node
        if not isinstance(node, tree.Scalar) or not isinstance(node.value, str):
            return self._refuse(node.position, path, f"got {got(node)}; allowed is {_forms(library)}")
        source = _find(node.value, library, file, folder=file.parent if node.position.line is not None else Path())
        if isinstance(source, str):
            return self._refuse(node.position, path, source)
        real_path = source.resolve()
        if real_path in chain:
            names = " -> ".join(link.name for link in (*chain[chain.index(real_path) :], real_path))
            return self._refuse(node.position, path, f"got {node.value!r}, which leads back to itself: {names}")
        root = read_file(readable_path(source), self._faults)
        if isinstance(root, tree.Mapping):
            expanded = self._expand(root, library, source, (*chain, real_path))
            return _at_name(expanded, node.position) if library is MEDIA else expanded
        if isinstance(root, tree.Broken):
            return root
        return self._refuse(
            root.position, (library.key,), f"is not a {library.noun}: it holds {kind_of(root)}; allowed is a mapping"
        )


def _at_name(node: tree.Node, at: tree.Position) -> tree.Node:
    """A medium with the position `at` of its name, and its nulls with this position too.

    So faults of the whole medium, and of numbers that its source does not state, point to the config that names the
    medium: there another medium or the missing number has to be given.
    """
    if not isinstance(node, tree.Mapping):
        return node
    node = tree.Mapping(at, node.nodes, node.keys)
    for key, value in node.nodes.items():
        if isinstance(value, tree.Scalar) and value.value is None:
            node = tree.set_key(node, key, tree.Scalar(at, None, value.text), at)
    return node


def _forms(library: Library) -> str:
    """Allowed forms of a reference, for messages."""
    return f"the name of a {library.noun}, a path ending in .yaml, or a mapping"


def _find(name: str, library: Library, file: Path, folder: Path) -> Path | str:
    """File of the model or medium `name`, or a sentence that says why there is none.

    file: the file that contains the name; folder: where relative paths start, the folder of this file, or the working
    folder for a name from the command line or from Python.
    """
    quoted = repr(short(name))
    if name.endswith((".yaml", ".yml")):
        path = folder / name
        start = "the folder of the config" if folder == file.parent else "the working folder"
        missing = f"got {quoted}, but there is no file {readable_path(path)}; paths start from {start}, or from /"
        return path if is_file(path) else missing
    folders = library.folders(file.parent)
    if _NAME.fullmatch(name):
        for place in folders:
            path = place / f"{name}.yaml"
            if not is_file(path) or path.resolve() == file.resolve():
                continue
            if place != file.parent or not _is_scenario(path, library):
                return path
    # The folder of the config mostly contains configs; a message that lists them as models would mislead.
    listed = [place for place in folders if place != file.parent]
    known = sorted({path.stem for place in listed if place.is_dir() for path in place.glob("*.yaml")})
    if library is MEDIA and name in LAWS:
        return f"got {quoted}, which is a law and no medium; give its numbers, as medium: {{law: {name}, ...}}"
    hint = f"{did_you_mean(name, known)} there are {', '.join(known) or 'none'}".strip()
    return f"got {quoted}, but there is no such {library.noun}; {hint}"


def _is_scenario(path: Path, library: Library) -> bool:
    """Whether a file is a config, not a model or medium: a config may have the name of a model."""
    root = read_file(readable_path(path), [])
    return isinstance(root, tree.Mapping) and library.key in root.nodes


def readable_path(path: Path) -> Path:
    """`path` without `..`, and relative if it is below the working folder."""
    full = Path(os.path.normpath(path))
    if not full.is_absolute():
        return full
    working = Path.cwd()
    return full.relative_to(working) if full.is_relative_to(working) else full


ABOUT = frozenset(
    {"law", "name", "source", "standing", "provenance", "range", "scatter", "measured_scatter", "angle_of_repose_deg"}
)  # keys of a medium that are no numbers of its law


def with_true_provenance(base: tree.Node | None, node: tree.Node) -> tree.Node:
    """The medium `node`, which was merged over `base`, with corrected provenance and standing if a number differs.

    A provenance or standing that differs from that of `base` stays. A medium without both is returned as it is.
    """
    if not isinstance(base, tree.Mapping) or not isinstance(node, tree.Mapping) or base is node:
        return node
    numbers = sorted(key for key in node.nodes.keys() - ABOUT if _is_changed(base.nodes.get(key), node.nodes[key]))
    if not numbers or not any(_states(base, key) for key in ("provenance", "standing")):
        return node
    at = node.keys[numbers[0]]
    corrected = {"provenance": "own", "standing": _standing(base, numbers)}
    for key, text in corrected.items():
        if node.nodes.get(key) is base.nodes.get(key):
            node = tree.set_key(node, key, tree.Scalar(at, text, text), at)
    return node


def with_true_provenance_each(base: tree.Node | None, node: tree.Node) -> tree.Node:
    """`with_true_provenance` of a medium, or of each medium in a list."""
    if isinstance(base, tree.Items) and isinstance(node, tree.Items) and len(base.nodes) == len(node.nodes):
        return tree.Items(node.position, tuple(map(with_true_provenance, base.nodes, node.nodes)))
    return with_true_provenance(base, node)


def _is_changed(before: tree.Node | None, after: tree.Node) -> bool:
    """Whether a number was changed. To give a number that the source does not state (null) is no change.

    A group of numbers that is null, for example withdrawing, is an exception: null means that other numbers of the
    medium are used, so giving the group is a change.
    """
    if before is after:
        return False
    if isinstance(before, tree.Scalar) and before.value is None:
        return isinstance(after, tree.Mapping)
    return before is None or tree.plain(before) != tree.plain(after)


def _states(medium: tree.Mapping, key: str) -> bool:
    """Whether a medium has a value other than null under a key."""
    value = tree.child(medium, key)
    return value is not None and tree.plain(value) is not None


def _standing(base: tree.Mapping, numbers: list[str]) -> str:
    """Standing of a medium with changed numbers: the name of the original medium, and all changed keys."""
    name, standing = (tree.child(base, key) for key in ("name", "standing"))
    beginning = f"changed from {tree.plain(name) if name is not None else 'another'}: "
    before = str(tree.plain(standing)) if standing is not None else ""
    earlier = before.removeprefix(beginning).split(", ") if before.startswith(beginning) else []
    return beginning + ", ".join(sorted({*earlier, *numbers}))
