"""Strains and stresses of links that bend, in the plane and in space, and a yield stress that is passed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from granular_contact import Results, load, simulate

LENGTH, DENSITY, MODULUS = 0.3, 1200.0, 2e9
SECTIONS = {"round": {"diameter_m": 0.006}, "flat": {"width_m": 0.02, "thickness_m": 0.003}}


def cantilever(in_space: bool, section: str, **flexible: Any) -> Results:
    """A link that stands out of a wall under its own weight; deflections are a hundredth of its length and less."""
    elastic = {"youngs_modulus_Pa": MODULUS, "elements": 16} | flexible
    link = {"type": "link", "length_m": LENGTH, **SECTIONS[section], "density_kg_m3": DENSITY, "flexible": elastic}
    joints = {"wall": {"type": "weld", "parent": "ground", "child": "link"}}
    model = {"name": "cantilever", "bodies": {"link": link}, "joints": joints} | (
        {"in_space": True} if in_space else {}
    )
    solver = {"end_time_s": 4e-4, "step_s": 1e-4}
    return simulate(load({"model": model, "gravity_m_s2": 1.0, "initial": {"settle": True}, "solver": solver}))


@pytest.mark.slow
@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("in_space", [False, True])
def test_strain_at_the_root_is_that_of_the_moment_there(in_space: bool, section: str) -> None:
    """M = q L^2 / 2 there, and M c / I its stress; both beams err by a share of (1 / 16)^2."""
    results, sizes = cantilever(in_space, section), SECTIONS[section]
    thick = sizes.get("diameter_m", sizes.get("thickness_m"))
    area = np.pi / 4.0 * thick**2 if section == "round" else sizes["width_m"] * thick
    inertia = area * thick**2 / (16.0 if section == "round" else 12.0)
    stress = 0.5 * DENSITY * area * LENGTH**2 * 0.5 * thick / inertia
    assert results["link_root_strain"][0] == pytest.approx(stress / MODULUS, rel=0.01)
    assert results["link_strain"][0] == pytest.approx(stress / MODULUS, rel=0.01)
    most = results.summary["links"]["link"]
    assert most["stress_Pa"] == pytest.approx(stress, rel=0.01)
    assert most["root_stress_Pa"] == pytest.approx(stress, rel=0.01)
    assert most["place_m"] < 0.01
    assert most["strain"] == results["link_strain"].max() >= most["root_strain"]


@pytest.mark.slow
@pytest.mark.parametrize("in_space", [False, True])
def test_a_yield_stress_that_is_passed_is_reported(in_space: bool) -> None:
    """From both sides: a little above the greatest stress, and a little below it."""
    most = cantilever(in_space, "round").summary["links"]["link"]["stress_Pa"]
    for factor, warned in ((1.02, False), (0.98, True)):
        results = cantilever(in_space, "round", yield_stress_Pa=factor * most)
        sentences = [sentence for sentence in results.warnings if "yield_stress_Pa" in sentence]
        assert bool(sentences) is warned
        assert all(
            sentence.startswith("the stress of link comes to") and ", at its root at" in sentence
            for sentence in sentences
        )


def test_torsion_has_its_shear_in_the_stress() -> None:
    """Twist phi per length of a round rod is a shear G r phi, sqrt(3) times that by von Mises; damped, so uniform."""
    elastic = {"youngs_modulus_Pa": MODULUS, "elements": 4, "torsion_damping_N_m2_s": 1e-4}
    rod = {"type": "link", "length_m": LENGTH, "diameter_m": 0.006, "density_kg_m3": DENSITY, "flexible": elastic}
    arm = {"type": "rigid", "mass_kg": 0.01, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), 1e-5)}
    joints = {
        "bearing": {
            "type": "hinge",
            "parent": "rod",
            "child": "arm",
            "axis": [1, 0, 0],
            "parent_point_m": [LENGTH, 0, 0],
        },
        "wall": {"type": "weld", "parent": "ground", "child": "rod"},
    }
    joints["bearing"] |= {"spring": {"stiffness_Nm_per_rad": 0.02, "rest_deg": 90.0}}
    model = {"in_space": True, "name": "torsion", "bodies": {"rod": rod, "arm": arm}, "joints": joints}
    config = {
        "model": model,
        "gravity_m_s2": 0.0,
        "solver": {"end_time_s": 0.02, "accuracy": 1e-3, "rest_time_s": None},
    }
    results = simulate(load(config))
    k = int(np.argmax(np.abs(results["rod_twist_deg"])))
    twist = np.radians(abs(results["rod_twist_deg"][k])) / LENGTH
    assert twist > 0.1
    stress = np.sqrt(3.0) * MODULUS / 2.6 * 0.003 * twist
    assert results.summary["links"]["rod"]["stress_Pa"] == pytest.approx(stress, rel=0.1)
