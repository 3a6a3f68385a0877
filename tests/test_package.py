"""The public names of the package exist and are documented, whatever was imported before."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from types import FunctionType

import pytest
from support_runs import ROOT

import granular_contact

CODE = """
import granular_contact.run, granular_contact.scene.build, granular_contact.config.load
import granular_contact
for name in {names!r}:
    thing = getattr(granular_contact, name)
    assert callable(thing), (name, thing)
    assert thing.__doc__, name
"""


@pytest.mark.parametrize("step", [1, -1])
def test_every_name_is_a_thing_to_call_whatever_was_loaded_before_it(step: int) -> None:
    code = CODE.format(names=granular_contact.__all__[::step])
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.stderr == ""


def test_unknown_attributes_of_the_package_are_refused() -> None:
    with pytest.raises(AttributeError, match="no attribute 'grains'"):
        granular_contact.grains  # noqa: B018


def test_a_run_without_files() -> None:
    scenario = granular_contact.load(ROOT / "configs" / "pendulum_rigid.yaml").scenario
    results = granular_contact.simulate(granular_contact.build(scenario), scenario)
    assert results.status.code == "rest"


def test_help_lists_the_public_names() -> None:
    """The first page of `help(granular_contact)` names all of it; completion offers it and nothing else."""
    assert dir(granular_contact) == granular_contact.__all__
    mentioned = set(re.findall(r"\w+", granular_contact.__doc__ or ""))
    assert set(granular_contact.__all__) - mentioned == {"RftCoefficients", "VerticalResistance"}  # parts of their laws


def calls(name: str, thing: object) -> Iterator[tuple[str, FunctionType]]:
    """A function, or the methods of a class that users call, by name."""
    if isinstance(thing, FunctionType):
        yield name, thing
    for key, value in vars(thing).items() if isinstance(thing, type) else ():
        function = getattr(value, "__func__", value)
        if not key.startswith("_") and isinstance(function, FunctionType):
            yield f"{name}.{key}", function


def test_public_functions_document_arguments_results_and_errors() -> None:
    """Docstrings have the sections of numpydoc, with the name of each argument in them; functions an example too."""
    from granular_contact.config.schema import Scenario
    from granular_contact.config.template import Loaded

    homes = [getattr(granular_contact, name) for name in ("GranularBed", "Results", "Simulation")]
    homes += map(extra, ("gym.GranularEnv", "mujoco.MujocoBed"))
    functions = [getattr(granular_contact, name) for name in granular_contact.__all__]
    things = [*homes, Loaded, *(parameter for parameter in functions if isinstance(parameter, FunctionType))]
    public = dict(call for thing in things for call in calls(thing.__name__, thing))
    public |= {"Scenario.replace": Scenario.replace, "Mesh.read": granular_contact.Mesh.read.__func__}
    lacking = []
    for name, function in public.items():
        text, given = inspect.getdoc(function) or "", inspect.signature(function)
        sections = dict(re.findall(r"^(\w+)\n-{4,}\n(.*?)(?=^\w+\n-{4,}|\Z)", text, re.M | re.S))
        documented = set(re.findall(r"\w+", " ".join(re.findall(r"^\S.*", sections.get("Parameters", ""), re.M))))
        lacking += [
            f"{name}: {parameter}" for parameter in given.parameters if parameter not in documented | {"self", "cls"}
        ]
        if given.return_annotation != "None" and "Returns" not in sections:
            lacking.append(f"{name}: Returns")
        if re.search(r"^\s+raise \w", inspect.getsource(function), re.M) and "Raises" not in sections:
            lacking.append(f"{name}: Raises")
        if "." not in name and "Examples" not in sections:
            lacking.append(f"{name}: Examples")
    assert lacking == []
    assert len(public) > 40


def test_laws_and_shapes_say_what_they_are_made_of() -> None:
    """Each number of a law, a shape, a layer or a floor is among the Parameters of its class, or of the one above."""
    from granular_contact.laws.catalogue import LAWS

    named = [getattr(granular_contact, name) for name in granular_contact.__all__]
    kinds = [kind_ for kind_ in named if isinstance(kind_, type) and hasattr(kind_, "__dataclass_fields__")]
    for kind in {*kinds, *LAWS.values()} - {granular_contact.Results}:
        texts = (inspect.cleandoc(kind_.__doc__ or "") for kind_ in kind.__mro__)
        documented = " ".join(line for text in texts for line in re.findall(r"^\S.* : .*", text, re.M))
        fields = [name for name, field in kind.__dataclass_fields__.items() if getattr(field, "init", True)]
        assert set(fields) <= set(re.findall(r"\w+", documented)), kind.__name__


def extra(path: str) -> type:
    """A class that needs an extra of the package."""
    module, _, name = path.partition(".")
    pytest.importorskip({"gym": "gymnasium"}.get(module, module))
    kind: type = getattr(import_module(f"granular_contact.{module}"), name)
    return kind


def test_media_and_simulations_are_shown_in_a_line() -> None:
    medium = granular_contact.preset("hill_cylinders", density_kg_m3=1500)
    assert repr(medium).startswith("Hill(density=1500.0, ")
    assert len(repr(medium)) < 200
    assert "<td>law</td><td>hill</td>" in medium._repr_html_()
    loaded = granular_contact.load("pendulum_rigid", solver={"end_time_s": 0.01})
    assert loaded._repr_html_() == loaded.scenario._repr_html_()
    simulation = granular_contact.Simulation(loaded)
    assert repr(simulation) == "<simulation of pendulum_rigid: 0 of 0.01 s, controls: none>"
    assert repr(simulation.state()) == "<state of pendulum_rigid at 0 s>"
