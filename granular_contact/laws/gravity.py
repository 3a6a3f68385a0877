"""Scaling of the coefficients of a law with gravity, and the evidence for it.

A law gives the scaling of each coefficient in its annotation, `stiffness: Annotated[NotNegative, measured(1, "...")]`.
A medium gives the gravity g_m at which it was measured. At another gravity g a coefficient c is

    c(g) = c(g_m) (g / g_m)^power

A coefficient whose power is not known is not scaled, and there is a warning. The `derived` powers hold for rigid grains
without cohesion that resist by friction and by their inertia. Only their density has a unit, so a static resistance is
proportional to rho g, and an inertial resistance does not depend on g [Slonaker et al. 2017].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from granular_contact.laws.coefficients import Coefficients

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

    from granular_contact.laws.law import Law

EARTH = 9.81  # m/s2
SAME = 0.01  # relative difference of gravity that counts as none: another place on Earth, or another rounding


@dataclass(frozen=True)
class GravityScaling:
    """Scaling of one coefficient with gravity.

    Parameters
    ----------
    power : float or None
        Power of gravity to which the coefficient is proportional; None where it is not known.
    basis : {"derived", "measured", "not known"}
        Kind of evidence.
    why : str
        The evidence, for messages and the reference.
    """

    power: float | None
    basis: Literal["derived", "measured", "not known"]
    why: str

    def __str__(self) -> str:
        """Return the scaling as one sentence."""
        if self.power is None:
            return f"not known: {self.why}"
        sentence = {0.0: "does not depend on g", 1.0: "in proportion to g"}.get(self.power, f"as g^{self.power:g}")
        return f"{sentence}, {self.basis}: {self.why}"


def derived(power: float, why: str) -> GravityScaling:
    """Scaling whose power follows from an argument.

    Parameters
    ----------
    power : float
        Power of gravity.
    why : str
        The argument.
    """
    return GravityScaling(float(power), "derived", why)


def measured(power: float, why: str) -> GravityScaling:
    """Scaling whose power was found by experiments, or by simulations of grains, at several gravities.

    Parameters
    ----------
    power : float
        Power of gravity.
    why : str
        What was measured, and the source.
    """
    return GravityScaling(float(power), "measured", why)


def not_known(why: str) -> GravityScaling:
    """Scaling of a coefficient whose dependence on gravity is not known.

    Parameters
    ----------
    why : str
        Why it is not known.
    """
    return GravityScaling(None, "not known", why)


BULK = derived(0, "a density of the packing")
INERTIA = derived(0, "the inertia of the grains pushed away has no g in it")
WEIGHT_FACTOR = derived(0, "a number; the law has g beside it")
SHAPE = derived(0, "an angle, a length or a power")
FRICTION = derived(0, "a friction coefficient or angle of the grains")
UNSTATED = not_known("the law does not say")


def scalings(law: type[Coefficients]) -> dict[str, GravityScaling]:
    """Scaling of each coefficient of a law with gravity.

    Parameters
    ----------
    law : type
        Class of a law, or of a nested set of coefficients.

    Returns
    -------
    dict of str to GravityScaling
        By the name of the coefficient. A nested set without a scaling of its own has an entry for each of its
        coefficients, by the dotted name.
    """
    from granular_contact.laws.law import METADATA

    by_name: dict[str, GravityScaling] = {}
    for name, field in law.model_fields.items():
        if name in (*METADATA, "law"):
            continue
        scaling = _scaling(field)
        if scaling is None and (part := _nested(field.annotation)) is not None:
            by_name |= {f"{name}.{inner}": nested for inner, nested in scalings(part).items()}
        else:
            by_name[name] = scaling or UNSTATED
    return by_name


def _nested(annotation: Any) -> type[Coefficients] | None:
    """Class of a nested set of coefficients; None of a plain number."""
    return annotation if isinstance(annotation, type) and issubclass(annotation, Coefficients) else None


def at_gravity(medium: Law, gravity: float) -> Law:
    """Medium with its coefficients scaled to a gravity; those of unknown scaling are unchanged.

    Parameters
    ----------
    medium : Law
        The medium, with `measured_gravity`.
    gravity : float
        Gravity (m/s2), 0 or more.

    Returns
    -------
    Law
        The same object if nothing has to be scaled.
    """
    ratio = gravity / medium.measured_gravity
    if ratio == 1.0:
        return medium
    scaled: Law = _scaled(medium, ratio)
    return scaled


def _scaled(coefficients: Any, ratio: float) -> Any:
    """Copy of coefficients scaled by ratio^power each, nested sets included; ratio: gravity over measured gravity."""
    changed = {}
    for name, field in type(coefficients).model_fields.items():
        value, scaling = getattr(coefficients, name), _scaling(field)
        if scaling is not None and scaling.power and value is not None:
            changed[name] = _scaled_value(value, ratio**scaling.power)
        elif scaling is None and isinstance(value, Coefficients) and (part := _scaled(value, ratio)) is not value:
            changed[name] = part
    return coefficients.model_copy(update=changed) if changed else coefficients


def _scaled_value(value: Any, factor: float) -> Any:
    """Product of a factor and a number, or each number of a set or tuple."""
    if isinstance(value, Coefficients):
        return value.model_copy(update={name: factor * number for name, number in dict(value).items()})
    return tuple(factor * number for number in value) if isinstance(value, tuple) else factor * value


def _scaling(field: FieldInfo) -> GravityScaling | None:
    """Scaling in the annotation of a field; None if it has none."""
    return next((item for item in field.metadata if isinstance(item, GravityScaling)), None)


def gravity_notes(medium: Law, gravity: float) -> Iterator[str]:
    """Sentences on what is assumed of a medium at another gravity than the one of its measurement.

    Parameters
    ----------
    medium : Law
        The medium.
    gravity : float
        Gravity of the run (m/s2); its sign does not matter.

    Yields
    ------
    str
        One sentence on coefficients of unknown scaling; one on those that are scaled from a gravity that the medium
        does not state.
    """
    gravity, g_m = abs(gravity), medium.measured_gravity
    if abs(gravity - g_m) <= SAME * g_m:
        return
    law = type(medium)
    acting = {key_of(law, name): scaling for name, scaling in scalings(law).items() if _acts(medium, name)}
    if as_they_are := [key for key, scaling in acting.items() if scaling.power is None]:
        yield (
            f"{medium.name} is of {g_m:g} m/s2, gravity is {gravity:g} m/s2, and how these scale with it is not known, "
            f"so that they are used as they are: {', '.join(as_they_are)}"
        )
    scaled = [key for key, scaling in acting.items() if scaling.power]
    if scaled and "measured_gravity" not in medium.model_fields_set:
        yield (
            f"{medium.name} does not say at which gravity it was measured; these are scaled from {g_m:g} to "
            f"{gravity:g} m/s2: {', '.join(scaled)}; say measured_gravity_m_s2"
        )


def _acts(medium: Law, name: str) -> bool:
    """Return whether a coefficient has an effect: it is given, and not 0."""
    value: Any = medium
    for part in name.split("."):
        value = getattr(value, part)
    return value is not None and value != 0.0


def key_of(law: type[Coefficients], name: str) -> str:
    """Key of a coefficient in YAML.

    Parameters
    ----------
    law : type
        Class of the law.
    name : str
        Name of the coefficient in Python, dotted if it is nested.

    Returns
    -------
    str
        The key; of a nested coefficient dotted too.
    """
    first, *inner = name.split(".")
    return ".".join((law.model_fields[first].alias or first, *inner))
