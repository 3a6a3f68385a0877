"""How the coefficients of a law scale with gravity, and what that rests on.

A law says it beside each coefficient, `stiffness: Annotated[NotNegative, measured(1, "...")]`. A medium says the
gravity g_m at which it was measured; at another gravity g a coefficient c is

    c(g) = c(g_m) (g / g_m)^power

where the power is known, and stays as it is, with a warning, where it is not. `derived` powers are those of rigid
grains without cohesion that resist by friction and by their inertia: their density is all that has a unit, so that a
static resistance is in proportion to rho g, and an inertial one does not depend on g [Slonaker et al. 2017].
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
SAME = 0.01  # of gravity: less than a hundredth is another place on Earth, or another rounding


@dataclass(frozen=True)
class GravityScaling:
    """Power of gravity to which a coefficient is in proportion, None where it is not known; and what that rests on."""

    power: float | None
    basis: Literal["derived", "measured", "not known"]
    why: str

    def __str__(self) -> str:
        """In one sentence."""
        if self.power is None:
            return f"not known: {self.why}"
        words = {0.0: "does not depend on g", 1.0: "in proportion to g"}.get(self.power, f"as g^{self.power:g}")
        return f"{words}, {self.basis}: {self.why}"


def derived(power: float, why: str) -> GravityScaling:
    """A power that follows from an argument."""
    return GravityScaling(float(power), "derived", why)


def measured(power: float, why: str) -> GravityScaling:
    """A power that experiments or simulations of grains at several gravities found."""
    return GravityScaling(float(power), "measured", why)


def not_known(why: str) -> GravityScaling:
    """A coefficient of which nobody knows."""
    return GravityScaling(None, "not known", why)


BULK = derived(0, "a density of the packing")
INERTIA = derived(0, "the inertia of the grains pushed away has no g in it")
WITH_WEIGHT = derived(0, "a number; the law has g beside it")
SHAPE = derived(0, "an angle, a length or a power")
FRICTION = derived(0, "a friction coefficient or angle of the grains")
UNSTATED = not_known("the law does not say")


def scalings(law: type[Coefficients]) -> dict[str, GravityScaling]:
    """How each coefficient of a law scales, by its name; those of a part by its dotted name, unless the part says."""
    from granular_contact.laws.law import ABOUT

    found: dict[str, GravityScaling] = {}
    for name, field in law.model_fields.items():
        if name in (*ABOUT, "law"):
            continue
        said = _said(field)
        if said is None and (part := _part(field.annotation)) is not None:
            found |= {f"{name}.{below}": one for below, one in scalings(part).items()}
        else:
            found[name] = said or UNSTATED
    return found


def _part(annotation: Any) -> type[Coefficients] | None:
    return annotation if isinstance(annotation, type) and issubclass(annotation, Coefficients) else None


def at_gravity(medium: Law, gravity: float) -> Law:
    """A medium with those of its coefficients scaled whose scaling is known; gravity (m/s2), 0 or more."""
    ratio = gravity / medium.measured_gravity
    if ratio == 1.0:
        return medium
    scaled: Law = _at(medium, ratio)
    return scaled


def _at(coefficients: Any, ratio: float) -> Any:
    changed = {}
    for name, field in type(coefficients).model_fields.items():
        value, said = getattr(coefficients, name), _said(field)
        if said is not None and said.power and value is not None:
            changed[name] = _times(value, ratio**said.power)
        elif said is None and isinstance(value, Coefficients) and (part := _at(value, ratio)) is not value:
            changed[name] = part
    return coefficients.model_copy(update=changed) if changed else coefficients


def _times(value: Any, factor: float) -> Any:
    """A number times a factor, or each of a set of numbers."""
    if isinstance(value, Coefficients):
        return value.model_copy(update={name: factor * one for name, one in dict(value).items()})
    return tuple(factor * one for one in value) if isinstance(value, tuple) else factor * value


def _said(field: FieldInfo) -> GravityScaling | None:
    return next((one for one in field.metadata if isinstance(one, GravityScaling)), None)


def gravity_notes(medium: Law, gravity: float) -> Iterator[str]:
    """Sentences on what is assumed of a medium that meets another gravity (m/s2) than it was measured at."""
    gravity, at = abs(gravity), medium.measured_gravity
    if abs(gravity - at) <= SAME * at:
        return
    found = {key_of(type(medium), n): one for n, one in scalings(type(medium)).items() if _counts(medium, n)}
    if as_they_are := [key for key, one in found.items() if one.power is None]:
        yield (
            f"{medium.name} is of {at:g} m/s2, gravity is {gravity:g} m/s2, and how these scale with it is not known, "
            f"so that they are used as they are: {', '.join(as_they_are)}"
        )
    scaled = [key for key, one in found.items() if one.power]
    if scaled and "measured_gravity" not in medium.model_fields_set:
        yield (
            f"{medium.name} does not say at which gravity it was measured; these are scaled from {at:g} to {gravity:g} "
            f"m/s2: {', '.join(scaled)}; say measured_gravity_m_s2"
        )


def _counts(medium: Law, name: str) -> bool:
    """Whether a coefficient does anything: it is given, and not 0."""
    value: Any = medium
    for part in name.split("."):
        value = getattr(value, part)
    return value is not None and value != 0.0


def key_of(law: type[Coefficients], name: str) -> str:
    """A coefficient's key in YAML."""
    first, *below = name.split(".")
    return ".".join((law.model_fields[first].alias or first, *below))
