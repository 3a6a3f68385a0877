"""Names and paths of models and media -> their trees, merged with the keys beside `from`.

The provenance of a medium is corrected where a config changes some of its numbers: a preset with a changed number is no
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
    """Where files of one kind (`key` of a scenario) are found by name, given the folder of the file that names one."""

    key: str
    noun: str
    folders: Callable[[Path], list[Path]]


def _model_folders(folder: Path) -> list[Path]:
    # The last one serves an editable install, in which the models stand beside the package.
    return [folder / ".." / "models", folder / "models", folder, _PACKAGE / "models", _PACKAGE.parent / "models"]


MODELS = Library("model", "model", _model_folders)
MEDIA = Library("medium", "medium preset", lambda _: [_PACKAGE / "laws" / "presets"])


def medium_names() -> list[str]:
    """Names of all medium presets."""
    return sorted(path.stem for folder in MEDIA.folders(Path()) for path in folder.glob("*.yaml"))


class Resolver:
    """Replaces references by the trees that they refer to; faults are appended to `faults`.

    notices: on what was passed over in a robot file.
    """

    def __init__(self, config: Path, faults: list[Fault]) -> None:
        self._config, self._faults = config, faults
        self.notices: list[Fault] = []

    def resolve(self, node: tree.Node, library: Library) -> tree.Node:
        """Tree of a model or medium given as name, path, or mapping that may have `from`; null is left alone."""
        if isinstance(node, tree.Scalar) and node.value is None:
            return node
        if isinstance(node, tree.Mapping) or (isinstance(node, tree.Scalar) and isinstance(node.value, str)):
            found = self._expand(node, library, self._config, ())
            if library is MODELS and isinstance(found, tree.Mapping) and "urdf" in found.nodes:
                from granular_contact.config.urdf import mechanism  # of a robot file alone

                return mechanism(found, self._faults, self.notices)
            return found
        if isinstance(node, tree.Broken):
            return node
        return self._refuse(node.position, (library.key,), f"got {got(node)}; allowed is {_forms(library)}")

    def _refuse(self, position: tree.Position, path: tuple[str, ...], message: str) -> tree.Broken:
        self._faults.append(position.fault(path, message))
        return tree.Broken(position)

    def _expand(self, node: tree.Node, library: Library, file: Path, chain: tuple[Path, ...]) -> tree.Node:
        """`node`, written in `file`, merged over what it refers to; `chain` holds the files that led here."""
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
        law, given = tree.child(base, LAW), tree.child(node, LAW)
        if law is not None and given is not None and tree.plain(law) != tree.plain(given):
            why = f"got {got(given)}, but {tree.plain(node.nodes[FROM])} is of the law {tree.plain(law)}"
            message = f"{why}, and law can't change under from: leave one of the two out"
            return self._refuse(node.keys[LAW], (library.key, LAW), message)
        return restated(base, tree.merge(base, tree.drop_key(node, FROM)))

    def _with_scatter(self, node: tree.Mapping, file: Path, chain: tuple[Path, ...]) -> tree.Mapping:
        """A medium with what was measured in the one that it names, which is of the same sand by another law."""
        named = node.nodes[SCATTER]
        found = self._load(named, MEDIA, (MEDIA.key, SCATTER), file, chain)
        nothing = tree.Items(named.position, ())
        measured = found if isinstance(found, tree.Broken) else tree.child(found, SCATTER) or nothing
        return tree.set_key(node, SCATTER, measured, node.keys[SCATTER])

    def _load(
        self, node: tree.Node, library: Library, path: tuple[str, ...], file: Path, chain: tuple[Path, ...]
    ) -> tree.Node:
        if isinstance(node, tree.Broken):
            return node
        if not isinstance(node, tree.Scalar) or not isinstance(node.value, str):
            return self._refuse(node.position, path, f"got {got(node)}; allowed is {_forms(library)}")
        found = _find(node.value, library, file, at=file.parent if node.position.line is not None else Path())
        if isinstance(found, str):
            return self._refuse(node.position, path, found)
        real = found.resolve()
        if real in chain:
            names = " -> ".join(link.name for link in (*chain[chain.index(real) :], real))
            return self._refuse(node.position, path, f"got {node.value!r}, which leads back to itself: {names}")
        root = read_file(shown(found), self._faults)
        if isinstance(root, tree.Mapping):
            made = self._expand(root, library, found, (*chain, real))
            return _named_at(made, node.position) if library is MEDIA else made
        if isinstance(root, tree.Broken):
            return root
        return self._refuse(
            root.position, (library.key,), f"is not a {library.noun}: it holds {kind_of(root)}; allowed is a mapping"
        )


def _named_at(node: tree.Node, at: tree.Position) -> tree.Node:
    """A medium at the position of its name, for faults of it as a whole, and its nulls at that position, too: there
    another medium, or the number that its source leaves open, has to be given.
    """
    if not isinstance(node, tree.Mapping):
        return node
    node = tree.Mapping(at, node.nodes, node.keys)
    for key, value in node.nodes.items():
        if isinstance(value, tree.Scalar) and value.value is None:
            node = tree.set_key(node, key, tree.Scalar(at, None, value.text), at)
    return node


def _forms(library: Library) -> str:
    return f"the name of a {library.noun}, a path ending in .yaml, or a mapping"


def _find(name: str, library: Library, file: Path, at: Path) -> Path | str:
    """File of the model or medium called `name` in `file`, or a sentence that says why there is none.

    at: folder that paths start from, that of the file they stand in; of what stands in none, the working folder.
    """
    quoted = repr(short(name))
    if name.endswith((".yaml", ".yml")):
        path = at / name
        start = "the folder of the config" if at == file.parent else "the folder that you are in"
        lost = f"got {quoted}, but there is no file {shown(path)}; paths start from {start}, or from /"
        return path if is_file(path) else lost
    folders = library.folders(file.parent)
    if _NAME.fullmatch(name):
        for folder in folders:
            path = folder / f"{name}.yaml"
            if not is_file(path) or path.resolve() == file.resolve():
                continue
            if folder != file.parent or not _is_scenario(path, library):
                return path
    # The folder of the config itself holds configs mostly; to list them as models would mislead.
    listed = [folder for folder in folders if folder != file.parent]
    known = sorted({path.stem for folder in listed if folder.is_dir() for path in folder.glob("*.yaml")})
    if library is MEDIA and name in LAWS:
        return f"got {quoted}, which is a law and no medium; give its numbers, as medium: {{law: {name}, ...}}"
    hint = f"{did_you_mean(name, known)} there are {', '.join(known) or 'none'}".strip()
    return f"got {quoted}, but there is no such {library.noun}; {hint}"


def _is_scenario(path: Path, library: Library) -> bool:
    """Whether a file is a config: one beside the config that is read may have the name of its model."""
    root = read_file(shown(path), [])
    return isinstance(root, tree.Mapping) and library.key in root.nodes


def shown(path: Path) -> Path:
    """`path` without `..`, and relative if it lies below the current folder."""
    full = Path(os.path.normpath(path))
    if not full.is_absolute():
        return full
    here = Path.cwd()
    return full.relative_to(here) if full.is_relative_to(here) else full


ABOUT = frozenset(
    {"law", "name", "source", "standing", "provenance", "range", "scatter", "measured_scatter", "angle_of_repose_deg"}
)  # all else is a number of the law


def restated(base: tree.Node | None, node: tree.Node) -> tree.Node:
    """The medium `node`, merged over the medium `base`, with its provenance corrected if a number was changed.

    A provenance or standing that was overridden stays, and so does a medium without either.
    """
    if not isinstance(base, tree.Mapping) or not isinstance(node, tree.Mapping) or base is node:
        return node
    numbers = sorted(key for key in node.nodes.keys() - ABOUT if _is_changed(base.nodes.get(key), node.nodes[key]))
    if not numbers or not any(_says(base, key) for key in ("provenance", "standing")):
        return node
    at = node.keys[numbers[0]]
    own = {"provenance": "own", "standing": _standing(base, numbers)}
    for key, text in own.items():
        if node.nodes.get(key) is base.nodes.get(key):
            node = tree.set_key(node, key, tree.Scalar(at, text, text), at)
    return node


def restated_each(base: tree.Node | None, node: tree.Node) -> tree.Node:
    """`restated` of one medium, or of each in a list."""
    if isinstance(base, tree.Items) and isinstance(node, tree.Items) and len(base.nodes) == len(node.nodes):
        return tree.Items(node.position, tuple(map(restated, base.nodes, node.nodes)))
    return restated(base, node)


def _is_changed(before: tree.Node | None, after: tree.Node) -> bool:
    """Whether a number was changed; giving one that its source leaves open (null) is no change.

    A group of numbers that is null, as withdrawing, is not open: it means other numbers of the medium.
    """
    if before is after:
        return False
    if isinstance(before, tree.Scalar) and before.value is None:
        return isinstance(after, tree.Mapping)
    return before is None or tree.plain(before) != tree.plain(after)


def _says(medium: tree.Mapping, key: str) -> bool:
    held = tree.child(medium, key)
    return held is not None and tree.plain(held) is not None


def _standing(base: tree.Mapping, numbers: list[str]) -> str:
    name, held = (tree.child(base, key) for key in ("name", "standing"))
    said = f"changed from {tree.plain(name) if name is not None else 'another'}: "
    before = str(tree.plain(held)) if held is not None else ""
    earlier = before.removeprefix(said).split(", ") if before.startswith(said) else []
    return said + ", ".join(sorted({*earlier, *numbers}))
