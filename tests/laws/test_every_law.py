"""What holds for every law of the list, whatever it is: physics, units, words and schema.

Numbers are made from the keys of its coefficients, so a law that is added to the list is held to all of this at once.
Tangents, frames and sums of work of every law: tests/kernels and tests/properties, whose media are those of the list,
which is asserted here.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from random import Random
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from support_every_law import NONE, UNITS, WITHOUT_UNIT, bodies, motions, sample, total, unit

from granular_contact.config import json_schema
from granular_contact.laws.catalogue import LAWS, laws_for
from granular_contact.laws.coefficients import Coefficients
from granular_contact.laws.kinds import SHAPE_NAMES
from granular_contact.laws.law import METADATA, Law
from granular_contact.laws.probe import force
from granular_contact.sand.kernels.law import TERMS
from validation.fuzzing import media

EVERY = pytest.mark.parametrize("law", LAWS.values(), ids=list(LAWS))
MIRROR = np.array([-1.0, 1.0])
DEPTH = 0.04


@cache
def schema_of_a_run() -> dict[str, Any]:
    return json_schema()


def coefficients(law: type[Coefficients]) -> dict[str, type[Coefficients]]:
    """Keys of all numbers of a law, those of its parts too, with their class."""
    classes: dict[str, type[Coefficients]] = {}
    for name, field in law.model_fields.items():
        if name in (*METADATA, "law"):
            continue
        if isinstance(field.annotation, type) and issubclass(field.annotation, Coefficients):
            classes |= coefficients(field.annotation)
        else:
            classes[field.alias or name] = law
    return classes


def test_random_media_draw_every_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those without numbers of their own, too: a law that is new."""
    assert set(LAWS) == {law for family in media.FAMILIES.values() for law in family}
    monkeypatch.setattr(media, "LAWS", {})
    for tag in ("albert", "rft3d", "tsimring_volfson"):
        assert LAWS[tag].model_validate({"law": tag} | media.numbers(Random(3), tag)).terms


@EVERY
def test_every_law_dissipates(law: type[Law]) -> None:
    medium = sample(law)
    for body in bodies(medium, DEPTH):
        powers = np.array([total(medium, body, v) @ v for v in motions()])
        assert (powers <= 0.0).all()
        assert powers.min() < -1e-6  # and does something


@EVERY
def test_force_on_the_mirror_image_is_the_mirrored_force(law: type[Law]) -> None:
    medium = sample(law)
    for body in bodies(medium, DEPTH):
        image = replace(body, points=body.points * MIRROR)
        for v in motions():
            want = total(medium, body, v) * MIRROR
            # Closed forms and sums of a few hundred products: round-off.
            np.testing.assert_allclose(total(medium, image, v * MIRROR), want, rtol=1e-10, atol=1e-12 * abs(want).max())


@EVERY
def test_force_starts_at_zero_at_the_surface(law: type[Law]) -> None:
    medium, v = sample(law), np.array([0.3, -0.5])
    for above, at, deep in zip(bodies(medium, -1e-9), bodies(medium, 1e-9), bodies(medium, DEPTH), strict=True):
        assert not total(medium, above, v).any()
        # What grows slowest grows in proportion to a depth of 1e-3 diameters, of which this is 4e-5.
        assert np.linalg.norm(total(medium, at, v)) < 1e-4 * np.linalg.norm(total(medium, deep, v))


@EVERY
def test_forces_of_a_law_scale_with_the_units_of_its_keys(law: type[Law]) -> None:
    # The same bed and body in units of mass and length that are smaller by these factors, and in a unit of time in
    # which gravity has the same number, as its value is a constant of some laws.
    mass, length = 3.0, 1.7
    time = math.sqrt(length)
    original, scaled = sample(law), sample(law, (mass, length, time))
    if law.tag() == "tsimring_volfson":  # its k is given at the depth of 1 m, so that its unit is N/m^p
        scaled = replace(scaled, friction=scaled.friction / length**original.exponent)
    forces_original = bodies(original, DEPTH)
    forces_scaled = bodies(scaled, DEPTH * length, length, mass)
    for body, image in zip(forces_original, forces_scaled, strict=True):
        for v in motions():
            want = total(original, body, v) * mass * length / time**2
            np.testing.assert_allclose(
                total(scaled, image, v * length / time), want, rtol=1e-9, atol=1e-9 * abs(want).max()
            )


@EVERY
def test_a_law_has_the_terms_it_names(law: type[Law]) -> None:
    medium = sample(law)
    assert 1 <= len(law.terms) == len(set(law.terms)) <= TERMS
    for body in bodies(medium, DEPTH):
        forces = np.array([force(medium, body, v) for v in motions()])
        assert (np.abs(forces).max(axis=(0, 2)) > 0.0).all()  # each of them does something


@EVERY
def test_a_law_describes_its_equation_shapes_and_tag(law: type[Law]) -> None:
    assert law.__doc__
    assert "=" in law.equation
    assert law.takes
    assert law.takes <= set(SHAPE_NAMES)
    assert all(law.tag() in laws_for(kind) for kind in law.takes)
    schema = schema_of_a_run()
    assert schema["$defs"][law.__name__]["properties"]["law"]["const"] == law.tag()
    assert "law" in schema["$defs"][law.__name__]["required"]
    for key in coefficients(law):
        assert (unit(key)[0] != NONE) == any(key.endswith(end) for end in UNITS)


@EVERY
def test_coefficients_must_be_finite_numbers_within_bounds(law: type[Law]) -> None:
    plain = sample(law).model_dump(by_alias=True)
    law.model_validate(plain)
    for key, owner in coefficients(law).items():
        if owner is law:
            for wrong in (math.nan, math.inf, "1", True, -WITHOUT_UNIT):
                with pytest.raises(ValidationError, match=key):
                    law.model_validate(plain | {key: wrong})
