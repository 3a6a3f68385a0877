"""Ensembles: one run with many seeds of its medium's scatter, on the workers of sweeps; mean, quantiles, bands."""

from __future__ import annotations

from granular_contact.studies.ensemble.calls import cases, ensemble
from granular_contact.studies.ensemble.runs import observed
from granular_contact.studies.ensemble.statistics import Numbers, Summary, of_rows

__all__ = ["Numbers", "Summary", "cases", "ensemble", "observed", "of_rows"]
