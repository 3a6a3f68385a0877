"""Clamped-free modes against the beam equation, its boundary conditions and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from support_runs import LENGTH, LINE_MASS, STIFFNESS

from granular_contact.engines.modal.modes import Modes, roots

XI, WEIGHT = np.polynomial.legendre.leggauss(200)  # exact to round-off for 20 half waves
XI, WEIGHT = 0.5 * (1 + XI), 0.5 * WEIGHT
ALL = Modes(roots(20), LENGTH)


def test_roots_are_those_of_the_textbooks():
    # Blevins (1979), table 8-1: ten digits given.
    np.testing.assert_allclose(roots(5), [1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839], atol=1e-8)
    # cos(beta) = -1 / cosh(beta); cos has slope 1 there, and beta is good to 1e-15 of 60.
    np.testing.assert_allclose(np.cos(roots(20)) + 1 / np.cosh(roots(20)), 0, atol=1e-13)


def test_first_frequency_of_the_papers_link():
    assert ALL.frequencies(STIFFNESS, LINE_MASS)[0] == pytest.approx(77.4, abs=0.05)


def test_shapes_meet_the_boundary_conditions():
    ends = np.array([0.0, LENGTH])
    shape, curvature = ALL.shape(ends), ALL.curvature(ends) * LENGTH**2
    # Sums of four terms of order 1, times beta^2 < 4000 for the curvature.
    np.testing.assert_allclose(shape[0], 0, atol=1e-14)
    np.testing.assert_allclose(shape[1], 1, atol=1e-14)
    np.testing.assert_allclose(curvature[1], 0, atol=1e-11)
    slope = (ALL.shape(np.array([1e-7]))[0] - shape[0]) / 1e-7
    np.testing.assert_allclose(slope, 0, atol=1e-6 * ALL.beta[-1] ** 2 / LENGTH**2)


def test_orthogonal_and_scaled():
    shape, curvature = ALL.shape(XI * LENGTH), ALL.curvature(XI * LENGTH)
    np.testing.assert_allclose(shape.T @ (WEIGHT[:, None] * shape), np.eye(20) / 4, atol=1e-13)
    bent = LENGTH * curvature.T @ (WEIGHT[:, None] * curvature) / ALL.bending()
    # Off the diagonal what remains of round-off, in units of the smaller of two stiffnesses.
    np.testing.assert_allclose(np.triu(bent), np.eye(20), atol=1e-9)


def test_moments_are_the_integrals():
    shape = ALL.shape(XI * LENGTH)
    np.testing.assert_allclose(WEIGHT @ shape, ALL.mean(), atol=1e-14)
    np.testing.assert_allclose((WEIGHT * XI) @ shape, ALL.first_moment(), atol=1e-14)


def test_the_twentieth_mode_keeps_its_digits():
    """Fourth derivative beta^4 Phi, by differences: what the textbook form gets wrong by exp(60) times round-off."""
    step = LENGTH / 4000
    z = np.linspace(0.05, 0.95, 37) * LENGTH
    stencil = np.array([ALL.curvature(z + k * step)[:, -1] for k in (-1, 0, 1)])
    fourth = (stencil[0] - 2 * stencil[1] + stencil[2]) / step**2
    wanted = (ALL.beta[-1] / LENGTH) ** 4 * ALL.shape(z)[:, -1]
    # Error of the difference: (beta step / L)^2 / 12 = 2e-5 of a mode whose largest value is 1.
    np.testing.assert_allclose(fourth / (ALL.beta[-1] / LENGTH) ** 4, wanted / (ALL.beta[-1] / LENGTH) ** 4, atol=3e-5)
