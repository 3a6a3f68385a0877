"""Scenarios from one config with different overrides, and a map from their keys to files and lines.

Parts that several scenarios share are read and checked once.
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
from granular_contact.config.messages import by_place, faults_of, root_of_kind
from granular_contact.config.references import MEDIA, MODELS, Resolver, with_true_provenance_each
from granular_contact.config.schema import Scenario
from granular_contact.config.schema.initial import unused_signals
from granular_contact.config.structure_errors import structure_errors, too_large
from granular_contact.errors import ConfigError, Fault
from granular_contact.values.scalars import resolve

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from granular_contact.config.given import Changes

Change = Callable[[tree.Node], tree.Node]
NAMELESS = "scenario"  # name of a config that is in no file
_MOST_KEPT = 64  # number of trees with resolved references that are kept
_SHARED = ("model", "load", "solver", "output", "method")  # parts that are often the same in many scenarios


class SourceMap:
    """Files and lines in which the keys of a scenario were written: its config, model, medium and overrides."""

    def __init__(self, root: tree.Node, notices: Sequence[str] = ()) -> None:
        """Map the keys of a tree.

        notices: sentences about the files that are no faults: unused signals, parts of a robot file that were skipped.
        """
        self.root, self.notices = root, tuple(notices)

    def locate(self, key: str) -> tuple[str, int | None]:
        """File and line in which a key was written; those of the nearest enclosing key if the config does not have the
        key.

        Parameters
        ----------
        key : str
            Dotted key of a config, with indices of lists as digits: `bed.layers.0.medium`.

        Returns
        -------
        tuple
            File as the user named it (`--set KEY=VALUE` for such an override), and line from 1. The line is None for
            `--set` and for values from Python.
        """
        return tree.find(self.root, key.split("."))[0].position

    def place(self, faults: Iterable[Fault]) -> list[Fault]:
        """Give faults the files and lines of their keys.

        Parameters
        ----------
        faults : iterable of Fault
            Faults with dotted keys. A fault that has a file already keeps its file and line.

        Returns
        -------
        list of Fault
            All faults, sorted by file and line.
        """
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
        """Return the scenario with other values. Unchanged keys keep their files and lines in messages.

        Parameters
        ----------
        values : mapping, optional
            Values by dotted key, as for `Scenario.replace`.
        **changes
            Values by the keys of a config.

        Returns
        -------
        Loaded

        Raises
        ------
        ConfigError
            With every fault, each with its key, what was got and what is allowed.
        """
        faults: list[Fault] = []
        overrides = changes_of(merged(values, changes), "replace", faults)
        return Template(self.sources.root, Path(self.scenario.name or NAMELESS), []).make(overrides, faults)

    def _repr_html_(self) -> str:
        return self.scenario._repr_html_()

    def __repr__(self) -> str:
        file = self.sources.locate("model")[0]
        return f"<loaded from {file}: {self.scenario!r}>" if file else f"<loaded: {self.scenario!r}>"


class _Part(NamedTuple):
    """One key of a config at the top of the file.

    written: its tree in the file; read: this tree with the numbers of CSV files in it; value: the checked value, which
    other scenarios may share, or None.
    """

    written: tree.Node
    read: tree.Node
    value: Any = None


class Template:
    """A config that is read once, to make scenarios with different overrides."""

    def __init__(self, root: tree.Node, path: Path, faults: list[Fault]) -> None:
        """Take the tree of the config in the file `path`.

        Raises
        ------
        ConfigError
            The tree is no config; with the `faults` found so far.
        """
        root = root_of_kind(root, Scenario, "not a config", faults, also=("config",))
        if "config" in root.nodes and "model" not in root.nodes:
            at = root.keys["config"]
            faults.append(at.fault(("config",), "stands in a sweep only; the config of one run is needed here"))
            raise ConfigError(sorted(faults, key=by_place))
        self._root, self._path = root, path
        self._resolved: dict[tuple[setting.Override, ...], tuple[tree.Node, list[str]]] = {}
        self._parts: dict[str, _Part] = {}  # parts of the last scenario
        self._small: tree.Node | None = None  # the last tree in which no number is too large

    def make(self, overrides: Sequence[setting.Override], faults: Sequence[Fault] = ()) -> Loaded:
        """The scenario with the overrides applied.

        Raises
        ------
        ConfigError
            With `faults` and all further faults.
        """
        all_faults = list(faults)
        resolved, notices = self._with_references(
            tuple(override for override in overrides if override.is_reference), all_faults
        )
        changed = setting.apply(resolved, [override for override in overrides if not override.is_reference], all_faults)
        node = _named(_with_true_provenance(resolved, changed), self._path)
        assert isinstance(node, tree.Mapping)  # as the root, see __init__
        if not self._is_small(resolved, overrides):
            all_faults += too_large(node)
        parts = {key: self._part(key, below, all_faults) for key, below in node.nodes.items()}
        node = tree.Mapping(node.position, {key: part.read for key, part in parts.items()}, node.keys)
        checked = {key: part.value for key, part in parts.items() if part.value is not None}
        scenario = scenario_of(node, all_faults, checked)
        new = [key for key in _SHARED if key in parts and parts[key].value is None]
        self._parts = parts | {key: parts[key]._replace(value=getattr(scenario, key)) for key in new}
        notices = [*notices, *_unused(node, scenario)]
        return Loaded(scenario, SourceMap(node, notices))

    def _is_small(self, resolved: tree.Node, overrides: Sequence[setting.Override]) -> bool:
        """Whether no number is too large, in the tree before the overrides and in the overrides.

        The result for the tree is kept, since the same tree comes with many overrides.
        """
        if self._small is not resolved and not any(too_large(resolved)):
            self._small = resolved
        return self._small is resolved and not any(
            fault for override in overrides for fault in too_large(override.value)
        )

    def _part(self, key: str, written: tree.Node, faults: list[Fault]) -> _Part:
        """The part under a key, with the numbers of its CSV files; that of the last scenario if it is unchanged."""
        known = self._parts.get(key)
        if known is not None and known.written is written:
            return known
        folder = self._path.parent
        node = with_numbers(written, key, folder, faults)
        return _Part(written, with_paths(node, key, folder))

    @property
    def names_columns(self) -> bool:
        """Whether the config may name CSV files of signals, regardless of overrides."""
        return any(tree.child(self._root, key) is not None for key in COLUMN_KEYS)

    def _with_references(
        self, references: tuple[setting.Override, ...], faults: list[Fault]
    ) -> tuple[tree.Node, list[str]]:
        """The tree in which names of models and media are replaced by their content, and notices.

        references: overrides that name models or media. The result without faults is kept for the same references.
        """
        if references in self._resolved:
            return self._resolved[references]
        before = len(faults)
        node = setting.apply(self._root, references, faults)
        resolver = Resolver(self._path, faults)
        node = tree.change_key(node, "model", partial(resolver.resolve, library=MODELS))
        medium = partial(resolver.resolve, library=MEDIA)
        layers = partial(_each, change=partial(tree.change_key, key="medium", change=medium))
        node = tree.change_key(node, "medium", partial(_each, change=medium))
        node = tree.change_key(node, "bed", partial(tree.change_key, key="layers", change=layers))
        notices = [str(notice) for notice in resolver.notices]
        if len(faults) == before:
            if len(self._resolved) == _MOST_KEPT:
                self._resolved.clear()
            self._resolved[references] = node, notices
        return node, notices


def scenario_of(node: tree.Node, faults: Sequence[Fault], known: Mapping[str, Any] | None = None) -> Scenario:
    """The scenario of a tree in which all references are resolved.

    known: values of parts that were checked before, by their keys.

    Raises
    ------
    ConfigError
        With `faults` and all further faults.
    """
    all_faults, scenario, kind = list(faults), None, scenario_class(node)
    try:
        nodes = node.nodes if isinstance(node, tree.Mapping) else {}
        values = {key: known[key] if known and key in known else tree.plain(below) for key, below in nodes.items()}
        scenario = kind.model_validate(values)
    except ValidationError as error:
        errors = error.errors(include_url=False, include_input=False)
        all_faults += faults_of([*errors, *structure_errors(node, errors)], node, kind)
    # A `Broken` node gives no scenario and no further fault: its fault was reported when the node was read.
    if all_faults or scenario is None:
        raise ConfigError(sorted(all_faults, key=by_place))
    return scenario


def _unused(node: tree.Node, scenario: Scenario) -> Iterator[str]:
    """Notices of shared signals that no drive uses."""
    for name in unused_signals(scenario.drives, scenario.signals):
        at = tree.key_position(node, ("signals", name))
        yield str(at.fault(("signals", name), "no drive uses it; a drive gives its name as the signal"))


def _with_true_provenance(before: tree.Node, node: tree.Node) -> tree.Node:
    """`node` with corrected provenance of the media in which overrides changed numbers, see `config.references`.

    before: the tree without these overrides.
    """

    def restate(holder: tree.Node, original: tree.Node | None) -> tree.Node:
        """A config or a layer with the provenance of its medium corrected."""
        if original is None:
            return holder
        return tree.change_key(holder, "medium", partial(with_true_provenance_each, tree.child(original, "medium")))

    originals, _ = tree.find(before, ("bed", "layers"))
    if isinstance(originals, tree.Items):
        layers_changed = partial(_paired, others=originals, change=restate)
        node = tree.change_key(node, "bed", partial(tree.change_key, key="layers", change=layers_changed))
    return restate(node, before)


def _each(node: tree.Node, change: Change) -> tree.Node:
    """A list with `change` applied to each item; any other node with `change` applied to it."""
    if not isinstance(node, tree.Items):
        return change(node)
    return tree.Items(node.position, tuple(change(item) for item in node.nodes))


def _paired(node: tree.Node, others: tree.Items, change: Callable[[tree.Node, tree.Node], tree.Node]) -> tree.Node:
    """A list with `change` applied to each item and the item of `others` with the same index.

    A node that is no list of the same length is returned as it is.
    """
    if not isinstance(node, tree.Items) or len(node.nodes) != len(others.nodes):
        return node
    return tree.Items(node.position, tuple(map(change, node.nodes, others.nodes)))


def _named(root: tree.Node, path: Path) -> tree.Node:
    """`root` with a name: its own, else the stem of the file, or the whole file name if the stem reads as a number."""
    name_node = tree.child(root, "name")
    if not isinstance(root, tree.Mapping) or (name_node is not None and tree.plain(name_node) is not None):
        return root
    at = tree.Position(str(path), None)
    name = path.stem if isinstance(resolve(path.stem), str) else path.name
    return tree.set_key(root, "name", tree.Scalar(at, name, name), at)
