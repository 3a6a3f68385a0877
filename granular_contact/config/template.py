"""A config that was read -> scenarios with different overrides, and where each key was written.

What several scenarios have in common is read and checked once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import ValidationError

from granular_contact.config import overrides as setting
from granular_contact.config import tree
from granular_contact.config.columns import KEYS as COLUMN_KEYS
from granular_contact.config.columns import with_numbers
from granular_contact.config.file_kind import scenario_class, with_paths
from granular_contact.config.given import changes as changes_of
from granular_contact.config.given import merged
from granular_contact.config.messages import by_place, faults_of, of_file
from granular_contact.config.references import MEDIA, MODELS, Resolver, restated_each
from granular_contact.config.schema import Scenario
from granular_contact.config.schema.initial import unused_signals
from granular_contact.config.structure_errors import structure_errors, too_large
from granular_contact.errors import ConfigError, Fault
from granular_contact.values.scalars import resolve

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from granular_contact.config.given import Changes

Change = Callable[[tree.Node], tree.Node]
NAMELESS = "scenario"  # a config that is in no file
_MOST_KEPT = 64  # trees with their model and medium read in
_SHARED = ("model", "load", "solver", "output", "method")  # parts of a scenario that are the same in many


class SourceMap:
    """Where the keys of a scenario were written, across its config, its model, its medium and the overrides."""

    def __init__(self, root: tree.Node, notices: Sequence[str] = ()) -> None:
        """Of a tree; notices: sentences on keys that still work, and are better written otherwise."""
        self.root, self.notices = root, tuple(notices)

    def locate(self, key: str) -> tuple[str, int | None]:
        """File and line (from 1; None for an override) of a dotted key, or of the nearest one around it."""
        return tree.find(self.root, key.split("."))[0].position

    def place(self, faults: Iterable[Fault]) -> list[Fault]:
        """The faults with file and line filled in where the file is missing, sorted."""
        placed = [fault if fault.file else self._placed(fault) for fault in faults]
        return sorted(placed, key=by_place)

    def _placed(self, fault: Fault) -> Fault:
        file, line = self.locate(fault.key)
        return replace(fault, file=file, line=line)


class Loaded(NamedTuple):
    """A scenario, and the map from its keys to the files it came from."""

    scenario: Scenario
    sources: SourceMap

    def replace(self, values: Mapping[str, Any] | None = None, /, **changes: Unpack[Changes]) -> Loaded:
        """The same with other values; what stays keeps its lines in messages.

        Parameters
        ----------
        values : mapping, optional
            Values by dotted key, as of `Scenario.replace`.
        **changes
            The same by the keys of a config.

        Returns
        -------
        Loaded

        Raises
        ------
        ConfigError
            With every fault, each with its key, what was got and what is allowed.
        """
        faults: list[Fault] = []
        given = changes_of(merged(values, changes), "replace", faults)
        return Template(self.sources.root, Path(self.scenario.name or NAMELESS), []).make(given, faults)

    def _repr_html_(self) -> str:
        return self.scenario._repr_html_()

    def __repr__(self) -> str:
        file = self.sources.locate("model")[0]
        return f"<loaded from {file}: {self.scenario!r}>" if file else f"<loaded: {self.scenario!r}>"


class _Part(NamedTuple):
    """What stands under a key of a config: its tree as it was written and as it is read, and its value, which other
    scenarios may share.
    """

    written: tree.Node
    read: tree.Node
    value: Any = None


class Template:
    """A config that was read once, from which scenarios with different overrides are made."""

    def __init__(self, root: tree.Node, path: Path, faults: list[Fault]) -> None:
        """Take the tree of the config in the file `path`.

        Raises
        ------
        ConfigError
            It is no mapping; with the `faults` found so far.
        """
        root = of_file(root, Scenario, "not a config", faults, also=("config",))
        if "config" in root.nodes and "model" not in root.nodes:
            at = root.keys["config"]
            faults.append(at.fault(("config",), "stands in a sweep only; the config of one run is needed here"))
            raise ConfigError(sorted(faults, key=by_place))
        self._root, self._path = root, path
        self._resolved: dict[tuple[setting.Override, ...], tuple[tree.Node, list[str]]] = {}
        self._parts: dict[str, _Part] = {}  # of the last scenario
        self._small: tree.Node | None = None  # the last tree without a number that is too large

    def make(self, overrides: Sequence[setting.Override], faults: Sequence[Fault] = ()) -> Loaded:
        """The scenario with the overrides in it.

        Raises
        ------
        ConfigError
            With `faults` and what was found besides.
        """
        found = list(faults)
        read, notices = self._with_references(tuple(one for one in overrides if one.is_reference), found)
        changed = setting.apply(read, [one for one in overrides if not one.is_reference], found)
        node = _named(_restated(read, changed), self._path)
        assert isinstance(node, tree.Mapping)  # as the root, see __init__
        if not self._is_small(read, overrides):
            found += too_large(node)
        parts = {key: self._part(key, below, found) for key, below in node.nodes.items()}
        node = tree.Mapping(node.position, {key: one.read for key, one in parts.items()}, node.keys)
        scenario = scenario_of(node, found, {key: one.value for key, one in parts.items() if one.value is not None})
        new = [key for key in _SHARED if key in parts and parts[key].value is None]
        self._parts = parts | {key: parts[key]._replace(value=getattr(scenario, key)) for key in new}
        notices = [*notices, *_unused(node, scenario)]
        return Loaded(scenario, SourceMap(node, notices))

    def _is_small(self, read: tree.Node, overrides: Sequence[setting.Override]) -> bool:
        """Whether no number is too large: of the tree before the overrides, looked through once, and of theirs."""
        if self._small is not read and not any(too_large(read)):
            self._small = read
        return self._small is read and not any(fault for one in overrides for fault in too_large(one.value))

    def _part(self, key: str, written: tree.Node, faults: list[Fault]) -> _Part:
        """The part under a key, with the numbers of its files in it; that of the last scenario if it is the same."""
        known = self._parts.get(key)
        if known is not None and known.written is written:
            return known
        folder = self._path.parent
        node = with_numbers(written, key, folder, faults)
        return _Part(written, with_paths(node, key, folder))

    @property
    def names_columns(self) -> bool:
        """Whether the config, overrides aside, may name files of columns."""
        return any(tree.child(self._root, key) is not None for key in COLUMN_KEYS)

    def _with_references(
        self, references: tuple[setting.Override, ...], faults: list[Fault]
    ) -> tuple[tree.Node, list[str]]:
        """The tree with model and medium read in, and notices; once for the same references, unless with faults."""
        if references in self._resolved:
            return self._resolved[references]
        before = len(faults)
        node = setting.apply(self._root, references, faults)
        resolver = Resolver(self._path, faults)
        node = tree.under(node, "model", partial(resolver.resolve, library=MODELS))
        medium = partial(resolver.resolve, library=MEDIA)
        layers = partial(_each, change=partial(tree.under, key="medium", change=medium))
        node = tree.under(node, "medium", partial(_each, change=medium))
        node = tree.under(node, "bed", partial(tree.under, key="layers", change=layers))
        notices = [str(notice) for notice in resolver.notices]
        if len(faults) == before:
            if len(self._resolved) == _MOST_KEPT:
                self._resolved.clear()
            self._resolved[references] = node, notices
        return node, notices


def scenario_of(node: tree.Node, faults: Sequence[Fault], known: Mapping[str, Any] | None = None) -> Scenario:
    """The scenario of a tree in which nothing is left to be resolved.

    known: parts that were found valid before, by their keys.

    Raises
    ------
    ConfigError
        With `faults` and what was found besides.
    """
    found, scenario, kind = list(faults), None, scenario_class(node)
    try:
        nodes = node.nodes if isinstance(node, tree.Mapping) else {}
        given = {key: known[key] if known and key in known else tree.plain(below) for key, below in nodes.items()}
        scenario = kind.model_validate(given)
    except ValidationError as error:
        errors = error.errors(include_url=False, include_input=False)
        found += faults_of([*errors, *structure_errors(node, errors)], node, kind)
    # What is broken can't be valid, but its fault may have been reported by whoever read it.
    if found or scenario is None:
        raise ConfigError(sorted(found, key=by_place))
    return scenario


def _unused(node: tree.Node, scenario: Scenario) -> Iterator[str]:
    """Notices on shared signals that no drive follows."""
    for name in unused_signals(scenario.drives, scenario.signals):
        at = tree.key_position(node, ("signals", name))
        yield str(at.fault(("signals", name), "no drive uses it; a drive gives its name as the signal"))


def _restated(before: tree.Node, node: tree.Node) -> tree.Node:
    """`node` with the provenance of its media corrected where overrides changed numbers, see `config.references`."""

    def media(one: tree.Node, held: tree.Node | None) -> tree.Node:
        return one if held is None else tree.under(one, "medium", partial(restated_each, tree.child(held, "medium")))

    held, _ = tree.find(before, ("bed", "layers"))
    if isinstance(held, tree.Items):
        node = tree.under(
            node, "bed", lambda bed: tree.under(bed, "layers", lambda layers: _paired(layers, held, media))
        )
    return media(node, before)


def _each(node: tree.Node, change: Change) -> tree.Node:
    """The items of a list changed, or what stands there in its place."""
    if not isinstance(node, tree.Items):
        return change(node)
    return tree.Items(node.position, tuple(change(item) for item in node.nodes))


def _paired(node: tree.Node, held: tree.Items, change: Callable[[tree.Node, tree.Node], tree.Node]) -> tree.Node:
    """The items of a list changed, each with the one that was held in its place."""
    if not isinstance(node, tree.Items) or len(node.nodes) != len(held.nodes):
        return node
    return tree.Items(node.position, tuple(map(change, node.nodes, held.nodes)))


def _named(root: tree.Node, path: Path) -> tree.Node:
    """`root` with the stem of its file for a name, if it has none; the whole name where the stem is a number."""
    held = tree.child(root, "name")
    if not isinstance(root, tree.Mapping) or (held is not None and tree.plain(held) is not None):
        return root
    at = tree.Position(str(path), None)
    name = path.stem if isinstance(resolve(path.stem), str) else path.name
    return tree.set_key(root, "name", tree.Scalar(at, name, name), at)
