"""Checked medium of a config -> the medium that acts; presets by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from granular_contact.config import load_medium, schema
from granular_contact.errors import scene_error
from granular_contact.laws.albert import Albert
from granular_contact.laws.allen import Allen
from granular_contact.laws.bingham import Bingham
from granular_contact.laws.drft import Drft
from granular_contact.laws.hill import Hill
from granular_contact.laws.katsuragi_durian import KatsuragiDurian
from granular_contact.laws.kinds import Medium
from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.laws.linear_depth import LinearDepth
from granular_contact.laws.poncelet import Poncelet
from granular_contact.laws.rft import Coefficients, Rft
from granular_contact.laws.rft3d import Rft3d
from granular_contact.laws.tsimring_volfson import TsimringVolfson
from granular_contact.laws.validity import Validity

# One line a law: its coefficients from the keys of its schema class.
LAWS: dict[type, Callable[..., Medium]] = {
    schema.LeeMarghitu: lambda s, **more: LeeMarghitu(
        s.density_kg_m3, s.eta_d, s.eta_h, _vertical(s.plunging), _vertical(s.withdrawing or s.plunging), **more
    ),
    schema.Albert: lambda s, **more: Albert(s.density_kg_m3, s.eta_h, **more),
    schema.Hill: lambda s, **more: Hill(
        s.density_kg_m3, _vertical(s.plunging), _vertical(s.withdrawing), s.length_scale_m, **more
    ),
    schema.Rft: lambda s, **more: Rft(_coefficients(s), s.zeta, **more),
    schema.Drft: lambda s, **more: Drft(_coefficients(s), s.density_kg_m3, s.lambda_, s.zeta, s.surface_drop_m, **more),
    schema.Rft3d: lambda s, **more: Rft3d(s.density_kg_m3, s.mu_int, s.mu_surf, **more),
    schema.Bingham: lambda s, **more: Bingham(s.yield_force_N, s.viscosity_N_s_m, **more),
    schema.Poncelet: lambda s, **more: Poncelet(s.constant_force_N, s.drag_kg_m, **more),
    schema.Allen: lambda s, **more: Allen(s.drag_kg_m, s.viscosity_N_s_m, s.constant_force_N, **more),
    schema.LinearDepth: lambda s, **more: LinearDepth(s.stiffness_N_m, **more),
    schema.TsimringVolfson: lambda s, **more: TsimringVolfson(s.drag_kg_m, s.friction_N, s.exponent, **more),
    schema.KatsuragiDurian: lambda s, **more: KatsuragiDurian(
        s.stiffness_N_m, s.drag_length_m or 0.0, s.drag_length_diameters or 0.0, **more
    ),
}


def _vertical(s: schema.VerticalStatic) -> VerticalResistance:
    return VerticalResistance(s.eta_v, s.lambda_)


def _coefficients(s: schema.Rft | schema.Drft) -> Coefficients:
    return Coefficients(**s.alpha_N_cm3.model_dump())


def missing(spec: schema.AnyLaw) -> list[str]:
    """Keys without which the medium can't act: those that its source leaves open."""
    open_keys: dict[type, str] = {schema.Hill: "density_kg_m3", schema.KatsuragiDurian: "stiffness_N_m"}
    key = open_keys.get(type(spec))
    return [key] if key is not None and getattr(spec, key) is None else []


def medium(spec: schema.AnyLaw) -> Medium:
    """Medium of a checked config that lacks nothing; what withdrawing leaves out is as for plunging."""
    stated = spec.range
    validity = Validity(stated.speed_m_s, stated.depth_m, stated.size_m)
    return LAWS[type(spec)](spec, name=spec.name or spec.law, validity=validity)


def preset(name: str, **values: Any) -> Medium:
    """Medium by the name of its preset (`play_sand`) or by the path of a YAML file.

    values: top-level keys that replace those of the preset, as stiffness_N_m=60.

    Raises
    ------
    ConfigError
        There is no such medium, with a list of those there are, or a value is at fault.
    SceneError
        The preset lacks a number that its source does not state: give it among the values.
    """
    spec = load_medium(name, **values)
    for key in missing(spec):
        raise scene_error(f"medium.{key}", f"the source of {name} does not state it: give the number of your case")
    return medium(spec)
