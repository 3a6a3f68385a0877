"""The functions of a law of your own are checked before they are compiled; what can't be compiled is one sentence."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

from granular_contact import Law, simulate
from granular_contact.config import allowed
from granular_contact.config.schema import Bed, BedLayer, Scenario
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.functions import check_law
from granular_contact.sand.kernels import facet_blocks, law, plates
from granular_contact.sand.kernels.signatures import IN_PLANE, IN_SPACE, arguments

SURFACES = frozenset({"round", "flat", "outline"})


class Winkler(Law):
    """Pressure k z, without a function that says so."""

    law: Literal["winkler"]
    equation = "p = k z"
    terms = ("static",)
    takes: ClassVar[Any] = SURFACES
    constants = ("k",)

    def numbers(self, gravity: float) -> dict[str, float]:  # noqa: ARG002
        """Of any."""
        return {"k": 2e5}


def law_with(**members: Any) -> type[Law]:
    """A law with these members."""
    return type("Own", (Winkler,), {"__module__": __name__, **members})


@pytest.fixture
def forgotten() -> Iterator[None]:
    yield
    LAWS.pop("winkler", None)
    for part in (BedLayer, Bed, Scenario, *Scenario.__subclasses__()):
        part.model_rebuild(force=True)
    allowed.clear_cache()


def test_expected_arguments_of_law_functions_are_those_of_kernels() -> None:
    stubs: dict[str, Callable[..., Any]] = {
        **{name: getattr(law, name) for name in ("strip_force", "cap_force", "ball_force", "drag_anchor")},
        **{"stress": plates.stress, "traction": plates.traction},
        **{f"facet_{name}": getattr(facet_blocks, name) for name in ("stress", "traction", "inertia", "force")},
    }
    for name, stub in stubs.items():
        assert arguments(name) == [
            "m" if argument == "medium" else argument for argument in inspect.signature(stub).parameters
        ], name
    assert (IN_PLANE | IN_SPACE).keys() - stubs.keys() == {"bar_force", "bar_cap", "space_ball_force"}


def test_laws_of_the_package_have_what_is_wanted() -> None:
    for known_law in LAWS.values():
        check_law(known_law)


def other_arguments(name: str) -> dict[str, Callable[..., Any]]:
    """Functions that kernels can't call by this name; each by what is said of it."""
    right = arguments(name)
    swapped = [right[1], right[0], *right[2:]]
    lists = {
        "got the arguments (*a)": "*a",
        "got the arguments (**a)": "**a",
        "got the arguments ()": "",
        f"({', '.join(right[1:])})": ", ".join(right[1:]),
        f"(self, {', '.join(right)})": f"self, {', '.join(right)}",
        f"(*, {', '.join(right)})": f"*, {', '.join(right)}",
        f"with {right[1]}, {right[0]} at another place": ", ".join(swapped),
    }
    return {message: eval(f"lambda {given}: None") for message, given in lists.items()}


@pytest.mark.parametrize("name", [*IN_PLANE, *IN_SPACE])
def test_other_arguments_are_refused_with_those_wanted(name: str) -> None:
    for message, function in other_arguments(name).items():
        with pytest.raises(TypeError) as caught:
            check_law(_with(name, function))
        (line,) = [text_line for text_line in str(caught.value).splitlines() if f"Own.{name}:" in text_line]
        assert message in line
        assert f"wanted is a static method {name}({', '.join(arguments(name))})" in line


def _with(name: str, function: Any) -> type[Law]:
    return law_with(**{name: staticmethod(function)})


def test_law_functions_that_raise_are_refused() -> None:
    """It is called by its address, and what it raised would be printed and passed over."""

    def stress(t, u, m):  # type: ignore[no-untyped-def]  # noqa: ARG001
        if u[1] > 0.0:
            raise ValueError("upward")
        return 0.0, -m.k

    with pytest.raises(TypeError, match=r"Own.stress: it raises or asserts.*wanted is a static method stress\("):
        check_law(law_with(stress=staticmethod(stress)))


def test_names_of_arguments_are_free() -> None:
    check_law(law_with(stress=staticmethod(lambda a, b, numbers: (0.0, 0.0))))  # noqa: ARG005


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({}, r"Own takes flat, outline, round, but has no stress\(t, u, m\)"),
        ({"takes": frozenset({"ball"})}, r"Own takes ball, but has no ball_force\(z, v, e, line, m, f\)"),
        ({"stress": staticmethod(max)}, "Own.stress: got builtin_function_or_method, which is no plain function"),
        ({"terms": ("a", "b", "c", "d")}, "Own.terms: got 4, allowed are 1 to 3"),
        ({"constants": "k"}, "Own.constants: got 'k', allowed is a tuple of names"),
        ({"takes": frozenset({"plate"})}, "Own.takes: got plate, allowed are round, flat, outline, ball"),
    ],
)
def test_a_class_that_is_no_law_is_refused(members: dict[str, Any], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        check_law(law_with(**members))


def disc(law: type[Law]) -> None:
    """Run a disc in a medium of this law."""
    shapes = [{"type": "disc", "diameter_m": 0.1, "thickness_m": 0.1}]
    body = {"type": "rigid", "mass_kg": 5, "inertia_kg_m2": 0.02, "shapes": shapes}
    free = {"type": "free", "parent": "ground", "child": "disc"}
    model = {"name": "disc", "bodies": {"disc": body}, "joints": {"fall": free}}
    simulate({"model": model, "medium": {"law": "winkler"}, "solver": {"end_time_s": 0.01}}, laws=[law])


def undefined(t, u, m):  # type: ignore[no-untyped-def]  # noqa: ARG001
    return 0.0, m.k * something  # type: ignore[name-defined]  # noqa: F821


@pytest.mark.slow
@pytest.mark.usefixtures("forgotten")
@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({"stress": staticmethod(undefined)}, "the law Own can't be compiled: stress: .*'something' is not defined"),
        (
            {"stress": staticmethod(lambda t, u, m: m.k)},  # noqa: ARG005
            r"stress gives float64, wanted is stress\(t, u, m\), which gives a tuple of 2 numbers",
        ),
        (
            {"stress": staticmethod(lambda t, u, m: (0.0, m.stiffness))},  # noqa: ARG005
            "m has no 'stiffness'; the law's constants are k",
        ),
        (
            {"facet_stress": staticmethod(lambda n, u, m: (0.0, 0.0, -m.k))},  # noqa: ARG005
            "the law Own has no force in the plane",
        ),
        (
            {
                "stress": staticmethod(lambda t, u, m: (0.0, -m.k)),  # noqa: ARG005
                "numbers": lambda self, gravity: {"q": 1.0},  # noqa: ARG005
            },
            "Own.numbers gives q; allowed are the names in its constants: k",
        ),
    ],
    ids=["name", "result", "constant", "plane", "numbers"],
)
def test_functions_that_do_not_compile_are_refused_in_one_sentence(members: dict[str, Any], message: str) -> None:
    with pytest.raises(TypeError, match=message) as caught:
        disc(law_with(**members))
    assert len(str(caught.value).splitlines()) == 1


def through_an_array(t, u, m):  # type: ignore[no-untyped-def]  # noqa: ARG001
    stresses = np.zeros(2)
    stresses[1] = -m.q * u[1]
    return stresses[0], stresses[1]


@pytest.mark.slow
@pytest.mark.usefixtures("forgotten")
def test_functions_of_own_laws_may_create_arrays() -> None:
    """Functions of the package make none, and are compiled without what arrays need."""
    # Another constant, or its record would be that of the laws above.
    disc(law_with(stress=staticmethod(through_an_array), constants=("q",), numbers=lambda self, gravity: {"q": 2e5}))  # noqa: ARG005
