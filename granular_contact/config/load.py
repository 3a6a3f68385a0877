"""Load a config with overrides as a checked scenario, and a medium by its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter, ValidationError

from granular_contact import examples
from granular_contact.config import overrides as setting
from granular_contact.config import tree
from granular_contact.config.add_law import add_law
from granular_contact.config.given import changes as changes_of
from granular_contact.config.given import plain_data
from granular_contact.config.messages import by_place, faults_of
from granular_contact.config.references import MEDIA, Resolver, readable_path
from granular_contact.config.schema import Medium, Scenario
from granular_contact.config.template import NAMELESS, Loaded, Template
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault, listed, of_type, scene_error
from granular_contact.values.strict import did_you_mean

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from granular_contact.config.given import Changes
    from granular_contact.laws.law import Law

# Config as the functions that run one take it: the result of `load`, its scenario, or an argument of `load`.
Given = Scenario | Loaded | str | PathLike[str] | Mapping[str, Any]
_MODEL_KEYS = {"urdf", "bodies", "chain"}  # a file of a model has one of them


def load(
    source: str | PathLike[str] | Mapping[str, Any],
    overrides: Sequence[str] | Mapping[str, Any] = (),
    *,
    laws: Sequence[type[Law]] = (),
    **changes: Unpack[Changes],
) -> Loaded:
    """Read, resolve and check one config.

    Parameters
    ----------
    source : str, path or mapping
        YAML file; or the name of a config that comes with the package, as `runner`; or the content of such a file.
    overrides : sequence of str, or mapping
        Texts `dotted.key=value`, or values by dotted key. An override that names a model or a medium is applied first,
        then the model and the medium are read, then the other overrides are applied. Paths start from the working
        folder.
    laws : sequence of types of Law
        Laws of your own, which the config may name by their tags. They are registered as by `add_law`, also for configs
        that are read later.
    **changes
        Values by the keys of a config, as `solver={"accuracy": 1e-3}`. A mapping changes only the keys that it names,
        unless it says its kind (`type`, `law` or `from`).

    Returns
    -------
    Loaded
        The `scenario`, and the files and lines of its keys. `simulate`, `build` and `sweep` take it as an argument.

    Raises
    ------
    ConfigError
        With every fault found, sorted by file and line.

    Examples
    --------
    >>> load("runner", solver={"accuracy": 1e-3}, medium="poppy_seeds_loose").scenario.solver.accuracy
    0.001
    """
    of_type("source", source, (str, PathLike, Mapping), "the name of a config, as 'pendulum', its file, or a mapping")
    if not isinstance(overrides, Mapping):
        listed("overrides", overrides, str, "['solver.end_time_s=1'] or {'solver.end_time_s': 1}")
    listed("laws", laws, type, "a list of classes, as [MyLaw]")
    for law in laws:
        add_law(law)
    faults: list[Fault] = []
    if isinstance(source, Mapping):
        path, root = Path(NAMELESS), tree.from_plain(plain_data(source), tree.Position(NAMELESS, None))
    else:
        path = _file(source, faults)
        if path.suffix.lower() == ".urdf" and not faults:
            message = "is a robot file, and not the config of a run, which names it: `model: {urdf: FILE}`"
            raise ConfigError([tree.Position(str(path), None).fault((), message)])
        root = tree.Broken(tree.Position(str(path), None)) if faults else read_file(path, faults)
    if isinstance(root, tree.Mapping) and "model" not in root.nodes and _MODEL_KEYS & set(root.nodes):
        message = "is a model, and not the config of a run, which names it: `model: FILE`"
        raise ConfigError([tree.Position(str(path), None).fault((), message)])
    by_text = [] if isinstance(overrides, Mapping) else setting.parse(overrides, faults)
    by_value = changes_of({**overrides, **changes} if isinstance(overrides, Mapping) else changes, "load", faults)
    return Template(root, path, faults).make(setting.effective([*by_text, *by_value]), faults)


def loaded(given: Given) -> Scenario | Loaded:
    """Load a config, unless it is loaded already.

    Parameters
    ----------
    given : Scenario, Loaded, str, path or mapping
        Result or first argument of `load`.

    Returns
    -------
    Scenario or Loaded
        `given` itself if it has one of these types; else what `load` returns.

    Raises
    ------
    ConfigError, TypeError
        As `load`.
    """
    return given if isinstance(given, Scenario | Loaded) else load(given)


def scenario_given(given: Given) -> Scenario:
    """Scenario of a config, which is loaded unless it is already.

    Parameters
    ----------
    given : Scenario, Loaded, str, path or mapping
        Result or first argument of `load`.

    Returns
    -------
    Scenario
        Without the files and lines of its keys. A Scenario is returned as it is, without a check.

    Raises
    ------
    ConfigError, TypeError
        As `load`.
    """
    config = loaded(given)
    return config.scenario if isinstance(config, Loaded) else config


def _file(source: str | PathLike[str], faults: list[Fault]) -> Path:
    """The file at the path `source` if it exists, else the shipped config of this name; with a fault if none exists."""
    given_path = Path(source)
    path = examples.named(given_path)
    if path != given_path:
        return readable_path(path)
    if path.name == str(source) and not path.exists():
        names = examples.config_names()
        file = path.with_name(f"{path.name}.yaml")
        near = f"did you mean {file}?" if file.exists() else did_you_mean(path.stem, names)
        hint = near or ("" if path.suffix else f"there are {', '.join(names)}")
        message = f"no such file, and no config of this name is shipped; {hint}" if hint else "no such file"
        faults.append(Fault(str(path), None, "", message))
    return path


def load_scenario(path: str | PathLike[str], overrides: Sequence[str] = ()) -> Scenario:
    """The scenario that `load` gives, without the files and lines of its keys.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a config that comes with the package.
    overrides : sequence of str, optional
        Texts `dotted.key=value`, as for `load`.

    Returns
    -------
    Scenario

    Raises
    ------
    ConfigError, TypeError
        As `load`.
    """
    return load(path, overrides).scenario


def load_medium(name: str, **values: Any) -> Medium:
    """Load a medium: a preset, or the medium in a YAML file.

    Parameters
    ----------
    name : str
        Name of a preset; or the path of a file that ends in .yaml or .yml, relative to the working folder.
    **values
        Values by the keys of the medium, in the units of these keys. They replace the values of the file.

    Returns
    -------
    Medium
        The checked medium, of the class of its law.

    Raises
    ------
    ConfigError
        There is no such medium, its file is faulty, or a value is not allowed.
    TypeError
        `name` is no text.
    """
    faults: list[Fault] = []
    of_type("name", name, str, "the name of a preset, as 'play_sand', or the path of a YAML file, as a text")
    at = tree.Position("", None)
    node = Resolver(Path("medium"), faults).resolve(tree.Scalar(at, name, name), MEDIA)
    if not faults:
        try:
            return TypeAdapter[Medium](Medium).validate_python(tree.plain(node) | values)
        except ValidationError as error:
            faults += faults_of(error.errors(include_url=False, include_input=False), node)
    raise ConfigError(sorted(faults, key=by_place))


def preset(name: str, **values: Any) -> Law:
    """Medium of a preset, or of a YAML file.

    Parameters
    ----------
    name : str
        Name of a preset, as `play_sand`, or path of a YAML file, from the working folder.
    **values
        Values that replace those of the preset, by their keys in YAML, as `stiffness_N_m=60`.

    Returns
    -------
    Law
        The medium, for `GranularBed` or `scenario.replace({"medium": ...})`.

    Raises
    ------
    ConfigError
        There is no such medium (the message lists the presets), or a value is not allowed.
    SceneError
        A number is missing that the source of the preset does not state: give it among the values.

    Examples
    --------
    >>> from granular_contact import preset
    >>> preset("play_sand").eta_d
    6.5
    >>> preset("play_sand", eta_d=5.0).eta_d
    5.0
    """
    medium: Law = load_medium(name, **values)
    for key in medium.lacking:
        raise scene_error(f"medium.{key}", f"the source of {name} does not state it: give the number of your case")
    return medium
